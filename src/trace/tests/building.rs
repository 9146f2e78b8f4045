//! Building and refitting, and what they refuse.

use super::{every_backend, every_way, random_rays, views};
use crate::trace::{Accel, AccelOptions, Coherence, Hits, MeshView, Rays, TraceError, all_lanes};
use common::shapes::{Random, Shape, icosphere, soup};
use glam::Vec3;

#[test]
fn refit_moves_hits_and_agrees_with_a_new_build() {
    let mut random = Random::new(11);
    let mut shapes = [
        soup(&mut random, 200, 0.3),
        (vec![], vec![]),
        icosphere(2, Vec3::ZERO, 0.4),
    ];
    for options in every_way() {
        let mut accel = Accel::build(&views(&shapes), options).unwrap();
        for step in 0..4 {
            let shift = 0.3 * random.cube();
            shapes[0].0.iter_mut().for_each(|p| *p += shift);
            shapes[2].0.iter_mut().for_each(|p| *p *= 1.1);
            accel.refit(&views(&shapes)).unwrap();
            let fresh = Accel::build(&views(&shapes), options).unwrap();
            for _ in 0..50 {
                let rays = random_rays::<16>(&mut random, true);
                let (mut a, mut b) = (Hits::default(), Hits::default());
                accel.intersect(&rays, all_lanes::<16>(), &mut a, Coherence::Coherent);
                fresh.intersect(&rays, all_lanes::<16>(), &mut b, Coherence::Coherent);
                assert_eq!(a, b, "step {step}, {options:?}");
            }
        }
    }
}

#[test]
fn refit_refuses_another_topology() {
    let sphere = [icosphere(1, Vec3::ZERO, 1.0)];
    let finer = [icosphere(2, Vec3::ZERO, 1.0)];
    for options in every_backend() {
        let mut accel = Accel::build(&views(&sphere), options).unwrap();
        assert!(matches!(
            accel.refit(&views(&finer)),
            Err(TraceError::Topology(_))
        ));
        assert!(matches!(accel.refit(&[]), Err(TraceError::Topology(_))));
    }
}

#[test]
#[cfg(feature = "embree")]
fn want_of_memory_is_an_error() {
    let options = AccelOptions {
        memory_limit: 10_000,
        ..AccelOptions::default()
    };
    let error = Accel::build(&views(&[icosphere(3, Vec3::ZERO, 1.0)]), options).unwrap_err();
    assert!(matches!(error, TraceError::OutOfMemory(_)), "{error}");
}

#[test]
fn bad_meshes_are_errors() {
    let (mut positions, triangles) = icosphere(3, Vec3::ZERO, 1.0);
    let view = MeshView {
        positions: &positions,
        triangles: &triangles,
    };
    let short = MeshView {
        positions: &positions[..100],
        triangles: &triangles,
    };
    let error = Accel::build(&[view, short], AccelOptions::default()).unwrap_err();
    assert!(
        matches!(
            error,
            TraceError::Index {
                mesh: 1,
                vertices: 100,
                ..
            }
        ),
        "{error}"
    );
    positions[7].y = f32::NAN;
    let view = MeshView {
        positions: &positions,
        triangles: &triangles,
    };
    let error = Accel::build(&[view], AccelOptions::default()).unwrap_err();
    assert_eq!(error, TraceError::NonFinite { mesh: 0, vertex: 7 });
}

#[test]
fn build_threads_do_not_change_hits() {
    let mut random = Random::new(17);
    let shapes = [icosphere(6, Vec3::ZERO, 1.0), soup(&mut random, 5000, 0.05)];
    for options in every_backend() {
        let build =
            |threads| Accel::build(&views(&shapes), AccelOptions { threads, ..options }).unwrap();
        same_hits(&[build(1), build(2), build(2), build(0)], &shapes[0]);
    }
}

fn same_hits(accels: &[Accel; 4], (positions, triangles): &Shape) {
    let mut random = Random::new(18);
    for chunk in triangles.chunks_exact(16) {
        // Half of the rays go through edges and vertices, where two triangles are equally near.
        let mut rays = Rays::<16>::default();
        for (lane, corners) in chunk.iter().enumerate() {
            let [a, b, c] = corners.map(|i| positions[i as usize]);
            let aim = [a, (a + b) / 2.0, (a + b + c) / 3.0, random.direction()][lane % 4];
            rays.set(
                lane,
                2.0 * aim + 0.1 * (lane % 2) as f32 * random.cube(),
                -aim,
                0.0,
                f32::INFINITY,
            );
        }
        let hits = accels.each_ref().map(|accel| {
            let mut hits = Hits::default();
            accel.intersect(&rays, all_lanes::<16>(), &mut hits, Coherence::Incoherent);
            hits
        });
        assert!(hits.iter().all(|h| *h == hits[0]));
    }
}

#[test]
fn versions_and_widths_are_known() {
    for options in every_backend() {
        let accel = Accel::build(&views(&[icosphere(1, Vec3::ZERO, 1.0)]), options).unwrap();
        let version = accel.library_version();
        assert_eq!(
            version
                .split('.')
                .filter_map(|n| n.parse::<u32>().ok())
                .count(),
            3
        );
        assert!(matches!(accel.native_width(), 1 | 4 | 8 | 16));
        assert!(accel.memory_bytes() > 80 * 36 && accel.memory_bytes() < 1 << 20);
        assert_eq!(accel.backend(), options.backend);
    }
}
