//! Runs for a figure; those of references are kept.

use crate::Result;
use crate::figures::{Figure, LEAST_RUNS, Options};
use crate::shared::program::{Forward, ForwardRun, Program};
use std::path::PathBuf;

/// Seeds of references start here: the runs to be judged do not use them.
const REFERENCE_SEED: usize = 1_000_000;

pub fn out() -> PathBuf {
    PathBuf::from("out/figures")
}

/// Gradient images by the figure's method for each of the seeds 1, 2, …
pub fn judged(
    program: &Program,
    figure: &Figure,
    options: &Options,
    spp: u32,
    runs: usize,
) -> Result<Vec<ForwardRun>> {
    let folder = out().join(&figure.name).join("run");
    (1..=runs)
        .map(|seed| {
            let what = forward(figure, options, &figure.method, spp, seed);
            program.forward(&what, &folder)
        })
        .collect()
}

/// Gradient images by finite differences. They are kept, and made again if the scene is no longer
/// that of `hash`.
pub fn reference(
    program: &Program,
    figure: &Figure,
    options: &Options,
    hash: &str,
) -> Result<Vec<ForwardRun>> {
    let runs = figure.reference.runs.max(LEAST_RUNS);
    (1..=runs)
        .map(|run| {
            let seed = REFERENCE_SEED + run;
            let what = forward(figure, options, "fd", figure.reference.spp, seed);
            let folder = out().join("references").join(name(&what.arguments()));
            if !options.fresh
                && let Ok(kept) = ForwardRun::kept(&folder)
                && kept.scene_hash == hash
            {
                return Ok(kept);
            }
            eprintln!("{}: reference, run {run} of {runs}", figure.name);
            program.forward(&what, &folder)
        })
        .collect()
}

fn forward<'a>(
    figure: &'a Figure,
    options: &Options,
    method: &'a str,
    spp: u32,
    seed: usize,
) -> Forward<'a> {
    Forward {
        scene: &figure.scene,
        defines: figure.defines.clone(),
        directions: &figure.direction,
        method,
        spp,
        seed,
        resolution: options.resolution(),
    }
}

/// A folder's name for what is run: figures that share a reference find each other's.
fn name(arguments: &[String]) -> String {
    let mut hash = 0xcbf2_9ce4_8422_2325u64;
    for byte in arguments.join("\n").bytes() {
        hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
    }
    format!("{hash:016x}")
}
