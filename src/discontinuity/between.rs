//! Which boundary lies between two rays of a bundle.
//!
//! Loubet et al. choose the followed point by comparing the two hits' tangent planes. Here both
//! surfaces are walked toward the other ray (`crate::discontinuity::walk`); the nearer silhouette
//! is the one that is seen. Where neither surface ends between the rays they must pass through each
//! other, and the line in which their planes meet is followed, as in the reference code's last
//! rule.

use crate::discontinuity::adjacency::Adjacency;
use crate::discontinuity::arc::Arc;
use crate::discontinuity::boundary::Boundary;
use crate::discontinuity::crossing::{Crossing, Kind, Reservoir};
use crate::discontinuity::texture_edges;
use crate::discontinuity::walk::{Fold, Walk, walk};
use crate::trace::geometry::{Geometry, NO_TRIANGLE};

/// Why two rays see what they do was not found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unresolved {
    /// There must be a silhouette between them.
    Lost,
    /// Both surfaces go on, and lie in one plane as far as single precision tells: it is chance
    /// which of them is seen, as of the floor under what stands on it.
    Coincident,
}

/// Halvings of a cell before it is given up.
pub const HALVINGS: u32 = 10;

/// A part of a cell, from 0 to 1, whose ends see these triangles.
pub type CellPart = ([f64; 2], [u32; 2]);

/// What `find` finds between two rays that see the triangles `ends`. If it finds nothing that
/// explains them, because both go on behind something that stands between the rays, a ray between
/// them (`seen`: what it sees) says what that is, and both halves are looked at. The parts left
/// without an explanation are returned, too, with the reason.
pub fn between_halves<T>(
    ends: [u32; 2],
    mut seen: impl FnMut(f64) -> u32,
    mut find: impl FnMut([f64; 2], [u32; 2]) -> Result<T, Unresolved>,
) -> (Vec<T>, Vec<(CellPart, Unresolved)>) {
    let mut found = Vec::new();
    let mut unresolved = Vec::new();
    let mut parts = vec![([0.0, 1.0], ends, 0)];
    while let Some((place @ [from, to], ends @ [a, b], halvings)) = parts.pop() {
        match find(place, ends) {
            Ok(part) => found.push(part),
            Err(why) if halvings == HALVINGS || why == Unresolved::Coincident => {
                unresolved.push(((place, ends), why));
            }
            Err(_) => {
                let middle = 0.5 * (from + to);
                let m = seen(middle);
                let halves = [([middle, to], [m, b]), ([from, middle], [a, m])];
                let differ = halves.into_iter().filter(|(_, [a, b])| a != b);
                parts.extend(differ.map(|(place, ends)| (place, ends, halvings + 1)));
            }
        }
    }
    (found, unresolved)
}

/// What lies between two rays that both look for the nearest surface ([`NO_TRIANGLE`] for a ray
/// that hit none): the silhouette, if they see different surfaces, and an edge within the surfaces
/// on either side of it, across which they bend, or a picture on them. Of several such edges
/// `choice` in [0, 1) picks one, and those nearer to the next than `gap` (in parameters of the arc)
/// are taken as one with it. Without a choice none are looked for.
pub fn between(
    geometry: &Geometry,
    adjacency: &Adjacency,
    arc: &Arc,
    [a, b]: [u32; 2],
    choice: Option<f64>,
    gap: f64,
) -> Result<[Option<Crossing>; 2], Unresolved> {
    if a == b {
        return Ok([
            None,
            choice.and_then(|choice| texture_edge(geometry, arc, a, choice, gap)),
        ]);
    }
    let back = arc.reversed();
    let has_ridges = |t: u32| choice.is_some() && t != NO_TRIANGLE;
    let reservoir = || choice.map_or(Reservoir::closed(), |choice| Reservoir::new(choice, gap));

    let mut ridges = reservoir();
    let from_a =
        (a != NO_TRIANGLE).then(|| walk(geometry, adjacency, arc, [a, b], 1.0, &mut ridges));
    if let Some(Walk::Reached) = from_a {
        return Ok([None, ridges.chosen()]);
    }
    let mut ridges = reservoir();
    let from_b =
        (b != NO_TRIANGLE).then(|| walk(geometry, adjacency, &back, [b, a], 1.0, &mut ridges));
    let silhouette = match (from_a, from_b) {
        (_, Some(Walk::Reached)) => return Ok([None, ridges.turned().chosen()]),
        (Some(Walk::Fold(f)), Some(Walk::Fold(g))) => {
            let distance = |fold: &Fold| (fold.point - arc.origin).length_squared();
            if distance(&f) <= distance(&g) {
                f
            } else {
                g.turned()
            }
        }
        (Some(Walk::Fold(f)), _) => f,
        (_, Some(Walk::Fold(g))) => g.turned(),
        (Some(Walk::Continues), Some(Walk::Continues)) => {
            return crease(geometry, arc, a, b).map(|crossing| [Some(crossing), None]);
        }
        _ => return Err(Unresolved::Lost),
    };

    // The ridges up to the silhouette on the side of a, and from there on on the side of b.
    let mut ridges = reservoir();
    if has_ridges(b) {
        walk(
            geometry,
            adjacency,
            &back,
            [b, NO_TRIANGLE],
            1.0 - silhouette.s,
            &mut ridges,
        );
    }
    ridges = ridges.turned();
    if has_ridges(a) {
        walk(
            geometry,
            adjacency,
            arc,
            [a, NO_TRIANGLE],
            silhouette.s,
            &mut ridges,
        );
    }
    let s = silhouette.s.clamp(0.0, 1.0);
    let kind = if silhouette.is_thin {
        Kind::ThinSilhouette
    } else {
        Kind::Silhouette
    };
    let silhouette = Crossing::new(Boundary::Edge(silhouette.edge), kind, s);
    Ok([Some(silhouette), ridges.chosen()])
}

/// A texture edge between two rays that see one triangle.
fn texture_edge(
    geometry: &Geometry,
    arc: &Arc,
    triangle: u32,
    choice: f64,
    gap: f64,
) -> Option<Crossing> {
    if !geometry.has_texture_edges(triangle) {
        return None;
    }
    let corners = geometry.triangles[triangle as usize];
    let points = corners.map(|v| geometry.positions[v as usize].as_dvec3() - arc.origin);
    let mut lines = Reservoir::new(choice, gap);
    for (line, s) in texture_edges::lines(geometry, triangle, points, arc, [0.0, 1.0]) {
        lines.meet(Crossing::ridge(line, s));
    }
    lines.settle(f64::INFINITY);
    lines.chosen()
}

/// The line in which the planes of triangles `a` and `b` meet, if it passes between the rays.
fn crease(geometry: &Geometry, arc: &Arc, a: u32, b: u32) -> Result<Crossing, Unresolved> {
    if geometry.coincide([a, b]) {
        return Err(Unresolved::Coincident);
    }
    let boundary = Boundary::Crease([a, b].map(|t| geometry.triangles[t as usize]));
    let c = boundary.normal(geometry, arc.origin);
    let (at_a, at_b) = (c.dot(arc.a), c.dot(arc.b));
    let s = at_a / (at_a - at_b);
    if (0.0..=1.0).contains(&s) {
        Ok(Crossing::new(boundary, Kind::Silhouette, s))
    } else {
        Err(Unresolved::Lost)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Something (2) stands between 0.3 and 0.32 before what is 0 on its left and 1 on its right,
    /// neither of which ends.
    #[test]
    fn halves_are_searched_for_what_hides_both_ends() {
        let seen = |s: f64| match s {
            s if s < 0.3 => 0,
            s if s < 0.32 => 2,
            _ => 1,
        };
        let find = |place: [f64; 2], ends: [u32; 2]| match ends {
            [0, 1] => Err(Unresolved::Lost),
            _ => Ok((place, ends)),
        };
        let (mut found, unresolved) = between_halves([0, 1], seen, find);
        found.sort_by(|a, b| a.0[0].total_cmp(&b.0[0]));
        assert!(unresolved.is_empty());
        let ends: Vec<_> = found.iter().map(|part| part.1).collect();
        assert_eq!(ends, [[0, 2], [2, 1]]);
        for ([from, to], [a, b]) in found {
            assert_eq!([seen(from), seen(to)], [a, b]);
        }
    }

    #[test]
    fn what_cannot_be_explained_is_counted() {
        let all = |why| between_halves([0, 1], |_| 0, |_, _| Err::<(), _>(why));
        for why in [Unresolved::Lost, Unresolved::Coincident] {
            let (found, unresolved) = all(why);
            assert!(found.is_empty());
            assert_eq!(unresolved.len(), 1);
            assert_eq!(unresolved[0].1, why);
        }
    }
}
