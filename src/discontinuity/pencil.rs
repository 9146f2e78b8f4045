//! What lies between two rays that start in different places: those that smooth surfaces have bent.
//!
//! Between the two ends the rays are taken for o(s) = lerp(o₀, o₁), d(s) = lerp(d₀, d₁). The ray
//! passes through the line of an edge (p, q) where d·((p − o) × (q − o)) = 0, which is quadratic in
//! s, because o × o vanishes. So a walk over a mesh needs neither a common origin nor a plane, and
//! does not care where the rays converge. What it finds is where the true rays, which curved
//! surfaces bend otherwise, are looked at.

use crate::discontinuity::adjacency::Adjacency;
use crate::discontinuity::arc::Arc;
use crate::discontinuity::between::Unresolved;
use crate::discontinuity::boundary::{Boundary, vector};
use crate::discontinuity::crossing::{Crossing, Kind};
use crate::discontinuity::texture_edges;
use crate::discontinuity::walk::{FLAT, bend, is_torn};
use crate::kernels::silhouette::crease_side;
use crate::trace::geometry::{Geometry, NO_TRIANGLE};
use glam::DVec3;

/// Triangles crossed before a walk is given up.
const MAX_STEPS: usize = 512;
/// What rounding may have moved a crossing by.
const ROUNDING: f64 = 1e-4;

/// Two rays, and those between them.
#[derive(Clone, Copy, Debug)]
pub struct Pencil {
    pub starts: [DVec3; 2],
    pub directions: [DVec3; 2],
}

/// Where a surface ends.
#[derive(Clone, Copy)]
struct Fold {
    edge: [u32; 2],
    s: f64,
    /// Along the ray.
    distance: f64,
    is_thin: bool,
}

enum Walk {
    Fold(Fold),
    Reached,
    Continues,
    Lost,
}

/// What lies between two rays.
#[derive(Default)]
pub struct Between {
    /// And which of the two rays sees what ends there, if not both.
    pub silhouette: Option<(Crossing, Option<usize>)>,
    /// Edges within what is seen over which shading, or the plane of what is flat, does not go on.
    pub ridges: Vec<Crossing>,
}

impl Between {
    /// Ridges that lie in one place are one, since who looks beside one of them sees them all. Of
    /// an edge and lines of a picture along it the edge stays: there rays may be bent otherwise.
    fn new(silhouette: Option<(Crossing, Option<usize>)>, mut ridges: Vec<Crossing>) -> Self {
        let is_line = |ridge: &Crossing| matches!(ridge.boundary, Boundary::TextureEdge { .. });
        ridges.sort_by(|a, b| a.s.total_cmp(&b.s));
        ridges.dedup_by(|next, kept| {
            let is_same = next.s - kept.s < ROUNDING;
            if is_same && is_line(kept) {
                *kept = *next;
            }
            is_same
        });
        Self { silhouette, ridges }
    }
}

impl Pencil {
    fn reversed(self) -> Self {
        let ([o, p], [d, e]) = (self.starts, self.directions);
        Self {
            starts: [p, o],
            directions: [e, d],
        }
    }

    /// Whether they start on two sides of the plane of one of these triangles.
    pub fn starts_pass(&self, geometry: &Geometry, seen: [u32; 2]) -> bool {
        seen.into_iter().filter(|&t| t != NO_TRIANGLE).any(|t| {
            let corners = geometry.triangles[t as usize];
            let [p, q, r] = corners.map(|v| geometry.positions[v as usize].as_dvec3());
            let normal = (q - p).cross(r - p);
            let [from, to] = self.starts.map(|o| normal.dot(o - p));
            from * to <= 0.0
        })
    }

    fn ray(&self, s: f64) -> (DVec3, DVec3) {
        let [o, d] = [self.starts, self.directions].map(|[a, b]| a.lerp(b, s));
        (o, d)
    }

    /// Coefficients of F(s) for the edge from `p` to `q`.
    fn side(&self, p: DVec3, q: DVec3) -> [f64; 3] {
        let [o, d] = [self.starts, self.directions].map(|[a, _]| a);
        let [o_turn, d_turn] = [self.starts, self.directions].map(|[a, b]| b - a);
        let across = (p - o).cross(q - o);
        let turn = o_turn.cross(p - q);
        [
            d.dot(across),
            d_turn.dot(across) + d.dot(turn),
            d_turn.dot(turn),
        ]
    }
}

/// The first root beyond `from` at which a quadratic function falls.
fn falls([c, b, a]: [f64; 3], from: f64) -> Option<f64> {
    let linear = -c / b;
    let is_linear = a.abs() * (1.0 + linear.abs()) < 1e-9 * b.abs();
    let roots = if is_linear {
        [linear; 2]
    } else {
        let square = b * b - 4.0 * a * c;
        if square < 0.0 {
            return None;
        }
        let q = -0.5 * (b + b.signum() * square.sqrt());
        [q / a, c / q]
    };
    let falling = |r: &f64| r.is_finite() && b + 2.0 * a * r < 0.0 && *r > from - ROUNDING;
    roots.into_iter().filter(falling).reduce(f64::min)
}

/// What lies between the rays of a pencil that see these triangles ([`NO_TRIANGLE`]: none).
pub fn between(
    geometry: &Geometry,
    adjacency: &Adjacency,
    pencil: &Pencil,
    [a, b]: [u32; 2],
) -> Result<Between, Unresolved> {
    if a == b {
        let ridges = texture_lines(geometry, a, pencil, [0.0, 1.0]);
        return Ok(Between::new(None, ridges));
    }
    let mut before = Vec::new();
    let from_a = (a != NO_TRIANGLE).then(|| walk(geometry, adjacency, pencil, [a, b], &mut before));
    if let Some(Walk::Reached) = from_a {
        return Ok(Between::new(None, before));
    }
    let mut after = Vec::new();
    let back = pencil.reversed();
    let from_b = (b != NO_TRIANGLE).then(|| walk(geometry, adjacency, &back, [b, a], &mut after));
    for ridge in &mut after {
        ridge.s = 1.0 - ridge.s;
    }
    let turned = |fold: Fold| Fold {
        s: 1.0 - fold.s,
        ..fold
    };
    let (fold, near) = match (from_a, from_b) {
        (_, Some(Walk::Reached)) => {
            return Ok(Between::new(None, after));
        }
        (Some(Walk::Fold(f)), Some(Walk::Fold(g))) => {
            if f.distance <= g.distance {
                (f, 0)
            } else {
                (turned(g), 1)
            }
        }
        (Some(Walk::Fold(f)), _) => (f, 0),
        (_, Some(Walk::Fold(g))) => (turned(g), 1),
        (Some(Walk::Continues), Some(Walk::Continues)) => {
            let silhouette = Some((crease(geometry, pencil, [a, b])?, None));
            return Ok(Between::new(silhouette, Vec::new()));
        }
        _ => return Err(Unresolved::Lost),
    };
    before.retain(|ridge| ridge.s < fold.s);
    after.retain(|ridge| ridge.s > fold.s);
    before.extend(after);
    let kind = if fold.is_thin {
        Kind::ThinSilhouette
    } else {
        Kind::Silhouette
    };
    let silhouette = Crossing::new(Boundary::Edge(fold.edge), kind, fold.s);
    Ok(Between::new(Some((silhouette, Some(near))), before))
}

/// Where two surfaces pass through each other that both go on.
fn crease(geometry: &Geometry, pencil: &Pencil, seen: [u32; 2]) -> Result<Crossing, Unresolved> {
    if geometry.coincide(seen) {
        return Err(Unresolved::Coincident);
    }
    let [a, b] = seen.map(|t| geometry.triangles[t as usize]);
    let point = |v: u32| vector(geometry.positions[v as usize].as_dvec3());
    let side = |s: f64| {
        let (o, d) = pencil.ray(s);
        crease_side(vector(o), vector(d), a.map(point), b.map(point))
    };
    let (low, high) = (side(0.0), side(1.0));
    if low * high >= 0.0 {
        return Err(Unresolved::Lost);
    }
    let s = low / (low - high);
    Ok(Crossing::new(Boundary::Crease([a, b]), Kind::Silhouette, s))
}

/// The texture edges that rays between two places cross on a triangle, taken to lie on a straight
/// line there.
fn texture_lines(
    geometry: &Geometry,
    triangle: u32,
    pencil: &Pencil,
    [from, to]: [f64; 2],
) -> Vec<Crossing> {
    if !geometry.has_texture_edges(triangle) || from >= to {
        return Vec::new();
    }
    let corners = geometry.triangles[triangle as usize];
    let [p, q, r] = corners.map(|v| geometry.positions[v as usize].as_dvec3());
    let normal = (q - p).cross(r - p);
    let origin = pencil.ray(0.5 * (from + to)).0;
    let [a, b] = [from, to].map(|s| {
        let (o, d) = pencil.ray(s);
        o + d * (normal.dot(p - o) / normal.dot(d)) - origin
    });
    let arc = Arc { origin, a, b };
    let points = [p, q, r].map(|p| p - origin);
    let lines = texture_edges::lines(geometry, triangle, points, &arc, [0.0, 1.0]);
    let place = |s: f64| from + (to - from) * s;
    lines
        .into_iter()
        .map(|(line, s)| Crossing::ridge(line, place(s)))
        .collect()
}

/// Walks from `start`, which the pencil's first ray meets, toward `goal`, which its last one meets.
fn walk(
    geometry: &Geometry,
    adjacency: &Adjacency,
    pencil: &Pencil,
    [start, goal]: [u32; 2],
    ridges: &mut Vec<Crossing>,
) -> Walk {
    let position = |v: u32| geometry.positions[v as usize].as_dvec3();
    let is_smooth = geometry.smooth[geometry.mesh_of_triangle[start as usize] as usize];
    let mut triangle = start;
    let mut entered_at = 0.0;
    for _ in 0..MAX_STEPS {
        let vertices = geometry.triangles[triangle as usize];
        let points = vertices.map(position);
        let normal = (points[1] - points[0]).cross(points[2] - points[0]);
        let facing = normal.dot(pencil.ray(entered_at).1).signum();
        let exit = (0..3)
            .filter_map(|corner| {
                let side = pencil.side(points[corner], points[(corner + 1) % 3]);
                let s = falls(side.map(|c| c * facing), entered_at)?;
                Some((corner, s.max(entered_at)))
            })
            .min_by(|a, b| a.1.total_cmp(&b.1));
        let left_at = exit.map_or(1.0, |(_, s)| s.min(1.0));
        ridges.extend(texture_lines(
            geometry,
            triangle,
            pencil,
            [entered_at, left_at],
        ));
        let Some((corner, s)) = exit else {
            return Walk::Continues;
        };
        if s >= 1.0 {
            return Walk::Continues;
        }
        let edge = [vertices[corner], vertices[(corner + 1) % 3]];
        let (o, d) = pencil.ray(s);
        let fold = Fold {
            edge,
            s,
            distance: normal.dot(points[0] - o) / normal.dot(d),
            is_thin: false,
        };
        let Some(across) = adjacency.across(triangle, corner) else {
            return Walk::Fold(fold);
        };
        let next = geometry.triangles[across.triangle as usize].map(position);
        let there = (next[1] - next[0]).cross(next[2] - next[0]);
        let there = if across.flipped { -there } else { there };
        if there.dot(d) * normal.dot(d) <= 0.0 {
            let is_acute = normal.dot(there) < 0.0;
            return Walk::Fold(Fold {
                is_thin: is_smooth && is_acute,
                ..fold
            });
        }
        let is_ridge = if is_smooth {
            is_torn(geometry, triangle, corner, &across)
        } else {
            bend(normal, there) > FLAT
        };
        let has_pattern = geometry.pattern(triangle).is_some();
        let is_ridge = is_ridge
            || (has_pattern && texture_edges::is_seam(geometry, triangle, corner, &across));
        if is_ridge {
            ridges.push(Crossing::ridge(Boundary::Edge(edge), s));
        }
        if across.triangle == goal {
            ridges.extend(texture_lines(geometry, goal, pencil, [s, 1.0]));
            return Walk::Reached;
        }
        triangle = across.triangle;
        entered_at = s;
    }
    Walk::Lost
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The roots of a quadratic function at which it falls, and none at which it rises.
    #[test]
    fn only_where_it_falls() {
        // (s − 0.2)(0.6 − s): rises at 0.2, falls at 0.6.
        let f = [-0.12, 0.8, -1.0];
        assert!((falls(f, 0.0).unwrap() - 0.6).abs() < 1e-12);
        assert!((falls(f.map(|c| -c), 0.0).unwrap() - 0.2).abs() < 1e-12);
        assert!(falls(f.map(|c| -c), 0.3).is_none());
        assert!((falls([1.0, -2.0, 0.0], 0.0).unwrap() - 0.5).abs() < 1e-12);
        assert!(falls([1.0, 2.0, 0.0], 0.0).is_none());
    }

    /// Rays that cross between their starts and what they meet: an edge's crossing is where they
    /// say it is.
    #[test]
    fn an_edge_behind_a_focus() {
        let pencil = Pencil {
            starts: [DVec3::new(-1.0, 0.0, 0.0), DVec3::new(1.0, 0.0, 0.0)],
            directions: [DVec3::new(1.0, 0.0, 1.0), DVec3::new(-1.0, 0.0, 1.0)],
        };
        // At z = 3 the ray of s is at x = −1 + 2s + 3(1 − 2s) = 2 − 4s.
        let edge = [DVec3::new(1.0, -1.0, 3.0), DVec3::new(1.0, 1.0, 3.0)];
        let [c, b, a] = pencil.side(edge[0], edge[1]);
        let s = 0.25;
        assert!((c + s * (b + s * a)).abs() < 1e-12);
    }
}
