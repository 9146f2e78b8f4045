//! How fast paths spread: how far a vertex moves if the film point moves by one pixel.
//!
//! About that: it is told from the lengths, the cosines and the curvatures along a path, as if each
//! turned the ray in the worst direction. It does not depend on what is asked about. What moves
//! elsewhere than the film point is taken to move by about a pixel, too.

use crate::lanes::{LANES, Lane, Real};
use crate::paths::film::camera::Camera;
use crate::paths::rays::lane_mask;
use crate::paths::scene_view::SceneView;
use crate::paths::store::Vertices;
use crate::paths::surface::vertex::Surface;
use crate::scene::Lens;
use crate::trace::geometry::NO_TRIANGLE;

/// Surfaces are not taken to be seen more edge-on than this.
const LEAST_COSINE: f64 = 1e-4;

/// Of the rays of a packet, per pixel.
#[derive(Clone, Copy, Debug)]
pub struct Spread {
    /// Of the camera's rays: a length where they start, and radians.
    pixel: [f32; 2],
    /// The path's length so far.
    pub length: Lane,
    /// How far the ray's start moves, and then its end over the surface there.
    pub at: Lane,
    /// By how much the ray turns.
    pub ray_rad: Lane,
    /// Over what angles it is looked at: it may turn with what moves where the film point does not
    /// turn it.
    pub looks_rad: Lane,
    /// By how much the shading normal turns at its end.
    pub normal_rad: Lane,
    /// Of the angle at which the ray has arrived.
    cos: Lane,
    /// The largest part of its cosine by which an angle changes where lobes that are no diffuse
    /// ones reflected or refracted the path so far.
    pub bends: Lane,
    /// Lanes whose rays follow what they meet.
    follows: u32,
}

impl Spread {
    /// Of camera rays.
    pub fn new(camera: &Camera) -> Self {
        let pixel = camera.pixel_spread();
        let zero = Lane::splat(0.0);
        Self {
            pixel,
            length: zero,
            at: Lane::splat(pixel[0]),
            ray_rad: Lane::splat(pixel[1]),
            looks_rad: zero,
            normal_rad: zero,
            cos: zero,
            bends: zero,
            follows: 0,
        }
    }

    /// Follows the rays to a vertex. Lanes in which nothing moves so far begin anew.
    pub fn arrive(&mut self, view: &SceneView, vertices: &Vertices, surface: &Surface) {
        let to = surface.x - vertices.origin;
        let step = to.dot(to).sqrt();
        self.length += step;
        let moves = lane_mask(vertices.moves);
        let [start, angle] = self.pixel.map(Lane::splat);
        self.ray_rad = <Lane as Real>::select(moves, self.ray_rad, angle);
        self.bends = <Lane as Real>::select(moves, self.bends, Lane::splat(0.0));
        let pixel = start + angle * self.length;
        let over = <Lane as Real>::select(lane_mask(self.follows), step, self.length);
        self.looks_rad = self.ray_rad.max(pixel / over);
        let reached = self.at + step * self.ray_rad;
        self.at = <Lane as Real>::select(moves, reached, pixel);
        self.cos = surface.geometric.dot(to).abs() / step;
        self.cos = self.cos.max(<Lane as Real>::splat(LEAST_COSINE));
        self.at /= self.cos;
        self.normal_rad = self.at * view.curvature(&vertices.triangle);
    }

    /// Leaves a vertex: a ray that rests or drifts does not turn, others turn with the normal.
    pub fn leave(&mut self, vertices: &Vertices) {
        let kinds = &vertices.kinds;
        let turned = kinds.special() & !kinds.null & !vertices.lobes.diffuse;
        let select = <Lane as Real>::select;
        let with_normal = self.normal_rad + self.normal_rad + self.ray_rad;
        let kept = select(lane_mask(kinds.in_chains()), self.ray_rad, self.normal_rad);
        let turns = select(lane_mask(turned), with_normal, kept);
        let held = vertices.rests | vertices.drifts;
        let is_held = lane_mask(held);
        let bends = self.bends.max((self.normal_rad + self.ray_rad) / self.cos);
        self.bends = select(lane_mask(turned & !held), bends, self.bends);
        self.ray_rad = select(is_held, Lane::splat(0.0), turns);
        self.follows = vertices.drifts;
        let across = self.at * self.cos;
        self.at = select(lane_mask(kinds.in_chains()), across, self.at);
    }
}

impl SceneView<'_> {
    /// By how much the shading normal turns over each lane's triangle, per unit of length.
    fn curvature(&self, triangles: &[u32; LANES]) -> Lane {
        let geometry = self.geometry;
        let smooth = self.smooth_lanes(triangles);
        Lane::new(std::array::from_fn(|lane| {
            if smooth >> lane & 1 == 0 || triangles[lane] == NO_TRIANGLE {
                return 0.0;
            }
            let ids = geometry.triangles[triangles[lane] as usize];
            let [p, n] =
                [&geometry.positions, &geometry.normals].map(|of| ids.map(|v| of[v as usize]));
            let sides = [[0, 1], [1, 2], [2, 0]];
            let turns = sides.map(|[i, j]| n[i].distance(n[j]) / p[i].distance(p[j]));
            // The other sides of a triangle without an area tell enough.
            turns
                .into_iter()
                .filter(|t| t.is_finite())
                .fold(0.0, f32::max)
        }))
    }
}

impl Camera {
    /// How far rays begin apart, and by what angle, that are one pixel apart.
    fn pixel_spread(&self) -> [f32; 2] {
        let angles = self.direction_per_pixel().map(|d| d.length());
        let angle = angles[0].max(angles[1]);
        match self.lens {
            Lens::Parallel { half_sides } => {
                let per_tangent = angle / self.tan_half_x_fov;
                [half_sides.x * per_tangent as f32, 0.0]
            }
            Lens::Pinhole | Lens::Thin { .. } => [0.0, angle as f32],
        }
    }
}
