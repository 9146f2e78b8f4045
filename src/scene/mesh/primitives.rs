//! Shapes that are formulas in Mitsuba and triangle meshes here.

use super::RawMesh;
use glam::{DVec3, Vec2, Vec3};
use std::collections::HashMap;

/// Times that each triangle of the icosahedron is cut into four: 20·4⁵ = 20480 triangles.
pub(in crate::scene) const SPHERE_SUBDIVISIONS: u32 = 5;

/// Rings of latitude of a sphere with texture coordinates; twice as many sectors: 20448 triangles.
pub(in crate::scene) const GLOBE_RINGS: u32 = 72;

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
        uvs: Some(
            [0, 1, 2, 3]
                .map(|i| Vec2::new((i & 1) as f32, (i >> 1) as f32))
                .to_vec(),
        ),
        ..RawMesh::default()
    }
}

/// The cube (−1,−1,−1)…(1,1,1). Its sides share their eight corners, so that edges have two
/// triangles.
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
        ..RawMesh::default()
    }
}

/// The cube with four corners a side, each side mapped onto the unit square as Mitsuba does.
pub(in crate::scene) fn cube_of_six_sides() -> RawMesh {
    let shared = cube();
    let mut mesh = RawMesh::default();
    let mut uvs = Vec::with_capacity(24);
    for side in shared.triangles.chunks_exact(2) {
        // A fan of two triangles: 0, 1, 2 and 0, 2, 3.
        let corners = [side[0][0], side[0][1], side[0][2], side[1][2]];
        let corners = corners.map(|i| shared.positions[i as usize]);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let first = mesh.positions.len() as u32;
        mesh.triangles
            .extend(super::fan(&[0, 1, 2, 3].map(|i| first + i)));
        mesh.positions.extend(corners);
        uvs.extend(corners.map(|p| (side_uv(p, normal) + 1.0) / 2.0));
    }
    mesh.uvs = Some(uvs);
    mesh
}

/// Mitsuba's axes on the side of the cube that faces along `normal`, from −1 to 1.
fn side_uv(p: Vec3, normal: Vec3) -> Vec2 {
    match normal.abs().max_position() {
        0 if normal.x > 0.0 => Vec2::new(p.y, -p.z),
        0 => Vec2::new(p.y, p.z),
        1 if normal.y > 0.0 => Vec2::new(-p.x, -p.z),
        1 => Vec2::new(p.z, p.x),
        _ if normal.z > 0.0 => Vec2::new(p.y, p.x),
        _ => Vec2::new(-p.y, p.x),
    }
}

/// The unit sphere by latitude and longitude with Mitsuba's texture coordinates: u the longitude
/// about z from +x over its full turn, v the angle from +z over half a turn. Split along u = 0, and
/// at the poles, where u has no value. Its normals are exact, so that the seam does not show.
pub(in crate::scene) fn globe(rings: u32) -> RawMesh {
    use std::f64::consts::{PI, TAU};
    let sectors = 2 * rings;
    let mut mesh = RawMesh::default();
    let mut uvs = Vec::new();
    for ring in 0..=rings {
        let v = f64::from(ring) / f64::from(rings);
        let is_pole = ring == 0 || ring == rings;
        for sector in 0..=sectors {
            // At the poles each triangle has a vertex of its own, half-way between the two others.
            let u = (f64::from(sector) + if is_pole { 0.5 } else { 0.0 }) / f64::from(sectors);
            // The last meridian is the first, to the bit.
            let longitude = TAU * f64::from(sector % sectors) / f64::from(sectors);
            let (sin, cos) = if is_pole {
                (0.0, 1.0 - 2.0 * v)
            } else {
                (v * PI).sin_cos()
            };
            let point = DVec3::new(sin * longitude.cos(), sin * longitude.sin(), cos);
            mesh.positions.push(point.as_vec3() + 0.0);
            uvs.push(Vec2::new(u as f32, v as f32));
        }
    }
    for ring in 0..rings {
        for sector in 0..sectors {
            let above = ring * (sectors + 1) + sector;
            let below = above + sectors + 1;
            if ring + 1 < rings {
                mesh.triangles.push([above, below, below + 1]);
            } else {
                mesh.triangles.push([above, below, above + 1]);
            }
            if ring > 0 && ring + 1 < rings {
                mesh.triangles.push([above, below + 1, above + 1]);
            }
        }
    }
    mesh.normals = Some(mesh.positions.clone());
    mesh.uvs = Some(uvs);
    mesh
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
        ..RawMesh::default()
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
    fn textured_shapes_are_the_same_and_hold_mitsubas_coordinates() {
        assert!((volume(&cube_of_six_sides()) - 8.0).abs() < 1e-6);
        let ball = globe(64);
        let exact = 4.0 / 3.0 * std::f64::consts::PI;
        assert!((volume(&ball) / exact - 1.0).abs() < 0.01);
        let uvs = ball.uvs.unwrap();
        for triangle in &ball.triangles {
            let u = triangle.map(|i| uvs[i as usize].x);
            let width = u.into_iter().fold(0.0, f32::max) - u.into_iter().fold(1.0, f32::min);
            assert!(width < 0.01, "a triangle crosses the seam: {u:?}");
            let [a, b, c] = triangle.map(|i| ball.positions[i as usize]);
            assert!((b - a).cross(c - a).length() > 0.0);
        }
        for (p, uv) in ball.positions.iter().zip(&uvs) {
            let (phi, theta) = (uv.x * std::f32::consts::TAU, uv.y * std::f32::consts::PI);
            let expected = Vec3::new(
                phi.cos() * theta.sin(),
                phi.sin() * theta.sin(),
                theta.cos(),
            );
            assert!((*p - expected).length() < 1e-5, "{p} {expected}");
        }
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
