//! Rays at shared edges and vertices: what robust mode is for.

use super::{BOTH, every_backend, views};
use crate::trace::{Accel, AccelOptions, Backend, Coherence, Hits, MISS, Rays, all_lanes};
use common::shapes::*;
use glam::Vec3;

/// Rays from within a closed sphere at its vertices and at points of its edges: how many of each
/// there were and how many got out.
fn leaks(options: AccelOptions, coherence: Coherence) -> [(usize, usize); 2] {
    let mut random = Random::new(5);
    let shape = icosphere(4, Vec3::new(0.3, -0.2, 0.1), 1.0);
    let accel = Accel::build(&views(std::slice::from_ref(&shape)), options).unwrap();
    let (positions, triangles) = &shape;
    let mut counts = [(0, 0); 2];
    for round in 0..40 {
        let origin = Vec3::new(0.3, -0.2, 0.1) + 0.5 * random.cube();
        for chunk in triangles.chunks_exact(16) {
            let mut rays = Rays::<16>::default();
            for (lane, corners) in chunk.iter().enumerate() {
                let [a, b, _] = corners.map(|i| positions[i as usize]);
                let along = if round % 2 == 0 { 0.0 } else { random.unit() };
                rays.set(lane, origin, a.lerp(b, along) - origin, 0.0, f32::INFINITY);
            }
            let mut hits = Hits::default();
            accel.intersect(&rays, all_lanes::<16>(), &mut hits, coherence);
            let out = hits.mesh.iter().filter(|m| **m == MISS).count();
            let blocked = accel.occluded(&rays, all_lanes::<16>(), coherence);
            if options.robust {
                assert_eq!(out, blocked.count_zeros() as usize - 16);
            }
            counts[round % 2].0 += 16;
            counts[round % 2].1 += out;
        }
    }
    counts
}

#[test]
fn robust_mode_does_not_leak_through_edges() {
    for (options, coherence) in every_backend().flat_map(|o| BOTH.map(|c| (o, c))) {
        let [(rays, vertices), (_, edges)] = leaks(options, coherence);
        assert_eq!(edges, 0, "{options:?}");
        match options.backend {
            // Embree's robust test is not tight at a vertex that is hit to the last bit: 0.4 % get
            // out.
            Backend::Embree(..) => assert!(vertices < rays / 100, "{vertices} of {rays}"),
            Backend::Obvhs(..) => assert_eq!(vertices, 0, "{options:?}"),
        }
        let leaky = AccelOptions {
            robust: false,
            ..options
        };
        let [(_, vertices), (_, edges)] = leaks(leaky, coherence);
        println!(
            "{} not robust: {vertices} {edges} of {rays}",
            options.backend
        );
        assert!(
            vertices > 0 && edges > 0,
            "these rays would leak: {vertices} {edges}, {leaky:?}"
        );
    }
}
