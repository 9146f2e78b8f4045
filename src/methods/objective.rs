//! Functions of the image: their values, and their derivatives by it.

use super::error::EngineError;
use super::prepared::Prepared;
use super::progress::Progress;
use super::render::render;
use super::settings::Settings;
use super::statistics::Statistics;
use crate::picture::Image;
use crate::room;

/// The image that an objective is measured on gets its own random numbers: a loss and its
/// derivative from the same samples would be correlated, and the gradient biased (METHODS §6).
const OBJECTIVE_SEED: u64 = 0x9e37_79b9_7f4a_7c15;

/// The function of the image whose gradient [`backward`](super::backward()) computes.
#[derive(Clone, Copy, Debug)]
pub enum Objective<'a> {
    /// The sum over pixels and channels of image times this.
    Adjoint(&'a Image),
    /// The mean over pixels and channels of |image − target|.
    L1(&'a Image),
    /// The mean over pixels and channels of (image − target)².
    L2(&'a Image),
}

/// An objective at the present parameters.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// Its value; 0 for [`Objective::Adjoint`], whose value is known after its backward pass.
    pub loss: f64,
    /// Its derivative by the image.
    pub adjoint: Image,
    /// The image it was measured on, if one had to be rendered for that.
    pub image: Option<Image>,
    pub statistics: Statistics,
}

/// The objective's value and derivative by the image, and the image they were taken at.
pub fn evaluate(
    prepared: &Prepared,
    settings: &Settings,
    objective: &Objective,
    progress: &dyn Progress,
) -> Result<Evaluation, EngineError> {
    let (target, is_l1) = match objective {
        Objective::Adjoint(adjoint) => {
            return Ok(Evaluation {
                loss: 0.0,
                adjoint: Image {
                    pixels: room::copy(&adjoint.pixels)?,
                    ..**adjoint
                },
                image: None,
                statistics: Statistics::default(),
            });
        }
        Objective::L1(target) => (target, true),
        Objective::L2(target) => (target, false),
    };
    let settings = Settings {
        seed: settings.seed ^ OBJECTIVE_SEED,
        // Whoever does a part of the samples needs the same whole image.
        groups: None,
        // What noise is known of is that of the gradient.
        noise: None,
        ..settings.clone()
    };
    let rendering = render(prepared, &settings, progress)?;
    let mut statistics = Statistics::default();
    statistics.absorb(&rendering.statistics);
    let image = rendering.image;
    check_size(target, [image.width, image.height])?;
    let scale = 1.0 / (3 * image.pixels.len()) as f64;
    let mut loss = 0.0;
    let derivative = |value: f32, target: f32, loss: &mut f64| {
        let difference = f64::from(value) - f64::from(target);
        let slope = if is_l1 {
            *loss += difference.abs() * scale;
            if difference == 0.0 {
                0.0
            } else {
                difference.signum()
            }
        } else {
            *loss += difference * difference * scale;
            2.0 * difference
        };
        (slope * scale) as f32
    };
    let pixels = image
        .pixels
        .iter()
        .zip(&target.pixels)
        .map(|(value, target)| std::array::from_fn(|c| derivative(value[c], target[c], &mut loss)))
        .collect();
    let adjoint = Image {
        width: image.width,
        height: image.height,
        pixels,
    };
    Ok(Evaluation {
        loss,
        adjoint,
        image: Some(image),
        statistics,
    })
}

pub fn check_size(image: &Image, [width, height]: [usize; 2]) -> Result<(), EngineError> {
    if [image.width, image.height] == [width, height] {
        return Ok(());
    }
    Err(EngineError::Refused(format!(
        "the image given has {}×{} pixels, the rendering has {width}×{height}",
        image.width, image.height
    )))
}

/// The sum over pixels and channels of the products: the value of [`Objective::Adjoint`].
pub fn inner_product(a: &Image, b: &Image) -> f64 {
    a.pixels
        .iter()
        .flatten()
        .zip(b.pixels.iter().flatten())
        .map(|(x, y)| *x as f64 * *y as f64)
        .sum()
}
