//! `<transform>`: translate, rotate, scale, lookat and matrix, in order.

use super::values::{number, numbers, tokens};
use glam::{DAffine3, DMat3, DMat4, DVec3};

/// Axes of rotations are as good as unit vectors if their lengths differ from one by less.
const UNIT: f64 = 1e-3;

/// One operation, from its tag and attributes (already checked to be the known ones). The whole
/// transform is the product with later operations on the left. Errors are sentences.
pub(super) fn operation(
    tag: &str,
    attribute: &dyn Fn(&str) -> Option<String>,
) -> Result<DAffine3, String> {
    match tag {
        "translate" => Ok(DAffine3::from_translation(xyz(attribute, 0.0)?)),
        "scale" => Ok(DAffine3::from_scale(xyz(attribute, 1.0)?)),
        "rotate" => {
            let axis = xyz(attribute, 0.0)?;
            let angle_deg = number(&attribute("angle").unwrap_or_default())?;
            if axis == DVec3::ZERO {
                let what = "the rotation axis is zero; give x, y, z or value=\"x, y, z\"";
                return Err(what.to_string());
            }
            Ok(rotation(axis, angle_deg.to_radians()))
        }
        "lookat" => lookat(attribute),
        "matrix" => matrix(&attribute("value").unwrap_or_default()),
        _ => Err(format!("<{tag}> is no transform operation")),
    }
}

/// Whether an axis has about unit length.
pub(super) fn is_unit(axis: DVec3) -> bool {
    (axis.length() - 1.0).abs() < UNIT
}

/// cos θ I + sin θ [a]× + (1 − cos θ) a aᵀ: Rodrigues' formula, which turns about unit vectors. Of
/// others Mitsuba makes what it comes to, and so do we; but what was rounded in a file is meant to
/// be one.
fn rotation(axis: DVec3, angle_rad: f64) -> DAffine3 {
    if is_unit(axis) {
        return DAffine3::from_axis_angle(axis.normalize(), angle_rad);
    }
    let (sin, cos) = angle_rad.sin_cos();
    let columns = [DVec3::X, DVec3::Y, DVec3::Z]
        .map(|e| e * cos + axis.cross(e) * sin + axis * (axis.dot(e) * (1.0 - cos)));
    DAffine3::from_mat3(DMat3::from_cols(columns[0], columns[1], columns[2]))
}

/// `value` (one or three numbers) or any of `x`, `y`, `z`.
pub(super) fn xyz(
    attribute: &dyn Fn(&str) -> Option<String>,
    missing: f64,
) -> Result<DVec3, String> {
    let axes = ["x", "y", "z"].map(attribute);
    if let Some(value) = attribute("value") {
        if axes.iter().any(Option::is_some) {
            return Err("\"value\" cannot be mixed with \"x\", \"y\", \"z\"".to_string());
        }
        return match tokens(&value).len() {
            1 => numbers::<1>(&value).map(|[v]| DVec3::splat(v)),
            3 => numbers::<3>(&value).map(DVec3::from),
            n => Err(format!("\"value\" must have one or three numbers, got {n}")),
        };
    }
    let mut out = DVec3::splat(missing);
    for (axis, text) in axes.iter().enumerate() {
        if let Some(text) = text {
            out[axis] = number(text)?;
        }
    }
    Ok(out)
}

fn lookat(attribute: &dyn Fn(&str) -> Option<String>) -> Result<DAffine3, String> {
    let vector = |name: &str| -> Result<DVec3, String> {
        let text = attribute(name).unwrap_or_default();
        let numbers = numbers::<3>(&text).map_err(|e| format!("{name}: {e}"))?;
        Ok(DVec3::from(numbers))
    };
    let origin = vector("origin")?;
    let forward = (vector("target")? - origin)
        .try_normalize()
        .ok_or("origin and target are the same point")?;
    let up = match attribute("up") {
        Some(_) => vector("up")?,
        None => DVec3::ZERO,
    };
    let up = if up == DVec3::ZERO {
        forward.any_orthonormal_vector()
    } else {
        up
    };
    // Mitsuba's camera frame: +x points left in the image.
    let left = up
        .cross(forward)
        .try_normalize()
        .ok_or("up is parallel to the viewing direction")?;
    let up = forward.cross(left);
    Ok(DAffine3::from_mat3_translation(
        DMat3::from_cols(left, up, forward),
        origin,
    ))
}

/// 9 or 16 numbers, row by row.
fn matrix(text: &str) -> Result<DAffine3, String> {
    match tokens(text).len() {
        9 => {
            let rows = numbers::<9>(text)?;
            Ok(DAffine3::from_mat3(
                DMat3::from_cols_array(&rows).transpose(),
            ))
        }
        16 => {
            let rows = numbers::<16>(text)?;
            if rows[12..] != [0.0, 0.0, 0.0, 1.0] {
                return Err("the last row of a matrix must be 0 0 0 1".to_string());
            }
            Ok(DAffine3::from_mat4(
                DMat4::from_cols_array(&rows).transpose(),
            ))
        }
        n => Err(format!("a matrix has 9 or 16 numbers, got {n}")),
    }
}
