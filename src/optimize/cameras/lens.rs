//! Focal lengths and principal points in pixels.

use glam::{DVec2, Vec2};

/// Pixels are square up to this share of the focal length.
const SQUARE: f64 = 2e-3;

/// What a camera sees, in pixels from the top left corner of the image.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lens {
    pub size: Option<[u32; 2]>,
    /// Radians, if that is what is known.
    pub x_fov_rad: Option<f64>,
    pub focal_length_pixels: Option<f64>,
    /// The middle of the image if not known.
    pub principal_point_pixels: Option<DVec2>,
}

impl Lens {
    /// Horizontal opening angle in radians, and the shift of the principal point in films: a point
    /// at u pixels is 1 − 2(u/width + shift) half films from the axis.
    pub fn settle(&self, size: [u32; 2]) -> (f32, Vec2) {
        let [width, height] = size.map(f64::from);
        let of_focal = |f: f64| 2.0 * (0.5 * width / f).atan();
        let x_fov_rad = self.focal_length_pixels.map(of_focal).or(self.x_fov_rad);
        let offset = self.principal_point_pixels.map_or(DVec2::ZERO, |c| {
            DVec2::splat(0.5) - c / DVec2::new(width, height)
        });
        (x_fov_rad.unwrap_or(1.0) as f32, offset.as_vec2())
    }
}

/// One focal length of two, if pixels are square.
pub fn one_focal_length(x: f64, y: f64) -> Result<f64, String> {
    if !(x > 0.0 && x.is_finite() && y > 0.0 && y.is_finite()) {
        return Err(format!(
            "its focal lengths are {x} and {y} pixels; they are above zero"
        ));
    }
    match (y / x - 1.0).abs() <= SQUARE {
        true => Ok(x),
        false => Err(format!(
            "its focal lengths are {x} and {y} pixels: pixels that are not square are not supported; resample its pictures"
        )),
    }
}
