//! How far parameters are from a scene that is known.

use crate::optimize::problem::Problem;
use crate::optimize::problem::variable::{Variable, present};
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
    /// The median and the largest difference now. Texels that no pixel sees are far off, and weigh
    /// in a mean of squares.
    pub median: f64,
    pub largest: f64,
    /// Of textures, `start` and `end` where texels count by how much the views change with them.
    pub seen_start: Option<f64>,
    pub seen_end: Option<f64>,
}

/// Of all parameters that the known scene has too, with as many numbers.
pub fn all(problem: &Problem, state: &State) -> Vec<ParameterError> {
    let values = state.values(problem);
    let mut errors = Vec::new();
    for (variable, values) in problem.variables.iter().zip(values) {
        let Some(wanted) = wanted(problem, variable) else {
            continue;
        };
        let Ok(start) = variable.start(&problem.base.scene) else {
            continue;
        };
        if wanted.len() != values.len() || wanted.len() != start.len() {
            continue;
        }
        let values: Vec<f64> = values.iter().map(|&v| f64::from(v)).collect();
        let pairs = values.iter().zip(&wanted);
        let mut differences: Vec<f64> = pairs.map(|(a, b)| (a - b).abs()).collect();
        differences.sort_by(f64::total_cmp);
        errors.push(ParameterError {
            key: variable.parameter.key.clone(),
            start: distance(&start, &wanted, None),
            end: distance(&values, &wanted, None),
            median: differences.get(values.len() / 2).copied().unwrap_or(0.0),
            largest: differences.last().copied().unwrap_or(0.0),
            seen_start: None,
            seen_end: None,
        });
    }
    errors
}

/// By variable, the root mean square of the differences of its values from the known scene's; none
/// where that has no such parameter or one of other numbers.
pub fn now(problem: &Problem, values: &[Vec<f32>]) -> Vec<Option<f64>> {
    let pairs = problem.variables.iter().zip(values);
    pairs
        .map(|(variable, values)| {
            let wanted = wanted(problem, variable).filter(|w| w.len() == values.len())?;
            let values: Vec<f64> = values.iter().map(|&v| f64::from(v)).collect();
            Some(distance(&values, &wanted, None))
        })
        .collect()
}

/// A parameter's numbers in the known scene.
pub fn wanted(problem: &Problem, variable: &Variable) -> Option<Vec<f64>> {
    let truth = problem.truth.as_ref()?;
    let parameter = parameters::find(truth, &variable.parameter.key).ok()?;
    Some(present(truth, &parameter))
}

/// The root of the mean of squared differences, by weights if there are any.
pub fn distance(a: &[f64], b: &[f64], weights: Option<&[f64]>) -> f64 {
    let (mut squares, mut sum) = (0.0, 0.0);
    for (i, (a, b)) in a.iter().zip(b).enumerate() {
        let weight = weights.map_or(1.0, |weights| weights[i]);
        squares += weight * (a - b).powi(2);
        sum += weight;
    }
    if sum > 0.0 {
        (squares / sum).sqrt()
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::distance;

    #[test]
    fn what_nobody_sees_does_not_count() {
        let (a, b) = ([0.1, 0.9, 0.5], [0.1, 0.2, 0.8]);
        assert!((distance(&a, &b, None) - (0.58f64 / 3.0).sqrt()).abs() < 1e-12);
        assert!((distance(&a, &b, Some(&[2.0, 0.0, 1.0])) - 0.03f64.sqrt()).abs() < 1e-12);
        assert_eq!(distance(&a, &b, Some(&[0.0; 3])), 0.0);
    }
}
