//! A point of an edge, drawn for a vertex.
//!
//! \[Li2018\] draw points along edges from the shading point. With Θ the angle under which an edge
//! is seen, points are drawn uniformly in it, so that a point of an edge that is drawn with chance
//! P stands for Θ/P of the length of all borders on the unit sphere. A border moves across itself
//! by −Ḟ/|c|, with F(d) = c·d for unit directions d, and brings (L₋ − L₊) times that: per unit of Ḟ
//! (L₊ − L₋) Θ / (P |c|).

use super::directions::Directions;
use super::scene_edges::SceneEdge;
use super::set::EdgeSet;
use super::tree::Query;
use crate::boundary::occlusion::{SurfacePoint, probe_angle};
use crate::discontinuity::boundary::Boundary;
use crate::discontinuity::crossing::{Crossing, Kind};
use crate::trace::geometry::{Geometry, NO_TRIANGLE};
use glam::DVec3;

/// Probes look no farther beside an edge than this angle.
const MOST_BESIDE: f64 = 0.01;

/// A point of an edge as a vertex sees it, if nothing stands before it.
#[derive(Clone, Copy)]
pub struct EdgePoint {
    pub boundary: Boundary,
    pub crossing: Crossing,
    /// The sign of F where its surface does not lie; `None` if that goes on.
    pub open_side: Option<f64>,
    /// Toward it from the vertex, unit.
    pub direction: DVec3,
    /// Toward it from where rays leave the vertex, of full length; of any length at a horizon.
    pub way: DVec3,
    /// Across the edge, unit, toward F > 0.
    pub across: DVec3,
    /// How far beside it probes look.
    pub beside_rad: f64,
    /// What a jump brings, from the side of F < 0 to the other, per unit of Ḟ.
    pub per_side: f64,
    /// Whether it is one of the plane of the vertex's own triangle. Nothing stands before that, and
    /// what is below may be as open as what is above.
    pub is_horizon: bool,
}

impl EdgePoint {
    /// Draws one of an edge by two uniform numbers.
    pub fn draw(
        set: &EdgeSet,
        geometry: &Geometry,
        directions: &Directions,
        point: &SurfacePoint,
        [which, along]: [f64; 2],
    ) -> Option<Self> {
        let drawn = set.tree.draw(geometry, &set.edges, directions, which)?;
        let edge = &set.edges.edges[drawn.edge as usize];
        let x = directions.origin();
        let boundary = Boundary::Edge(edge.ends);
        let [a, b] = edge
            .ends
            .map(|v| geometry.positions[v as usize].as_dvec3() - x);
        let c = boundary.normal(geometry, x);
        let (from, to) = (a.normalize(), b.normalize());
        let angle = from.angle_between(to);
        let turn = angle * along;
        let direction = (from * (angle - turn).sin() + to * turn.sin()).normalize();
        let y = boundary.seen_along(geometry, x, direction)?;

        let start = point.leave(y - x).as_dvec3();
        let open_side = set.edges.side(geometry, edge, x).map(|side| -side);
        let crossing = Crossing::new(boundary, kind(edge, open_side), 0.0);
        let [beside, _] = probe_angle(geometry, &crossing, (start, 0.0), y - start);
        let found = Self {
            boundary,
            crossing,
            open_side,
            direction,
            way: y - start,
            across: boundary.normal(geometry, start).normalize(),
            beside_rad: beside.min(MOST_BESIDE),
            per_side: edge.share * angle / (drawn.chance * c.length()),
            is_horizon: false,
        };
        let is_good = found.per_side.is_finite()
            && found.across.is_finite()
            && found.direction.is_finite()
            && found.way.is_finite();
        is_good.then_some(found)
    }

    /// The unit direction beside it, on the side of this sign of F.
    pub fn beside(&self, side: f64) -> DVec3 {
        (self.way.normalize() + self.across * (side * self.beside_rad)).normalize()
    }

    /// Where a ray ends that meets what stands before it.
    pub fn end(&self, start: DVec3) -> DVec3 {
        let shift = self.open_side.unwrap_or(0.0) * self.beside_rad * self.way.length();
        start + self.way + self.across * shift
    }
}

/// What happens at an edge, from where it is seen.
pub fn kind(edge: &SceneEdge, open_side: Option<f64>) -> Kind {
    match open_side {
        Some(_) if edge.is_acute => Kind::ThinSilhouette,
        Some(_) => Kind::Silhouette,
        None if edge.shading.is_facets() => Kind::FacetEdge,
        None => Kind::Ridge,
    }
}

/// Whether a triangle is one of those at an edge.
pub fn is_at(geometry: &Geometry, edge: &Boundary, triangle: u32) -> bool {
    let (Boundary::Edge(ends), true) = (edge, triangle != NO_TRIANGLE) else {
        return false;
    };
    let position = |v: u32| geometry.positions[v as usize];
    let corners = geometry.triangles[triangle as usize].map(position);
    ends.iter().all(|&v| corners.contains(&position(v)))
}

/// Whether what is seen on both sides of an edge tells what jumps there. Where shading jumps these
/// are the edge's own triangles: near an outline a fine mesh's edges lie so close that probes look
/// past them.
pub fn explains(geometry: &Geometry, crossing: &Crossing, seen: [u32; 2]) -> bool {
    crossing.is_silhouette()
        || seen
            .iter()
            .all(|&triangle| is_at(geometry, &crossing.boundary, triangle))
}
