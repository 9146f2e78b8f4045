//! Total variation: what keeps textures from fitting noise \[Rudin1992\].

use super::found::Evaluation;
use crate::optimize::problem::Problem;
use crate::scene::Layout;
use crate::scene::parameters::Target;

/// Differences below this are smoothed, so that equal neighbours have a derivative.
const SMOOTHED: f64 = 1e-3;

/// Adds each texture's total variation to the loss, and its derivative to the gradient.
pub fn add(problem: &Problem, values: &[Vec<f32>], done: &mut Evaluation) {
    for (i, variable) in problem.variables.iter().enumerate() {
        let weight = variable.settings.total_variation;
        if let Some(Target::Texels(t)) = variable.parameter.target
            && weight > 0.0
        {
            let texture = &problem.base.scene.textures[t];
            if let Layout::Bitmap { width, .. } = texture.layout {
                let numbers: Vec<f64> = values[i].iter().map(|&v| f64::from(v)).collect();
                let (value, slopes) = of(&numbers, width as usize, texture.channels);
                done.penalty += weight * value;
                for (g, slope) in done.gradients[i].iter_mut().zip(slopes) {
                    *g += weight * slope;
                }
            }
        }
    }
}

/// The mean over texels and channels of √(dx² + dy² + ε²), and its derivative.
pub fn of(numbers: &[f64], width: usize, channels: usize) -> (f64, Vec<f64>) {
    let height = numbers.len() / channels / width;
    let scale = 1.0 / numbers.len() as f64;
    let at = |x: usize, y: usize, c: usize| (y * width + x) * channels + c;
    let mut sum = 0.0;
    let mut slopes = vec![0.0; numbers.len()];
    for y in 0..height {
        for x in 0..width {
            for c in 0..channels {
                let here = at(x, y, c);
                let right = at((x + 1).min(width - 1), y, c);
                let below = at(x, (y + 1).min(height - 1), c);
                let [dx, dy] = [right, below].map(|there| numbers[there] - numbers[here]);
                let length = (dx * dx + dy * dy + SMOOTHED * SMOOTHED).sqrt();
                sum += scale * length;
                for (there, d) in [(right, dx), (below, dy)] {
                    slopes[there] += scale * d / length;
                    slopes[here] -= scale * d / length;
                }
            }
        }
    }
    (sum, slopes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn its_derivative_is_that_of_differences() {
        let mut numbers: Vec<f64> = (0..4 * 3 * 3).map(|i| (i as f64 * 1.7).sin()).collect();
        let (_, slopes) = of(&numbers, 4, 3);
        for i in 0..numbers.len() {
            let h = 1e-6;
            let here = numbers[i];
            numbers[i] = here + h;
            let above = of(&numbers, 4, 3).0;
            numbers[i] = here - h;
            let below = of(&numbers, 4, 3).0;
            numbers[i] = here;
            assert!(((above - below) / (2.0 * h) - slopes[i]).abs() < 1e-8);
        }
        assert!(of(&[0.5; 36], 4, 3).0 < 1.001e-3);
    }
}
