//! What directions over lobes drift with (`paths::lobe_drift`), and where they rest.
//!
//! Bounces follow pieces of metal, glass and plastic, because their light changes along them;
//! pieces that are curved, along which points slide near an outline; and meshes of many pieces,
//! because there are too many borders to find.
//!
//! Where a surface is full of detail its normal turns by much over its own size. A lobe that turns
//! with the normal sweeps over what it sees, and where it sees such a surface again, as inside of
//! glass, its ray is turned by many times as much: after four reflections inside of a scanned
//! animal by a hundred thousand times. There directions rest in the world, and what the lobe sends
//! along them changes instead. That has a noise in proportion to one over the lobe's width, but
//! once. Of a diffuse lobe it is so little that directions rest over all that is curved: in a
//! furnished room a ball that moves has a quarter of the variance. Pictures that turn normals are
//! detail, too (`relief`).

use super::relief;
use super::walls::walls;
use crate::boundary::search_scene::SearchScene;
use crate::paths::drift_body::Body;
use crate::paths::lobe_drift::{LobeDrift, Rests};
use crate::trace::geometry::Geometry;
use glam::DVec3;
use std::collections::BTreeMap;

/// The mean turn of a mesh's normals over half its size from which it is full of detail; a ball's
/// is 1.7. Over these also the directions of rough metal, glass and plastic rest.
const DETAIL_RAD: f64 = 3.0;
/// The same from which it is curved: points on it slide near its outline and its normal turns
/// there.
const CURVED_RAD: f64 = 1.0;
/// Facets of something curved meet at less than that.
const MOST_BEND_RAD: f64 = 0.5;
/// So many pieces of a mesh are a crowd...
const CROWD: usize = 16;
/// ...unless one of them has more than one in so many of its triangles.
const LARGEST: usize = 4;
/// So many triangles tell where a body is.
const MOST_TRIANGLES: usize = 1 << 14;
/// Of the radius of a ball: all of its triangles' middles are as far from its centre. Those of an
/// icosahedron are at 0.79.
const BALL: f64 = 0.75;

/// What directions over lobes drift with; `None` if nothing moves or nothing carries them.
pub fn find(scene: &SearchScene) -> Option<LobeDrift> {
    let view = scene.view;
    if !scene.moving.anything() {
        return None;
    }
    let geometry = view.geometry;
    let meshes = 0..geometry.smooth.len();
    let crowds: Vec<bool> = meshes.clone().map(|m| is_crowd(scene, m)).collect();
    let details_rad: Vec<f64> = meshes.clone().map(|m| detail_rad(scene, m)).collect();
    let is_plain = |&m: &usize| {
        let is_special = view.materials.is_special(view.scene.meshes[m].material);
        !(crowds[m] || is_special || details_rad[m] > CURVED_RAD)
    };
    let walls = walls(scene, meshes.clone().filter(is_plain));
    let bodies = meshes.flat_map(|m| bodies_of(scene, m, crowds[m], details_rad[m]));
    let rests = details_rad.iter().enumerate().map(|(m, &shape)| {
        let detail = shape + half_diagonal(geometry, m) * relief::turn_rad_per_length(scene, m);
        Rests {
            diffuse: detail > CURVED_RAD,
            rough: detail > DETAIL_RAD,
        }
    });
    LobeDrift::new(
        [bodies.collect(), walls],
        crowds.contains(&true),
        rests.collect(),
    )
}

/// Whether a mesh is of many pieces of which none is large.
fn is_crowd(scene: &SearchScene, mesh: usize) -> bool {
    let triangles = triangles_of(scene, mesh);
    // Triangles of a piece mostly follow one another.
    let runs = triangles.chunk_by(|a, b| number(scene, a) == number(scene, b));
    let mut sizes: BTreeMap<u32, usize> = BTreeMap::new();
    for run in runs {
        *sizes.entry(number(scene, &run[0])).or_default() += run.len();
    }
    let largest = sizes.values().max().copied().unwrap_or(0);
    sizes.len() >= CROWD && LARGEST * largest < triangles.len()
}

fn triangles_of<'a>(scene: &'a SearchScene, mesh: usize) -> &'a [[u32; 3]] {
    let geometry = scene.view.geometry;
    let [from, to] = [mesh, mesh + 1].map(|m| geometry.first_triangle[m] as usize);
    &geometry.triangles[from..to]
}

/// Of the piece that a triangle belongs to.
fn number(scene: &SearchScene, triangle: &[u32; 3]) -> u32 {
    scene.pieces().number(triangle[0])
}

/// A crowd is one body; of other meshes each piece is one, if it is special or curved.
fn bodies_of(scene: &SearchScene, mesh: usize, is_crowd: bool, detail_rad: f64) -> Vec<Body> {
    let triangles = triangles_of(scene, mesh);
    if is_crowd {
        return body(scene, triangles).into_iter().collect();
    }
    let view = scene.view;
    let is_special = view.materials.is_special(view.scene.meshes[mesh].material);
    if !is_special && detail_rad <= CURVED_RAD {
        return Vec::new();
    }
    let mut of_piece: BTreeMap<u32, Vec<[u32; 3]>> = BTreeMap::new();
    for triangle in triangles {
        let piece = of_piece.entry(number(scene, triangle));
        piece.or_default().push(*triangle);
    }
    let pieces = of_piece.values();
    pieces.filter_map(|piece| body(scene, piece)).collect()
}

/// What these triangles make up, as some of them tell.
fn body(scene: &SearchScene, triangles: &[[u32; 3]]) -> Option<Body> {
    let geometry = scene.view.geometry;
    let step = triangles.len().div_ceil(MOST_TRIANGLES);
    let triangles: Vec<[u32; 3]> = triangles.iter().copied().step_by(step).collect();
    let position = |v: u32| geometry.positions[v as usize].as_dvec3();
    // Files have vertices of no triangle, too.
    let mut vertices = triangles.as_flattened().to_vec();
    vertices.sort_unstable();
    vertices.dedup();
    let corners = vertices.iter().map(|&v| position(v));
    let low = corners.clone().reduce(DVec3::min)?;
    let high = corners.clone().reduce(DVec3::max)?;
    let centre = low.midpoint(high);
    let radius = corners.map(|p| p.distance(centre)).fold(0.0, f64::max);
    let is_far = |triangle: &[u32; 3]| {
        let middle = triangle.map(position).iter().sum::<DVec3>() / 3.0;
        middle.distance(centre) > BALL * radius
    };
    let is_ball = triangles.iter().all(is_far);
    let moves = vertices.iter().any(|&v| scene.moving.vertex(geometry, v));
    Body::new(vertices, position, (centre, radius), [moves, is_ball])
}

/// By how much the normals of a mesh turn over half the diagonal of its box, in the mean over its
/// surface.
fn detail_rad(scene: &SearchScene, mesh: usize) -> f64 {
    let geometry = scene.view.geometry;
    let triangles = geometry.first_triangle[mesh]..geometry.first_triangle[mesh + 1];
    let turn_times_area = if geometry.smooth[mesh] {
        shading_turn
    } else {
        facets_turn
    };
    let [mut area, mut turn] = [0.0f64; 2];
    for triangle in triangles {
        let [p, q, r] = corners(geometry, triangle);
        let own = 0.5 * (q - p).cross(r - p).length();
        let turned = turn_times_area(scene, triangle, own);
        if turned.is_finite() {
            area += own;
            turn += turned;
        }
    }
    half_diagonal(geometry, mesh) * turn / area.max(f64::MIN_POSITIVE)
}

fn corners(geometry: &Geometry, triangle: u32) -> [DVec3; 3] {
    geometry.triangles[triangle as usize].map(|v| geometry.positions[v as usize].as_dvec3())
}

/// What shading normals turn by over a length, times the triangle's area.
fn shading_turn(scene: &SearchScene, triangle: u32, area: f64) -> f64 {
    let geometry = scene.view.geometry;
    let p = corners(geometry, triangle);
    let ids = geometry.triangles[triangle as usize];
    let n = ids.map(|v| geometry.normals[v as usize].as_dvec3());
    let along = |i: usize| n[i].distance(n[(i + 1) % 3]) / p[i].distance(p[(i + 1) % 3]);
    area * (0..3).map(along).sum::<f64>() / 3.0
}

/// The same of facets, which turn at their edges: the mean curvature's integral is half of an
/// edge's angle times its length, and either triangle has half of that. Where they turn by more at
/// once a shape is not curved but has edges.
fn facets_turn(scene: &SearchScene, triangle: u32, _: f64) -> f64 {
    let geometry = scene.view.geometry;
    let p = corners(geometry, triangle);
    let normal = |[a, b, c]: [DVec3; 3]| (b - a).cross(c - a).normalize();
    let bend = |corner: usize| {
        let across = scene.adjacency.across(triangle, corner)?;
        let side = if across.flipped { -1.0 } else { 1.0 };
        let cos = side * normal(p).dot(normal(corners(geometry, across.triangle)));
        let angle = cos.clamp(-1.0, 1.0).acos();
        (angle < MOST_BEND_RAD).then(|| angle * p[corner].distance(p[(corner + 1) % 3]))
    };
    0.25 * (0..3).filter_map(bend).sum::<f64>()
}

/// Of a mesh's box.
fn half_diagonal(geometry: &Geometry, mesh: usize) -> f64 {
    let vertices = geometry.first_vertex[mesh] as usize..geometry.first_vertex[mesh + 1] as usize;
    let all = geometry.positions[vertices].iter().copied();
    let low = all.clone().reduce(|a, b| a.min(b));
    let high = all.reduce(|a, b| a.max(b));
    low.zip(high)
        .map_or(0.0, |(low, high)| 0.5 * f64::from(low.distance(high)))
}
