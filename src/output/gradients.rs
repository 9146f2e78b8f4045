//! From independent groups of samples to named gradients with standard errors.

use super::tensors::Tensor;
use crate::picture::Image;
use crate::scene::Scene;
use crate::scene::parameters::{Gradient, Parameter};
use crate::statistics::estimate::Estimate;

/// Ends the name of a gradient's standard error.
pub const STANDARD_ERROR: &str = "#se";

/// Each group's gradient of one parameter.
pub fn reduced(scene: &Scene, parameter: &Parameter, groups: &[Gradient]) -> Vec<Vec<f32>> {
    // Reduced first: the parts of a sum are not independent within a group.
    let groups = groups.iter();
    groups.map(|group| group.by(scene, parameter)).collect()
}

/// The mean of the groups under `name`, followed by its standard error if it is wanted and can be
/// told.
pub fn of_groups(
    name: &str,
    shape: &[usize],
    groups: &[Vec<f32>],
    standard_error: bool,
) -> Vec<Tensor> {
    let tensor = |name: String, values| Tensor {
        name,
        shape: shape.to_vec(),
        values,
    };
    let numbers = groups.first().map_or(0, Vec::len);
    let estimates: Vec<Estimate> = (0..numbers)
        .map(|i| Estimate::mean_of(groups.iter().map(move |group| f64::from(group[i]))))
        .collect();
    let values = estimates.iter().map(|e| e.value as f32).collect();
    let mut tensors = vec![tensor(name.into(), values)];
    if standard_error && groups.len() > 1 {
        let name = format!("{name}{STANDARD_ERROR}");
        let errors = estimates.iter().map(|e| e.error as f32).collect();
        tensors.push(tensor(name, errors));
    }
    tensors
}

/// The root of the sum of squares.
pub fn norm<'a>(values: impl IntoIterator<Item = &'a f32>) -> f64 {
    let squares = values.into_iter().map(|v| (*v as f64).powi(2));
    squares.sum::<f64>().sqrt()
}

/// The root of the mean square over pixels and channels.
pub fn rms(image: &Image) -> f64 {
    norm(image.pixels.iter().flatten()) / ((3 * image.pixels.len()).max(1) as f64).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_standard_error_is_that_of_the_mean() {
        let groups: Vec<Vec<f32>> = (0..16).map(|g| vec![g as f32, 1.0]).collect();
        let tensors = of_groups("a", &[2], &groups, true);
        assert_eq!(tensors[0].values, [7.5, 1.0]);
        assert_eq!(tensors[1].name, "a#se");
        let se = &tensors[1].values;
        assert!(
            (se[0] - 4.760_952_3 / 4.0).abs() < 1e-5 && se[1] == 0.0,
            "{se:?}"
        );
        assert_eq!(of_groups("a", &[2], &groups, false).len(), 1);
        assert_eq!(of_groups("a", &[2], &groups[..1], true).len(), 1);
    }
}
