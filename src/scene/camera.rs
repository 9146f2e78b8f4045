//! Sensor, film, filter and sampler from their elements, with Mitsuba 3's defaults.

use super::data::{Film, Filter, Lens, Mesh, Sensor};
use super::error::SceneError;
use super::nearest::shown;
use super::rigid::rigid;
use super::xml::{Object, Tree};
use glam::{Affine3A, DAffine3, DMat3, DVec3, Vec2, Vec3};

/// Film pixels in each direction: more is a typing error, and indices stay within 32 bits.
const MAX_FILM_SIDE_PIXELS: u32 = 65_536;

const DEFAULT_FILM: Film = Film {
    width: 768,
    height: 576,
    crop_offset: [0, 0],
    crop_size: [768, 576],
    filter: Filter::Gaussian { stddev: 0.5 },
    sample_border: false,
};

/// `perspective`, `thinlens` or `orthographic`, under the id it will be listed with.
// Long: one property after another.
pub(super) fn sensor(tree: &Tree, object: &Object, id: String) -> Result<Sensor, SceneError> {
    let mut film_element = None;
    let mut sampler_element = None;
    for child in &object.children {
        let inner = &tree.objects[child.object];
        let slot = match inner.tag {
            "film" => &mut film_element,
            "sampler" => &mut sampler_element,
            _ => return Err(cannot_stand_inside(child, inner, object)),
        };
        if slot.replace(inner).is_some() {
            let what = format!("a sensor has only one {}", inner.tag);
            return Err(SceneError::at(&child.place, what));
        }
    }
    let film = film(tree, film_element)?;
    let (sample_count, seed) = match sampler_element {
        None => (4, 0),
        Some(sampler) => {
            no_children(tree, sampler)?;
            (
                sampler.count("sample_count", 4, 1)?,
                sampler.count("seed", 0, 0)?,
            )
        }
    };
    // Nothing moves while the shutter is open.
    for name in ["shutter_open", "shutter_close"] {
        object.float(name)?;
    }
    let near_clip = object.positive("near_clip", 1e-2)?;
    let far_clip = object.positive("far_clip", 1e4)?;
    if near_clip as f32 >= far_clip as f32 {
        let what =
            format!("\"near_clip\" ({near_clip}) must be smaller than \"far_clip\" ({far_clip})");
        return Err(object.property_error("near_clip", what));
    }
    let aspect = f64::from(film.width) / f64::from(film.height);
    let (lens, to_world, x_fov_rad, clip) = match object.plugin.as_str() {
        "orthographic" => {
            let (to_world, sides) = scaled(object)?;
            // The near plane is scaled with the camera, what lies between the planes is not.
            let near = near_clip * sides.z;
            let clip = [near, near + far_clip - near_clip];
            let half_sides = sides.truncate().as_vec2();
            (Lens::Parallel { half_sides }, to_world, 1.0, clip)
        }
        plugin => {
            let lens = match plugin {
                "thinlens" => thin_lens(object, far_clip)?,
                _ => {
                    // A pinhole has all in focus.
                    object.float("focus_distance")?;
                    Lens::Pinhole
                }
            };
            let to_world = rigid(object, "the camera's")?;
            (
                lens,
                to_world,
                x_fov_rad(object, aspect)?,
                [near_clip, far_clip],
            )
        }
    };
    let offset = |name| Ok::<_, SceneError>(object.float(name)?.unwrap_or(0.0) as f32);
    Ok(Sensor {
        id,
        to_world: to_world.as_affine3a(),
        x_fov_rad: x_fov_rad as f32,
        lens,
        near_clip: clip[0] as f32,
        far_clip: clip[1] as f32,
        principal_point_offset: match lens {
            Lens::Pinhole => Vec2::new(
                offset("principal_point_offset_x")?,
                offset("principal_point_offset_y")?,
            ),
            _ => Vec2::ZERO,
        },
        film,
        sample_count,
        seed,
    })
}

fn thin_lens(object: &Object, far_clip: f64) -> Result<Lens, SceneError> {
    let Some(radius) = object.float("aperture_radius")? else {
        let what = "a thin lens has an \"aperture_radius\", in the units of the scene";
        return Err(object.error(what));
    };
    if radius < 0.0 {
        let what = format!("\"aperture_radius\" must not be negative: {radius}");
        return Err(object.property_error("aperture_radius", what));
    }
    let focus_distance = object.positive("focus_distance", far_clip)?;
    Ok(Lens::Thin {
        aperture_radius: radius as f32,
        focus_distance: focus_distance as f32,
    })
}

/// A `to_world` that may scale along its own axes, as a rigid one and the factors.
fn scaled(object: &Object) -> Result<(DAffine3, DVec3), SceneError> {
    let to_world = object.transform("to_world")?;
    let m = to_world.matrix3;
    let sides = DVec3::new(m.x_axis.length(), m.y_axis.length(), m.z_axis.length());
    let unit = |axis: DVec3| axis.try_normalize();
    let axes = (unit(m.x_axis), unit(m.y_axis), unit(m.z_axis));
    if let (Some(x), Some(y), Some(z)) = axes
        && [x.dot(y), y.dot(z), z.dot(x)]
            .iter()
            .all(|c| c.abs() < 1e-3)
    {
        let axes = DMat3::from_cols(x, y, z);
        let rigid = DAffine3::from_mat3_translation(axes, to_world.translation);
        return Ok((rigid, sides));
    }
    let what = "the camera's to_world is skewed or flat; only rotations, translations and scales along its own axes \
                are allowed";
    Err(object.property_error("to_world", what))
}

/// The camera of a scene that has none: it sees everything, along +z.
pub(super) fn overview(meshes: &[Mesh]) -> Sensor {
    let positions = || meshes.iter().flat_map(|m| &m.positions);
    let low = positions().copied().reduce(Vec3::min).unwrap_or(-Vec3::ONE);
    let high = positions().copied().reduce(Vec3::max).unwrap_or(Vec3::ONE);
    let x_fov_rad = 45f32.to_radians();
    let size = (high - low).max_element().max(1e-3);
    // The film is wider than high.
    let distance = 1.05 * size * 4.0 / 3.0 * 0.5 / (0.5 * x_fov_rad).tan();
    let middle = 0.5 * (low + high);
    let from = Vec3::new(middle.x, middle.y, low.z - distance);
    Sensor {
        id: "PerspectiveCamera".into(),
        to_world: Affine3A::from_translation(from),
        x_fov_rad,
        lens: Lens::Pinhole,
        near_clip: 0.01 * distance,
        far_clip: 5.0 * size + distance,
        principal_point_offset: Vec2::ZERO,
        film: DEFAULT_FILM,
        sample_count: 4,
        seed: 0,
    }
}

/// The diagonal of a film frame of 35 mm, in millimetres, to which focal lengths refer.
const FRAME_DIAGONAL_MM: f64 = 43.266_615_305_567_87;

/// The opening angle of the film's diagonal, of a lens whose focal length is written as `50mm`.
fn diagonal_fov_deg(object: &Object) -> Result<f64, SceneError> {
    let written = object.string("focal_length")?;
    let written = written.as_deref().unwrap_or("50mm").trim();
    let digits = written.strip_suffix("mm").unwrap_or(written).trim_end();
    match digits.parse::<f64>() {
        Ok(length_mm) if length_mm > 0.0 && length_mm.is_finite() => {
            let half_tangent = 0.5 * FRAME_DIAGONAL_MM / length_mm;
            Ok(2.0 * half_tangent.atan().to_degrees())
        }
        _ => {
            let what = format!(
                "\"focal_length\" is a positive number of millimetres, such as 50mm, not \"{}\"",
                shown(written)
            );
            Err(object.property_error("focal_length", what))
        }
    }
}

/// The horizontal opening angle of a film of this aspect ratio (width over height).
pub(super) fn x_fov_rad(object: &Object, aspect: f64) -> Result<f64, SceneError> {
    let fov_deg = object.float("fov")?;
    if fov_deg.is_some() && object.has("focal_length") {
        let what = "give either \"fov\" or \"focal_length\", not both";
        return Err(object.property_error("focal_length", what));
    }
    let axes = ["x", "y", "diagonal", "smaller", "larger"];
    let axis = object.choice("fov_axis", "x", &axes)?;
    let (fov_deg, axis) = match fov_deg {
        Some(fov_deg) => (fov_deg, axis),
        None => (diagonal_fov_deg(object)?, "diagonal"),
    };
    let axis = match axis {
        "smaller" if aspect > 1.0 => "y",
        "smaller" => "x",
        "larger" if aspect > 1.0 => "x",
        "larger" => "y",
        other => other,
    };
    let between_0_and_180 = |deg: f64| deg > 1e-6 && deg < 180.0 - 1e-6;
    if !between_0_and_180(fov_deg) {
        let what = format!("\"fov\" must be between 0 and 180 degrees, not {fov_deg}");
        return Err(object.property_error("fov", what));
    }
    let half_tangent = (0.5 * fov_deg.to_radians()).tan();
    let x_half_tangent = match axis {
        "y" => half_tangent * aspect,
        "diagonal" => half_tangent / (1.0 + 1.0 / (aspect * aspect)).sqrt(),
        _ => half_tangent,
    };
    let x_fov_rad = 2.0 * x_half_tangent.atan();
    if between_0_and_180(x_fov_rad.to_degrees()) {
        Ok(x_fov_rad)
    } else {
        let what = format!(
            "the horizontal opening angle is {} degrees",
            x_fov_rad.to_degrees()
        );
        Err(object.property_error("fov", what))
    }
}

fn film(tree: &Tree, object: Option<&Object>) -> Result<Film, SceneError> {
    let Some(object) = object else {
        return Ok(DEFAULT_FILM);
    };
    let side = |name, default| {
        let value = object.count(name, default, 1)?;
        if value > MAX_FILM_SIDE_PIXELS {
            let what = format!(
                "\"{name}\" is {value} pixels; at most {MAX_FILM_SIDE_PIXELS} are supported"
            );
            return Err(object.property_error(name, what));
        }
        Ok(value)
    };
    let size = [side("width", 768)?, side("height", 576)?];
    let crop_size = [side("crop_width", size[0])?, side("crop_height", size[1])?];
    let crop_offset = [
        object.count("crop_offset_x", 0, 0)?,
        object.count("crop_offset_y", 0, 0)?,
    ];
    for axis in 0..2 {
        if u64::from(crop_offset[axis]) + u64::from(crop_size[axis]) > u64::from(size[axis]) {
            let (offset, length) = [
                ("crop_offset_x", "crop_width"),
                ("crop_offset_y", "crop_height"),
            ][axis];
            let what = format!(
                "the crop window does not fit: {offset} {} + {length} {} > {}",
                crop_offset[axis], crop_size[axis], size[axis]
            );
            let at = if object.has(offset) { offset } else { length };
            return Err(object.property_error(at, what));
        }
    }
    // Output is always linear RGB; these are read so that files for Mitsuba load without warnings.
    object.choice("file_format", "openexr", &["openexr", "exr", "rgbe", "pfm"])?;
    let formats = ["luminance", "luminance_alpha", "rgb", "rgba", "xyz", "xyza"];
    object.choice("pixel_format", "rgb", &formats)?;
    object.choice(
        "component_format",
        "float16",
        &["float16", "float32", "uint32"],
    )?;
    Ok(Film {
        width: size[0],
        height: size[1],
        crop_offset,
        crop_size,
        filter: filter(tree, object)?,
        sample_border: object.boolean("sample_border", false)?,
    })
}

fn filter(tree: &Tree, film: &Object) -> Result<Filter, SceneError> {
    let mut found = None;
    for child in &film.children {
        let inner = &tree.objects[child.object];
        if inner.tag != "rfilter" {
            return Err(cannot_stand_inside(child, inner, film));
        }
        if found.replace(inner).is_some() {
            return Err(SceneError::at(&child.place, "a film has only one rfilter"));
        }
    }
    let Some(object) = found else {
        return Ok(Filter::Gaussian { stddev: 0.5 });
    };
    no_children(tree, object)?;
    // Filters reach over neighbouring pixels: far wider ones than these are a typing error.
    let length = |name, default: f64| {
        let value = object.positive(name, default)?;
        if (0.01..=64.0).contains(&value) {
            return Ok(value as f32);
        }
        let what = format!("\"{name}\" must be between 0.01 and 64 pixels, not {value}");
        Err(object.property_error(name, what))
    };
    Ok(match object.plugin.as_str() {
        "box" => Filter::Box { radius: 0.5 },
        "tent" => Filter::Tent {
            radius: length("radius", 1.0)?,
        },
        _ => Filter::Gaussian {
            stddev: length("stddev", 0.5)?,
        },
    })
}

/// `child` is no part of `object`.
pub(super) fn cannot_stand_inside(
    child: &super::xml::Child,
    inner: &Object,
    object: &Object,
) -> SceneError {
    let what = format!("{} cannot stand inside {}", inner.shown(), object.shown());
    SceneError::at(&child.place, what)
}

/// For objects that consist of properties only.
pub(super) fn no_children(tree: &Tree, object: &Object) -> Result<(), SceneError> {
    match object.children.first() {
        None => Ok(()),
        Some(child) => Err(cannot_stand_inside(
            child,
            &tree.objects[child.object],
            object,
        )),
    }
}
