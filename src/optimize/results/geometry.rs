//! How far a mesh is from the one of a scene that is known, whatever their triangles.

use crate::scene::Mesh;
use glam::DVec3;
use serde::Serialize;

/// Points on each mesh. They are as far apart as the square root of area over number, which is
/// what a distance of nothing comes to.
const POINTS: usize = 4000;

/// The distance between two surfaces.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Distance {
    pub mesh: String,
    /// The mean of both mean distances from points of one to the nearest triangle's plane of the
    /// other, in world units: at the start, and now.
    pub chamfer_start: f64,
    pub chamfer_end: f64,
    /// The mean angle between normals at nearest points, degrees.
    pub normal_error_start_deg: f64,
    pub normal_error_end_deg: f64,
}

/// Of one mesh at the start and now, against the known one.
pub fn distance(start: &Mesh, now: &Mesh, truth: &Mesh) -> Distance {
    let truth_points = points(truth);
    let of = |mesh: &Mesh| {
        let own = points(mesh);
        let (a, b) = (one_way(&own, &truth_points), one_way(&truth_points, &own));
        [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])]
    };
    let (before, after) = (of(start), of(now));
    Distance {
        mesh: now.id.clone(),
        chamfer_start: before[0],
        chamfer_end: after[0],
        normal_error_start_deg: before[1],
        normal_error_end_deg: after[1],
    }
}

/// A point of a surface with the unit normal there.
pub struct Point {
    pub position: DVec3,
    normal: DVec3,
    pub triangle: usize,
    /// What it mixes the triangle's corners by.
    pub weights: DVec3,
}

/// Points evenly over the surface: by area along the triangles, and within each by the additive
/// recurrence of the plastic number.
pub fn points(mesh: &Mesh) -> Vec<Point> {
    let corner = |i: u32| mesh.positions[i as usize].as_dvec3();
    let mut ends = Vec::with_capacity(mesh.triangles.len());
    let mut sum = 0.0;
    for t in &mesh.triangles {
        let [a, b, c] = t.map(corner);
        sum += (b - a).cross(c - a).length();
        ends.push(sum);
    }
    (0..POINTS)
        .map(|i| {
            let at = sum * (i as f64 + 0.5) / POINTS as f64;
            let triangle = ends.partition_point(|end| *end < at).min(ends.len() - 1);
            let [a, b, c] = mesh.triangles[triangle].map(corner);
            let [mut u, mut v] =
                [0.754_877_666, 0.569_840_291].map(|s| (0.5 + s * i as f64).fract());
            if u + v > 1.0 {
                (u, v) = (1.0 - u, 1.0 - v);
            }
            Point {
                position: a + u * (b - a) + v * (c - a),
                normal: (b - a).cross(c - a).normalize_or_zero(),
                triangle,
                weights: DVec3::new(1.0 - u - v, u, v),
            }
        })
        .collect()
}

/// Mean distance to the plane at the nearest point of `to`, and mean angle in degrees.
fn one_way(from: &[Point], to: &[Point]) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for point in from {
        let away = |other: &Point| other.position.distance_squared(point.position);
        let near = to.iter().min_by(|a, b| away(a).total_cmp(&away(b)));
        if let Some(near) = near {
            sums[0] += (point.position - near.position).dot(near.normal).abs();
            let cosine = point.normal.dot(near.normal).clamp(-1.0, 1.0);
            sums[1] += cosine.acos().to_degrees();
        }
    }
    sums.map(|sum| sum / from.len().max(1) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_plate_and_its_copies() {
        let plate = |z: f32, tilt: f32| Mesh {
            positions: vec![
                Vec3::new(0.0, 0.0, z),
                Vec3::new(1.0, 0.0, z + tilt),
                Vec3::new(1.0, 1.0, z + tilt),
                Vec3::new(0.0, 1.0, z),
            ],
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            ..Mesh::default()
        };
        let found = distance(&plate(0.25, 0.0), &plate(0.0, 1.0), &plate(0.0, 0.0));
        assert!((found.chamfer_start - 0.25).abs() < 1e-12);
        assert!(found.normal_error_start_deg < 1e-5);
        assert!((found.normal_error_end_deg - 45.0).abs() < 1e-5);
    }
}
