use super::*;
use common::shapes::{Random, Shape, icosphere, soup};
use glam::Vec3;

mod brute_force;
mod edges;

const BOTH: [Coherence; 2] = [Coherence::Coherent, Coherence::Incoherent];

fn views(shapes: &[Shape]) -> Vec<MeshView<'_>> {
    shapes
        .iter()
        .map(|(positions, triangles)| MeshView {
            positions,
            triangles,
        })
        .collect()
}

/// Options for every way through the backends on this CPU: Embree's packets whole, split in native
/// parts, or singly; obvhs's trees at every preset.
fn every_way() -> Vec<AccelOptions> {
    let mut ways = Vec::new();
    for robust in [false, true] {
        for backend in Backend::built_in() {
            let options = AccelOptions::new(robust, 1).on(backend);
            if let Backend::Embree(..) = backend {
                ways.extend([0, 1, 4, 8, 16].map(|width| AccelOptions { width, ..options }));
            } else {
                ways.extend(backend.presets().into_iter().map(|b| options.on(b)));
            }
        }
    }
    ways
}

/// Robust options on every backend.
fn every_backend() -> impl Iterator<Item = AccelOptions> {
    let on = |backend| AccelOptions::default().on(backend);
    Backend::built_in().into_iter().map(on)
}

fn random_rays<const N: usize>(random: &mut Random, coherent: bool) -> Rays<N> {
    let mut rays = Rays::default();
    let (origin, axis) = (2.0 * random.cube(), random.direction());
    for lane in 0..N {
        if coherent {
            rays.set(
                lane,
                origin,
                axis + 0.05 * random.cube(),
                0.0,
                f32::INFINITY,
            );
        } else {
            let (tnear, length) = (0.3 * random.unit(), 2.0 * random.unit());
            let scale = 0.5 + random.unit();
            rays.set(
                lane,
                random.cube(),
                scale * random.direction(),
                tnear,
                tnear + length,
            );
        }
    }
    rays
}

#[test]
fn inactive_lanes_stay_untouched() {
    let mut random = Random::new(3);
    let shapes = [icosphere(2, Vec3::ZERO, 1.0)];
    for options in every_way() {
        let accel = Accel::build(&views(&shapes), options).unwrap();
        for _ in 0..64 {
            let mut rays = Rays::<16>::default();
            for lane in 0..16 {
                rays.set(lane, Vec3::ZERO, random.direction(), 0.0, f32::INFINITY);
            }
            let mut whole = Hits::default();
            accel.intersect(&rays, all_lanes::<16>(), &mut whole, Coherence::Incoherent);
            let active = random.bits() & random.bits() & 0xffff;
            let mark = Hits {
                t: [-7.0; 16],
                u: [8.0; 16],
                v: [9.0; 16],
                mesh: [5; 16],
                triangle: [6; 16],
            };
            let mut hits = mark;
            accel.intersect(&rays, active, &mut hits, Coherence::Incoherent);
            assert_eq!(accel.occluded(&rays, active, Coherence::Incoherent), active);
            for i in 0..16 {
                let from = if active >> i & 1 == 1 { &whole } else { &mark };
                assert_eq!(
                    (hits.t[i], hits.u[i], hits.v[i]),
                    (from.t[i], from.u[i], from.v[i])
                );
                assert_eq!(
                    (hits.mesh[i], hits.triangle[i]),
                    (from.mesh[i], from.triangle[i])
                );
            }
        }
    }
}

#[test]
fn unsound_rays_miss_and_disturb_no_other_lane() {
    for options in every_way() {
        unsound_rays_miss(
            &Accel::build(&views(&[icosphere(2, Vec3::ZERO, 1.0)]), options).unwrap(),
        );
    }
}

fn unsound_rays_miss(accel: &Accel) {
    let mut rays = Rays::<8>::default();
    for lane in 0..8 {
        rays.set(
            lane,
            Vec3::ZERO,
            Vec3::new(0.1, 0.2, 0.9),
            0.0,
            f32::INFINITY,
        );
    }
    rays.org_x[0] = f32::NAN;
    rays.dir_z[1] = f32::INFINITY;
    rays.tnear[2] = f32::NAN;
    rays.tfar[3] = f32::NAN;
    (rays.tnear[4], rays.tfar[4]) = (3.0, 2.0);
    rays.dir_y[5] = f32::NEG_INFINITY;
    // Embree asserts that nothing is larger than 1.844e18.
    rays.org_z[6] = -1.9e18;
    for coherence in BOTH {
        let mut hits = Hits {
            mesh: [3; 8],
            ..Hits::default()
        };
        accel.intersect(&rays, all_lanes::<8>(), &mut hits, coherence);
        assert_eq!(hits.mesh, [MISS, MISS, MISS, MISS, MISS, MISS, MISS, 0]);
        assert_eq!(
            accel.occluded(&rays, all_lanes::<8>(), coherence),
            0b1000_0000
        );
    }
}

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
fn empty_scenes_are_all_misses() {
    let nothing: [&[Shape]; 2] = [&[], &[(vec![], vec![]), (vec![Vec3::ZERO; 3], vec![])]];
    let ways = every_way();
    for (shapes, options) in nothing
        .into_iter()
        .flat_map(|s| ways.iter().map(move |w| (s, *w)))
    {
        let mut accel = Accel::build(&views(shapes), options).unwrap();
        accel.refit(&views(shapes)).unwrap();
        let rays = random_rays::<8>(&mut Random::new(1), true);
        let mut hits = Hits {
            mesh: [0; 8],
            ..Hits::default()
        };
        accel.intersect(&rays, all_lanes::<8>(), &mut hits, Coherence::Coherent);
        assert_eq!(hits, Hits::default());
        assert_eq!(
            accel.occluded(&rays, all_lanes::<8>(), Coherence::Coherent),
            0
        );
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
