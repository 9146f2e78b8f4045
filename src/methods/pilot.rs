//! What `auto` does: a pilot tries what may be best, and the rest is done by what has the least
//! noise for its work.
//!
//! The pilot renders some tiles of the film with random numbers of its own, so what it comes to
//! does not depend on the samples that it is used for: whichever it is, their mean is the gradient.
//! Noise is the variance of the gradient image, from independent groups of samples. Work is counted
//! in rays and not in seconds, so all processes and all runs come to the same.

use super::carried;
use super::contender::Contender;
use super::decisions::{Answer, Asked};
use super::difference_step::step;
use super::error::EngineError;
use super::looks::Job;
use super::noise_map::Survey;
use super::number_by_number::numbers_of;
use super::prepared::Prepared;
use super::progress::Progress;
use super::settings::Settings;
use super::statistics::Pilot;
use super::trials::Trials;
use crate::boundary::mixture::Mixture;
use crate::scene::parameters::{self, Parameter};
use std::time::Instant;

/// Parameters and their tangents.
type Direction = Vec<(Parameter, Vec<f32>)>;

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

/// What a pilot looks for where a question is asked.
fn survey_for(question: &Question) -> Survey {
    match question {
        Question::Forward(_) => Survey::IfItPays,
        Question::Backward(_) => Survey::Always,
        Question::ForwardAndBackward(_) => Survey::None,
    }
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
        self.decide_for(1, settings, question, progress)
    }

    /// The same where the question will be asked `times`, of scenes like this: what more often pays
    /// may take longer.
    pub fn decide_for(
        &self,
        times: u64,
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
        let survey = survey_for(question);
        let named = direction.iter().map(|(p, v)| (p.key.clone(), v.clone()));
        let asked = Asked::new(settings, (differences, survey), named.collect());
        let mut seconds = 0.0;
        let mut answer = self.parts.decisions.once(asked, || {
            let mut answer =
                self.try_ways(times, settings, (differences, survey), &direction, progress)?;
            answer.pilot.chosen = answer.way.name();
            seconds = start.elapsed().as_secs_f64();
            Ok::<_, EngineError>(answer)
        })?;
        answer.pilot.seconds = seconds;
        let settled = Settings {
            noise: answer.noise,
            ..answer.way.settle(settings)
        };
        Ok((settled, answer.pilot))
    }

    fn try_ways(
        &self,
        times: u64,
        settings: &Settings,
        (differences, survey): (Option<usize>, Survey),
        direction: &[(Parameter, Vec<f32>)],
        progress: &dyn Progress,
    ) -> Result<Answer, EngineError> {
        let sensor = &self.scene.sensors[settings.sensor];
        let settings = settings.through_lens(sensor, true);
        let job = Job::new(self, &settings, times, differences)?;
        let mut trials = Trials::new(self, settings.clone(), (direction, job), progress);
        if differences.is_some() {
            trials.allow_differences()?;
        }
        match trials.run_usual() {
            Err(EngineError::Refused(sentence)) if differences.is_some() => {
                let tangent = parameters::tangent(self.scene, direction, settings.sensor)?;
                let carried = carried::is_possible(self.scene, &settings, &tangent);
                let way = Contender::Differences { carried };
                let pilot = Pilot::without_trials(sentence);
                return trials.answer(way, pilot, survey);
            }
            tried => tried?,
        }
        match differences {
            Some(_) => trials.run_all()?,
            None => trials.run_mixtures()?,
        }
        let (way, pilot) = trials.best()?;
        let answer = trials.answer(way, pilot, survey)?;
        if !way.is_difference() {
            drop(self.parts.take_followers(settings.backend));
        }
        Ok(answer)
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
