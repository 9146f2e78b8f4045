//! What pilots have come to for a scene, kept for those who ask the same of it again.

use super::contender::Contender;
use super::settings::{Groups, Settings};
use super::statistics::Pilot;
use std::sync::{Mutex, PoisonError};

/// Answers that are kept; the oldest goes first.
const MOST: usize = 8;

/// What was asked: the settings, whether for a gradient image, and the direction.
#[derive(Clone, PartialEq)]
pub struct Asked {
    settings: Settings,
    forward: bool,
    direction: Vec<(String, Vec<f32>)>,
}

/// The answers for one scene.
#[derive(Default)]
pub struct Decisions(Mutex<Vec<(Asked, Answer)>>);

/// What is best, and how a pilot has found that.
type Answer = (Contender, Pilot);

impl Asked {
    /// Leaves out what a pilot does not depend on.
    pub fn new(settings: &Settings, forward: bool, direction: Vec<(String, Vec<f32>)>) -> Self {
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
            forward,
            direction,
        }
    }
}

impl Decisions {
    pub fn find(&self, asked: &Asked) -> Option<Answer> {
        let known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let found = known.iter().find(|(other, _)| other == asked);
        found.map(|(_, answer)| answer.clone())
    }

    pub fn keep(&self, asked: Asked, answer: Answer) {
        let mut known = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        if known.len() == MOST {
            known.remove(0);
        }
        known.push((asked, answer));
    }
}
