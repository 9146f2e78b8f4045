//! Smooth vertex normals from positions: the triangles' unit normals, weighted by their angles.

use glam::{DVec3, Vec3};

/// The normal of a vertex that no triangle with an area uses, or whose triangles cancel out.
pub const FALLBACK_NORMAL: Vec3 = Vec3::X;

/// Unit normals, one a vertex: Σ over the triangles at the vertex of (angle at the vertex) · (unit
/// normal), normalised, as Mitsuba computes them (Thürmer & Wüthrich 1998). Sums are in double
/// precision and in the order of the triangles. Indices must be in range.
pub fn vertex_normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; positions.len()];
    for triangle in triangles {
        let corners = triangle.map(|i| positions[i as usize].as_dvec3());
        let cross = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let Some(normal) = cross.try_normalize() else {
            continue;
        };
        for k in 0..3 {
            let a = corners[(k + 1) % 3] - corners[k];
            let b = corners[(k + 2) % 3] - corners[k];
            // The cross product has the same length at every corner: twice the area.
            let angle_rad = cross.length().atan2(a.dot(b));
            sums[triangle[k] as usize] += normal * angle_rad;
        }
    }
    let unit = |sum: &DVec3| sum.try_normalize().map_or(FALLBACK_NORMAL, |n| n.as_vec3());
    sums.iter().map(unit).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cube_corner_points_along_the_diagonal_however_its_sides_are_split() {
        // Three sides of a cube meet at the origin; one is split in two triangles there.
        let positions = [
            Vec3::ZERO,
            Vec3::X,
            Vec3::Y,
            Vec3::Z,
            Vec3::new(1.0, 1.0, 0.0),
            Vec3::splat(9.0),
        ];
        let triangles = [[0, 4, 1], [0, 2, 4], [0, 3, 2], [0, 1, 3]];
        let normals = vertex_normals(&positions, &triangles);
        let expected = -Vec3::ONE.normalize();
        assert!((normals[0] - expected).length() < 1e-6, "{}", normals[0]);
        assert_eq!(normals[5], FALLBACK_NORMAL);
    }
}
