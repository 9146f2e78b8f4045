//! A scene in memory with all that its jobs share.

use super::estimate;
use super::key::SceneKey;
use super::ledger::Reservation;
use super::source::{Counted, Stamp};
use crate::jobs::failure::Failure;
use crate::methods::{Base, Followers, Lease, Parts, Workers};
use crate::room::Cancelled;
use crate::scene::{self, Scene};
use crate::trace::Backend;
use std::path::PathBuf;
use std::time::Instant;

/// A scene, what is made of it, and what it was read from.
pub struct Loaded {
    pub scene: Scene,
    parts: Parts,
    followers: Followers,
    pub load_seconds: f64,
    pub build_seconds: f64,
    files: Vec<(PathBuf, Stamp)>,
    reservation: Reservation<Loaded>,
}

impl Loaded {
    /// Loads the scene and makes its parts, counting the memory while it grows.
    pub fn load(
        key: &SceneKey,
        workers: &Workers,
        backend: Backend,
        mut reservation: Reservation<Loaded>,
        cancelled: Cancelled,
    ) -> Result<Self, Failure> {
        let start = Instant::now();
        let source = Counted::new(&mut reservation, cancelled);
        let scene = scene::load_from(&source, &key.path, &key.defines);
        let (files, refusal) = source.finish();
        // What the source refused is the cause of what the loader says.
        let scene = match refusal {
            Some(refusal) => return Err(refusal),
            None => scene?,
        };
        reservation.become_bytes(estimate::of_scene(&scene), cancelled)?;
        let load_seconds = start.elapsed().as_secs_f64();
        let start = Instant::now();
        let parts = Parts::new(&scene, workers, backend, cancelled)
            .map_err(|error| Failure::from_engine(error, None))?;
        Ok(Self {
            scene,
            parts,
            followers: Followers::new(backend),
            load_seconds,
            build_seconds: start.elapsed().as_secs_f64(),
            files,
            reservation,
        })
    }

    /// Whether all its files are as they were when they were read.
    pub fn is_fresh(&self) -> bool {
        let same = |(path, stamp): &(PathBuf, Stamp)| Stamp::of(path) == Some(*stamp);
        self.files.iter().all(same)
    }

    /// For jobs to edit.
    pub fn base(&self) -> Base<'_> {
        Base {
            scene: &self.scene,
            parts: &self.parts,
            followers: &self.followers,
        }
    }

    /// Takes back a structure, if there is room for keeping it.
    pub fn give_back(&self, lease: Lease) {
        self.followers.give_back(lease, || {
            let room = self.reservation.another(estimate::of_accel(&self.scene))?;
            Some(Box::new(room))
        });
    }
}
