//! Nothing leaves a closed mesh, wherever it stands and however large it is.

use super::{ask, backends, build};
use common::shapes::{Random, icosphere};
use glam::Vec3;
use warpath::bench::meshes::{Class, generate};
use warpath::trace::{Backend, MISS, Rays};

/// Rays from `origin` at vertices, at points of edges, and in any direction: how many of each got
/// out.
fn leaks(backend: Backend, positions: &[Vec3], triangles: &[[u32; 3]], origin: Vec3) -> [usize; 3] {
    let accel = build(backend, positions, triangles);
    let mut random = Random::new(9);
    let mut out = [0; 3];
    for (kind, out) in out.iter_mut().enumerate() {
        for chunk in triangles.chunks_exact(8) {
            let mut rays = Rays::<8>::default();
            for (lane, corners) in chunk.iter().enumerate() {
                let [a, b, c] = corners.map(|v| positions[v as usize]);
                let aim = match kind {
                    0 => a,
                    1 => a.lerp(b, random.unit()),
                    _ => (a.lerp(b, random.unit())).lerp(c, random.unit()),
                };
                rays.set(lane, origin, aim - origin, 0.0, f32::INFINITY);
            }
            let hits = ask(&accel, &rays);
            *out += hits.mesh.iter().filter(|m| **m == MISS).count();
        }
    }
    out
}

#[test]
fn closed_meshes_do_not_leak() {
    let ball = |centre: Vec3, radius: f32| {
        let (positions, triangles) = icosphere(5, centre, radius);
        (positions, triangles, centre)
    };
    let (tube, tube_triangles) = generate(Class::Smooth, 20_000);
    // The vertices of one ring of the tube lie around its middle.
    let ring = 2 * tube_triangles.len().isqrt() / 49;
    let middle = tube[..ring.max(3)].iter().sum::<Vec3>() / ring.max(3) as f32;
    let meshes = [
        ("tube", (tube, tube_triangles, middle)),
        ("ball", ball(Vec3::ZERO, 1.0)),
        ("far ball", ball(Vec3::new(1e4, -3e4, 2e4), 50.0)),
        ("huge ball", ball(Vec3::ZERO, 1e12)),
        ("tiny ball", ball(Vec3::ZERO, 1e-10)),
    ];
    for (name, (positions, triangles, inside)) in &meshes {
        for backend in backends() {
            let [vertices, edges, anywhere] = leaks(backend, positions, triangles, *inside);
            println!(
                "{name}, {backend}: {vertices} vertices, {edges} edges of {}",
                triangles.len()
            );
            match backend {
                Backend::Embree(..) => {
                    assert!(vertices < triangles.len() / 50, "{name}: {vertices}")
                }
                Backend::Obvhs(..) => assert_eq!(vertices, 0, "{name}, {backend}"),
            }
            assert_eq!((edges, anywhere), (0, 0), "{name}, {backend}");
        }
    }
}
