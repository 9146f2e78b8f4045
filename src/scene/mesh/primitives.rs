//! Shapes that are formulas in Mitsuba and triangle meshes here.

use super::RawMesh;
use glam::{DVec3, Vec3};
use std::collections::HashMap;

/// Times that each triangle of the icosahedron is cut into four: 20·4⁵ = 20480 triangles.
pub(in crate::scene) const SPHERE_SUBDIVISIONS: u32 = 5;

/// The square (−1,−1,0)…(1,1,0), facing +z.
pub(in crate::scene) fn rectangle() -> RawMesh {
    let corner = |x, y| Vec3::new(x, y, 0.0);
    RawMesh {
        positions: vec![
            corner(-1.0, -1.0),
            corner(1.0, -1.0),
            corner(-1.0, 1.0),
            corner(1.0, 1.0),
        ],
        triangles: vec![[0, 1, 3], [0, 3, 2]],
        normals: None,
    }
}

/// The cube (−1,−1,−1)…(1,1,1). Its sides share their eight corners, so that edges have two triangles.
pub(in crate::scene) fn cube() -> RawMesh {
    let sign = |bit: u32| if bit == 0 { -1.0 } else { 1.0 };
    let corner = |i: u32| Vec3::new(sign(i & 1), sign(i & 2), sign(i & 4));
    let mut triangles = Vec::with_capacity(12);
    for axis in 0..3 {
        // The other two axes, in the order that makes a right-handed frame.
        let (u, v) = (1 << ((axis + 1) % 3), 1 << ((axis + 2) % 3));
        let low = [0, v, u + v, u];
        let high = [0, u, u + v, v].map(|i| i + (1 << axis));
        for side in [low, high] {
            triangles.extend(super::fan(&side));
        }
    }
    RawMesh {
        positions: (0..8).map(corner).collect(),
        triangles,
        normals: None,
    }
}

/// The unit sphere: an icosahedron whose triangles are cut in four, all vertices on the sphere.
pub(in crate::scene) fn sphere(subdivisions: u32) -> RawMesh {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    // The twelve corners are the cyclic permutations of (0, ±1, ±φ).
    let mut points: Vec<DVec3> = Vec::new();
    for axis in 0..3 {
        for (a, b) in [
            (-1.0, -golden),
            (1.0, -golden),
            (-1.0, golden),
            (1.0, golden),
        ] {
            let mut p = [0.0; 3];
            p[(axis + 1) % 3] = a;
            p[(axis + 2) % 3] = b;
            points.push(DVec3::from(p).normalize());
        }
    }
    let mut triangles = icosahedron_triangles(&points);
    for _ in 0..subdivisions {
        let mut middles: HashMap<(u32, u32), u32> = HashMap::new();
        let mut finer = Vec::with_capacity(triangles.len() * 4);
        for [a, b, c] in triangles {
            let mut middle = |i: u32, j: u32| {
                *middles.entry((i.min(j), i.max(j))).or_insert_with(|| {
                    points.push((points[i as usize] + points[j as usize]).normalize());
                    points.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    RawMesh {
        positions: points.iter().map(|p| p.as_vec3()).collect(),
        triangles,
        normals: None,
    }
}

/// All triples of corners that are neighbours of each other, turned outwards.
fn icosahedron_triangles(corners: &[DVec3]) -> Vec<[u32; 3]> {
    // Neighbours are 63.4° apart (cosine 1/√5), the next nearest 116.6°.
    let near = |i: usize, j: usize| corners[i].dot(corners[j]) > 0.3;
    let mut triangles = Vec::with_capacity(20);
    for i in 0..corners.len() {
        for j in i + 1..corners.len() {
            for k in j + 1..corners.len() {
                if near(i, j) && near(j, k) && near(k, i) {
                    let outside = corners[i].dot(corners[j].cross(corners[k])) > 0.0;
                    let (j, k) = if outside { (j, k) } else { (k, j) };
                    triangles.push([i as u32, j as u32, k as u32]);
                }
            }
        }
    }
    triangles
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Signed volume: positive if the triangles are counter-clockwise seen from outside.
    fn volume(mesh: &RawMesh) -> f64 {
        let corner = |i: u32| mesh.positions[i as usize].as_dvec3();
        let six: f64 = mesh
            .triangles
            .iter()
            .map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2]))))
            .sum();
        six / 6.0
    }

    #[test]
    fn closed_shapes_face_outwards() {
        assert!((volume(&cube()) - 8.0).abs() < 1e-6);
        let ball = sphere(4);
        assert_eq!(ball.triangles.len(), 20 * 256);
        assert_eq!(ball.positions.len(), 10 * 256 + 2);
        let exact = 4.0 / 3.0 * std::f64::consts::PI;
        assert!((volume(&ball) / exact - 1.0).abs() < 0.01);
    }
}
