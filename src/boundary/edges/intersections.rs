//! Surfaces that pass through one another meet in lines that are no edges of meshes, and nothing
//! here would find those.
//!
//! Two triangles pass through each other only if an edge of one goes through the other, so rays
//! along all edges tell.

use crate::discontinuity::adjacency::Adjacency;
use crate::paths::scene_view::SceneView;
use crate::trace::geometry::NO_TRIANGLE;
use glam::{DVec3, Vec3};
use rayon::prelude::*;

/// What an edge meets this near to its ends, as a part of it, only touches it.
const TOUCHES: f64 = 1e-4;
/// An edge lies in a plane from which both its ends are no farther than this, per unit of the
/// largest coordinate and one.
const IN_PLANE: f64 = 2e-5;
/// Triangles around an edge's own ends that are passed on the way.
const MOST_PASSED: usize = 16;

/// Two meshes that pass through each other, or one that passes through itself, twice, of which
/// either `counts`; `None` if there are none.
pub fn find(
    view: &SceneView,
    adjacency: &Adjacency,
    counts: impl Fn(usize) -> bool + Sync,
) -> Option<[usize; 2]> {
    let triangles = 0..view.geometry.triangles.len() as u32;
    let mesh = |triangle: u32| view.geometry.mesh_of_triangle[triangle as usize] as usize;
    let boxes: Vec<[Vec3; 2]> = (0..view.geometry.smooth.len())
        .filter(|&m| counts(m))
        .map(|m| {
            let [first, end] = [m, m + 1].map(|m| view.geometry.first_vertex[m] as usize);
            around(&view.geometry.positions[first..end])
        })
        .collect();
    let may_count = |triangle: u32| {
        let corners = view.geometry.triangles[triangle as usize];
        let own = around(&corners.map(|v| view.geometry.positions[v as usize]));
        let meets = |[low, high]: &[Vec3; 2]| own[0].cmple(*high).all() && low.cmple(own[1]).all();
        boxes.iter().any(meets)
    };
    let crossed = triangles.into_par_iter().find_map_first(|triangle| {
        if !may_count(triangle) {
            return None;
        }
        (0..3).find_map(|corner| {
            let across = adjacency.across(triangle, corner);
            // The other triangle at the edge asks.
            let is_asked = across.is_some_and(|a| (a.triangle, a.corner) < (triangle, corner));
            if is_asked {
                return None;
            }
            let counts = |other: u32| counts(mesh(triangle)) || counts(mesh(other));
            let other = crossed(view, triangle, corner, &counts)?;
            Some([triangle, other])
        })
    });
    crossed.map(|both| both.map(mesh))
}

/// The box around points.
fn around(points: &[Vec3]) -> [Vec3; 2] {
    let all = points.iter().copied();
    let low = all.clone().fold(Vec3::INFINITY, Vec3::min);
    [low, all.fold(Vec3::NEG_INFINITY, Vec3::max)]
}

/// A triangle that an edge goes through, and that counts.
fn crossed(
    view: &SceneView,
    triangle: u32,
    corner: usize,
    counts: &impl Fn(u32) -> bool,
) -> Option<u32> {
    let geometry = view.geometry;
    let position = |v: u32| geometry.positions[v as usize];
    let vertices = geometry.triangles[triangle as usize];
    let ends = [vertices[corner], vertices[(corner + 1) % 3]].map(position);
    let [a, b] = ends.map(Vec3::as_dvec3);
    let mut near = TOUCHES;
    let mut passed = 0;
    while passed < MOST_PASSED {
        let far = (1.0 - TOUCHES) as f32;
        let hit = view.first_hit(ends[0], ends[1] - ends[0], near as f32, far);
        if hit == NO_TRIANGLE {
            return None;
        }
        let corners = geometry.triangles[hit as usize].map(position);
        let [p, q, r] = corners.map(Vec3::as_dvec3);
        let normal = (q - p).cross(r - p).normalize_or_zero();
        let [from, to] = [a, b].map(|end| normal.dot(end - p));
        let room = geometry.room(a.abs().max(b.abs()));
        let in_plane = from.abs().max(to.abs()) < IN_PLANE * room;
        let is_neighbour = ends.iter().any(|end| corners.contains(end));
        let at = from / (from - to);
        // What goes through a triangle at its very rim, as floors through the walls that stand on
        // them, only touches it.
        let point = a.lerp(b, at);
        let sides = [[p, q], [q, r], [r, p]];
        let inside = sides.map(|[v, w]| (w - v).normalize_or_zero().cross(point - v).dot(normal));
        let at_rim = inside.into_iter().fold(f64::INFINITY, f64::min) < IN_PLANE * room;
        let is_through = !in_plane && !is_neighbour && !at_rim && normal != DVec3::ZERO;
        if is_through && counts(hit) {
            return Some(hit);
        }
        // However many an edge goes through that do not count, the next may.
        passed += usize::from(!is_through);
        near = if at.is_finite() { at.max(near) } else { near } + TOUCHES;
        if near >= 1.0 - TOUCHES {
            return None;
        }
    }
    None
}
