//! Emitters: how a surface, a point, a direction or the environment shines.

use super::camera::no_children;
use super::data::{DeltaLight, DeltaLightKind, Environment, EnvironmentMap, Layout};
use super::error::SceneError;
use super::input::Input;
use super::rigid::rigid;
use super::texture::{POSITIVE, Slots, Textures, picture};
use super::xml::Object;
use glam::Vec3;

/// Fewest columns and rows of an environment map, as in Mitsuba.
const SMALLEST_MAP: [u32; 2] = [2, 3];

/// The radiance of an `area` emitter that is listed under `key`.
pub(super) fn area(
    input: &mut Input,
    textures: &mut Textures,
    object: usize,
    key: &str,
) -> Result<usize, SceneError> {
    let tree = input.tree;
    let object = &tree.objects[object];
    if object.has("to_world") {
        let what = "an area emitter has no to_world of its own: it goes with its shape";
        return Err(object.property_error("to_world", what));
    }
    object.float("sampling_weight")?;
    let mut slots = slots(input, textures, object, key);
    slots.only(&["radiance"])?;
    slots.texture("radiance", [1.0; 3], POSITIVE)
}

/// `constant` or `envmap`.
pub(super) fn environment<'a>(
    input: &mut Input<'a>,
    textures: &mut Textures,
    object: &'a Object,
    key: String,
) -> Result<Environment, SceneError> {
    no_children(input.tree, object)?;
    if object.plugin == "constant" {
        let radiance =
            slots(input, textures, object, &key).texture("radiance", [1.0; 3], POSITIVE)?;
        return Ok(Environment {
            key,
            radiance,
            map: None,
        });
    }
    // How Mitsuba draws samples, which does not change the image.
    object.boolean("mis_compensation", false)?;
    let scale = object.float("scale")?.unwrap_or(1.0);
    if scale < 0.0 {
        let what = format!("\"scale\" must not be negative: {scale}");
        return Err(object.property_error("scale", what));
    }
    let to_world = rigid(object, "the environment's")?.matrix3.as_mat3();
    let texture = picture(input, object, key.clone(), false)?;
    if let Layout::Bitmap { width, height, .. } = texture.layout
        && (width < SMALLEST_MAP[0] || height < SMALLEST_MAP[1])
    {
        let what = format!(
            "an environment map has at least {} columns and {} rows, this one has {width} and {height}",
            SMALLEST_MAP[0], SMALLEST_MAP[1]
        );
        return Err(object.property_error("filename", what));
    }
    if let Some(bad) = texture.texels.iter().flatten().find(|v| **v < 0.0) {
        let what = format!("the radiance of an environment map must be at least 0; it has {bad}");
        return Err(object.property_error("filename", what));
    }
    let radiance = textures.push(texture);
    Ok(Environment {
        key,
        radiance,
        map: Some(EnvironmentMap {
            to_world,
            scale: scale as f32,
        }),
    })
}

/// `point` or `directional`.
pub(super) fn delta_light<'a>(
    input: &mut Input<'a>,
    textures: &mut Textures,
    object: &'a Object,
    key: String,
) -> Result<DeltaLight, SceneError> {
    no_children(input.tree, object)?;
    let is_point = object.plugin == "point";
    let (place, power) = if is_point {
        ("position", "intensity")
    } else {
        ("direction", "irradiance")
    };
    if object.has(place) && object.has("to_world") {
        let what = format!("\"to_world\" cannot be given together with \"{place}\"");
        return Err(object.property_error("to_world", what));
    }
    let given = object.vector(place)?;
    let to_world = object.transform("to_world")?;
    let kind = if is_point {
        DeltaLightKind::Point {
            position: given.unwrap_or(to_world.translation).as_vec3(),
        }
    } else {
        let direction = given.unwrap_or(to_world.matrix3.z_axis);
        let direction = direction.try_normalize().map(|d| d.as_vec3());
        DeltaLightKind::Directional {
            direction: direction.filter(|d: &Vec3| d.is_finite()).ok_or_else(|| {
                let name = if given.is_some() { place } else { "to_world" };
                object.property_error(name, "the direction has no length")
            })?,
        }
    };
    let power = slots(input, textures, object, &key).texture(power, [1.0; 3], POSITIVE)?;
    Ok(DeltaLight {
        key,
        kind,
        power,
        beam: None,
    })
}

pub(super) fn slots<'r, 'a>(
    input: &'r mut Input<'a>,
    textures: &'r mut Textures,
    object: &'a Object,
    key: &str,
) -> Slots<'r, 'a> {
    Slots {
        input,
        textures,
        object,
        key: key.to_string(),
    }
}
