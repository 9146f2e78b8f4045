//! A place where visibility jumps, and how fast it moves.
//!
//! Seen from o, a boundary is the zero set of F(o, d; vertices) over directions d
//! (`kernels::silhouette`). F is linear in d: F = c·d. If the directions of a domain are d(u) with
//! two coordinates u, the boundary crosses u where F(d(u)) = 0 and moves so that ∇F·V + Ḟ = 0, with
//! Ḟ the derivative by the parameters at fixed u. Of all velocities V that satisfy this only the
//! part along ∇F matters; the shortest in the domain's metric M is V = −Ḟ M⁻¹∇F / (∇F·M⁻¹∇F).
//!
//! Another is that of a point which keeps its place on the edge: Loubet's rotation (2019) of the
//! direction to a followed point. On lights, whose cells are large, it is the better one: two
//! silhouettes of one moving object that fall into the same cell are missed together, and with V
//! the velocity of the object itself, the same at both, what is missed cancels. On the film cells
//! are smaller than pixels, and the shortest V has less variance but in crowds (docs/method.md, 2).
//! Its part along axis 0 is that of a line through the point along axis 1: it too is written as an
//! F.

use crate::adjoint::silhouette::{crease_side_adjoint, edge_side_adjoint};
use crate::kernels::silhouette::{crease_side, edge_side};
use crate::kernels::triangle::triangle_point;
use crate::lanes::{Real, V3};
use crate::trace::geometry::Geometry;
use glam::DVec3;

/// Where visibility jumps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Boundary {
    /// A mesh edge, by its vertices.
    Edge([u32; 2]),
    /// The line in which two triangles pass through each other, by their vertices.
    Crease([[u32; 3]; 2]),
    /// A point that keeps its place on an edge (`along` from its first vertex to its second), taken
    /// with a line of fixed direction `line` through it: only its motion across that line counts.
    Point {
        edge: [u32; 2],
        along: f64,
        line: DVec3,
    },
    /// An edge of a texture on a triangle, a line through two points that keep their places on it,
    /// given by the barycentrics of its second and third vertex.
    TextureEdge {
        triangle: [u32; 3],
        ends: [[f64; 2]; 2],
    },
    /// A plane of fixed direction, by its normal, through what rays go to: the border of a light's
    /// beam, seen from where that falls.
    Plane(DVec3),
}

/// Across the plane through the origin and two points, a × b as a × (b − a): of points that are far
/// away next to one another the one is all rounding.
pub fn plane_through([a, b]: [DVec3; 2]) -> DVec3 {
    a.cross(b - a)
}

impl Boundary {
    /// c in F = c·d, seen from `o`.
    pub fn normal(&self, geometry: &Geometry, o: DVec3) -> DVec3 {
        let at = |v: u32| geometry.positions[v as usize].as_dvec3() - o;
        match *self {
            Boundary::Edge(edge) => plane_through(edge.map(at)),
            Boundary::Crease([a, b]) => {
                let [a, b] = [a.map(at), b.map(at)];
                let [na, nb] = [a, b].map(|[p, q, r]| (q - p).cross(r - p));
                nb * na.dot(a[0]) - na * nb.dot(b[0])
            }
            Boundary::Point {
                edge: [a, b],
                along,
                line,
            } => at(a).lerp(at(b), along).cross(line),
            Boundary::TextureEdge { triangle, ends } => {
                let [a, b, c] = triangle.map(at);
                let [p, q] = ends.map(|[s, t]| a + (b - a) * s + (c - a) * t);
                plane_through([p, q])
            }
            Boundary::Plane(normal) => normal,
        }
    }

    /// An edge as its point that is seen from `o` along `d`, of which only the motion across `line`
    /// counts. Other boundaries, and edges that are seen along themselves, are left as they are.
    pub fn of_point(self, geometry: &Geometry, o: DVec3, d: DVec3, line: DVec3) -> Self {
        let Boundary::Edge(edge) = self else {
            return self;
        };
        let [a, b] = edge.map(|v| geometry.positions[v as usize].as_dvec3() - o);
        // Across d, in the plane of the edge and o.
        let across = plane_through([a, b]).cross(d);
        let along = a.dot(across) / (a - b).dot(across);
        if (0.0..=1.0).contains(&along) {
            Boundary::Point { edge, along, line }
        } else {
            self
        }
    }

    /// The point of an edge that is seen from `o` along `d`, or its end next to that, or that of a
    /// crease; `None` for other boundaries.
    pub fn seen_along(&self, geometry: &Geometry, o: DVec3, d: DVec3) -> Option<DVec3> {
        let edge = match *self {
            Boundary::Edge(edge) => edge,
            Boundary::Crease([a, _]) => {
                let [p, q, r] = a.map(|v| vector(geometry.positions[v as usize].as_dvec3()));
                return Some(dvec3(triangle_point(vector(o), vector(d), p, q, r)));
            }
            _ => return None,
        };
        let [a, b] = edge.map(|v| geometry.positions[v as usize].as_dvec3() - o);
        // Across d, in the plane of the edge and o.
        let across = plane_through([a, b]).cross(d);
        let along = a.dot(across) / (a - b).dot(across);
        // An edge that is seen along itself is seen at any of its points.
        let along = if along.is_nan() {
            0.5
        } else {
            along.clamp(0.0, 1.0)
        };
        Some(o + a.lerp(b, along))
    }

    /// F over any lane type; `point` gives a vertex, tangent and all.
    pub fn side<F: Real>(&self, o: V3<F>, d: V3<F>, point: impl Fn(u32) -> V3<F>) -> F {
        match *self {
            Boundary::Edge([a, b]) => edge_side(o, d, point(a), point(b)),
            Boundary::Crease([a, b]) => crease_side(o, d, a.map(&point), b.map(&point)),
            Boundary::Point {
                edge: [a, b],
                along,
                line,
            } => {
                let (a, b) = (point(a), point(b));
                let at = a + (b - a) * F::splat(along);
                let line = V3::new(F::splat(line.x), F::splat(line.y), F::splat(line.z));
                edge_side(o, d, at, at + line)
            }
            Boundary::TextureEdge { triangle, ends } => {
                let [a, b, c] = triangle.map(&point);
                let [p, q] = ends.map(|[s, t]| a + (b - a) * F::splat(s) + (c - a) * F::splat(t));
                edge_side(o, d, p, q)
            }
            Boundary::Plane(n) => V3::new(F::splat(n.x), F::splat(n.y), F::splat(n.z)).dot(d),
        }
    }

    /// Cotangents of `o` and `d` from that of F; the vertices' go to `scatter`.
    pub fn side_adjoint(
        &self,
        geometry: &Geometry,
        o: DVec3,
        d: DVec3,
        side_bar: f64,
        mut scatter: impl FnMut(u32, DVec3),
    ) -> (DVec3, DVec3) {
        let point = |v: u32| vector(geometry.positions[v as usize].as_dvec3());
        match *self {
            Boundary::Edge([a, b]) => {
                let (o_bar, d_bar, a_bar, b_bar) =
                    edge_side_adjoint(vector(o), vector(d), point(a), point(b), side_bar);
                scatter(a, dvec3(a_bar));
                scatter(b, dvec3(b_bar));
                (dvec3(o_bar), dvec3(d_bar))
            }
            Boundary::Crease([a, b]) => {
                let ends = (a.map(point), b.map(point));
                let (o_bar, d_bar, a_bar, b_bar) =
                    crease_side_adjoint(vector(o), vector(d), ends.0, ends.1, side_bar);
                for (v, bar) in a.into_iter().chain(b).zip(a_bar.into_iter().chain(b_bar)) {
                    scatter(v, dvec3(bar));
                }
                (dvec3(o_bar), dvec3(d_bar))
            }
            Boundary::Point {
                edge: [a, b],
                along,
                line,
            } => {
                let [p, q] = [a, b].map(|v| geometry.positions[v as usize].as_dvec3());
                let at = p.lerp(q, along);
                let (o_bar, d_bar, at_bar, end_bar) = edge_side_adjoint(
                    vector(o),
                    vector(d),
                    vector(at),
                    vector(at + line),
                    side_bar,
                );
                let at_bar = dvec3(at_bar) + dvec3(end_bar);
                scatter(a, at_bar * (1.0 - along));
                scatter(b, at_bar * along);
                (dvec3(o_bar), dvec3(d_bar))
            }
            Boundary::TextureEdge { triangle, ends } => {
                let [a, b, c] = triangle.map(point);
                let [p, q] = ends.map(|[s, t]| a + (b - a) * s + (c - a) * t);
                let (o_bar, d_bar, p_bar, q_bar) =
                    edge_side_adjoint(vector(o), vector(d), p, q, side_bar);
                for ([s, t], bar) in ends.into_iter().zip([p_bar, q_bar].map(dvec3)) {
                    for (v, part) in triangle.into_iter().zip([1.0 - s - t, s, t]) {
                        scatter(v, bar * part);
                    }
                }
                (dvec3(o_bar), dvec3(d_bar))
            }
            Boundary::Plane(normal) => (DVec3::ZERO, normal * side_bar),
        }
    }
}

/// As kernels take it.
pub fn vector(v: DVec3) -> V3<f64> {
    V3 {
        x: v.x,
        y: v.y,
        z: v.z,
    }
}

/// As `glam` takes it.
pub fn dvec3(v: V3<f64>) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}

/// What Ḟ must be multiplied with to give the velocity along axis `axis` of a two-coordinate
/// domain, where `gradient` is ∇F and `metric` the (inner) metric [M₀₀, M₀₁, M₁₁]; `None` where the
/// boundary does not cross.
pub fn velocity_per_side(gradient: [f64; 2], metric: [f64; 3], axis: usize) -> Option<f64> {
    let [f0, f1] = gradient;
    let [m00, m01, m11] = metric;
    // M⁻¹∇F up to the determinant, which cancels.
    let g = [m11 * f0 - m01 * f1, m00 * f1 - m01 * f0];
    let norm = f0 * g[0] + f1 * g[1];
    (norm > 0.0).then(|| -g[axis] / norm)
}
