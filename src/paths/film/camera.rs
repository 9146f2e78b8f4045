//! The camera that renders, and the film point a ray goes through.

use crate::kernels::camera::camera_direction;
use crate::lanes::{LANES, Lane, Real, V3};
use crate::paths::rays::{RayPacket, from_lanes, splat};
use crate::scene::{Lens, Sensor};
use glam::{DVec3, Vec3};
use std::f32::consts::TAU;

/// A camera, ready to make rays.
#[derive(Clone, Copy, Debug)]
pub struct Camera {
    pub origin: Vec3,
    /// World-space axes: x to the image's left, y up, z forward. Orthonormal.
    pub axes: [Vec3; 3],
    /// As its eye sees it ([`Camera::eye`]).
    pub tan_half_x_fov: f64,
    /// Film coordinates (pixels of the crop window) to the camera's tangents: p = offset + scale·u.
    offset: [f64; 2],
    scale: [f64; 2],
    /// What the film sees from top to bottom over what it sees from side to side.
    aspect: f64,
    pub near_clip: f32,
    pub far_clip: f32,
    /// What of it is no pinhole is for images and what does not move; where something does, each
    /// tile sees [`Camera::through`] one point of the lens.
    pub lens: Lens,
    /// Where on a lens this pinhole lies, to the image's left and up from the middle of the lens.
    pub lens_point: [f32; 2],
    /// One over the distance of what is in focus, or zero.
    per_focus: f32,
    /// How far behind the film the eye is from which a film position is a direction: zero, but for
    /// a parallel projection.
    reach: f64,
}

/// How far behind its film a parallel projection has its eye, in halves of the film's width. Over a
/// depth of ten such halves rays of a thousand pixels part by 5e-5 pixels then, and from there
/// double precision tells 1e-8 of them apart (docs/method.md, 2).
const FAR_EYE: f64 = 1e8;

impl Camera {
    pub fn new(sensor: &Sensor) -> Self {
        let film = &sensor.film;
        let (width, height) = (film.width as f64, film.height as f64);
        let shift = sensor.principal_point_offset.as_dvec2();
        let [crop_x, crop_y] = film.crop_offset.map(f64::from);
        let m = sensor.to_world.matrix3;
        // `stretch`: how much more of the world a pixel sees downward than to the right.
        let (reach, tan_half_x_fov, stretch) = match sensor.lens {
            Lens::Parallel { half_sides } => {
                let [half, other] = half_sides.as_dvec2().to_array();
                (FAR_EYE * half, 1.0 / FAR_EYE, other / half)
            }
            Lens::Pinhole | Lens::Thin { .. } => (0.0, (sensor.x_fov_rad as f64 / 2.0).tan(), 1.0),
        };
        Self {
            origin: sensor.to_world.translation.into(),
            axes: [m.x_axis.into(), m.y_axis.into(), m.z_axis.into()],
            tan_half_x_fov,
            // Mitsuba's convention: p_x = 1 − 2·(u_x/width + shift), p_y the same over the aspect
            // ratio.
            offset: [
                1.0 - 2.0 * (crop_x / width + shift.x),
                (1.0 - 2.0 * (crop_y / height + shift.y)) * stretch * height / width,
            ],
            scale: [-2.0 / width, -2.0 / width * stretch],
            aspect: stretch * height / width,
            near_clip: sensor.near_clip,
            far_clip: sensor.far_clip,
            lens: sensor.lens,
            lens_point: [0.0; 2],
            per_focus: 0.0,
            reach,
        }
    }

    /// The pinhole at one point of the lens, for two numbers in [0, 1)²: it sees what is in focus
    /// where the others do, so its film is shifted against it. Itself if the lens has no extent.
    pub fn through(self, numbers: [f32; 2]) -> Self {
        let Lens::Thin {
            aperture_radius,
            focus_distance,
        } = self.lens
        else {
            return self;
        };
        let lens_point = on_lens(aperture_radius, numbers);
        let [x, y, _] = self.axes;
        Self {
            origin: self.origin + x * lens_point[0] + y * lens_point[1],
            lens: Lens::Pinhole,
            lens_point,
            per_focus: 1.0 / focus_distance,
            ..self
        }
    }

    /// What stands for the axes in [`camera_direction`]: through a point (a, b) of the lens the
    /// third is z − (a x + b y)/f, with f the distance in focus.
    pub fn film_axes<V>(&self, [x, y, z]: [V; 3]) -> [V; 3]
    where
        V: Copy
            + std::ops::Mul<f32, Output = V>
            + std::ops::Add<Output = V>
            + std::ops::Sub<Output = V>,
    {
        [x, y, z - self.on_lens([x, y]) * self.per_focus]
    }

    /// Of vectors that belong to the axes to the left and up, what belongs to the point of the
    /// lens.
    pub fn on_lens<V>(&self, [x, y]: [V; 2]) -> V
    where
        V: Copy + std::ops::Mul<f32, Output = V> + std::ops::Add<Output = V>,
    {
        let [a, b] = self.lens_point;
        x * a + y * b
    }

    /// Cotangents of the axes from those of the origin and of [`Camera::film_axes`].
    pub fn axes_adjoint(&self, origin: DVec3, [x, y, z]: [DVec3; 3]) -> [DVec3; 3] {
        let both = origin - z * f64::from(self.per_focus);
        let [a, b] = self.lens_point.map(f64::from);
        [x + both * a, y + both * b, z]
    }

    /// How far a point on the axis of view is seen from the middle of the film, in the camera's
    /// tangents.
    pub fn focus_shift(&self) -> [f64; 2] {
        let shift = f64::from(self.per_focus) / self.tan_half_x_fov;
        self.lens_point.map(|at| f64::from(at) * shift)
    }

    /// The camera's tangents at a film point: what [`camera_direction`] takes.
    pub fn film_to_camera<F: Real>(&self, u: F, v: F) -> (F, F) {
        let along = |i: usize, at: F| F::splat(self.offset[i]) + F::splat(self.scale[i]) * at;
        (along(0, u), along(1, v))
    }

    /// Where the rays of all film points come from: of a parallel projection a point so far behind
    /// the film that they hardly part.
    pub fn eye(&self) -> DVec3 {
        self.origin.as_dvec3() - self.axes[2].as_dvec3() * self.reach
    }

    /// How far from the eye rays begin, in lengths of their directions.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Half the width of the film, if all rays are parallel.
    pub fn parallel_half_width(&self) -> Option<f64> {
        (self.reach > 0.0).then_some(self.reach * self.tan_half_x_fov)
    }

    /// The ray from the eye along a direction, where it begins.
    pub fn ray_along(&self, direction: DVec3) -> (DVec3, DVec3) {
        (self.eye() + direction * self.reach, direction)
    }

    /// Its rays from the eye along these directions, in the lanes of `active`.
    pub fn rays_along(&self, directions: &[DVec3; LANES], active: u32) -> RayPacket {
        if self.reach == 0.0 {
            return self.rays(from_lanes(&directions.map(|d| d.as_vec3())), active);
        }
        let origins = directions.map(|d| self.ray_along(d).0.as_vec3());
        RayPacket {
            origin: from_lanes(&origins),
            ..self.rays(splat(self.axes[2]), active)
        }
    }

    /// Whether a point is before the camera.
    pub fn is_before(&self, point: DVec3) -> bool {
        (point - self.origin.as_dvec3()).dot(self.axes[2].as_dvec3()) > 0.0
    }

    /// The film point at which a point before the camera is seen.
    pub fn film_point(&self, point: DVec3) -> [f64; 2] {
        let to = point - self.eye();
        // In single precision the axes are not quite perpendicular, which is felt from afar.
        let [x, y, z] = self.axes.map(|a| a.as_dvec3());
        let ahead = to.dot(x.cross(y));
        let tangents = [y.cross(z), z.cross(x)].map(|t| to.dot(t) / (ahead * self.tan_half_x_fov));
        let shift = self.focus_shift();
        [0, 1].map(|i| (tangents[i] + shift[i] - self.offset[i]) / self.scale[i])
    }

    /// Cotangents of a film point from those of the camera's tangents.
    pub fn film_to_camera_adjoint<F: Real>(&self, bars: [F; 2]) -> [F; 2] {
        let [u, v] = bars;
        let [right, down] = self.scale.map(F::splat);
        [u * right, v * down]
    }

    /// Direction from the eye through the film point (`u`, `v`), in pixels of the crop window.
    pub fn direction<F: Real>(&self, u: F, v: F) -> V3<F> {
        let (px, py) = self.film_to_camera(u, v);
        let [x, y, z] = self.film_axes(self.axes).map(splat);
        camera_direction(x, y, z, F::splat(self.tan_half_x_fov), px, py)
    }

    /// Where the ray through the film point (`u`, `v`) begins, and its direction. For one point of
    /// a lens.
    pub fn ray<F: Real>(&self, u: F, v: F) -> (V3<F>, V3<F>) {
        let Some(half_width) = self.parallel_half_width() else {
            return (splat(self.origin), self.direction(u, v));
        };
        let (px, py) = self.film_to_camera(u, v);
        let [x, y, z] = self.axes.map(splat);
        let half = F::splat(half_width);
        let beside = camera_direction(x, y, V3::splat(0.0), half, px, py);
        (splat::<F>(self.origin) + beside, z)
    }

    /// Its rays through the film points (`u`, `v`), in the lanes of `active`. `lens_point` gives
    /// two numbers in [0, 1)² for a lane, if the lens has an extent.
    pub fn rays_through(
        &self,
        u: Lane,
        v: Lane,
        active: u32,
        lens_point: impl Fn(usize) -> [f32; 2],
    ) -> RayPacket {
        let mut rays = self.rays(self.direction(u, v), active);
        let [x, y, z] = self.axes.map(splat::<Lane>);
        match self.lens {
            Lens::Pinhole => {}
            Lens::Thin {
                aperture_radius,
                focus_distance,
            } => {
                let points: [Vec3; LANES] = std::array::from_fn(|lane| {
                    let [a, b] = on_lens(aperture_radius, lens_point(lane));
                    self.axes[0] * a + self.axes[1] * b
                });
                let beside = from_lanes(&points);
                rays.origin = rays.origin + beside;
                rays.direction = rays.direction - beside * Lane::splat(1.0 / focus_distance);
            }
            Lens::Parallel { half_sides } => {
                let (px, py) = self.film_to_camera(u, v);
                let half = Lane::splat(half_sides.x);
                rays.origin = rays.origin + x * (px * half) + y * (py * half);
                rays.direction = z;
            }
        }
        rays
    }

    /// The rays of a pinhole along these directions, in the lanes of `active`.
    pub fn rays(&self, direction: V3<Lane>, active: u32) -> RayPacket {
        RayPacket {
            active,
            origin: splat(self.origin),
            direction,
            near: self.near_clip,
            far: self.far_clip,
        }
    }

    /// How the axis of view would have to lean to see what a principal point sees that is shifted
    /// by the film's width, or its height.
    pub fn axis_per_offset(&self) -> [DVec3; 2] {
        let [x, y, _] = self.axes.map(|a| a.as_dvec3());
        let tan = -2.0 * self.tan_half_x_fov;
        [x * tan, y * (tan * self.aspect)]
    }

    /// How the direction changes per pixel to the right and down.
    pub fn direction_per_pixel(&self) -> [DVec3; 2] {
        let [x, y, _] = self.axes.map(|axis| axis.as_dvec3());
        let [right, down] = self.scale.map(|scale| self.tan_half_x_fov * scale);
        [x * right, y * down]
    }
}

/// A point of a lens, uniform over it.
fn on_lens(aperture_radius: f32, [r, turn]: [f32; 2]) -> [f32; 2] {
    let (sin, cos) = (TAU * turn).sin_cos();
    let radius = aperture_radius * r.sqrt();
    [radius * cos, radius * sin]
}
