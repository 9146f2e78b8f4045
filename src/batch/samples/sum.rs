//! The groups of a job's samples, added up in their order.

use super::share::{as_image, of_group};
use crate::batch::results::line::Share;
use crate::jobs::failure::Failure;
use crate::jobs::mode::Mode;
use crate::jobs::results::Results;
use crate::methods::{ForwardGradient, Image};
use crate::output::FileError;
use crate::output::gradients;
use crate::output::tensors::{Tensor, TensorFile};
use crate::room::NoRoom;
use crate::statistics::image_mean::ImageMean;
use std::collections::BTreeMap;

/// All groups of a job.
pub struct Sum<'a> {
    pub share: &'a Share,
    pub files: Vec<TensorFile>,
    /// The file of each group.
    pub owner: BTreeMap<u32, usize>,
}

impl Sum<'_> {
    /// Refuses files without the tensors that make the results.
    pub fn check(&self) -> Result<(), FileError> {
        let names: Vec<&str> = match self.share.mode {
            Mode::Render => vec!["image"],
            Mode::Forward => vec!["image", "gradient"],
            Mode::Backward => self.share.keys.iter().map(String::as_str).collect(),
        };
        for (group, file) in &self.owner {
            for name in &names {
                self.files[*file].entry(&of_group(name, *group))?;
            }
        }
        Ok(())
    }

    /// The results, and the adjoint if the job had one.
    pub fn results(&self) -> Result<(Results, Option<Image>), Failure> {
        match self.share.mode {
            Mode::Render => Ok((Results::Image(self.mean("image")?.0), None)),
            Mode::Forward => {
                let (image, _) = self.mean("image")?;
                let (gradient, stderr) = self.mean("gradient")?;
                let done = ForwardGradient {
                    image,
                    gradient,
                    stderr: stderr.filter(|_| self.share.stderr),
                    ..ForwardGradient::default()
                };
                Ok((Results::Forward(Box::new(done)), None))
            }
            Mode::Backward => {
                let first = &self.files[self.owner[&0]];
                let mut gradients = Vec::new();
                for key in &self.share.keys {
                    let groups = self.groups(key)?;
                    let shape = groups[0].shape.clone();
                    let values: Vec<Vec<f32>> = groups.into_iter().map(|g| g.values).collect();
                    gradients.extend(gradients::of_groups(
                        key,
                        &shape,
                        &values,
                        self.share.stderr,
                    ));
                }
                let image = match first.get("image") {
                    Ok(whole) => as_image(&whole),
                    Err(_) => self.mean("image")?.0,
                };
                let adjoint = first.get("adjoint").ok().map(|a| as_image(&a));
                Ok((Results::Backward { gradients, image }, adjoint))
            }
        }
    }

    /// A tensor of every group, in their order.
    fn groups(&self, name: &str) -> Result<Vec<Tensor>, Failure> {
        let of = |(group, file): (&u32, &usize)| self.files[*file].get(&of_group(name, *group));
        Ok(self.owner.iter().map(of).collect::<Result<_, _>>()?)
    }

    fn mean(&self, name: &str) -> Result<(Image, Option<Image>), Failure> {
        let groups: Vec<Image> = self.groups(name)?.iter().map(as_image).collect();
        let no_room = |error: NoRoom| Failure::System(error.to_string());
        let (width, height) = (groups[0].width, groups[0].height);
        let mut mean = ImageMean::new(width * height, self.share.groups).map_err(no_room)?;
        for group in &groups {
            mean.add(&group.pixels);
        }
        let (mean, error) = mean.finish().map_err(no_room)?;
        let image = |pixels| Image {
            width,
            height,
            pixels,
        };
        Ok((image(mean), error.map(image)))
    }
}
