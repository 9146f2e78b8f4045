//! `warpath check`: forward, backward and finite differences against each other.

use super::arguments::CheckArguments;
use super::comparison::{Comparison, Excess, z_scores};
use super::exit::Failure;
use super::replicates::Replicates;
use super::session::{self, Session};
use super::verdict::{Circumstances, SIGNIFICANT, Transposition, Verdict, judge};
use crate::batch::direction::{self, Direction};
use crate::methods::{self, ForwardGradient, Image, Method, Objective, Settings};
use crate::output::{atomic, chart, exr};
use crate::scene::Filter;
use crate::scene::parameters::{self, Parameter};
use serde_json::json;
use std::ffi::OsString;
use std::io::Write;

/// Independent runs of either side: a few groups of samples in one run are too few to trust error bars from.
const LEAST_RUNS: usize = 8;
/// As long as a bias as large as the tolerance could not be told from noise, the noisier side's runs are
/// doubled, up to this many.
const MOST_RUNS: usize = 32;
/// Parts the seeds of the runs; finite differences with the random numbers under test would share their noise.
const SEED_STEP: u64 = 0x9e37_79b9_7f4a_7c15;
const FIRST_REFERENCE_SEED: usize = 1 << 20;

/// Runs the three and compares them.
pub fn run(arguments: &CheckArguments, typed: &[OsString]) -> Result<(), Failure> {
    let method = session::method(arguments.method)?;
    if method == Method::Fd {
        return Err(Failure::Usage(
            "--method fd is what the others are checked against".into(),
        ));
    }
    let mut session = Session::open("check", &arguments.trace, typed, Some(method), true)?;
    let settings = session.settings.clone();
    let direction = direction::resolve(&session.scene, &arguments.parameters, settings.sensor)?;
    if settings.spp < 2 {
        return Err(Failure::Input(
            "with one sample a pixel there are no standard errors to check against: raise --spp"
                .into(),
        ));
    }
    let mut tested = Replicates::default();
    let first = run_tested(&mut session, &settings, &direction, &mut tested)?;
    let transposition = transpose(&mut session, &settings, &direction, &first.gradient)?;
    let mut reference = Replicates::default();
    let (mut tested_runs, mut reference_runs) = (LEAST_RUNS, LEAST_RUNS);
    let comparison = loop {
        while tested.runs() < tested_runs {
            run_tested(&mut session, &settings, &direction, &mut tested)?;
        }
        while reference.runs() < reference_runs {
            run_reference(&mut session, &settings, &direction, &mut reference)?;
        }
        let comparison = Comparison::of(&tested, &reference);
        let blurred = SIGNIFICANT * comparison.relative_bias_se > arguments.tolerance;
        if !blurred {
            break comparison;
        }
        let of_reference = comparison.reference_noise_share > 0.5;
        match of_reference {
            true if reference_runs < MOST_RUNS => reference_runs *= 2,
            false if tested_runs < MOST_RUNS => tested_runs *= 2,
            _ => break comparison,
        }
    };
    write_images(&mut session, &tested, &reference)?;
    let moves = direction
        .iter()
        .any(|(parameter, _)| parameter.moves_visibility);
    let verdict = judge(
        method.name(),
        Circumstances {
            ignores_visibility: moves && method == Method::Interior,
            box_filter: matches!(
                session.scene.sensors[settings.sensor].film.filter,
                Filter::Box { .. }
            ),
        },
        &transposition,
        &comparison,
        arguments.tolerance,
    );
    conclude(
        session,
        &verdict,
        &transposition,
        &comparison,
        arguments.tolerance,
    )
}

/// Writes and prints what was found.
fn conclude(
    mut session: Session,
    verdict: &Verdict,
    transposition: &Transposition,
    comparison: &Comparison,
    tolerance: f64,
) -> Result<(), Failure> {
    for doubt in &verdict.doubts {
        session.warn(doubt.clone());
    }
    let found = json!({
        "verdict": verdict,
        "tolerance": tolerance,
        "forward_against_backward": transposition,
        "forward_against_fd": comparison,
    });
    let text = format!("{found:#}\n");
    session.write("check.json", |path| {
        atomic::write(path, |file| file.write_all(text.as_bytes()))
    })?;
    session.report.results.insert("check".into(), found);
    if !session.prints_json() {
        print(transposition, comparison, verdict)?;
    }
    session.close()?;
    match verdict.agrees {
        true => Ok(()),
        false => Err(Failure::Disagreement(verdict.complaints.join("\n"))),
    }
}

fn run_tested(
    session: &mut Session,
    settings: &Settings,
    direction: &Direction,
    runs: &mut Replicates,
) -> Result<ForwardGradient, Failure> {
    let settings = Settings {
        seed: nth_seed(settings.seed, runs.runs()),
        ..settings.clone()
    };
    run_forward(session, "forward", &settings, direction, runs)
}

fn run_reference(
    session: &mut Session,
    settings: &Settings,
    direction: &Direction,
    runs: &mut Replicates,
) -> Result<(), Failure> {
    let settings = Settings {
        method: Method::Fd,
        seed: nth_seed(settings.seed, FIRST_REFERENCE_SEED + runs.runs()),
        ..settings.clone()
    };
    run_forward(session, "fd", &settings, direction, runs).map(drop)
}

fn run_forward(
    session: &mut Session,
    stage: &'static str,
    settings: &Settings,
    direction: &Direction,
    runs: &mut Replicates,
) -> Result<ForwardGradient, Failure> {
    let forward = session.trace(
        stage,
        settings,
        |scene, settings, progress| methods::forward(scene, settings, direction, progress),
        |forward| &forward.statistics,
    )?;
    let stderr = forward.stderr.as_ref().ok_or_else(|| {
        Failure::Input(
            "with so few samples there are no standard errors to check against: raise --spp".into(),
        )
    })?;
    runs.add(&forward.gradient, stderr);
    Ok(forward)
}

/// The first is the user's own.
fn nth_seed(seed: u64, n: usize) -> u64 {
    seed.wrapping_add((n as u64).wrapping_mul(SEED_STEP))
}

/// Runs reverse mode on a fixed adjoint image and compares the two ways to the same number.
fn transpose(
    session: &mut Session,
    settings: &Settings,
    direction: &Direction,
    gradient: &Image,
) -> Result<Transposition, Failure> {
    let adjoint = smooth_image(gradient.width, gradient.height, settings.seed);
    let keys: Vec<Parameter> = direction
        .iter()
        .map(|(parameter, _)| parameter.clone())
        .collect();
    let objective = Objective::Adjoint(&adjoint);
    let done = session.trace(
        "backward",
        settings,
        |scene, settings, progress| methods::backward(scene, settings, &keys, &objective, progress),
        |backward| &backward.statistics,
    )?;
    let forward = inner(
        gradient.pixels.as_flattened(),
        adjoint.pixels.as_flattened(),
    );
    let mut backward = (0.0, 0.0);
    for (parameter, tangent) in direction {
        let reduced = parameters::reduce(&session.scene, parameter, &done.gradient);
        let (sum, size) = inner(&reduced, tangent);
        backward = (backward.0 + sum, backward.1 + size);
    }
    Ok(Transposition::new(forward, backward))
}

/// The sum of the products, and of their absolute values.
fn inner(a: &[f32], b: &[f32]) -> (f64, f64) {
    let products = || a.iter().zip(b).map(|(a, b)| *a as f64 * *b as f64);
    (products().sum(), products().map(f64::abs).sum())
}

/// An adjoint image with no symmetry by which mistakes could cancel: a few slow waves per channel.
fn smooth_image(width: usize, height: usize, seed: u64) -> Image {
    let phase = |n: u64| {
        let mixed = (seed ^ (n + 1).wrapping_mul(SEED_STEP)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (mixed >> 40) as f64 / (1u64 << 24) as f64 * std::f64::consts::TAU
    };
    let wave = |u: f64, v: f64, channel: u64| {
        let terms = (0..4u64).map(|k| {
            let (across, down) = (1.0 + k as f64, 0.7 + (3 - k) as f64);
            (across * u * 3.0 + down * v * 3.0 + phase(4 * channel + k)).cos()
        });
        (1.0 + 0.5 * terms.sum::<f64>()) as f32
    };
    let pixels = (0..width * height)
        .map(|at| {
            let (u, v) = (
                (at % width) as f64 / width as f64,
                (at / width) as f64 / height as f64,
            );
            std::array::from_fn(|channel| wave(u, v, channel as u64))
        })
        .collect();
    Image {
        width,
        height,
        pixels,
    }
}

/// One scale for the two gradients, so that equal colours are equal numbers.
fn write_images(
    session: &mut Session,
    tested: &Replicates,
    reference: &Replicates,
) -> Result<(), Failure> {
    let z = z_scores(tested, reference);
    let (tested, reference) = (tested.mean(), reference.mean());
    let scale = chart::robust_scale(&reference).max(chart::robust_scale(&tested));
    session.write("forward.exr", |path| exr::write(path, &tested))?;
    session.write("forward.png", |path| chart::write(path, &tested, scale))?;
    session.write("fd.exr", |path| exr::write(path, &reference))?;
    session.write("fd.png", |path| chart::write(path, &reference, scale))?;
    session.write("z.exr", |path| exr::write(path, &z))?;
    session.write("z.png", |path| chart::write(path, &z, SIGNIFICANT as f32))
}

fn print(t: &Transposition, c: &Comparison, verdict: &Verdict) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    writeln!(
        out,
        "forward against backward: {:.7e}, {:.7e}: {:.1e} apart",
        t.forward, t.backward, t.relative_difference
    )?;
    // Without a signal nothing is relative to it.
    let bias = match c.reference_is_significant {
        true => format!(
            "{:+.2} % ± {:.2} %",
            100.0 * c.relative_bias,
            100.0 * c.relative_bias_se
        ),
        false => "unknown".into(),
    };
    let unexplained = |excess: &Excess| match excess.relative_rms.is_finite() {
        true => format!("{:.2} %", 100.0 * excess.relative_rms),
        false => "unknown".into(),
    };
    writeln!(
        out,
        "forward against fd:       bias {bias}; unexplained over blocks {} ({:.1} se), in pixels {} ({:.1} se); \
         chi²/N {:.2}, beyond 4 se {:.2} %; runs {} and {}",
        unexplained(&c.blocks),
        c.blocks.significance,
        unexplained(&c.pixels),
        c.pixels.significance,
        c.chi2_per_number,
        100.0 * c.share_beyond_4,
        c.tested_runs,
        c.reference_runs,
    )?;
    match verdict.agrees {
        true => writeln!(out, "{}", verdict.summary)?,
        // The error on stderr says why.
        false => writeln!(out, "they disagree")?,
    }
    Ok(out.flush()?)
}
