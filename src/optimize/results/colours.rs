//! Textures compared with those of a scene that is known, at the same places of the surface: where
//! vertices slide over it and the texture slides with them, no picture tells.

use super::geometry::{Point, points};
use crate::optimize::problem::Problem;
use crate::paths::surface::texture::lookup;
use crate::scene::parameters::{self, Target};
use crate::scene::{Mesh, Scene, Texture};
use glam::{DVec3, Vec2};
use serde::Serialize;

/// How far the colours of a surface are from the known ones.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ColourDistance {
    pub mesh: String,
    pub key: String,
    /// Root mean squares over the known surface, of the differences between what a texture is there
    /// and what it is at the nearest point: at the start, and now.
    pub start: f64,
    pub end: f64,
}

/// Of every texture that is optimised on a mesh whose vertices are.
pub fn all(problem: &Problem, now: &Scene) -> Vec<ColourDistance> {
    let Some(truth) = &problem.truth else {
        return Vec::new();
    };
    let meshes = problem.variables.iter().filter_map(|v| v.mesh());
    let mut found = Vec::new();
    for m in meshes {
        for variable in &problem.variables {
            let key = &variable.parameter.key;
            let Some(Target::Texels(t)) = variable.parameter.target else {
                continue;
            };
            let id = &now.meshes[m].id;
            let Ok(Some(Target::Texels(wanted))) =
                parameters::find(truth, key).map(|parameter| parameter.target)
            else {
                continue;
            };
            let Some(known) = truth.meshes.iter().find(|mesh| mesh.id == *id) else {
                continue;
            };
            let picture = &truth.textures[wanted];
            let is_constant = picture.texels.len() == 1;
            if is_constant || known.uvs.is_empty() || !has(now, now.meshes[m].material, t) {
                continue;
            }
            let known = (known, picture);
            let of = |scene: &Scene| distance(known, (&scene.meshes[m], &scene.textures[t]));
            found.push(ColourDistance {
                mesh: id.clone(),
                key: key.clone(),
                start: of(&problem.start),
                end: of(now),
            });
        }
    }
    found
}

/// Whether a material, or one that it is made of, has a texture.
fn has(scene: &Scene, material: usize, texture: usize) -> bool {
    let bsdf = &scene.materials[material].bsdf;
    bsdf.slots().iter().any(|(_, t)| *t == texture)
        || bsdf.nested().iter().any(|(_, m)| has(scene, *m, texture))
}

fn distance(known: (&Mesh, &Texture), found: (&Mesh, &Texture)) -> f64 {
    let all = points(known.0);
    let mut sum = 0.0;
    for point in &all {
        let (triangle, weights) = nearest(found.0, point);
        let a = lookup(known.1, uv(known.0, point.triangle, point.weights)).value;
        let b = lookup(found.1, uv(found.0, triangle, weights)).value;
        sum += f64::from((a - b).length_squared()) / 3.0;
    }
    (sum / all.len().max(1) as f64).sqrt()
}

fn uv(mesh: &Mesh, triangle: usize, weights: DVec3) -> Vec2 {
    let [a, b, c] = mesh.triangles[triangle].map(|i| mesh.uvs[i as usize]);
    let w = weights.as_vec3();
    a * w.x + b * w.y + c * w.z
}

/// The triangle nearest to a point, and what its nearest place mixes the corners by.
fn nearest(mesh: &Mesh, point: &Point) -> (usize, DVec3) {
    let mut best = (f64::INFINITY, 0, DVec3::X);
    for (number, triangle) in mesh.triangles.iter().enumerate() {
        let corners = triangle.map(|i| mesh.positions[i as usize].as_dvec3());
        let weights = nearest_weights(corners, point.position);
        let [a, b, c] = corners;
        let place = a * weights.x + b * weights.y + c * weights.z;
        let squared = place.distance_squared(point.position);
        if squared < best.0 {
            best = (squared, number, weights);
        }
    }
    (best.1, best.2)
}

/// Barycentric coordinates of the point of a triangle that is nearest to p.
fn nearest_weights([a, b, c]: [DVec3; 3], p: DVec3) -> DVec3 {
    let normal = (b - a).cross(c - a);
    let area = normal.length_squared();
    if area > 0.0 {
        let of = |q: DVec3, r: DVec3| (q - p).cross(r - p).dot(normal) / area;
        let inside = DVec3::new(of(b, c), of(c, a), of(a, b));
        if inside.min_element() >= 0.0 {
            return inside;
        }
    }
    let on_edge = |q: DVec3, r: DVec3| {
        let along = r - q;
        let length = along.length_squared();
        let t = if length > 0.0 {
            ((p - q).dot(along) / length).clamp(0.0, 1.0)
        } else {
            0.0
        };
        (t, (q + t * along).distance_squared(p))
    };
    let edges = [on_edge(a, b), on_edge(b, c), on_edge(c, a)];
    let mixed = |i: usize| {
        let mut weights = [0.0; 3];
        weights[i] = 1.0 - edges[i].0;
        weights[(i + 1) % 3] = edges[i].0;
        DVec3::from(weights)
    };
    let order = |i: &usize, j: &usize| edges[*i].1.total_cmp(&edges[*j].1);
    mixed((0..3).min_by(order).unwrap_or(0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{Layout, Wrap};
    use glam::{Affine2, Vec3};

    #[test]
    fn the_nearest_place_of_a_triangle() {
        let triangle = [DVec3::ZERO, DVec3::X, DVec3::Y];
        for (p, weights) in [
            ([0.25, 0.25, 3.0], [0.5, 0.25, 0.25]),
            ([-1.0, -1.0, 0.0], [1.0, 0.0, 0.0]),
            ([0.4, -2.0, 0.0], [0.6, 0.4, 0.0]),
            ([1.0, 1.0, 0.5], [0.0, 0.5, 0.5]),
            ([-3.0, 0.5, 0.0], [0.5, 0.0, 0.5]),
        ] {
            let found = nearest_weights(triangle, DVec3::from(p));
            assert!((found - DVec3::from(weights)).length() < 1e-12, "{found}");
        }
    }

    /// A plate whose coordinates and texture are both turned around has the same colours.
    #[test]
    fn a_texture_that_slid_with_its_vertices_is_the_same() {
        let plate = |flip: bool| {
            let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
            Mesh {
                positions: corners.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec(),
                triangles: vec![[0, 1, 2], [0, 2, 3]],
                uvs: corners
                    .map(|[x, y]| Vec2::new(if flip { 1.0 - x } else { x }, y))
                    .to_vec(),
                ..Mesh::default()
            }
        };
        let picture = |left: f32, right: f32| Texture {
            key: String::new(),
            texels: vec![[left; 3], [right; 3]],
            layout: Layout::Bitmap {
                width: 2,
                height: 1,
                wrap: Wrap::Clamp,
                bilinear: true,
                to_uv: Affine2::IDENTITY,
            },
            channels: 3,
            limits: [0.0, 1.0],
        };
        let known = (&plate(false), &picture(0.2, 0.8));
        let same = distance(known, (&plate(true), &picture(0.8, 0.2)));
        let other = distance(known, (&plate(true), &picture(0.2, 0.8)));
        assert!(same < 1e-6 && other > 0.3, "{same} {other}");
    }
}
