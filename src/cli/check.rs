//! `warpath check`: forward, backward and finite differences against each other.

use super::arguments::CheckArguments;
use super::comparison::{Comparison, Estimate, z_scores};
use super::direction::{self, Direction};
use super::exit::Failure;
use super::session::{self, Session};
use crate::methods::{self, ForwardGradient, Image, Method, Objective, Settings};
use crate::output::{atomic, chart, exr};
use crate::scene::parameters::{self, Parameter};
use serde::Serialize;
use serde_json::json;
use std::ffi::OsString;
use std::io::Write;

/// Forward and reverse mode compute one number from the same samples: only rounding may part them,
/// relative to the sum of what was added up.
const ROUNDING: f64 = 1e-4;
/// More than this many standard errors is significant.
const SIGNIFICANT: f64 = 4.0;
/// What per-pixel statistics may reach while the images agree. Error bars from few groups have heavier
/// tails than a normal distribution's.
const MOST_CHI2: f64 = 1.5;
const MOST_BEYOND_4: f64 = 0.01;
/// An error bar of the bias above this lets almost anything pass, and the user should know.
const COARSE: f64 = 0.1;
/// Finite differences with the very random numbers under test would share their noise.
const REFERENCE_SEED: u64 = 0x9e37_79b9_7f4a_7c15;

/// Forward against reverse mode.
#[derive(Clone, Debug, Serialize)]
struct Transposition {
    /// ⟨dI/dθ·v, w⟩
    forward: f64,
    /// ⟨v, Jᵀw⟩
    backward: f64,
    /// The sums of the absolute values of what either adds up, the larger of the two.
    magnitude: f64,
    relative_difference: f64,
    agrees: bool,
}

/// Runs the three and compares them.
pub fn run(arguments: &CheckArguments, typed: &[OsString]) -> Result<(), Failure> {
    let method = session::method(arguments.method)?;
    if method == Method::Fd {
        return Err(Failure::Usage(
            "--method fd is what the others are checked against".into(),
        ));
    }
    let mut session = Session::open("check", &arguments.trace, typed, Some(method), true)?;
    let direction = direction::resolve(&session.scene, &arguments.parameters)?;
    let settings = session.settings.clone();

    // Each image is written as soon as it is there: an interrupt keeps what is finished.
    let tested = forward(&mut session, "forward", &settings, &direction)?;
    session.write("forward.exr", |path| exr::write(path, &tested.gradient))?;
    let transposition = transpose(&mut session, &settings, &direction, &tested.gradient)?;
    let reference_settings = Settings {
        method: Method::Fd,
        seed: settings.seed ^ REFERENCE_SEED,
        ..settings
    };
    let reference = forward(&mut session, "fd", &reference_settings, &direction)?;
    session.write("fd.exr", |path| exr::write(path, &reference.gradient))?;

    let (tested, reference) = (estimate(&tested)?, estimate(&reference)?);
    write_pictures(&mut session, tested, reference)?;
    let comparison = Comparison::of(tested, reference);
    let complaints = complaints(&transposition, &comparison, arguments.tolerance);
    if !comparison.reference_is_significant {
        session.warn("the finite differences do not stand out of their noise: raise --spp".into());
    } else if SIGNIFICANT * comparison.relative_bias_se > COARSE {
        let seen = 100.0 * SIGNIFICANT * comparison.relative_bias_se;
        session.warn(format!(
            "only a bias above {seen:.0} % could be seen: raise --spp"
        ));
    }
    let verdict = json!({
        "agrees": complaints.is_empty(),
        "complaints": complaints,
        "tolerance": arguments.tolerance,
        "forward_against_backward": transposition,
        "forward_against_fd": comparison,
    });
    let text = format!("{verdict:#}\n");
    session.write("check.json", |path| {
        atomic::write(path, |file| file.write_all(text.as_bytes()))
    })?;
    session.report.results.insert("check".into(), verdict);
    if !session.prints_json() {
        print(&transposition, &comparison, complaints.is_empty())?;
    }
    session.close()?;
    if complaints.is_empty() {
        Ok(())
    } else {
        Err(Failure::Disagreement(complaints.join("\n")))
    }
}

fn forward(
    session: &mut Session,
    stage: &'static str,
    settings: &Settings,
    direction: &Direction,
) -> Result<ForwardGradient, Failure> {
    session.trace(
        stage,
        settings,
        |scene, settings, progress| methods::forward(scene, settings, direction, progress),
        |forward| &forward.statistics,
    )
}

fn estimate(forward: &ForwardGradient) -> Result<Estimate<'_>, Failure> {
    let stderr = forward.stderr.as_ref().ok_or_else(|| {
        Failure::Input(
            "with so few samples there are no standard errors to check against: raise --spp".into(),
        )
    })?;
    Ok(Estimate {
        value: &forward.gradient,
        stderr,
    })
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
    // With the same settings, to the letter: without standard errors the samples would be grouped differently.
    let done = session.trace(
        "backward",
        settings,
        |scene, settings, progress| methods::backward(scene, settings, &keys, &objective, progress),
        |backward| &backward.statistics,
    )?;
    let numbers = |image: &Image| {
        image
            .pixels
            .iter()
            .flatten()
            .map(|v| *v as f64)
            .collect::<Vec<_>>()
    };
    let (forward, forward_size) = inner(&numbers(gradient), &numbers(&adjoint));
    let (mut backward, mut backward_size) = (0.0, 0.0);
    for (parameter, tangent) in direction {
        let reduced = parameters::reduce(&session.scene, parameter, &done.gradient);
        let widen = |values: &[f32]| values.iter().map(|v| *v as f64).collect::<Vec<_>>();
        let (sum, size) = inner(&widen(&reduced), &widen(tangent));
        backward += sum;
        backward_size += size;
    }
    let magnitude = forward_size.max(backward_size);
    let relative_difference = if magnitude > 0.0 {
        (forward - backward).abs() / magnitude
    } else {
        0.0
    };
    Ok(Transposition {
        forward,
        backward,
        magnitude,
        relative_difference,
        agrees: relative_difference <= ROUNDING,
    })
}

/// The sum of the products, and of their absolute values.
fn inner(a: &[f64], b: &[f64]) -> (f64, f64) {
    let products = || a.iter().zip(b).map(|(a, b)| a * b);
    (products().sum(), products().map(f64::abs).sum())
}

/// An adjoint image with no symmetry by which mistakes could cancel: a few slow waves per channel.
fn smooth_image(width: usize, height: usize, seed: u64) -> Image {
    let phase = |n: u64| {
        let mixed =
            (seed ^ (n + 1).wrapping_mul(REFERENCE_SEED)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
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

/// What is wrong, in sentences with numbers; empty if all is well.
fn complaints(transposition: &Transposition, c: &Comparison, tolerance: f64) -> Vec<String> {
    let mut complaints = Vec::new();
    if !transposition.agrees {
        complaints.push(format!(
            "forward and backward disagree: {:.7e} against {:.7e}, {:.1e} of the magnitude where {ROUNDING:.0e} is rounding",
            transposition.forward, transposition.backward, transposition.relative_difference,
        ));
    }
    if c.certain_differences > 0 {
        complaints.push(format!(
            "forward and fd disagree in {} numbers that neither is uncertain of",
            c.certain_differences
        ));
    }
    if c.relative_bias.abs() > tolerance && c.relative_bias.abs() > SIGNIFICANT * c.relative_bias_se
    {
        complaints.push(format!(
            "forward is off by {:+.1} % ± {:.1} % along fd's image",
            100.0 * c.relative_bias,
            100.0 * c.relative_bias_se
        ));
    }
    let significant = c.chi2_per_number > MOST_CHI2 || c.share_beyond_4 > MOST_BEYOND_4;
    // Without a signal nothing is relative to it, and what is significant is all there is to say.
    if significant && (c.relative_excess > tolerance || !c.reference_is_significant) {
        complaints.push(format!(
            "forward and fd disagree pixel by pixel: chi²/N {:.2}, {:.2} % beyond 4 standard errors, \
             the largest z {:.1} at x {}, y {}; {:.1} % of fd's RMS is not explained by noise",
            c.chi2_per_number,
            100.0 * c.share_beyond_4,
            c.largest_z,
            c.largest_z_at[0],
            c.largest_z_at[1],
            100.0 * c.relative_excess
        ));
    }
    complaints
}

/// One scale for the two gradients, so that equal colours are equal numbers.
fn write_pictures(
    session: &mut Session,
    tested: Estimate,
    reference: Estimate,
) -> Result<(), Failure> {
    let scale = chart::robust_scale(reference.value).max(chart::robust_scale(tested.value));
    let z = z_scores(tested, reference);
    session.write("forward.png", |path| {
        chart::write(path, tested.value, scale)
    })?;
    session.write("fd.png", |path| chart::write(path, reference.value, scale))?;
    session.write("z.exr", |path| exr::write(path, &z))?;
    session.write("z.png", |path| chart::write(path, &z, SIGNIFICANT as f32))
}

fn print(t: &Transposition, c: &Comparison, agrees: bool) -> Result<(), Failure> {
    let mut out = std::io::stdout().lock();
    writeln!(
        out,
        "forward against backward: {:.7e}, {:.7e}: {:.1e} apart",
        t.forward, t.backward, t.relative_difference
    )?;
    writeln!(
        out,
        "forward against fd:       bias {:+.2} % ± {:.2} %, chi²/N {:.3}, beyond 4 se {:.3} %, unexplained {:.2} %",
        100.0 * c.relative_bias,
        100.0 * c.relative_bias_se,
        c.chi2_per_number,
        100.0 * c.share_beyond_4,
        100.0 * c.relative_excess
    )?;
    writeln!(
        out,
        "{}",
        if agrees {
            "they agree"
        } else {
            "they disagree"
        }
    )?;
    Ok(out.flush()?)
}
