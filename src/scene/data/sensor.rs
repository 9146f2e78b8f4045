//! Cameras.

use glam::{Affine3A, Vec2};

/// A camera with its film.
#[derive(Clone, Debug)]
pub struct Sensor {
    pub id: String,
    /// Camera to world: looks along +z, +x is left in the image, +y up (Mitsuba's convention).
    /// Rigid.
    pub to_world: Affine3A,
    /// Horizontal opening angle in radians, whatever `fov_axis` the file used; nothing to a
    /// parallel projection.
    pub x_fov_rad: f32,
    pub lens: Lens,
    pub near_clip: f32,
    pub far_clip: f32,
    /// Shift of the principal point as a fraction of the film's width and height.
    pub principal_point_offset: Vec2,
    pub film: Film,
    pub sample_count: u32,
    pub seed: u32,
}

/// Where rays through one point of the film begin and go.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Lens {
    /// `perspective`: in one point.
    Pinhole,
    /// `thinlens`: on a disk, toward one point of the plane in focus.
    Thin {
        aperture_radius: f32,
        focus_distance: f32,
    },
    /// `orthographic`: all go along the axis. Half the film's width, and what is to half the width
    /// as half the height is to the film's, in world units: a scale in `to_world`.
    Parallel { half_sides: Vec2 },
}

#[derive(Clone, Debug)]
pub struct Film {
    /// Full size in pixels, before cropping.
    pub width: u32,
    pub height: u32,
    /// Offset and size of the crop window, in pixels: the image that is written.
    pub crop_offset: [u32; 2],
    pub crop_size: [u32; 2],
    pub filter: Filter,
    /// Also sample the filter's border around the film.
    pub sample_border: bool,
}

/// Film reconstruction filters; lengths in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    Box {
        radius: f32,
    },
    Tent {
        radius: f32,
    },
    /// exp(−x²/2σ²) − exp(−r²/2σ²), r = 4σ.
    Gaussian {
        stddev: f32,
    },
}
