//! What `auto` does: a pilot tries what may be best, and the rest is done by what has the least
//! noise for its work.
//!
//! The pilot renders some tiles of the film with random numbers of its own, so what it comes to does
//! not depend on the samples that it is used for: whichever it is, their mean is the gradient.
//! Noise is the variance of the gradient image, from independent groups of samples. Work is counted
//! in rays and not in seconds, so all processes and all runs come to the same.

use super::contender::Contender;
use super::decisions::Asked;
use super::difference_step::step;
use super::error::EngineError;
use super::number_by_number::numbers_of;
use super::prepared::Prepared;
use super::progress::Progress;
use super::settings::{Groups, Settings};
use super::stage::Stage;
use super::statistics::{Pilot, Statistics};
use super::trials::{Job, Trials};
use crate::boundary::mixture::Mixture;
use crate::scene::parameters::{self, Parameter};
use std::time::Instant;

/// Parameters and their tangents.
type Direction = Vec<(Parameter, Vec<f32>)>;

/// The pilot's own random numbers.
const SEED: u64 = 0x7069_6c6f_7400_0001;
const GROUPS: u32 = 4;
/// Samples a pixel of a group, as far as the job's groups have as many.
const SAMPLES: [u32; 2] = [2, 16];
/// Paths of one trial, at least, and the share that they have in the whole job's at least.
const LEAST_PATHS: f64 = 16384.0;
const LEAST_SHARE: f64 = 1.0 / 64.0;

/// In reverse differences are tried for at most so many numbers, each of which takes one. Before
/// smooth metal and glass paths may have 10⁴ times their variance, but rarely elsewhere.
const MOST_NUMBERS: usize = 64;

/// What one may ask for.
pub enum Question<'a> {
    /// The gradient image along a direction.
    Forward(&'a [(Parameter, Vec<f32>)]),
    /// The derivative of a number by these.
    Backward(&'a [Parameter]),
    /// Both by these, in the same way, of which one is the transpose of the other.
    ForwardAndBackward(&'a [Parameter]),
}

impl Prepared<'_> {
    /// The settings with which `auto` answers a question, and how it came to them.
    ///
    /// Errors are those of the answer itself.
    pub fn decide(
        &self,
        settings: &Settings,
        question: &Question,
        progress: &dyn Progress,
    ) -> Result<(Settings, Pilot), EngineError> {
        let start = Instant::now();
        let Some(direction) = moving_direction(self, settings, question)? else {
            let mut pilot = Pilot::without_trials("nothing that moves has edges".into());
            let way = Contender::Mixture(Mixture::default());
            pilot.chosen = way.name();
            return Ok((way.settle(settings), pilot));
        };
        let differences = differences_asked(settings, question, &direction);
        let named = direction.iter().map(|(p, v)| (p.key.clone(), v.clone()));
        let asked = Asked::new(settings, differences, named.collect());
        let mut seconds = 0.0;
        let (way, mut pilot) = self.parts.decisions.once(asked, || {
            let (way, mut pilot) = self.try_ways(settings, differences, &direction, progress)?;
            pilot.chosen = way.name();
            seconds = start.elapsed().as_secs_f64();
            Ok::<_, EngineError>((way, pilot))
        })?;
        pilot.seconds = seconds;
        Ok((way.settle(settings), pilot))
    }

    fn try_ways(
        &self,
        settings: &Settings,
        differences: Option<usize>,
        direction: &[(Parameter, Vec<f32>)],
        progress: &dyn Progress,
    ) -> Result<(Contender, Pilot), EngineError> {
        let sensor = &self.scene.sensors[settings.sensor];
        let (own, share) = of_pilot(self, &settings.through_lens(sensor, true))?;
        let job = Job {
            spp: settings.spp,
            share,
        };
        let mut trials = Trials::new(self, own, (direction, job), progress);
        match trials.run(Contender::Mixture(Mixture::default())) {
            Err(EngineError::Refused(sentence)) if differences.is_some() => {
                return Ok((Contender::Differences, Pilot::without_trials(sentence)));
            }
            tried => tried?,
        }
        match differences {
            Some(count) => trials.run_all(count)?,
            None => trials.run_mixtures()?,
        }
        Ok((trials.best(), trials.into_pilot()))
    }
}

/// The direction along which a pilot looks; `None` if it would not find any edge that moves.
fn moving_direction(
    prepared: &Prepared,
    settings: &Settings,
    question: &Question,
) -> Result<Option<Direction>, EngineError> {
    let scene = prepared.scene;
    let moves = |direction: &[(Parameter, Vec<f32>)]| {
        let tangent = parameters::tangent(scene, direction, settings.sensor)?;
        Ok::<_, EngineError>(tangent.moves_edges(scene))
    };
    let direction = match question {
        Question::Forward(direction) => direction.to_vec(),
        Question::Backward(wanted) | Question::ForwardAndBackward(wanted) => {
            // All of them at once, each as fast on the film as the others.
            let mut together = Vec::new();
            for parameter in *wanted {
                let one = vec![(parameter.clone(), vec![1.0; parameter.len()])];
                if moves(&one)? {
                    let speed = step(scene, settings, &one)? as f32;
                    together.push((parameter.clone(), vec![speed; parameter.len()]));
                }
            }
            together
        }
    };
    let is_worth_it = !direction.is_empty() && moves(&direction)?;
    Ok(is_worth_it.then_some(direction))
}

/// How many differences would answer, if they can: one along a direction, or else one for each
/// number, which have to be few.
fn differences_asked(
    settings: &Settings,
    question: &Question,
    direction: &[(Parameter, Vec<f32>)],
) -> Option<usize> {
    match question {
        // Whole images are compared by one process.
        Question::Forward(_) => settings.groups().only.is_none().then_some(1),
        Question::Backward(_) => {
            let numbers = direction.iter().map(|(p, _)| numbers_of(p)).sum();
            (numbers <= MOST_NUMBERS).then_some(numbers)
        }
        Question::ForwardAndBackward(_) => None,
    }
}

/// Fewer samples on the whole film, or on tiles of it where even the least would be too many. What has
/// most of the noise, as a lamp that is seen, may lie in one place.
///
/// And the share of these samples in the job's.
fn of_pilot(prepared: &Prepared, settings: &Settings) -> Result<(Settings, f64), EngineError> {
    let [least, most] = SAMPLES.map(|n| n.min(settings.spp / settings.groups().count).max(1));
    let mut own = Settings {
        seed: SEED,
        spp: most * GROUPS,
        standard_error: true,
        groups: Some(Groups {
            count: GROUPS,
            only: None,
        }),
        part_of_film: None,
        ..settings.clone()
    };
    let stage = Stage::new(prepared, &own, None, &mut Statistics::default())?;
    let pixels = stage.size.iter().product::<usize>() as f64;
    let paths = LEAST_PATHS.max(LEAST_SHARE * pixels * f64::from(settings.spp));
    let samples = ((paths / pixels) as u32 / GROUPS).clamp(least, most);
    own.spp = samples * GROUPS;
    let part = (paths / (pixels * f64::from(own.spp))).min(1.0);
    own.part_of_film = (part < 1.0).then_some(part);
    let of_job = part * f64::from(own.spp) / f64::from(settings.spp);
    Ok((own, of_job))
}
