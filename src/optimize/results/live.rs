//! What is shown while a run goes on.

use super::page::{self, Figure};
use super::strip::Strip;
use super::{curve, errors};
use crate::jobs::failure::Failure;
use crate::optimize::problem::Problem;
use crate::optimize::run::state::State;
use crate::output::atomic;
use crate::picture::Image;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Views on the page while it runs; all of them are on it in the end.
const MOST_VIEWS: usize = 8;

/// The first and the newest image of each view, as the loss had them.
pub struct Live {
    directory: PathBuf,
    images: BTreeMap<usize, [Image; 2]>,
}

impl Live {
    pub fn new(directory: &Path) -> Self {
        Self {
            directory: directory.into(),
            images: BTreeMap::new(),
        }
    }

    /// Keeps the images of a step.
    pub fn keep(&mut self, images: &[(usize, Image)]) {
        for (view, image) in images {
            match self.images.get_mut(view) {
                // A first one of another size cannot stand beside it.
                Some([first, newest]) => {
                    if first.width != image.width {
                        *first = image.clone();
                    }
                    *newest = image.clone();
                }
                None => {
                    self.images.insert(*view, [image.clone(), image.clone()]);
                }
            }
        }
    }

    /// Writes the curve, the strips and the page as they are.
    pub fn write(&self, problem: &Problem, state: &State) -> Result<(), Failure> {
        curve::write(&self.directory, problem, state)?;
        let mut figures = Vec::new();
        for (&number, [first, newest]) in self.images.iter().take(MOST_VIEWS) {
            let view = &problem.views[number];
            let factor = view.target.width / newest.width.max(1);
            let (target, weights) = problem.counted(view, factor.max(1));
            let png = Strip::new([first, newest, &target], weights.as_deref()).png()?;
            let name = page::of_view(&view.name);
            atomic::write(&self.directory.join(name), |file| file.write_all(&png))?;
            figures.push(Figure {
                caption: format!("{}: start, now, target, difference", view.name),
                png,
            });
        }
        let errors = errors::all(problem, state);
        let html = page::html(problem, state, &figures, &errors, &[], true);
        atomic::write(&self.directory.join(page::NAME), |file| {
            file.write_all(html.as_bytes())
        })?;
        Ok(())
    }
}
