//! Transforms that keep lengths.

use super::error::SceneError;
use super::xml::Object;
use glam::{DAffine3, DMat3};

/// As far as a transform may be from rigid: Mitsuba's tolerance on the Gram matrix.
const RIGID_TOLERANCE: f64 = 1e-3;

/// The `to_world` of something (`the camera's`). A scale is refused, a mirror image is not, as in
/// Mitsuba.
pub(super) fn rigid(object: &Object, whose: &str) -> Result<DAffine3, SceneError> {
    let to_world = object.transform("to_world")?;
    let m = to_world.matrix3;
    if !is_rigid(m) {
        let what =
            format!("{whose} to_world has a scale; only rotations and translations are allowed");
        return Err(object.property_error("to_world", what));
    }
    // What rounding or the tolerance let through is taken out again.
    let x = m.x_axis.normalize();
    let y = (m.y_axis - x * x.dot(m.y_axis)).normalize();
    let z = x.cross(y) * m.determinant().signum();
    Ok(DAffine3::from_mat3_translation(
        DMat3::from_cols(x, y, z),
        to_world.translation,
    ))
}

/// Whether a matrix keeps lengths, within Mitsuba's tolerance.
pub(super) fn is_rigid(m: DMat3) -> bool {
    let gram = m * m.transpose();
    let off = gram - DMat3::IDENTITY;
    let entries = off.to_cols_array();
    entries.iter().all(|x| x.abs() <= RIGID_TOLERANCE)
}
