//! Recurrences that turn gradients into steps.

use super::config::Kind;

/// The numbers of an optimiser at one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    pub kind: Kind,
    pub lr: f64,
    pub momentum: f64,
    pub betas: [f64; 2],
    pub epsilon: f64,
    pub weight_decay: f64,
    /// No number goes farther than this.
    pub max_step: Option<f64>,
}

/// What an optimiser remembers of one parameter.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Memory {
    /// Steps made.
    pub steps: u64,
    /// Running mean of gradients, or the velocity.
    pub first: Vec<f64>,
    /// Running mean of their squares; empty for gradient descent.
    pub second: Vec<f64>,
}

impl Memory {
    /// Nothing yet, of so many numbers.
    pub fn new(numbers: usize, kind: Kind) -> Self {
        let second = if kind == Kind::Sgd { 0 } else { numbers };
        Self {
            steps: 0,
            first: vec![0.0; numbers],
            second: vec![0.0; second],
        }
    }

    /// Moves `x` by one step. Recurrences and the order of their operations are those that PyTorch
    /// documents for `SGD`, `Adam` and `AdamW`; `Uniform` divides by the largest second moment of
    /// all numbers \[Nicolet2021\]. Returns whether `max_step` has shortened the step.
    pub fn step(&mut self, rates: &Rates, x: &mut [f64], gradient: &[f64]) -> bool {
        self.steps += 1;
        let step = match rates.kind {
            Kind::Sgd => self.descent(rates, gradient),
            Kind::Adam | Kind::AdamW | Kind::Uniform => self.adaptive(rates, gradient),
        };
        let longest = step.iter().fold(0.0f64, |most, s| most.max(s.abs()));
        let most = rates.max_step.unwrap_or(f64::INFINITY);
        let scale = if longest > most { most / longest } else { 1.0 };
        let decay = match rates.kind {
            Kind::AdamW => 1.0 - rates.lr * rates.weight_decay,
            _ => 1.0,
        };
        for (x, step) in x.iter_mut().zip(step) {
            *x = *x * decay - scale * step;
        }
        longest > most
    }

    fn descent(&mut self, rates: &Rates, gradient: &[f64]) -> Vec<f64> {
        let is_first = self.steps == 1;
        for (velocity, g) in self.first.iter_mut().zip(gradient) {
            *velocity = if is_first {
                *g
            } else {
                rates.momentum * *velocity + g
            };
        }
        self.first.iter().map(|v| rates.lr * v).collect()
    }

    fn adaptive(&mut self, rates: &Rates, gradient: &[f64]) -> Vec<f64> {
        let [beta1, beta2] = rates.betas;
        for (mean, g) in self.first.iter_mut().zip(gradient) {
            *mean = beta1 * *mean + (1.0 - beta1) * g;
        }
        for (square, g) in self.second.iter_mut().zip(gradient) {
            *square = beta2 * *square + (1.0 - beta2) * g * g;
        }
        let correction = |beta: f64| 1.0 - beta.powf(self.steps as f64);
        let (first, second) = (correction(beta1), correction(beta2));
        let root = |square: f64| (square / second).sqrt();
        let uniform = match rates.kind {
            Kind::Uniform => Some(root(self.second.iter().fold(0.0, |a: f64, &b| a.max(b)))),
            _ => None,
        };
        let pairs = self.first.iter().zip(&self.second);
        pairs
            .map(|(mean, square)| {
                let scale = uniform.unwrap_or_else(|| root(*square)) + rates.epsilon;
                rates.lr * (mean / first) / scale
            })
            .collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn rates(kind: Kind) -> Rates {
        Rates {
            kind,
            lr: 0.1,
            momentum: 0.5,
            betas: [0.9, 0.999],
            epsilon: 1e-8,
            weight_decay: 0.1,
            max_step: None,
        }
    }

    fn run(kind: Kind, gradients: &[[f64; 2]]) -> Vec<f64> {
        let mut memory = Memory::new(2, kind);
        let mut x = vec![1.0, -2.0];
        for gradient in gradients {
            memory.step(&rates(kind), &mut x, gradient);
        }
        x
    }

    fn close(found: &[f64], wanted: &[f64]) {
        for (a, b) in found.iter().zip(wanted) {
            assert!((a - b).abs() < 1e-12, "{found:?} {wanted:?}");
        }
    }

    /// Two steps by hand, from the formulas of PyTorch's documentation.
    #[test]
    fn the_recurrences_are_the_documented_ones() {
        let gradients = [[0.5, -1.0], [0.25, 2.0]];
        // b = g, then 0.5 g + g'.
        close(
            &run(Kind::Sgd, &gradients),
            &[1.0 - 0.05 - 0.05, -2.0 + 0.1 - 0.15],
        );
        // After one step the corrected moments are g and g², so each number moves by lr.
        close(
            &run(Kind::Adam, &gradients[..1]),
            &[
                1.0 - 0.1 * 0.5 / (0.5 + 1e-8),
                -2.0 + 0.1 * 1.0 / (1.0 + 1e-8),
            ],
        );
        let second = |g: f64, h: f64| {
            let mean = (0.9 * 0.1 * g + 0.1 * h) / (1.0 - 0.81);
            let square = (0.999 * 0.001 * g * g + 0.001 * h * h) / (1.0 - 0.999f64.powi(2));
            0.1 * mean / (square.sqrt() + 1e-8)
        };
        let adam = [
            1.0 - 0.1 * 0.5 / (0.5 + 1e-8) - second(0.5, 0.25),
            -2.0 + 0.1 / (1.0 + 1e-8) - second(-1.0, 2.0),
        ];
        close(&run(Kind::Adam, &gradients), &adam);
        // The same steps, after each number has shrunk by lr times the decay.
        let first = [0.99 - 0.05 / (0.5 + 1e-8), -1.98 + 0.1 / (1.0 + 1e-8)];
        let adamw = [
            0.99 * first[0] - second(0.5, 0.25),
            0.99 * first[1] - second(-1.0, 2.0),
        ];
        close(&run(Kind::AdamW, &gradients), &adamw);
        // One scale, that of the number that moves most.
        close(
            &run(Kind::Uniform, &gradients[..1]),
            &[1.0 - 0.1 * 0.5 / (1.0 + 1e-8), -2.0 + 0.1 / (1.0 + 1e-8)],
        );
    }

    /// x² / 2 has the gradient x: descent multiplies by 1 − lr.
    #[test]
    fn descent_on_a_parabola_has_its_closed_form() {
        let mut memory = Memory::new(1, Kind::Sgd);
        let rates = Rates {
            momentum: 0.0,
            ..rates(Kind::Sgd)
        };
        let mut x = vec![3.0];
        for _ in 0..20 {
            let gradient = x.clone();
            memory.step(&rates, &mut x, &gradient);
        }
        close(&x, &[3.0 * 0.9f64.powi(20)]);
    }

    #[test]
    fn long_steps_are_shortened_together() {
        let mut memory = Memory::new(2, Kind::Sgd);
        let rates = Rates {
            max_step: Some(0.01),
            ..rates(Kind::Sgd)
        };
        let mut x = vec![0.0, 0.0];
        assert!(memory.step(&rates, &mut x, &[4.0, -2.0]));
        close(&x, &[-0.01, 0.005]);
    }
}
