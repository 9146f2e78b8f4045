//! What `check` concludes from its measurements, in sentences.

use crate::statistics::comparison::Comparison;
use serde::Serialize;

/// Forward and backward compute one number from the same samples: only rounding may part them,
/// relative to the sum of what was added up.
const ROUNDING: f64 = 1e-4;
/// More than this many standard errors is significant.
pub const SIGNIFICANT: f64 = 4.0;
/// Single pixels may differ by this many times the tolerance: a finite step blurs what is sharp.
const PIXEL_FACTOR: f64 = 3.0;
/// Of what the image itself would weigh over a step of finite differences: sums of smaller terms
/// are zero but for rounding.
const LEAST_SHARE: f64 = 1e-5;

/// Forward against backward.
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
    /// From either sum and its magnitude; `conceivable` is the sum if every pixel changed by its
    /// whole value over a step of finite differences.
    pub fn new(
        (forward, forward_size): (f64, f64),
        (backward, backward_size): (f64, f64),
        conceivable: f64,
    ) -> Self {
        let least = LEAST_SHARE * conceivable;
        let magnitude = forward_size.max(backward_size).max(least);
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

/// In a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Outcome {
    Agrees,
    Disagrees,
    /// The noise is larger than what is looked for.
    CannotTell,
}

/// The conclusion.
#[derive(Clone, Debug, Serialize)]
pub struct Verdict {
    pub outcome: Outcome,
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
    /// What moves stands on something else: it has one derivative lifted, and one pressed in.
    pub stands: bool,
}

/// What differences do not tell of what stands on something.
const STANDS: &str = "something stands on something else, and has one derivative lifted and another pressed in: the \
                      latter is given, and finite differences are the mean of both; move it a little up, or into it";

/// Judges.
pub fn judge(
    method: &str,
    circumstances: Circumstances,
    t: &Transposition,
    c: &Comparison,
    tolerance: f64,
) -> Verdict {
    let mut complaints = complaints(method, t, c, tolerance);
    let outcome = match (complaints.is_empty(), c.can_tell(tolerance)) {
        (false, _) => Outcome::Disagrees,
        (true, true) => Outcome::Agrees,
        (true, false) => Outcome::CannotTell,
    };
    let disagrees = outcome == Outcome::Disagrees;
    if disagrees && circumstances.ignores_visibility {
        complaints.push(format!(
            "{method} ignores visibility, which these parameters move"
        ));
    } else if disagrees && circumstances.box_filter && c.blocks.significance <= SIGNIFICANT {
        complaints.push(
            "but over blocks of pixels they agree: under a box filter an edge that lies between two pixels has no \
             derivative; another rfilter tells"
                .into(),
        );
    } else if disagrees && circumstances.stands {
        complaints.push(format!("but {STANDS}"));
    }
    Verdict {
        outcome,
        agrees: outcome == Outcome::Agrees,
        summary: match outcome {
            Outcome::Agrees => agreement(method, t, c, tolerance),
            Outcome::Disagrees => complaints.join("; "),
            Outcome::CannotTell => ignorance(method, c, tolerance),
        },
        complaints,
        doubts: match c.is_zero {
            true => vec![
                "both gradients are zero everywhere: the image does not depend on the parameters"
                    .into(),
            ],
            false => Vec::new(),
        },
    }
}

/// Where differences with other steps are others, and those that count are all noise.
pub fn cannot_tell(method: &str, c: &Comparison, tolerance: f64) -> Verdict {
    Verdict {
        outcome: Outcome::CannotTell,
        agrees: false,
        summary: ignorance(method, c, tolerance),
        complaints: Vec::new(),
        doubts: Vec::new(),
    }
}

impl Verdict {
    /// Says what differences with other steps may be others by.
    pub fn explain(&mut self, circumstances: Circumstances) {
        if self.outcome == Outcome::CannotTell && circumstances.stands {
            self.summary += &format!("; {STANDS}");
        }
    }
}

fn agreement(method: &str, t: &Transposition, c: &Comparison, tolerance: f64) -> String {
    let same = format!(
        "Forward and backward are the same number but for {:.0e} of its magnitude.",
        t.relative_difference
    );
    if c.is_zero {
        return format!("{method} and finite differences are both zero. {same}");
    }
    format!(
        "{method} agrees with finite differences: along their image it is {:+.2} % ± {:.2} % off ({:.0} % and {SIGNIFICANT} \
         standard errors may be), and over blocks of pixels {} is left, which is {:.1} standard errors of noise. {same}",
        100.0 * c.relative_bias,
        100.0 * c.relative_bias_se,
        100.0 * tolerance,
        share(c.blocks.relative_rms, 2),
        c.blocks.significance,
    )
}

/// Why nothing can be told, and what would help.
fn ignorance(method: &str, c: &Comparison, tolerance: f64) -> String {
    let why = match c.reference_is_significant {
        true => format!(
            "along the image of finite differences {method} is {:+.1} % ± {:.1} % off, and what is looked for is {} %; that \
             needs about {} times the samples",
            100.0 * c.relative_bias,
            100.0 * c.relative_bias_se,
            100.0 * tolerance,
            two_digits((c.relative_bias_se / tolerance).powi(2)),
        ),
        false => "the finite differences do not stand out of their noise".to_string(),
    };
    format!("cannot tell: {why}. Raise --spp, or go on with --until-sure")
}

/// Rounded up.
fn two_digits(number: f64) -> f64 {
    let unit = 10_f64.powf(number.log10().floor() - 1.0).max(1.0);
    (number / unit).ceil() * unit
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_of_nothing_are_the_same() {
        let new = |forward, backward| Transposition::new(forward, backward, 100.0);
        assert!(new((0.0, 0.0), (0.0, 0.0)).agrees);
        // What moves as one cancels over its vertices, and what is left is rounding.
        assert!(new((0.0, 0.0), (-2.8e-14, 2.8e-14)).agrees);
        assert!(new((0.0, 0.0), (-2.8e-6, 1.0)).agrees);
        assert!(!new((0.0, 0.0), (-2.8e-3, 1.0)).agrees);
        assert!(!new((1.0, 1.0), (1.1, 1.1)).agrees);
    }

    #[test]
    fn a_number_of_samples_is_rounded_up() {
        for (number, shown) in [(2.1, 3.0), (64.0, 64.0), (2401.0, 2500.0)] {
            assert_eq!(two_digits(number), shown);
        }
    }
}
