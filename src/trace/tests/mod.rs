use super::*;
use common::shapes::{Random, Shape, icosphere};
use glam::Vec3;

mod brute_force;
mod building;
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
