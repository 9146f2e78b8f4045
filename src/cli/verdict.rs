//! What `check` concludes from its measurements, in sentences.

use super::comparison::Comparison;
use serde::Serialize;

/// Forward and reverse mode compute one number from the same samples: only rounding may part them,
/// relative to the sum of what was added up.
const ROUNDING: f64 = 1e-4;
/// More than this many standard errors is significant.
pub const SIGNIFICANT: f64 = 4.0;
/// Single pixels may differ by this many times the tolerance: a finite step blurs what is sharp.
const PIXEL_FACTOR: f64 = 3.0;
/// An error bar of the bias above this lets almost anything pass, and the user should know.
const COARSE: f64 = 0.1;

/// Forward against reverse mode.
#[derive(Clone, Debug, Serialize)]
pub struct Transposition {
    /// ⟨dI/dθ·v, w⟩
    pub forward: f64,
    /// ⟨v, Jᵀw⟩
    pub backward: f64,
    /// The sums of the absolute values of what either adds up, the larger of the two.
    pub magnitude: f64,
    pub relative_difference: f64,
    pub agrees: bool,
}

impl Transposition {
    /// From either sum and its magnitude.
    pub fn new((forward, forward_size): (f64, f64), (backward, backward_size): (f64, f64)) -> Self {
        let magnitude = forward_size.max(backward_size);
        let relative_difference = match magnitude > 0.0 {
            true => (forward - backward).abs() / magnitude,
            false => 0.0,
        };
        Self {
            forward,
            backward,
            magnitude,
            relative_difference,
            agrees: relative_difference <= ROUNDING,
        }
    }
}

/// The conclusion.
#[derive(Clone, Debug, Serialize)]
pub struct Verdict {
    pub agrees: bool,
    /// One or two sentences.
    pub summary: String,
    /// What is wrong, in sentences with numbers; empty if all is well.
    pub complaints: Vec<String>,
    /// What the check could not have seen.
    pub doubts: Vec<String>,
}

/// What may explain a disagreement.
#[derive(Clone, Copy, Debug)]
pub struct Circumstances {
    /// The method does not differentiate visibility, which the parameters move.
    pub ignores_visibility: bool,
    /// An edge on the border of two pixels has no derivative.
    pub box_filter: bool,
}

/// Judges.
pub fn judge(
    method: &str,
    circumstances: Circumstances,
    t: &Transposition,
    c: &Comparison,
    tolerance: f64,
) -> Verdict {
    let mut complaints = complaints(method, t, c, tolerance);
    let agrees = complaints.is_empty();
    if !agrees && circumstances.ignores_visibility {
        complaints.push(format!(
            "{method} ignores visibility, which these parameters move"
        ));
    } else if !agrees && circumstances.box_filter && c.blocks.significance <= SIGNIFICANT {
        complaints.push(
            "but over blocks of pixels they agree: under a box filter an edge that lies between two pixels has no \
             derivative; another rfilter tells"
                .into(),
        );
    }
    let agreement = if !c.reference_is_significant {
        format!("{method} and finite differences do not differ by more than their noise.")
    } else {
        let seen = SIGNIFICANT * c.relative_bias_se;
        let verb = match seen > COARSE {
            true => "is not seen to differ from",
            false => "agrees with",
        };
        format!(
            "{method} {verb} finite differences: along their image it is {:+.2} % ± {:.2} % off ({:.0} % and {SIGNIFICANT} \
             standard errors may be), and over blocks of pixels {} is left, which is {:.1} standard errors of noise.",
            100.0 * c.relative_bias,
            100.0 * c.relative_bias_se,
            100.0 * tolerance,
            share(c.blocks.relative_rms, 2),
            c.blocks.significance,
        )
    };
    Verdict {
        agrees,
        summary: match agrees {
            true => format!(
                "{agreement} Forward and backward are the same number but for {:.0e} of its magnitude.",
                t.relative_difference
            ),
            false => complaints.join("; "),
        },
        complaints,
        doubts: doubts(c),
    }
}

fn doubts(c: &Comparison) -> Vec<String> {
    let mut doubts = Vec::new();
    if c.compared == 0 {
        doubts.push(
            "both gradients are zero everywhere: the image does not depend on the parameters"
                .into(),
        );
    } else if !c.reference_is_significant {
        doubts.push("the finite differences do not stand out of their noise: raise --spp".into());
    } else if SIGNIFICANT * c.relative_bias_se > COARSE {
        doubts.push(format!(
            "only a bias above {:.0} % could be seen: raise --spp",
            100.0 * SIGNIFICANT * c.relative_bias_se
        ));
    }
    doubts
}

fn complaints(method: &str, t: &Transposition, c: &Comparison, tolerance: f64) -> Vec<String> {
    let mut complaints = Vec::new();
    if !t.agrees {
        complaints.push(format!(
            "forward and backward disagree: {:.7e} against {:.7e}, {:.1e} of the magnitude where {ROUNDING:.0e} is \
             rounding",
            t.forward, t.backward, t.relative_difference,
        ));
    }
    if c.certain_differences > 0 {
        complaints.push(format!(
            "{method} and finite differences disagree in {} numbers that neither is uncertain of",
            c.certain_differences
        ));
    }
    let bias = c.relative_bias.abs();
    if bias > tolerance && bias > SIGNIFICANT * c.relative_bias_se {
        complaints.push(format!(
            "{method} is off by {:+.1} % ± {:.1} % along the image of finite differences",
            100.0 * c.relative_bias,
            100.0 * c.relative_bias_se
        ));
    }
    // Without a signal nothing is relative to it, and what is significant is all there is to say.
    let large = |relative: f64, most: f64| relative > most || !c.reference_is_significant;
    if c.blocks.significance > SIGNIFICANT && large(c.blocks.relative_rms, tolerance) {
        complaints.push(format!(
            "{method} and finite differences disagree over blocks of pixels: {} is unexplained by noise \
             ({:.0} standard errors)",
            share(c.blocks.relative_rms, 1),
            c.blocks.significance
        ));
    } else if c.pixels.significance > SIGNIFICANT
        && large(c.pixels.relative_rms, PIXEL_FACTOR * tolerance)
    {
        complaints.push(format!(
            "{method} and finite differences disagree in pixels: {} is unexplained by noise ({:.0} standard \
             errors), the largest z is {:.1} at x {}, y {}",
            share(c.pixels.relative_rms, 1),
            c.pixels.significance,
            c.largest_z,
            c.largest_z_at[0],
            c.largest_z_at[1],
        ));
    }
    complaints
}

fn share(relative_rms: f64, digits: usize) -> String {
    match relative_rms.is_finite() {
        true => format!("{:.digits$} % of their RMS", 100.0 * relative_rms),
        false => "an unknown part".into(),
    }
}
