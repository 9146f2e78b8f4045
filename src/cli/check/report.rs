//! What was found, as files and on stdout.

use super::verdict::{Outcome, SIGNIFICANT, Transposition, Verdict};
use crate::cli::exit::Failure;
use crate::cli::session::Session;
use crate::output::{atomic, chart, exr};
use crate::statistics::comparison::{Comparison, Excess, z_scores};
use crate::statistics::replicates::Replicates;
use serde_json::json;
use std::io::Write;

/// The file with all that was found.
pub const FOUND: &str = "check.json";

/// One scale for the two gradients, so that equal colours are equal numbers.
pub fn write_images(
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

/// Writes and prints what was found.
pub fn conclude(
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
        "method": session.report.method,
        "verdict": verdict,
        "tolerance": tolerance,
        "forward_against_backward": transposition,
        "forward_against_fd": comparison,
    });
    let text = format!("{found:#}\n");
    session.write(FOUND, |path| {
        atomic::write(path, |file| file.write_all(text.as_bytes()))
    })?;
    session.report.results.insert("check".into(), found);
    if !session.prints_json() {
        print(transposition, comparison, verdict)?;
    }
    session.close()?;
    match verdict.outcome {
        Outcome::Agrees => Ok(()),
        Outcome::Disagrees => Err(Failure::Disagreement(verdict.complaints.join("\n"))),
        Outcome::CannotTell => Err(Failure::Unsure(verdict.summary.clone())),
    }
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
    match verdict.outcome {
        Outcome::Agrees => writeln!(out, "{}", verdict.summary)?,
        // The error on stderr says why.
        Outcome::Disagrees => writeln!(out, "they disagree")?,
        Outcome::CannotTell => writeln!(out, "cannot tell")?,
    }
    Ok(out.flush()?)
}
