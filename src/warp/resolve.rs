//! Which boundary lies between two rays of a bundle.
//!
//! Loubet et al. choose the followed point by comparing the two hits' tangent planes. Here both surfaces are walked
//! toward the other ray (`super::walk`); the nearer silhouette is the one that is seen. Where neither surface ends
//! between the rays they must pass through each other, and the line in which their planes meet is followed, as
//! in the reference code's last rule.

use super::adjacency::Adjacency;
use super::boundary::Boundary;
use super::walk::{Arc, Fold, Walk, walk};
use crate::trace::geometry::{Geometry, NO_TRIANGLE};

/// What lies between two rays.
#[derive(Clone, Copy, Debug)]
pub enum Between {
    /// One connected surface, or nothing at all.
    Nothing,
    Silhouette(Fold),
    /// One of `count` edges of a flat-shaded surface that both rays see, across which its shading jumps.
    Ridge { fold: Fold, count: u32 },
    /// Two surfaces that pass through each other, at parameter `s` of the arc.
    Crease { boundary: Boundary, s: f64 },
    /// There must be something, and it was not found.
    Unresolved,
}

impl Between {
    fn silhouette(fold: Fold, from_end: bool) -> Self {
        Between::Silhouette(seen_from_start(fold, from_end))
    }

    fn ridge(geometry: &Geometry, triangle: u32, ridge: Option<(Fold, u32)>, from_end: bool) -> Self {
        let smooth = geometry.smooth[geometry.mesh_of_triangle[triangle as usize] as usize];
        match ridge {
            Some((fold, count)) if !smooth => Between::Ridge { fold: seen_from_start(fold, from_end), count },
            _ => Between::Nothing,
        }
    }
}

fn seen_from_start(fold: Fold, from_end: bool) -> Fold {
    let s = if from_end { 1.0 - fold.s } else { fold.s };
    Fold { s: s.clamp(0.0, 1.0), ..fold }
}

/// What lies between two rays that both look for the nearest surface; [`NO_TRIANGLE`] for a ray that hit none.
/// `choice` in [0, 1) picks among several edges.
pub fn between(geometry: &Geometry, adjacency: &Adjacency, arc: &Arc, a: u32, b: u32, choice: f64) -> Between {
    if a == b {
        return Between::Nothing;
    }
    let from_a = (a != NO_TRIANGLE).then(|| walk(geometry, adjacency, arc, a, b, choice));
    if let Some(Walk::Reached(ridge)) = from_a {
        return Between::ridge(geometry, a, ridge, false);
    }
    let from_b = (b != NO_TRIANGLE).then(|| walk(geometry, adjacency, &arc.reversed(), b, a, choice));
    match (from_a, from_b) {
        (_, Some(Walk::Reached(ridge))) => Between::ridge(geometry, b, ridge, true),
        (Some(Walk::Fold(f)), Some(Walk::Fold(g))) => {
            let distance = |fold: &Fold| (fold.point - arc.origin).length_squared();
            if distance(&f) <= distance(&g) { Between::silhouette(f, false) } else { Between::silhouette(g, true) }
        }
        (Some(Walk::Fold(f)), _) => Between::silhouette(f, false),
        (_, Some(Walk::Fold(g))) => Between::silhouette(g, true),
        (Some(Walk::Continues), Some(Walk::Continues)) => crease(geometry, arc, a, b),
        _ => Between::Unresolved,
    }
}

/// The line in which the planes of triangles `a` and `b` meet, if it passes between the rays.
fn crease(geometry: &Geometry, arc: &Arc, a: u32, b: u32) -> Between {
    let boundary = Boundary::Crease([a, b].map(|t| geometry.triangles[t as usize]));
    let c = boundary.normal(geometry, arc.origin);
    let (at_a, at_b) = (c.dot(arc.a), c.dot(arc.b));
    let s = at_a / (at_a - at_b);
    if (0.0..=1.0).contains(&s) { Between::Crease { boundary, s } } else { Between::Unresolved }
}
