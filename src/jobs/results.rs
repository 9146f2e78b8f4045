//! What a job has computed.

use crate::methods::{ForwardGradient, Statistics};
use crate::output::gradients;
use crate::output::results::{self, NotFinite, ResultFile};
use crate::output::tensors::Tensor;
use crate::picture::Image;

/// What a job has computed.
pub enum Results {
    Image(Image),
    Forward(Box<ForwardGradient>),
    Backward {
        gradients: Vec<Tensor>,
        image: Image,
    },
}

/// Results with what is said of them.
pub struct Done {
    pub results: Results,
    pub loss: Option<f64>,
    pub statistics: Statistics,
}

impl Results {
    /// The files of these results.
    pub fn files(&self) -> Result<Vec<ResultFile<'_>>, NotFinite> {
        match self {
            Results::Image(image) => results::rendered(image),
            Results::Forward(done) => results::forward(done),
            Results::Backward { gradients, image } => results::backward(gradients, image),
        }
    }

    /// The norm of each gradient and of its standard error.
    pub fn norms(&self) -> Vec<(String, f64)> {
        let of_image = |image: &Image| gradients::norm(image.pixels.iter().flatten());
        match self {
            Results::Image(_) => Vec::new(),
            Results::Forward(done) => {
                let mut norms = vec![("gradient".to_string(), of_image(&done.gradient))];
                let name = format!("gradient{}", gradients::STANDARD_ERROR);
                norms.extend(
                    done.stderr
                        .iter()
                        .map(|image| (name.clone(), of_image(image))),
                );
                norms
            }
            Results::Backward { gradients, .. } => gradients
                .iter()
                .map(|tensor| (tensor.name.clone(), gradients::norm(&tensor.values)))
                .collect(),
        }
    }
}
