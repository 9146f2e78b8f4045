//! What is said of a method on a direction.

use super::quantities::Figures;
use super::reference::Reference;
use serde::{Deserialize, Serialize};

/// Beyond so many sigmas a method is biased.
const BIASED_SIGMAS: f64 = 4.0;
/// Where one repeat has more of the variance of all, the variance is not known at all.
const UNSTABLE_SHARE: f64 = 0.5;
/// Fewer repeats have a worst one that says nothing.
const LEAST_REPEATS: usize = 8;
/// A size that is not known better says nothing.
const VAGUE: f64 = 0.1;

/// What is said of a method on a direction.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Verdict {
    pub kind: Kind,
    pub text: String,
}

/// In a word.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    Right,
    Biased,
    Unstable,
    Refused,
    /// Noise, of the method or of the reference, hides what is asked.
    Unknown,
}

impl Kind {
    pub const ALL: [(&str, Self); 5] = [
        ("right", Kind::Right),
        ("biased", Kind::Biased),
        ("unstable", Kind::Unstable),
        ("refused", Kind::Refused),
        ("unknown", Kind::Unknown),
    ];

    pub fn name(self) -> &'static str {
        let named = Self::ALL.iter().find(|(_, kind)| *kind == self);
        named.map_or("", |(name, _)| name)
    }
}

impl Verdict {
    /// Of a method that refuses the scene.
    pub fn refused(sentence: &str) -> Self {
        Self {
            kind: Kind::Refused,
            text: sentence.into(),
        }
    }

    /// Of what was measured.
    pub fn of(figures: &Figures, repeats: usize, reference: &Reference) -> Self {
        let (kind, text) = judge(figures, repeats, reference);
        Self { kind, text }
    }
}

fn judge(f: &Figures, repeats: usize, reference: &Reference) -> (Kind, String) {
    if f.not_finite > 0 {
        let text = format!("{} numbers of the gradient are not finite", f.not_finite);
        return (Kind::Unstable, text);
    }
    if !reference.ladder.agrees {
        let text = "finite differences of different steps disagree with each other";
        return (Kind::Unknown, text.into());
    }
    let size = match (f.size_bias, f.size_bias_se) {
        (Some(bias), Some(se)) => format!("size {} ± {}", signed(bias), percent(se)),
        _ => "no gradient to be relative to".into(),
    };
    let left = f.bias_squared.max(0.0).sqrt();
    if f.bias_sigmas >= BIASED_SIGMAS {
        let of = if reference.rms.is_some() {
            percent(left)
        } else {
            format!("{left:.2e}")
        };
        return (
            Kind::Biased,
            format!("{size}; root mean square of the bias {of}"),
        );
    }
    if let Some(share) = f.worst_repeat_share.filter(|_| repeats >= LEAST_REPEATS)
        && share > UNSTABLE_SHARE
    {
        let text = format!(
            "one repeat of {repeats} has {} of the variance",
            percent(share)
        );
        return (Kind::Unstable, text);
    }
    match (reference.rms, f.size_bias_se) {
        (None, _) => judge_zero(f, reference),
        (Some(_), Some(se)) if se <= VAGUE && is_small(f, se) => (Kind::Right, size),
        _ => (Kind::Unknown, size),
    }
}

/// Of a bias that too few runs leave below the sigmas that are asked for: whether it is one by its
/// own standard error.
fn is_small(f: &Figures, size_se: f64) -> bool {
    let size = f.size_bias.unwrap_or(0.0).abs();
    size <= BIASED_SIGMAS * size_se && f.bias_squared <= BIASED_SIGMAS * f.bias_squared_se
}

/// Where the reference has nothing that stands out of its noise.
fn judge_zero(f: &Figures, reference: &Reference) -> (Kind, String) {
    if reference.noise() > reference.rounding {
        return (Kind::Unknown, "the reference is nothing but noise".into());
    }
    match f.rmse <= reference.rounding {
        true => (Kind::Right, "zero, as it should be".into()),
        false => (Kind::Right, format!("zero within a noise of {:.1e}", f.sd)),
    }
}

/// `0.25 %`, or more digits for what is smaller.
pub fn percent(share: f64) -> String {
    let value = 100.0 * share;
    match value.abs() {
        x if x >= 10.0 => format!("{value:.0} %"),
        x if x >= 1.0 => format!("{value:.1} %"),
        x if x >= 0.01 || x == 0.0 => format!("{value:.2} %"),
        _ => format!("{value:.0e} %"),
    }
}

/// The same with its sign.
pub fn signed(share: f64) -> String {
    let sign = if share < 0.0 { "−" } else { "+" };
    format!("{sign}{}", percent(share.abs()))
}
