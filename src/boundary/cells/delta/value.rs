//! What jumps at the border of a delta light's shadow: all that the light brings.

use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::boundary::{dvec3, vector};
use crate::kernels::triangle::triangle_point;
use crate::lanes::{LANES, V3};
use crate::paths::counts::Counts;
use crate::paths::rays::{RayPacket, lane_of};
use crate::paths::store::{DeltaSight, Vertices};
use crate::trace::Coherence;
use crate::trace::geometry::NO_TRIANGLE;
use glam::DVec3;

/// What stands as far away as this part of its distance from a receiver may be the receiver.
const SAME: f64 = 1e-4;

/// The radiance that each lane's ray receives from where it meets a triangle, if one delta light
/// shines on it and nothing hides either from the other. Where something hides the triangle from
/// the ray it is zero.
pub fn brought(
    scene: &SearchScene,
    rays: &RayPacket,
    receivers: &[u32; LANES],
    lights: &[u32; LANES],
    counts: &mut Counts,
) -> [DVec3; LANES] {
    let view = scene.view;
    let seen = view.intersect(rays, Coherence::Incoherent);
    counts.probe += u64::from(rays.active.count_ones());
    let is_seen = |&lane: &usize| {
        rays.active >> lane & 1 == 1
            && (seen[lane] == receivers[lane]
                || is_no_nearer(scene, rays, lane, [seen[lane], receivers[lane]]))
    };
    let lanes = (0..LANES).filter(is_seen).fold(0, |bits, l| bits | 1 << l);
    let mut vertices = Vertices {
        hit: lanes,
        origin: rays.origin,
        direction: rays.direction,
        triangle: *receivers,
        ..Vertices::default()
    };
    let sights: Vec<DeltaSight> = (0..view.delta_lights.len() as u32)
        .map(|light| {
            let its = (0..LANES).filter(|&l| lights[l] == light);
            DeltaSight {
                seen: lanes & its.fold(0, |bits, l| bits | 1 << l),
                hidden: 0,
            }
        })
        .collect();
    let mut sum = V3::splat(0.0);
    let mut part = 0;
    while let Some(fractions) = view.made_of(&mut vertices, part) {
        let surface = view.surface(&mut vertices);
        sum = sum + view.delta_light(&vertices, &surface, &sights) * fractions;
        part += 1;
    }
    std::array::from_fn(|l| {
        if lanes >> l & 1 == 1 {
            lane_of(sum, l).as_dvec3()
        } else {
            DVec3::ZERO
        }
    })
}

/// Whether the plane of the first triangle is not met before that of the second.
fn is_no_nearer(scene: &SearchScene, rays: &RayPacket, lane: usize, triangles: [u32; 2]) -> bool {
    let geometry = scene.view.geometry;
    let [o, d] = [rays.origin, rays.direction].map(|v| lane_of(v, lane).as_dvec3());
    let [seen, receiver] = triangles.map(|t| {
        if t == NO_TRIANGLE {
            return f64::INFINITY;
        }
        let corners = geometry.triangles[t as usize];
        let [p, q, r] = corners.map(|v| vector(geometry.positions[v as usize].as_dvec3()));
        dvec3(triangle_point(vector(o), vector(d), p, q, r)).distance(o)
    });
    seen >= receiver * (1.0 - SAME)
}
