//! The repeats of all cells of a direction, each alone on the machine and the methods in turns.

use super::cell::{Cell, Times};
use super::config::Contestant;
use super::figures;
use super::one_run::Run;
use super::reference::Reference;
use super::task::Task;
use super::verdict::Verdict;
use crate::jobs::failure::Failure;
use crate::jobs::machine;
use crate::jobs::seeds::nth_seed;
use crate::methods::{
    self, EngineError, Image, Method, NoiseMap, Prepared, Progress, Question, Settings,
};
use std::sync::Arc;
use std::time::Instant;

/// What a method other than finite differences takes, in camera paths of an image, about.
const GRADIENT_IMAGES: u64 = 3;

/// A cell while it is measured.
struct Trial {
    contestant: Contestant,
    spp: u32,
    runs: Vec<Run>,
    /// The sentence of a method that refuses.
    refused: Option<String>,
    /// What a pilot has come to, in words, once it is asked: that is not timed.
    way: Option<String>,
    /// Where its noise lies, if the pilot has found that.
    noise: Option<Arc<NoiseMap>>,
}

/// The cells of a direction, and a gradient picture of each that has one: that of the first repeat.
pub struct Measured {
    pub cells: Vec<Cell>,
    pub pictures: Vec<Option<Image>>,
}

/// Camera paths that a direction takes, about.
pub fn paths(task: &Task) -> u64 {
    let effort = &task.plan.effort;
    let methods = effort.methods.iter();
    let images: u64 = methods.map(|one| images(one.method)).sum();
    let samples = effort.spp.iter().map(|spp| task.paths(*spp));
    samples.sum::<u64>() * images * effort.repeats as u64
}

fn images(method: Method) -> u64 {
    match (method.displaces_scenes(), method.carries_samples()) {
        (true, true) => methods::CARRIED_DIFFERENCE_IMAGES as u64,
        (true, false) => methods::DIFFERENCE_IMAGES as u64,
        (false, _) => GRADIENT_IMAGES,
    }
}

/// Measures all cells. `done` counts camera paths.
pub fn measure(
    task: &Task,
    reference: &Reference,
    progress: &dyn Progress,
    done: &mut dyn FnMut(u64),
) -> Result<Measured, Failure> {
    let effort = &task.plan.effort;
    let mut trials: Vec<Trial> = Vec::new();
    for spp in &effort.spp {
        trials.extend(effort.methods.iter().map(|contestant| Trial {
            contestant: contestant.clone(),
            spp: *spp,
            runs: Vec::new(),
            refused: None,
            way: None,
            noise: None,
        }));
    }
    for repeat in 0..effort.repeats {
        for trial in &mut trials {
            if trial.refused.is_none() && trial.settle(task, progress)? {
                trial.run(task, repeat, progress)?;
            }
            done(task.paths(trial.spp) * images(trial.contestant.method));
        }
    }
    let pictures = trials.iter().map(|trial| trial.picture(task.size));
    let pictures = pictures.collect();
    let mut cells: Vec<Cell> = trials.iter().map(|t| t.cell(task, reference)).collect();
    compare_with_differences(&mut cells);
    Ok(Measured { cells, pictures })
}

impl Trial {
    /// Asks the pilot of a method that has one; whether the method does not refuse.
    fn settle(&mut self, task: &Task, progress: &dyn Progress) -> Result<bool, Failure> {
        let settings = Settings {
            method: self.contestant.method,
            constants: self.contestant.constants,
            spp: self.spp,
            ..task.settings.clone()
        };
        if !settings.needs_pilot() {
            return Ok(true);
        }
        let question = Question::Forward(&task.direction);
        let times = task.plan.effort.repeats as u64;
        let decided = Prepared::new(task.scene, &settings, &|| progress.cancelled())
            .and_then(|prepared| prepared.decide_for(times, &settings, &question, progress));
        match decided {
            Ok((settled, pilot)) => {
                self.contestant.method = settled.method;
                self.contestant.constants = settled.constants;
                self.noise = settled.noise;
                self.way = Some(pilot.chosen);
                Ok(true)
            }
            Err(EngineError::Refused(sentence)) => {
                self.refused = Some(sentence);
                Ok(false)
            }
            Err(other) => Err(Failure::from_engine(other, None)),
        }
    }

    fn run(&mut self, task: &Task, repeat: usize, progress: &dyn Progress) -> Result<(), Failure> {
        let settings = Settings {
            method: self.contestant.method,
            constants: self.contestant.constants,
            noise: self.noise.clone(),
            spp: self.spp,
            seed: nth_seed(task.settings.seed, repeat),
            ..task.settings.clone()
        };
        machine::forget_peak();
        let (wall, processor) = (Instant::now(), machine::fine_processor_seconds());
        let made = methods::forward(task.scene, &settings, &task.direction, progress);
        let seconds = wall.elapsed().as_secs_f64();
        let processor_seconds = machine::fine_processor_seconds() - processor;
        match made {
            Ok(made) => {
                let mut run = Run::of(made)?;
                (run.seconds, run.processor_seconds) = (seconds, processor_seconds);
                run.memory_bytes = machine::peak();
                self.runs.push(run);
            }
            Err(EngineError::Refused(sentence)) => self.refused = Some(sentence),
            Err(other) => return Err(Failure::from_engine(other, None)),
        }
        Ok(())
    }

    fn picture(&self, [width, height]: [usize; 2]) -> Option<Image> {
        let first = self.runs.first().filter(|_| self.refused.is_none())?;
        Some(Image {
            width,
            height,
            pixels: first.gradient.as_chunks::<3>().0.to_vec(),
        })
    }

    fn cell(&self, task: &Task, reference: &Reference) -> Cell {
        let repeats = task.plan.effort.repeats;
        let cell = |verdict, figures, times| Cell {
            method: self.contestant.name.clone(),
            spp: self.spp,
            way: self.way.clone(),
            repeats,
            verdict,
            figures,
            times,
        };
        if let Some(sentence) = &self.refused {
            return cell(Verdict::refused(sentence), None, None);
        }
        let groups = methods::group_count(self.spp);
        let figures = figures::of(&self.runs, reference, task.paths(self.spp), groups);
        let processor_seconds = median(self.runs.iter().map(|run| run.processor_seconds));
        let efficiency = 1.0 / (figures.rmse.powi(2) * processor_seconds);
        let times = Times {
            seconds: median(self.runs.iter().map(|run| run.seconds)),
            processor_seconds,
            memory_bytes: self.runs.iter().filter_map(|run| run.memory_bytes).max(),
            efficiency: efficiency.is_finite().then_some(efficiency),
            relative_efficiency: None,
            relative_noise: None,
        };
        let verdict = Verdict::of(&figures, repeats, reference);
        cell(verdict, Some(figures), Some(times))
    }
}

/// What each is worth beside finite differences of as many samples, if there are any.
fn compare_with_differences(cells: &mut [Cell]) {
    let base = Method::REFERENCE.name();
    let of = |cell: &Cell| Some((cell.figures.as_ref()?.sd, cell.times.clone()?));
    let bases: Vec<_> = cells
        .iter()
        .map(|cell| {
            let same = cells.iter().find(|c| c.method == base && c.spp == cell.spp);
            same.and_then(of)
        })
        .collect();
    for (cell, base) in cells.iter_mut().zip(bases) {
        let (Some((base_sd, base)), Some(figures), Some(times)) =
            (base, &cell.figures, &mut cell.times)
        else {
            continue;
        };
        let ratio = times.processor_seconds / base.processor_seconds;
        let noise = figures.sd / base_sd * ratio.sqrt();
        times.relative_noise = noise.is_finite().then_some(noise);
        times.relative_efficiency = times.efficiency.zip(base.efficiency).map(|(a, b)| a / b);
    }
}

fn median(numbers: impl Iterator<Item = f64>) -> f64 {
    let mut numbers: Vec<f64> = numbers.collect();
    numbers.sort_unstable_by(f64::total_cmp);
    let n = numbers.len();
    (numbers[(n - 1) / 2] + numbers[n / 2]) / 2.0
}
