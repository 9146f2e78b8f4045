//! When refitting is worth it: speed of refitted and of new structures over vertices that have
//! moved, as a Markdown table.
//!
//!     cargo run --release --example refit

use glam::Vec3;
use std::error::Error;
use std::time::Instant;
use warpath::trace::tightness::Tightness;
use warpath::trace::{Accel, AccelOptions, Coherence, Hits, MeshView, Rays, all_lanes};

use common::shapes::{Random, icosphere};

const LANES: usize = 16;
const PACKETS: usize = 1 << 13;
const BEST_OF: usize = 5;

fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "| triangles | vertices moved by | looseness | refit ms | build ms | refitted ns/ray | new ns/ray | slower | rays that pay for a build |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for subdivisions in [5, 7] {
        let (base, triangles) = icosphere(subdivisions, Vec3::ZERO, 1.0);
        let edge = (base[triangles[0][0] as usize] - base[triangles[0][1] as usize]).length();
        for noise in [0.0, 0.5, 1.0, 2.0, 4.0, 8.0, 16.0] {
            row(&base, &triangles, edge, noise)?;
        }
    }
    Ok(())
}

/// `noise` in lengths of an edge.
fn row(base: &[Vec3], triangles: &[[u32; 3]], edge: f32, noise: f32) -> Result<(), Box<dyn Error>> {
    let mut random = Random::new(5);
    let moved: Vec<Vec3> = base
        .iter()
        .map(|p| *p + random.cube() * noise * edge)
        .collect();
    let view = |positions| {
        [MeshView {
            positions,
            triangles,
        }]
    };
    let tightness = Tightness::new(&view(base));
    let looseness = tightness.looseness(&view(&moved), &[true]);
    let options = AccelOptions::new(true, 1);
    let mut refitted = Accel::build(&view(base), options)?;
    refitted.refit(&view(base))?;
    let (mut refit_s, mut build_s) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..BEST_OF {
        refitted.refit(&view(base))?;
        let start = Instant::now();
        refitted.refit(&view(&moved))?;
        refit_s = refit_s.min(start.elapsed().as_secs_f64());
        let start = Instant::now();
        Accel::build(&view(&moved), options)?;
        build_s = build_s.min(start.elapsed().as_secs_f64());
    }
    let fresh = Accel::build(&view(&moved), options)?;
    let [old, new] = [&refitted, &fresh].map(ns_a_ray);
    let pays = match old > new {
        true => format!("{:.1e}", (build_s - refit_s) * 1e9 / (old - new)),
        false => "never".into(),
    };
    println!(
        "| {} | {noise} edges | {looseness:.2} | {:.2} | {:.1} | {old:.0} | {new:.0} | {:+.0} % | {pays} |",
        triangles.len(),
        1e3 * refit_s,
        1e3 * build_s,
        100.0 * (old / new - 1.0)
    );
    Ok(())
}

/// Rays from around the mesh to points in it, in incoherent packets.
fn ns_a_ray(accel: &Accel) -> f64 {
    let mut random = Random::new(9);
    let packets: Vec<Rays<LANES>> = (0..PACKETS)
        .map(|_| {
            let mut rays = Rays::default();
            for lane in 0..LANES {
                let from = 2.0 * random.direction();
                rays.set(lane, from, 0.9 * random.cube() - from, 0.0, f32::INFINITY);
            }
            rays
        })
        .collect();
    let once = || {
        let start = Instant::now();
        for rays in &packets {
            let mut hits = Hits::<LANES>::default();
            accel.intersect(rays, all_lanes::<LANES>(), &mut hits, Coherence::Incoherent);
            std::hint::black_box(&hits);
        }
        start.elapsed().as_secs_f64()
    };
    let best = (0..BEST_OF).map(|_| once()).fold(f64::INFINITY, f64::min);
    best * 1e9 / (PACKETS * LANES) as f64
}
