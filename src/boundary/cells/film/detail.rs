//! Which meshes have detail that they see themselves, where a node of the film's drift looks.
//!
//! Under a film point that rests a surface slides that moves, and turns against its own edges: at
//! the distance r from one as fast as it slides over r. Lines over its lobe and over lights bring
//! that where they meet the edge, and r has no lower bound, so that few of them hold nearly all of
//! the noise. If the point follows the surface, all that moves with it rests. That costs what an
//! image's noise brings while its filter slides, in proportion to one over a pixel, and is less
//! where r is some pixels or less.

use crate::boundary::search_scene::SearchScene;
use crate::kernels::frame::direction_from_local;
use crate::lanes::LANES;
use crate::paths::dimensions::Single;
use crate::paths::film::node_hits::Hit;
use crate::paths::random::Stream;
use crate::paths::rays::{from_lanes, lane_of};
use crate::paths::surface::lobe_sample::cosine_direction;
use crate::trace::Coherence;
use crate::trace::geometry::NO_TRIANGLE;
use glam::{DVec3, Vec3};
use std::collections::BTreeSet;

/// What is nearer than so many pixels are wide for each sample that a group has along a pixel is
/// near, up to the second number of pixels: the more samples, the less the noise of an image, whose
/// samples lie on a lattice.
const NEAR_PIXELS: [f64; 2] = [4.0, 16.0];
/// Directions in which each point looks.
const LOOKS: u32 = 4;

/// What a node looks with.
pub struct Looks<'a> {
    pub stream: &'a Stream,
    pub node: usize,
    /// Points of a group along a pixel.
    pub per_pixel: f64,
    /// Of the camera's rays.
    pub directions: &'a [DVec3; LANES],
}

/// The meshes that move and see themselves near one of these points.
pub fn meshes(scene: &SearchScene, looks: &Looks, hits: &[Hit]) -> BTreeSet<u32> {
    let geometry = scene.view.geometry;
    let camera = &scene.view.camera;
    let origin = camera.eye();
    let [pixels, most_pixels] = NEAR_PIXELS;
    let far =
        (pixels * looks.per_pixel).min(most_pixels) * camera.direction_per_pixel()[0].length();
    let mut x = [Vec3::ZERO; LANES];
    let mut normal = [Vec3::Z; LANES];
    let mut near = [0.0; LANES];
    let mut from = [NO_TRIANGLE; LANES];
    let mut lanes = 0;
    for hit in hits {
        if !(hit.moves && scene.pieces().may_hide_itself(hit.mesh)) {
            continue;
        }
        let lane = hit.lane;
        let [p, q, r] = geometry.triangles[hit.triangle as usize]
            .map(|v| geometry.positions[v as usize].as_dvec3());
        let d = looks.directions[lane];
        let n = (q - p).cross(r - p).normalize();
        x[lane] = (origin + d * hit.distance).as_vec3();
        normal[lane] = (n * -n.dot(d).signum()).as_vec3();
        near[lane] = far * hit.distance;
        from[lane] = hit.triangle;
        lanes |= 1 << lane;
    }
    let mut found = BTreeSet::new();
    if lanes == 0 {
        return found;
    }
    let mesh = |triangle: u32| geometry.mesh_of_triangle[triangle as usize];
    for look in 0..LOOKS {
        let random = |lane: usize, axis: u32| {
            let name = [looks.node as u32, look * LANES as u32 + lane as u32, axis];
            looks.stream.single(Single::DriftLook, name)
        };
        let [u, v] = [0, 1].map(|axis| std::array::from_fn(|lane| random(lane, axis)).into());
        let local = cosine_direction(u, v);
        let normals = from_lanes(&normal);
        let directions = direction_from_local(normals, local);
        let scaled = std::array::from_fn(|l| lane_of(directions, l) * near[l] as f32);
        let mut rays = (scene.view).leaving(from_lanes(&x), normals, from_lanes(&scaled), lanes);
        rays.far = 1.0;
        let met = scene.view.intersect(&rays, Coherence::Incoherent);
        let pairs = met.into_iter().zip(from);
        let itself = pairs.filter(|&(met, from)| met != NO_TRIANGLE && mesh(met) == mesh(from));
        found.extend(itself.map(|(met, _)| mesh(met)));
    }
    found
}
