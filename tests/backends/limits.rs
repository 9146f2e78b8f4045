//! Rays and triangles at the limits: both backends must mean the same.

use super::{ask, backends, build};
use glam::Vec3;
use warpath::trace::{Backend, MISS, Rays};

/// The square from −1 to 1 at height z, as two triangles.
fn square(z: f32) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    let positions = corners.map(|(x, y)| Vec3::new(x, y, z)).to_vec();
    (positions, vec![[0, 1, 2], [0, 2, 3]])
}

#[test]
fn distances_reach_from_beyond_tnear_up_to_tfar() {
    let (positions, triangles) = square(2.0);
    for backend in backends() {
        let accel = build(backend, &positions, &triangles);
        let mut rays = Rays::<8>::default();
        // Embree's distances are rounded by a unit in the last place; obvhs's are exact here, to
        // the very end.
        let off = match backend {
            Backend::Embree(..) => 1e-6,
            Backend::Obvhs(..) => 0.0,
        };
        let ends = [
            (0.0, 2.0 + off, true),
            (2.0 + off, 3.0, false),
            (0.0, 1.999_999, false),
            (1.999_999, 2.0 + off, true),
            (2.0 + off, 2.0 + off, false),
            (0.0, 0.0, false),
            (3.0, f32::INFINITY, false),
            (0.0, f32::INFINITY, true),
        ];
        for (lane, (near, far, _)) in ends.into_iter().enumerate() {
            rays.set(lane, Vec3::new(0.3, 0.1, 0.0), Vec3::Z, near, far);
        }
        let hits = ask(&accel, &rays);
        for (lane, (near, far, met)) in ends.into_iter().enumerate() {
            assert_eq!(hits.mesh[lane] != MISS, met, "{backend}: {near} to {far}");
        }
        // A direction of twice the length, of half the distance.
        rays.set(0, Vec3::new(0.3, 0.1, 0.0), 2.0 * Vec3::Z, 0.0, 1.0 + off);
        let hits = ask(&accel, &rays);
        assert!(
            (hits.t[0] - 1.0).abs() <= off && hits.triangle[0] == 0,
            "{backend}"
        );
        // (0.3, 0.1) = (−1, −1) + u·(2, 0) + v·(2, 2).
        assert!(
            (hits.u[0] - 0.1).abs() < 1e-6 && (hits.v[0] - 0.55).abs() < 1e-6,
            "{backend}"
        );
    }
}

#[test]
fn directions_may_have_zeros_and_boxes_no_thickness() {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    // The six sides of a cube, each flat along an axis.
    for axis in 0..3 {
        for side in [-1.0, 1.0] {
            let (corners, faces) = square(side);
            let base = positions.len() as u32;
            let turn = |p: Vec3| {
                let p = p.to_array();
                Vec3::from(std::array::from_fn(|i| p[(i + 3 - axis) % 3]))
            };
            positions.extend(corners.into_iter().map(turn));
            triangles.extend(faces.into_iter().map(|t| t.map(|v| v + base)));
        }
    }
    for backend in backends() {
        let accel = build(backend, &positions, &triangles);
        for (axis, sign) in (0..3).flat_map(|axis| [(axis, 1.0), (axis, -1.0)]) {
            let mut direction = [0.0, -0.0, 0.0];
            direction[axis] = sign;
            let mut rays = Rays::<8>::default();
            for lane in 0..8 {
                // Along the axis through the middle, through edges of boxes, and at the diagonals.
                let off = [0.0, 0.25, -0.5, 0.999][lane % 4];
                let origin = if lane < 4 {
                    Vec3::ZERO
                } else {
                    Vec3::from(direction) * -3.0
                };
                let mut origin = origin.to_array();
                origin[(axis + 1) % 3] += off;
                origin[(axis + 2) % 3] += off;
                rays.set(lane, origin.into(), direction.into(), 0.0, f32::INFINITY);
            }
            let hits = ask(&accel, &rays);
            for lane in 0..8 {
                let want = if lane < 4 { 1.0 } else { 2.0 };
                let off = (hits.t[lane] - want).abs();
                assert!(off < 1e-6, "{backend}, axis {axis}, lane {lane}: {off}");
            }
            // In the plane of a side, beside everything, and without direction.
            rays.set(0, Vec3::splat(1.5), direction.into(), 0.0, f32::INFINITY);
            rays.set(1, Vec3::ZERO, Vec3::ZERO, 0.0, f32::INFINITY);
            let hits = ask(&accel, &rays);
            assert_eq!(hits.mesh[..2], [MISS, MISS], "{backend}");
        }
    }
}

#[test]
fn triangles_without_area_and_beyond_all_bounds_are_never_met() {
    let (mut positions, mut triangles) = square(2.0);
    positions.extend([
        Vec3::ZERO,
        Vec3::Z,
        2.0 * Vec3::Z,
        Vec3::splat(3e18),
        Vec3::splat(1e38),
    ]);
    // A point, two lines, and one that reaches too far to compute with.
    triangles.extend([[4, 4, 4], [4, 5, 6], [4, 6, 6], [4, 7, 8]]);
    for backend in backends() {
        let mut accel = build(backend, &positions, &triangles);
        let mut rays = Rays::<8>::default();
        for lane in 0..8 {
            let aside = 0.01 * lane as f32;
            rays.set(
                lane,
                Vec3::new(aside, 0.5 * aside, 0.0),
                Vec3::Z,
                0.0,
                f32::INFINITY,
            );
        }
        let view = [warpath::trace::MeshView {
            positions: &positions,
            triangles: &triangles,
        }];
        for round in 0..2 {
            let hits = ask(&accel, &rays);
            let near = hits.t.iter().all(|t| (t - 2.0).abs() < 1e-6);
            assert!(near, "{backend}, round {round}: {:?}", hits.t);
            assert!(
                hits.triangle.iter().all(|t| *t < 2),
                "{backend}, round {round}"
            );
            accel.refit(&view).expect("the same mesh");
        }
    }
}
