//! Lights of many triangles that are round: seen from outside, one thing.

use crate::paths::light::twins::NONE;
use crate::trace::geometry::Geometry;
use glam::DVec3;
use std::ops::Range;

/// Of so many patches a light is more than the sum of its parts.
const MANY: usize = 12;
/// Not more of the radius lies between the spheres around and inside a lamp, as seen along a facet:
/// icospheres have 0.36 with 80 triangles and 0.19 with 320.
const ROUND: f64 = 0.25;
/// A vertex that stands out of a plane by less than this part of the mesh's extent lies in it.
const FLAT: f64 = 1e-5;

/// A round light of many patches that shines outward. From outside none of it hides another part,
/// so that what hides it are other things; and all that is seen of it is nearer than its centre,
/// but for a little.
///
/// With R the radius of a sphere around it and r that of one inside about the same centre, no point
/// of a facet is farther than w = √(R² − r²) from where the centre lies over the facet's plane.
/// From a point at distance D only facets are seen whose normal has a cosine of at least r/D with
/// the way there. So what is seen is at most w farther than the centre.
pub struct Lamp {
    /// Of a sphere around it.
    pub centre: DVec3,
    pub radius: f64,
    /// How much farther than its centre what is seen of it is at most.
    pub behind: f64,
    /// One of its vertices.
    pub vertex: u32,
    /// Chance of picking any of its patches.
    pub chance: f64,
    triangles: Range<u32>,
    /// The patch of each of its triangles.
    patches: Vec<u32>,
}

impl Lamp {
    /// The lamp that a mesh is whose half-edges have these twins, and whose patches, from this
    /// number on, have these triangles; `None` if it is none.
    pub fn new(
        geometry: &Geometry,
        mesh: usize,
        twins: &[u32],
        (first_patch, patches): (usize, &[[u32; 2]]),
    ) -> Option<Self> {
        if patches.len() < MANY {
            return None;
        }
        let [first, end] = [mesh, mesh + 1].map(|m| geometry.first_triangle[m]);
        let vertices =
            geometry.first_vertex[mesh] as usize..geometry.first_vertex[mesh + 1] as usize;
        let positions = geometry.positions[vertices].iter().map(|p| p.as_dvec3());
        let low = positions.clone().fold(DVec3::INFINITY, DVec3::min);
        let high = positions.clone().fold(DVec3::NEG_INFINITY, DVec3::max);
        let centre = 0.5 * (low + high);
        let radius = positions.map(|p| p.distance(centre)).fold(0.0, f64::max);
        let inner = inner_radius(geometry, mesh, centre);
        let behind = (radius * radius - inner.max(0.0).powi(2)).sqrt();
        if behind > ROUND * radius || !is_convex(geometry, mesh, twins, FLAT * radius) {
            return None;
        }
        let mut own = vec![0; (end - first) as usize];
        for (number, of_patch) in patches.iter().enumerate() {
            for triangle in of_patch {
                own[(triangle - first) as usize] = (first_patch + number) as u32;
            }
        }
        Some(Self {
            centre,
            radius,
            behind,
            vertex: geometry.first_vertex[mesh],
            chance: 0.0,
            triangles: first..end,
            patches: own,
        })
    }

    /// Its patch that a triangle belongs to.
    pub fn patch(&self, triangle: u32) -> Option<u32> {
        self.triangles
            .contains(&triangle)
            .then(|| self.patches[(triangle - self.triangles.start) as usize])
    }
}

/// The least distance of a point from the planes of a mesh's triangles; negative outside of one.
fn inner_radius(geometry: &Geometry, mesh: usize, centre: DVec3) -> f64 {
    let [first, end] = [mesh, mesh + 1].map(|m| geometry.first_triangle[m] as usize);
    let distance = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| geometry.positions[v as usize].as_dvec3());
        (b - a).cross(c - a).normalize_or_zero().dot(a - centre)
    };
    let triangles = &geometry.triangles[first..end];
    triangles.iter().map(distance).fold(f64::INFINITY, f64::min)
}

/// Whether a mesh is the surface of one convex body, seen from outside: closed, of one piece, and
/// nowhere bent inward.
fn is_convex(geometry: &Geometry, mesh: usize, twins: &[u32], flat: f64) -> bool {
    let [first, end] = [mesh, mesh + 1].map(|m| geometry.first_triangle[m] as usize);
    let triangles = &geometry.triangles[first..end];
    let corner = |half_edge: usize| {
        let v = triangles[half_edge / 3][half_edge % 3];
        geometry.positions[v as usize].as_dvec3()
    };
    let mut joined = 0;
    for (half_edge, &twin) in twins.iter().enumerate() {
        if twin == NONE {
            continue;
        }
        joined += 1;
        let [a, b, c] = triangles[half_edge / 3].map(|v| geometry.positions[v as usize].as_dvec3());
        let normal = (b - a).cross(c - a).normalize_or_zero();
        if normal.dot(corner(twin as usize) - a) > flat {
            return false;
        }
    }
    // Each edge is shared by two, and vertices - edges + faces = 2.
    let welded = geometry.welded(mesh);
    let v0 = geometry.first_vertex[mesh];
    let mut used: Vec<u32> = triangles
        .iter()
        .flatten()
        .map(|&v| welded[(v - v0) as usize])
        .collect();
    used.sort_unstable();
    used.dedup();
    2 * joined == twins.len() && used.len() + triangles.len() == joined + 2
}
