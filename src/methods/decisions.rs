//! What pilots have come to for a scene, kept for those who ask the same of it again.

use super::contender::Contender;
use super::noise_map::{NoiseMap, Survey};
use super::settings::{Groups, Settings};
use super::statistics::Pilot;
use std::sync::{Arc, Mutex, PoisonError};

/// Answers that are kept; the oldest goes first.
const MOST: usize = 8;

/// What was asked: the settings, how many differences would answer, if they can, whether to survey
/// the film, and the direction.
#[derive(Clone, PartialEq)]
pub struct Asked {
    settings: Settings,
    differences: Option<usize>,
    survey: Survey,
    direction: Vec<(String, Vec<f32>)>,
}

/// The answers for one scene.
#[derive(Default)]
pub struct Decisions(Mutex<Vec<(Asked, Slot)>>);

/// What is best, and how a pilot has found that.
#[derive(Clone)]
pub struct Answer {
    pub way: Contender,
    /// Where its noise lies, if samples are better spent there.
    pub noise: Option<Arc<NoiseMap>>,
    pub pilot: Pilot,
}

/// An answer, as soon as it is there.
type Slot = Arc<Mutex<Option<Answer>>>;

impl Asked {
    /// Leaves out what a pilot does not depend on.
    pub fn new(
        settings: &Settings,
        (differences, survey): (Option<usize>, Survey),
        direction: Vec<(String, Vec<f32>)>,
    ) -> Self {
        let groups = settings.groups();
        let settings = Settings {
            seed: 0,
            threads: 0,
            groups: Some(Groups {
                only: groups.only.map(|_| 0),
                ..groups
            }),
            ..settings.clone()
        };
        Self {
            settings,
            differences,
            survey,
            direction,
        }
    }
}

impl Decisions {
    /// The answer: that of before, or else what `ask` comes to. Who asks the same meanwhile waits
    /// for it; if it fails, they ask themselves.
    pub fn once<E>(
        &self,
        asked: Asked,
        ask: impl FnOnce() -> Result<Answer, E>,
    ) -> Result<Answer, E> {
        let slot = self.slot(asked);
        let mut slot = slot.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(answer) = &*slot {
            return Ok(answer.clone());
        }
        let answer = ask()?;
        *slot = Some(answer.clone());
        Ok(answer)
    }

    fn slot(&self, asked: Asked) -> Slot {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, slot)) = known.iter().find(|(other, _)| *other == asked) {
            return slot.clone();
        }
        if known.len() == MOST {
            known.remove(0);
        }
        let slot = Slot::default();
        known.push((asked, slot.clone()));
        slot
    }
}
