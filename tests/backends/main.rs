//! The two backends against each other: hits, leaks, gradients.
#![cfg(all(feature = "embree", feature = "obvhs"))]

mod gradients;
mod hits;
mod leaks;
mod limits;

use glam::Vec3;
use warpath::trace::{Accel, AccelOptions, Backend, Coherence, Hits, MeshView, Rays, all_lanes};

/// A robust scene of one mesh.
fn build(backend: Backend, positions: &[Vec3], triangles: &[[u32; 3]]) -> Accel {
    let view = MeshView {
        positions,
        triangles,
    };
    Accel::build(&[view], AccelOptions::new(true, 2).on(backend)).expect("a built mesh")
}

fn backends() -> [Backend; 3] {
    ["embree", "obvhs", "obvhs-bvh2"].map(|name| name.parse().expect("a backend"))
}

/// First hits of eight rays, both ways of asking, which must give the same; and occlusion, which
/// must agree.
fn ask(accel: &Accel, rays: &Rays<8>) -> Hits<8> {
    let mut hits = [Hits::default(); 2];
    for (hits, coherence) in hits
        .iter_mut()
        .zip([Coherence::Coherent, Coherence::Incoherent])
    {
        accel.intersect(rays, all_lanes::<8>(), hits, coherence);
        let blocked = accel.occluded(rays, all_lanes::<8>(), coherence);
        for lane in 0..8 {
            let met = hits.mesh[lane] != warpath::trace::MISS;
            assert_eq!(blocked >> lane & 1 == 1, met, "{}", accel.backend());
        }
    }
    if let Backend::Obvhs(..) = accel.backend() {
        assert_eq!(hits[0], hits[1], "a packet and single rays");
    }
    hits[1]
}
