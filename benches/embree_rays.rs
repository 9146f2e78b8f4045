//! Rays a second on one thread, by packet width, coherence flag and robustness, and against a bare
//! C loop.
//!
//! `cargo bench --bench embree_rays`; the figures of one machine are in `docs/embree.md`.

use common::shapes::{self, Random, icosphere};
use glam::Vec3;
use std::{hint::black_box, time::Instant};
use warpath::trace::{
    Accel, AccelOptions, Coherence, Hits, MISS, MeshView, Rays, all_lanes, floor::floor,
};

/// Rays a side of the square of primary rays.
const SIDE: usize = 256;
/// Best of this many passes.
const PASSES: usize = 7;

struct Ray {
    origin: Vec3,
    direction: Vec3,
    tfar: f32,
}

fn ray(origin: Vec3, direction: Vec3) -> Ray {
    Ray {
        origin,
        direction,
        tfar: f32::INFINITY,
    }
}

fn main() {
    // A smooth room of 20 480 triangles around smaller spheres of 20 480 in all.
    let mut meshes = vec![icosphere(5, Vec3::ZERO, 3.0)];
    for i in 0..4 {
        let angle = i as f32 * 1.6;
        let centre = Vec3::new(
            1.5 * angle.cos(),
            0.5 * (3.0 * angle).sin(),
            1.5 * angle.sin(),
        );
        meshes.push(icosphere(4, centre, 0.6));
    }
    let accels = [false, true].map(|robust| {
        Accel::build(&views(&meshes), AccelOptions::new(robust, 1)).expect("Embree builds the room")
    });
    let version = accels[0].library_version();
    let width = accels[0].native_width();
    println!("Embree {version}, native width {width}, {PASSES} passes, Mrays/s on one thread");
    println!(
        "digit: packet width; c: coherent flag, i: incoherent; R: robust; %: time over a bare C loop\n"
    );
    print!("{:<16}", "");
    for robust in ["", "R"] {
        for column in ["1i", "4i", "8i", "16i", "4c", "8c", "16c"] {
            print!("{:>13}", format!("{column}{robust}"));
        }
    }
    println!("\nintersect");
    let loads = workloads(&accels[0]);
    table(
        &accels,
        &loads,
        |accel, rays, coherence, width| match width {
            1 => intersect::<1>(accel, rays, coherence),
            4 => intersect::<4>(accel, rays, coherence),
            8 => intersect::<8>(accel, rays, coherence),
            _ => intersect::<16>(accel, rays, coherence),
        },
    );
    println!("occluded");
    table(
        &accels,
        &loads,
        |accel, rays, coherence, width| match width {
            1 => occluded::<1>(accel, rays, coherence),
            4 => occluded::<4>(accel, rays, coherence),
            8 => occluded::<8>(accel, rays, coherence),
            _ => occluded::<16>(accel, rays, coherence),
        },
    );
    moving(&mut meshes);
}

/// One row a workload, one column a way of asking.
fn table(
    accels: &[Accel],
    loads: &[(String, Vec<Ray>)],
    measure: impl Fn(&Accel, &[Ray], Coherence, usize) -> String,
) {
    let ways = [1, 4, 8, 16]
        .map(|width| (width, Coherence::Incoherent))
        .into_iter()
        .chain([4, 8, 16].map(|width| (width, Coherence::Coherent)));
    for (name, rays) in loads {
        print!("{name:<16}");
        for accel in accels {
            for (width, coherence) in ways.clone() {
                print!("{:>13}", measure(accel, rays, coherence, width));
            }
        }
        println!();
    }
}

/// What rays of each kind cost: primary, bundles of 16 of one origin by their angular spread, one
/// bounce, and towards a light.
fn workloads(accel: &Accel) -> Vec<(String, Vec<Ray>)> {
    let mut random = Random::new(1);
    let eye = Vec3::new(0.0, 0.0, -2.4);
    let mut primary = Vec::new();
    for tile in 0..SIDE * SIDE / 16 {
        let corner = (tile % (SIDE / 4) * 4, tile / (SIDE / 4) * 4);
        for i in 0..16 {
            let at = |c: usize| c as f32 / SIDE as f32 * 2.0 - 1.0;
            primary.push(ray(
                eye,
                Vec3::new(at(corner.0 + i % 4), at(corner.1 + i / 4), 1.5),
            ));
        }
    }
    let mut bounce = Vec::new();
    let mut shadow = Vec::new();
    for r in &primary {
        let mut rays = Rays::<1>::default();
        rays.set(0, r.origin, r.direction, 0.0, f32::INFINITY);
        let mut hits = Hits::default();
        accel.intersect(&rays, 1, &mut hits, Coherence::Incoherent);
        assert!(hits.mesh[0] != MISS, "the room is closed");
        let point = r.origin + r.direction * hits.t[0] * 0.999;
        let normal = -point.normalize() * if hits.mesh[0] == 0 { 1.0 } else { -1.0 };
        bounce.push(ray(point, normal + 0.99 * random.direction()));
        let light = Vec3::new(0.2, 2.5, 0.0) + 0.2 * random.cube();
        shadow.push(Ray {
            tfar: 0.999,
            ..ray(point, light - point)
        });
    }
    let mut loads = vec![("primary".to_owned(), primary)];
    for sigma in [0.003, 0.01, 0.03, 0.1] {
        let mut bundle = Vec::new();
        for i in 0..SIDE * SIDE / 16 {
            let from = &bounce[i * 16 + 5];
            let axis = from.direction.normalize();
            for _ in 0..16 {
                let jitter = Vec3::new(random.normal(), random.normal(), random.normal());
                bundle.push(ray(from.origin, axis + sigma * jitter));
            }
        }
        loads.push((format!("bundle {sigma}"), bundle));
    }
    loads.push(("diffuse bounce".to_owned(), bounce));
    loads.push(("shadow".to_owned(), shadow));
    loads
}

fn pack<const N: usize>(rays: &[Ray]) -> Vec<Rays<N>> {
    let packet = |chunk: &[Ray]| {
        let mut packet = Rays::default();
        for (lane, r) in chunk.iter().enumerate() {
            packet.set(lane, r.origin, r.direction, 0.0, r.tfar);
        }
        packet
    };
    rays.chunks_exact(N).map(packet).collect()
}

/// Mrays/s, and how much longer it took than the bare C loop.
fn intersect<const N: usize>(accel: &Accel, rays: &[Ray], coherence: Coherence) -> String {
    let packets = pack::<N>(rays);
    let (mut best, mut bare) = (f64::INFINITY, f64::INFINITY);
    // Turn about, so that both see the same weather on a shared machine.
    for _ in 0..PASSES {
        let start = Instant::now();
        let mut found = 0;
        for packet in &packets {
            let mut hits = Hits::default();
            accel.intersect(packet, all_lanes::<N>(), &mut hits, coherence);
            found += hits.mesh.iter().filter(|m| **m != MISS).count() as u64;
        }
        best = best.min(start.elapsed().as_secs_f64());
        let alone = floor(accel, &packets, coherence).expect("Embree traces");
        bare = bare.min(alone.seconds);
        assert_eq!(found, alone.hits);
    }
    let rate = rays.len() as f64 / best / 1e6;
    format!("{rate:.2} {:+.1}%", 100.0 * (best / bare - 1.0))
}

/// Mrays/s.
fn occluded<const N: usize>(accel: &Accel, rays: &[Ray], coherence: Coherence) -> String {
    let packets = pack::<N>(rays);
    let mut best = f64::INFINITY;
    for _ in 0..PASSES {
        let start = Instant::now();
        for packet in &packets {
            black_box(accel.occluded(packet, all_lanes::<N>(), coherence));
        }
        best = best.min(start.elapsed().as_secs_f64());
    }
    format!("{:.2}", rays.len() as f64 / best / 1e6)
}

/// Building against refitting, and what a refitted scene costs to trace.
fn moving(meshes: &mut [shapes::Shape]) {
    println!("\nmilliseconds to build, on 1 and 2 threads; to refit first and later; robust");
    let time = |work: &mut dyn FnMut()| {
        let start = Instant::now();
        work();
        1e3 * start.elapsed().as_secs_f64()
    };
    for threads in [1, 2] {
        let options = AccelOptions::new(true, threads);
        let mut accel = None;
        let build = (0..PASSES)
            .map(|_| time(&mut || accel = Accel::build(&views(meshes), options).ok()))
            .fold(f64::INFINITY, f64::min);
        let mut accel = accel.expect("the room builds");
        let still: Vec<_> = workloads(&accel);
        let before = intersect::<16>(&accel, &still[0].1, Coherence::Coherent);
        let mut refit = Vec::new();
        for _ in 0..PASSES {
            meshes[1].0.iter_mut().for_each(|p| p.x += 1e-4);
            refit.push(time(&mut || {
                accel.refit(&views(meshes)).expect("same topology")
            }));
        }
        let later = refit[1..].iter().copied().fold(f64::INFINITY, f64::min);
        let after = intersect::<16>(&accel, &still[0].1, Coherence::Coherent);
        println!(
            "{threads}: build {build:.2}, first refit {:.2}, later {later:.2}; primary 16c {before} before, {after} after",
            refit[0]
        );
    }
}

fn views(meshes: &[shapes::Shape]) -> Vec<MeshView<'_>> {
    meshes
        .iter()
        .map(|(positions, triangles)| MeshView {
            positions,
            triangles,
        })
        .collect()
}
