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
use std::time::{Duration, Instant};

/// Views on the page while it runs; all of them are on it in the end.
const MOST_VIEWS: usize = 8;

/// From the first step on until the first page: whoever opens it soon shall see something.
const FIRST: Duration = Duration::from_secs(1);
/// From one page to the next,
const BETWEEN: Duration = Duration::from_secs(10);
/// but never more than one part in so many of the whole time for pages.
const PARTS: u32 = 20;

/// The first and the newest image of each view, as the loss had them.
pub struct Live {
    directory: PathBuf,
    images: BTreeMap<usize, [Image; 2]>,
    /// When the page is to be written again.
    due: Instant,
}

impl Live {
    pub fn new(directory: &Path) -> Self {
        Self {
            directory: directory.into(),
            images: BTreeMap::new(),
            due: Instant::now() + FIRST,
        }
    }

    /// Whether the page is old enough to be written again. No result depends on that: all files of
    /// the page are written anew in the end.
    pub fn is_due(&self) -> bool {
        Instant::now() >= self.due
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
    pub fn write(
        &mut self,
        problem: &Problem,
        state: &State,
        is_running: bool,
    ) -> Result<(), Failure> {
        let started = Instant::now();
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
        let html = page::html(problem, state, &figures, &errors, &[], is_running);
        atomic::write(&self.directory.join(page::NAME), |file| {
            file.write_all(html.as_bytes())
        })?;
        self.due = Instant::now() + BETWEEN.max(PARTS * started.elapsed());
        Ok(())
    }
}
