//! `to_uv`: what happens to texture coordinates before the texture is looked up.

use crate::scene::error::SceneError;
use crate::scene::xml::Object;
use glam::{Affine2, DMat2, DVec2};

/// The part of the property's transform that acts on u and v. One that mixes them with the third
/// axis is refused.
pub(super) fn to_uv(object: &Object) -> Result<Affine2, SceneError> {
    let whole = object.transform("to_uv")?;
    let [x, y, z] = [
        whole.matrix3.x_axis,
        whole.matrix3.y_axis,
        whole.matrix3.z_axis,
    ];
    let size = [x, y, z]
        .map(|a| a.length())
        .into_iter()
        .fold(0.0, f64::max);
    let mixed = [x.z, y.z, z.x, z.y]
        .map(f64::abs)
        .into_iter()
        .fold(0.0, f64::max);
    if mixed > 1e-6 * size {
        let what = "\"to_uv\" must stay within the plane of u and v: scales, translations and rotations about z";
        return Err(object.property_error("to_uv", what));
    }
    let linear = DMat2::from_cols(x.truncate(), y.truncate());
    let translation = DVec2::new(whole.translation.x, whole.translation.y);
    let to_uv = Affine2::from_mat2_translation(linear.as_mat2(), translation.as_vec2());
    if linear.determinant() == 0.0 || !to_uv.is_finite() {
        let what = "\"to_uv\" flattens the texture (its determinant is zero)";
        return Err(object.property_error("to_uv", what));
    }
    Ok(to_uv)
}
