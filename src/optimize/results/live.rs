//! What is shown while a run goes on.

use crate::jobs::failure::Failure;
use crate::optimize::problem::Problem;
use crate::optimize::run::state::State;
use crate::picture::Image;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The newest image of each view.
pub struct Live {
    directory: PathBuf,
    newest: BTreeMap<usize, Image>,
}

impl Live {
    pub fn new(directory: &Path) -> Self {
        Self {
            directory: directory.into(),
            newest: BTreeMap::new(),
        }
    }

    /// Keeps the images of a step.
    pub fn keep(&mut self, images: &[(usize, Image)]) {
        for (view, image) in images {
            self.newest.insert(*view, image.clone());
        }
    }

    /// Writes the curve as it is.
    pub fn write(&self, problem: &Problem, state: &State) -> Result<(), Failure> {
        super::curve::write(&self.directory, problem, state)
    }
}
