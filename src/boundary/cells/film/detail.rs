//! Which meshes have detail that they see themselves, where a node of the film's drift looks.
//!
//! Under a film point that rests a surface slides that moves, and turns against its own edges: at
//! the distance r from one as fast as it slides over r. Lines over its lobe and over lights bring
//! that where they meet the edge, and r has no lower bound, so that few of them hold nearly all of
//! the noise. If the point follows the surface, all that moves with it rests. That costs what an
//! image's noise brings while its filter slides, in proportion to one over a pixel, and is less
//! where r is some pixels or less.

use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::boundary::{dvec3, vector};
use crate::kernels::frame::direction_from_local;
use crate::kernels::triangle::triangle_point;
use crate::lanes::LANES;
use crate::paths::dimensions::Single;
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

/// What a node's rays have met.
pub struct Seen<'a> {
    pub node: usize,
    /// Points of a group along a pixel.
    pub per_pixel: f64,
    pub directions: &'a [DVec3; LANES],
    pub triangles: &'a [u32; LANES],
    /// Those that are asked about.
    pub lanes: u32,
}

/// The meshes that see themselves near one of these points.
pub fn meshes(scene: &SearchScene, stream: &Stream, seen: &Seen) -> BTreeSet<u32> {
    if seen.lanes == 0 {
        return BTreeSet::new();
    }
    let geometry = scene.view.geometry;
    let camera = &scene.view.camera;
    let origin = camera.origin.as_dvec3();
    let [pixels, most_pixels] = NEAR_PIXELS;
    let far = (pixels * seen.per_pixel).min(most_pixels) * camera.direction_per_pixel()[0].length();
    let mut x = [Vec3::ZERO; LANES];
    let mut normal = [Vec3::Z; LANES];
    let mut near = [0.0; LANES];
    let mut lanes = seen.lanes;
    for lane in (0..LANES).filter(|&l| seen.lanes >> l & 1 == 1) {
        let corners = geometry.triangles[seen.triangles[lane] as usize]
            .map(|v| geometry.positions[v as usize].as_dvec3());
        let [p, q, r] = corners;
        let d = seen.directions[lane];
        let n = (q - p).cross(r - p).normalize();
        let at = dvec3(triangle_point(
            vector(origin),
            vector(d),
            vector(p),
            vector(q),
            vector(r),
        ));
        if !at.is_finite() {
            lanes &= !(1 << lane);
            continue;
        }
        x[lane] = at.as_vec3();
        normal[lane] = (n * -n.dot(d).signum()).as_vec3();
        near[lane] = far * at.distance(origin) / d.length();
    }
    let mesh = |triangle: u32| geometry.mesh_of_triangle[triangle as usize];
    let mut found = BTreeSet::new();
    for look in 0..LOOKS {
        let random = |lane: usize, axis: u32| {
            let name = [seen.node as u32, look * LANES as u32 + lane as u32, axis];
            stream.single(Single::DriftLook, name)
        };
        let [u, v] = [0, 1].map(|axis| std::array::from_fn(|lane| random(lane, axis)).into());
        let local = cosine_direction(u, v);
        let normals = from_lanes(&normal);
        let directions = direction_from_local(normals, local);
        let scaled = std::array::from_fn(|l| lane_of(directions, l) * near[l] as f32);
        let mut rays = (scene.view).leaving(from_lanes(&x), normals, from_lanes(&scaled), lanes);
        rays.far = 1.0;
        let met = scene.view.intersect(&rays, Coherence::Incoherent);
        let pairs = met.into_iter().zip(seen.triangles);
        let itself = pairs.filter(|&(met, &from)| met != NO_TRIANGLE && mesh(met) == mesh(from));
        found.extend(itself.map(|(met, _)| mesh(met)));
    }
    found
}
