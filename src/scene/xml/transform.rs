//! `<transform>`: translate, rotate, scale, lookat and matrix, in order.

use super::values::{number, numbers, tokens};
use glam::{DAffine3, DMat3, DMat4, DVec3};

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
            let axis = axis
                .try_normalize()
                .ok_or("the rotation axis is zero; give x, y, z or value=\"x, y, z\"")?;
            Ok(DAffine3::from_axis_angle(axis, angle_deg.to_radians()))
        }
        "lookat" => lookat(attribute),
        "matrix" => matrix(&attribute("value").unwrap_or_default()),
        _ => Err(format!("<{tag}> is no transform operation")),
    }
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
