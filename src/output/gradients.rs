//! From independent groups of samples to named gradients with standard errors.

use super::tensors::Tensor;
use crate::methods::Image;
use crate::scene::parameters::{self, Parameter};
use crate::scene::{Scene, SceneDifferential};

/// Ends the name of a gradient's standard error.
pub const STANDARD_ERROR: &str = "#se";

/// Each group's gradient of one parameter.
pub fn reduced(
    scene: &Scene,
    parameter: &Parameter,
    groups: &[SceneDifferential],
) -> Vec<Vec<f32>> {
    // Reduced first: the parts of a sum are not independent within a group.
    let groups = groups.iter();
    groups
        .map(|group| parameters::reduce(scene, parameter, group))
        .collect()
}

/// The mean of the groups under `name`, followed by its standard error if it is wanted and can be told.
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
    let mut tensors = vec![tensor(name.into(), mean(groups))];
    if standard_error && groups.len() > 1 {
        let name = format!("{name}{STANDARD_ERROR}");
        tensors.push(tensor(name, error_of_mean(groups)));
    }
    tensors
}

/// The mean of equally weighted estimates, number by number.
fn mean(groups: &[Vec<f32>]) -> Vec<f32> {
    let n = groups.len() as f64;
    let numbers = groups.first().map_or(0, Vec::len);
    (0..numbers)
        .map(|i| (groups.iter().map(|group| group[i] as f64).sum::<f64>() / n) as f32)
        .collect()
}

/// The standard error of the mean of independent, equally weighted estimates, number by number.
fn error_of_mean(groups: &[Vec<f32>]) -> Vec<f32> {
    let n = groups.len() as f64;
    let numbers = groups.first().map_or(0, Vec::len);
    (0..numbers)
        .map(|i| {
            let mean = groups.iter().map(|group| group[i] as f64).sum::<f64>() / n;
            let squares: f64 = groups
                .iter()
                .map(|group| (group[i] as f64 - mean).powi(2))
                .sum();
            (squares / (n - 1.0) / n).sqrt() as f32
        })
        .collect()
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
