//! Hits against Möller–Trumbore over every triangle, in f64.

use super::{BOTH, every_way, random_rays, views};
use crate::trace::{Accel, Hits, MISS, all_lanes};
use common::shapes::*;
use glam::{DVec3, Vec3};

/// What brute force in f64 finds, and whether rounding to f32 could change it.
struct Truth {
    t: f64,
    u: f64,
    v: f64,
    mesh: u32,
    triangle: u32,
    certain: bool,
}

fn brute_force(shapes: &[Shape], origin: Vec3, direction: Vec3, tnear: f32, tfar: f32) -> Truth {
    let (o, d) = (origin.as_dvec3(), direction.as_dvec3());
    let mut best = Truth {
        t: f64::INFINITY,
        u: 0.0,
        v: 0.0,
        mesh: MISS,
        triangle: MISS,
        certain: true,
    };
    let mut doubtful = f64::INFINITY;
    for (mesh, (positions, triangles)) in shapes.iter().enumerate() {
        for (triangle, corners) in triangles.iter().enumerate() {
            let [a, b, c] = corners.map(|i| positions[i as usize].as_dvec3());
            let (e1, e2): (DVec3, DVec3) = (b - a, c - a);
            let p = d.cross(e2);
            let det = e1.dot(p);
            let s = o - a;
            let q = s.cross(e1);
            let (u, v, t) = (s.dot(p) / det, d.dot(q) / det, e2.dot(q) / det);
            let margin = u.min(v).min(1.0 - u - v);
            let flat = det.abs() < 1e-3 * e1.length() * e2.length() * d.length();
            let at_end = (t - f64::from(tnear)).abs() < 1e-4 || (t - f64::from(tfar)).abs() < 1e-4;
            if t > f64::from(tnear) - 1e-3 && margin > -1e-3 && (margin < 1e-3 || flat || at_end) {
                doubtful = doubtful.min(t);
            }
            if margin >= 0.0 && t >= f64::from(tnear) && t <= f64::from(tfar) {
                if (t - best.t).abs() < 1e-4 {
                    doubtful = doubtful.min(t);
                }
                if t < best.t {
                    let (mesh, triangle) = (mesh as u32, triangle as u32);
                    best = Truth {
                        t,
                        u,
                        v,
                        mesh,
                        triangle,
                        certain: true,
                    };
                }
            }
        }
    }
    best.certain = doubtful == f64::INFINITY || doubtful > best.t + 1e-3;
    best
}

fn agrees_with_brute_force<const N: usize>() {
    let mut random = Random::new(N as u64);
    let shapes = [
        soup(&mut random, 150, 0.3),
        (vec![], vec![]),
        soup(&mut random, 60, 0.5),
    ];
    for options in every_way() {
        let accel = Accel::build(&views(&shapes), options).unwrap();
        let (mut hit, mut certain) = (0, 0);
        for packet in 0..64 {
            let rays = random_rays::<N>(&mut random, packet % 2 == 0);
            for coherence in BOTH {
                let mut hits = Hits::default();
                accel.intersect(&rays, all_lanes::<N>(), &mut hits, coherence);
                let blocked = accel.occluded(&rays, all_lanes::<N>(), coherence);
                for i in 0..N {
                    let truth = brute_force(
                        &shapes,
                        rays.origin(i),
                        rays.direction(i),
                        rays.tnear[i],
                        rays.tfar[i],
                    );
                    assert_eq!(
                        blocked >> i & 1 == 1,
                        hits.mesh[i] != MISS,
                        "occlusion, {options:?}"
                    );
                    if !truth.certain {
                        continue;
                    }
                    certain += 1;
                    assert_eq!(
                        (hits.mesh[i], hits.triangle[i]),
                        (truth.mesh, truth.triangle),
                        "{options:?}"
                    );
                    if truth.mesh == MISS {
                        assert_eq!((hits.t[i], hits.u[i], hits.v[i]), (f32::INFINITY, 0.0, 0.0));
                        continue;
                    }
                    hit += 1;
                    let far = |a: f32, b: f64| (f64::from(a) - b).abs();
                    assert!(far(hits.t[i], truth.t) < 1e-4, "{} {}", hits.t[i], truth.t);
                    assert!(far(hits.u[i], truth.u) < 1e-3 && far(hits.v[i], truth.v) < 1e-3);
                }
            }
        }
        assert!(certain > 90 * N, "too few certain rays: {certain}");
        assert!(hit > 10 * N, "too few hits: {hit}");
    }
}

#[test]
fn one_ray_agrees_with_brute_force() {
    agrees_with_brute_force::<1>();
}
#[test]
fn packets_of_4_agree_with_brute_force() {
    agrees_with_brute_force::<4>();
}
#[test]
fn packets_of_8_agree_with_brute_force() {
    agrees_with_brute_force::<8>();
}
#[test]
fn packets_of_16_agree_with_brute_force() {
    agrees_with_brute_force::<16>();
}
