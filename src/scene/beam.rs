//! `spot` and `projector`: points that shine differently into different directions.

use super::camera::x_fov_rad;
use super::data::{Beam, BeamProfile, DeltaLight, DeltaLightKind, Layout};
use super::emitter::slots;
use super::error::SceneError;
use super::input::Input;
use super::texture::{POSITIVE, REFLECTANCE, Textures};
use super::xml::Object;
use glam::{Mat3, Vec2, Vec3};

/// `spot`
pub(super) fn spot<'a>(
    input: &mut Input<'a>,
    textures: &mut Textures,
    object: &'a Object,
    key: String,
) -> Result<DeltaLight, SceneError> {
    let (position, to_local, _) = place(object)?;
    let angle = |name: &str, default: f64| {
        let given = object.float(name)?.unwrap_or(default);
        if (0.0..90.0).contains(&given) {
            return Ok(given);
        }
        let what = format!("\"{name}\" is between 0 and 90 degrees, not {given}");
        Err(object.property_error(name, what))
    };
    let cutoff_deg = angle("cutoff_angle", 20.0)?;
    let beam_width_deg = angle("beam_width", 0.75 * cutoff_deg)?;
    if beam_width_deg > cutoff_deg {
        let what = format!(
            "\"beam_width\" ({beam_width_deg}) must not be larger than \"cutoff_angle\" ({cutoff_deg})"
        );
        return Err(object.property_error("beam_width", what));
    }
    if object.has("texture") {
        let what = "\"texture\" is a <texture>; a plain colour belongs into \"intensity\"";
        return Err(object.property_error("texture", what));
    }
    let mut slots = slots(input, textures, object, &key);
    slots.only(&["texture"])?;
    let power = slots.texture("intensity", [1.0; 3], POSITIVE)?;
    let texture = match object.children.is_empty() {
        true => None,
        false => Some(slots.texture("texture", [1.0; 3], REFLECTANCE)?),
    };
    let profile = BeamProfile::Spot {
        beam_width_rad: beam_width_deg.to_radians() as f32,
        cutoff_rad: cutoff_deg.to_radians() as f32,
        texture,
    };
    Ok(DeltaLight {
        key,
        kind: DeltaLightKind::Point { position },
        power,
        beam: Some(Beam { to_local, profile }),
    })
}

/// `projector`
pub(super) fn projector<'a>(
    input: &mut Input<'a>,
    textures: &mut Textures,
    object: &'a Object,
    key: String,
) -> Result<DeltaLight, SceneError> {
    let (position, to_local, axis) = place(object)?;
    let scale = object.float("scale")?.unwrap_or(1.0);
    if scale < 0.0 {
        let what = format!("\"scale\" must not be negative: {scale}");
        return Err(object.property_error("scale", what));
    }
    let mut slots = slots(input, textures, object, &key);
    slots.only(&["irradiance"])?;
    let power = slots.texture("irradiance", [1.0; 3], POSITIVE)?;
    let aspect = match textures.list[power].layout {
        Layout::Bitmap { width, height, .. } => f64::from(width) / f64::from(height),
        _ => 1.0,
    };
    let half_tangent = (0.5 * x_fov_rad(object, aspect)?).tan();
    let half_tangents = Vec2::new(half_tangent as f32, (half_tangent / aspect) as f32);
    let profile = BeamProfile::Projector {
        half_tangents,
        scale: scale as f32,
        axis,
    };
    Ok(DeltaLight {
        key,
        kind: DeltaLightKind::Point { position },
        power,
        beam: Some(Beam { to_local, profile }),
    })
}

/// Position, the world's directions as the light sees them, and its z axis.
fn place(object: &Object) -> Result<(Vec3, Mat3, Vec3), SceneError> {
    let to_world = object.transform("to_world")?;
    let to_local = to_world.matrix3.inverse();
    if !to_local.is_finite() {
        let what = "to_world flattens space: the light has no directions left";
        return Err(object.property_error("to_world", what));
    }
    let position = to_world.translation.as_vec3();
    Ok((
        position,
        to_local.as_mat3(),
        to_world.matrix3.z_axis.as_vec3(),
    ))
}
