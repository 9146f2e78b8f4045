//! A scene in memory with all that its jobs share.

use super::estimate;
use super::source::Counted;
use super::store::{Reservation, SceneKey};
use crate::jobs::failure::Failure;
use crate::methods::{Edits, Parts, Workers, views};
use crate::room::Cancelled;
use crate::scene::{self, Scene};
use crate::trace::tightness::Tightness;
use crate::trace::{Accel, AccelOptions, Backend};
use std::path::PathBuf;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::{Instant, SystemTime};

/// Boxes of a refitted hierarchy may be looser by this factor before building anew is cheaper: measured in
/// `docs/batch.md`.
const LOOSEST: f64 = 1.2;

/// A scene, what is made of it, and what it was read from.
pub struct Loaded {
    pub scene: Scene,
    pub parts: Parts,
    backend: Backend,
    pub load_seconds: f64,
    pub build_seconds: f64,
    files: Vec<(PathBuf, Stamp)>,
    tightness: OnceLock<Tightness>,
    /// Structures that can follow moved vertices, at rest.
    followers: Mutex<Vec<Follower>>,
    reservation: Reservation,
}

/// When a file was last changed, and its length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stamp {
    modified: Option<SystemTime>,
    length: u64,
}

impl Stamp {
    /// Of the file as it is now.
    pub fn of(path: &std::path::Path) -> Option<Self> {
        let metadata = std::fs::metadata(path).ok()?;
        Some(Self {
            modified: metadata.modified().ok(),
            length: metadata.len(),
        })
    }
}

/// A structure that follows moved vertices by refitting. Its hierarchy is always that of the scene as it was loaded, so
/// that what a job's rays hit does not depend on the jobs before it.
struct Follower {
    accel: Accel,
    _reservation: Reservation,
}

/// A structure over moved vertices, and how it was made.
pub enum Lease {
    Refitted(Arc<Accel>),
    Rebuilt(Arc<Accel>),
}

impl Lease {
    /// The structure.
    pub fn accel(&self) -> &Arc<Accel> {
        match self {
            Lease::Refitted(accel) | Lease::Rebuilt(accel) => accel,
        }
    }
}

impl Loaded {
    /// Loads the scene and makes its parts, counting the memory while it grows.
    pub fn load(
        key: &SceneKey,
        workers: &Workers,
        backend: Backend,
        mut reservation: Reservation,
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
            backend,
            load_seconds,
            build_seconds: start.elapsed().as_secs_f64(),
            files,
            tightness: OnceLock::new(),
            followers: Mutex::default(),
            reservation,
        })
    }

    /// Whether all its files are as they were when they were read.
    pub fn is_fresh(&self) -> bool {
        let same = |(path, stamp): &(PathBuf, Stamp)| Stamp::of(path) == Some(*stamp);
        self.files.iter().all(same)
    }

    /// A structure over `moved`, the scene with other vertices: refitted, or built anew where boxes would get loose.
    pub fn follow(&self, moved: &Scene, edits: &Edits, threads: usize) -> Result<Lease, Failure> {
        let failed = |error: crate::trace::TraceError| Failure::System(error.to_string());
        let options = AccelOptions::new(true, threads).on(self.backend);
        let base = views(&self.scene.meshes);
        let now = views(&moved.meshes);
        let tightness = self.tightness.get_or_init(|| Tightness::new(&base));
        if tightness.looseness(&now, &edits.moved) > LOOSEST {
            let accel = Accel::build(&now, options).map_err(failed)?;
            return Ok(Lease::Rebuilt(Arc::new(accel)));
        }
        let idle = self.lock().pop();
        let mut accel = match idle {
            Some(follower) => follower.accel,
            None => {
                let mut accel = Accel::build(&base, options).map_err(failed)?;
                // The first refit decides the hierarchy.
                accel.refit(&base).map_err(failed)?;
                accel
            }
        };
        accel.refit(&now).map_err(failed)?;
        Ok(Lease::Refitted(Arc::new(accel)))
    }

    /// Takes back a structure, if there is room for keeping it.
    pub fn give_back(&self, lease: Lease) {
        let Lease::Refitted(accel) = lease else {
            return;
        };
        let bytes = estimate::of_accel(&self.scene);
        if let (Ok(accel), Some(reservation)) =
            (Arc::try_unwrap(accel), self.reservation.another(bytes))
        {
            self.lock().push(Follower {
                accel,
                _reservation: reservation,
            });
        }
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, Vec<Follower>> {
        self.followers
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }
}
