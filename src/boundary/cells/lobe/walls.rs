//! The walls that directions over lobes follow (`paths::body_share`): the largest flat parts of
//! meshes.

use crate::boundary::search_scene::SearchScene;
use crate::paths::drift_body::Body;
use glam::DVec3;

/// What has more triangles is no wall, and neither are the flat parts of a mesh beyond so many.
const MOST_TRIANGLES: usize = 1 << 14;
const MOST_PARTS: usize = 16;
/// Up to this sine of an angle, and up to this part of their distance, triangles lie in one plane.
const FLAT: f64 = 1e-4;
/// A part that has less than this share of the largest one's area is no wall.
const LEAST_AREA: f64 = 0.25;
/// Parallel planes that are nearer to each other than this part of their radius are one wall: two
/// would carry directions twice as far.
const APART: f64 = 0.2;
const PARALLEL: f64 = 0.95;

/// Triangles in one plane.
struct Part {
    normal: DVec3,
    point: DVec3,
    area: f64,
    triangles: Vec<[u32; 3]>,
}

/// The walls among these meshes.
pub fn walls(scene: &SearchScene, meshes: impl Iterator<Item = usize>) -> Vec<Body> {
    let geometry = scene.view.geometry;
    let mut parts: Vec<Part> = meshes
        .flat_map(|mesh| {
            let [from, to] = [mesh, mesh + 1].map(|m| geometry.first_triangle[m] as usize);
            parts_of(scene, &geometry.triangles[from..to])
        })
        .collect();
    parts.sort_by(|a, b| b.area.total_cmp(&a.area));
    let largest = parts.first().map_or(0.0, |part| part.area);
    let mut walls: Vec<Body> = Vec::new();
    for part in parts {
        let Some(wall) = wall(scene, &part) else {
            continue;
        };
        let is_same = |other: &Body| {
            let normal = other.plane_normal().unwrap_or_default();
            let apart = normal.dot(wall.centre - other.centre).abs();
            normal.dot(part.normal).abs() > PARALLEL && apart < APART * other.radius
        };
        if part.area >= LEAST_AREA * largest && !walls.iter().any(is_same) {
            walls.push(wall);
        }
    }
    walls
}

/// The first flat parts of a mesh of few triangles.
fn parts_of(scene: &SearchScene, triangles: &[[u32; 3]]) -> Vec<Part> {
    let geometry = scene.view.geometry;
    let mut parts: Vec<Part> = Vec::new();
    if triangles.len() > MOST_TRIANGLES {
        return parts;
    }
    for triangle in triangles {
        let [p, q, r] = triangle.map(|v| geometry.positions[v as usize].as_dvec3());
        let across = (q - p).cross(r - p);
        let (normal, area) = (across.normalize_or_zero(), 0.5 * across.length());
        if area == 0.0 {
            continue;
        }
        let is_in_plane = |part: &Part| {
            let to = p - part.point;
            part.normal.cross(normal).length() < FLAT
                && part.normal.dot(to).abs() <= FLAT * to.length().max(area.sqrt())
        };
        match parts.iter().position(is_in_plane) {
            Some(number) => {
                parts[number].area += area;
                parts[number].triangles.push(*triangle);
            }
            None if parts.len() < MOST_PARTS => parts.push(Part {
                normal,
                point: p,
                area,
                triangles: vec![*triangle],
            }),
            None => {}
        }
    }
    parts
}

fn wall(scene: &SearchScene, part: &Part) -> Option<Body> {
    let geometry = scene.view.geometry;
    let position = |v: u32| geometry.positions[v as usize].as_dvec3();
    let mut vertices = part.triangles.as_flattened().to_vec();
    vertices.sort_unstable();
    vertices.dedup();
    let corners = vertices.iter().map(|&v| position(v));
    let centre = corners.clone().sum::<DVec3>() / vertices.len() as f64;
    let radius = corners.map(|p| p.distance(centre)).fold(0.0, f64::max);
    let moves = vertices.iter().any(|&v| scene.moving.vertex(geometry, v));
    let body = Body::new(vertices, position, (centre, radius), [moves, false])?;
    Some(body.as_wall(part.normal))
}
