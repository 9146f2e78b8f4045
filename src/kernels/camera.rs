//! The perspective camera.

use crate::lanes::{Real, V3};

/// Direction of the camera ray through film point (`px`, `py`), unnormalised: its component along
/// the viewing axis is 1, so that ray distances are depths and the direction is linear in the film
/// point.
///
/// `px`, `py` are tangents of the angles to the viewing axis divided by `tan_half_x_fov`; `x_axis`,
/// `y_axis` and `z_axis` are the camera's axes in world space.
pub fn camera_direction<F: Real>(
    x_axis: V3<F>,
    y_axis: V3<F>,
    z_axis: V3<F>,
    tan_half_x_fov: F,
    px: F,
    py: F,
) -> V3<F> {
    x_axis * (tan_half_x_fov * px) + y_axis * (tan_half_x_fov * py) + z_axis
}
