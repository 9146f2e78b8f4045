//! From the cotangents of a camera's ray to those of the camera and of the film point.

use crate::adjoint::camera::camera_direction_adjoint;
use crate::lanes::{Real, V3};
use crate::paths::film::camera::Camera;
use crate::paths::rays::splat;

/// Cotangents of what a camera's ray is made of.
pub struct CameraRayBars<F> {
    pub origin: V3<F>,
    /// Of [`Camera::film_axes`].
    pub film_axes: [V3<F>; 3],
    pub tan_half_x_fov: F,
    /// Of the film point, in pixels.
    pub film: [F; 2],
}

/// The transpose of [`MovingCamera::ray`].
///
/// [`MovingCamera::ray`]: super::forward::MovingCamera::ray
pub fn camera_ray_adjoint<F: Real>(
    camera: &Camera,
    [u, v]: [F; 2],
    origin: V3<F>,
    direction: V3<F>,
) -> CameraRayBars<F> {
    let (px, py) = camera.film_to_camera(u, v);
    let [x, y, z] = camera.film_axes(camera.axes).map(splat);
    let (film_axes, tan_half_x_fov, film) = match camera.parallel_half_width() {
        None => {
            let tan = F::splat(camera.tan_half_x_fov);
            let (x, y, z, tan, px, py) = camera_direction_adjoint(x, y, z, tan, px, py, direction);
            ([x, y, z], tan, [px, py])
        }
        Some(half) => {
            let (zero, half) = (V3::splat(0.0), F::splat(half));
            let (x, y, _, _, px, py) = camera_direction_adjoint(x, y, zero, half, px, py, origin);
            ([x, y, direction], F::splat(0.0), [px, py])
        }
    };
    CameraRayBars {
        origin,
        film_axes,
        tan_half_x_fov,
        film: camera.film_to_camera_adjoint(film),
    }
}
