//! How two numbers are compared.

use crate::optimize::config::Pointwise;

/// Keeps the relative loss finite where the target is black.
const RELATIVE_FLOOR: f64 = 0.01;

/// The loss of `value` against `target`, and its derivative by `value`.
pub fn of(kind: Pointwise, value: f64, target: f64) -> (f64, f64) {
    let difference = value - target;
    match kind {
        Pointwise::L1 if difference == 0.0 => (0.0, 0.0),
        Pointwise::L1 => (difference.abs(), difference.signum()),
        Pointwise::L2 => (difference * difference, 2.0 * difference),
        // By the target's brightness: that of the image is noise, which would bias the derivative.
        Pointwise::RelativeL2 => {
            let scale = 1.0 / (target * target + RELATIVE_FLOOR);
            (difference * difference * scale, 2.0 * difference * scale)
        }
        // What is below zero is noise of nobody's making, and taken for black.
        Pointwise::Log => {
            let log = |v: f64| v.max(0.0).ln_1p();
            let distance = log(value) - log(target);
            let slope = if value > 0.0 {
                1.0 / (1.0 + value)
            } else {
                1.0
            };
            (distance * distance, 2.0 * distance * slope)
        }
    }
}
