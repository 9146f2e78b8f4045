//! How far parameters are from a scene that is known.

use crate::optimize::problem::Problem;
use crate::optimize::problem::variable::present;
use crate::optimize::run::state::State;
use crate::scene::parameters;
use serde::Serialize;

/// The distance of a parameter from its truth.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ParameterError {
    pub key: String,
    /// Root mean squares of the differences of its numbers: at the start, and now.
    pub start: f64,
    pub end: f64,
    /// The largest difference now.
    pub largest: f64,
}

/// Of all parameters that the known scene has too, with as many numbers.
pub fn all(problem: &Problem, state: &State) -> Vec<ParameterError> {
    let Some(truth) = &problem.truth else {
        return Vec::new();
    };
    let values = state.values(problem);
    let mut errors = Vec::new();
    for (variable, values) in problem.variables.iter().zip(values) {
        let Ok(parameter) = parameters::find(truth, &variable.parameter.key) else {
            continue;
        };
        let wanted = present(truth, &parameter);
        let Ok(start) = variable.start(&problem.base.scene) else {
            continue;
        };
        if wanted.len() != values.len() || wanted.len() != start.len() {
            continue;
        }
        let values: Vec<f64> = values.iter().map(|&v| f64::from(v)).collect();
        let largest = values.iter().zip(&wanted).map(|(a, b)| (a - b).abs());
        errors.push(ParameterError {
            key: variable.parameter.key.clone(),
            start: distance(&start, &wanted),
            end: distance(&values, &wanted),
            largest: largest.fold(0.0, f64::max),
        });
    }
    errors
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    let squares: f64 = a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum();
    (squares / a.len().max(1) as f64).sqrt()
}
