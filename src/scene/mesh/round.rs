//! Round shapes with edges: the disk and the cylinder.

use super::RawMesh;
use glam::{DVec2, Vec2, Vec3};
use std::f64::consts::TAU;

/// Sectors of a disk or a cylinder: its area is by 10⁻⁴ too small.
pub(in crate::scene) const SECTORS: u32 = 256;

/// A point of the unit circle after so many sectors; the last is the first, to the bit.
fn on_circle(sector: u32) -> DVec2 {
    DVec2::from_angle(TAU * f64::from(sector % SECTORS) / f64::from(SECTORS))
}

/// The unit disk in the plane z = 0, facing +z. Texture coordinates as in Mitsuba: u the distance
/// from the middle, v the angle from +x over its full turn.
pub(in crate::scene) fn disk() -> RawMesh {
    let mut mesh = RawMesh::default();
    let mut uvs = Vec::new();
    let part = |sector: f64| (sector / f64::from(SECTORS)) as f32;
    for sector in 0..SECTORS {
        // Each sector has a middle of its own, whose angle is half-way between its two others'.
        let first = mesh.positions.len() as u32;
        mesh.triangles.push([first, first + 1, first + 2]);
        mesh.positions.push(Vec3::ZERO);
        uvs.push(Vec2::new(0.0, part(f64::from(sector) + 0.5)));
        for at in [sector, sector + 1] {
            mesh.positions.push(on_circle(at).as_vec2().extend(0.0));
            uvs.push(Vec2::new(1.0, part(f64::from(at))));
        }
    }
    mesh.uvs = Some(uvs);
    mesh
}

/// The cylinder of radius 1 about the z axis from 0 to 1, open at its ends, facing outwards.
/// Texture coordinates as in Mitsuba: u the angle from +x over its full turn, v along the axis. Its
/// normals are exact.
pub(in crate::scene) fn cylinder() -> RawMesh {
    let mut mesh = RawMesh::default();
    let mut uvs = Vec::new();
    let mut normals = Vec::new();
    for sector in 0..=SECTORS {
        let side = on_circle(sector).as_vec2();
        for z in [0.0, 1.0] {
            mesh.positions.push(side.extend(z));
            normals.push(side.extend(0.0));
            uvs.push(Vec2::new(
                (f64::from(sector) / f64::from(SECTORS)) as f32,
                z,
            ));
        }
    }
    for first in (0..SECTORS).map(|sector| 2 * sector) {
        let corners = [first, first + 2, first + 3, first + 1];
        mesh.triangles.extend(super::fan(&corners));
    }
    mesh.normals = Some(normals);
    mesh.uvs = Some(uvs);
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn areas_and_sides_are_right() {
        for (mesh, area) in [(disk(), 0.5 * TAU), (cylinder(), TAU)] {
            let mut sum = 0.0;
            for triangle in &mesh.triangles {
                let [a, b, c] = triangle.map(|i| mesh.positions[i as usize]);
                let normal = (b - a).cross(c - a);
                let outside = match &mesh.normals {
                    None => Vec3::Z,
                    Some(_) => (a + b + c) * Vec3::new(1.0, 1.0, 0.0),
                };
                assert!(normal.dot(outside) > 0.0);
                sum += 0.5 * f64::from(normal.length());
            }
            assert!((sum / area - 1.0).abs() < 1.1e-4, "{sum}, not {area}");
        }
    }
}
