//! Acceleration structures that follow moved vertices by refitting.

use super::edits::Edits;
use super::error::EngineError;
use super::placed::Placed;
use crate::scene::Scene;
use crate::trace::tightness::Tightness;
use crate::trace::{Accel, AccelOptions, Backend, TraceError};
use glam::Vec3;
use std::any::Any;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// Boxes of a refitted hierarchy may be looser by this factor before building anew is cheaper:
/// measured in `docs/batch.md`.
const LOOSEST: f64 = 1.2;

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

/// Counts the memory of a structure at rest for as long as it is kept.
pub type Keep = Box<dyn Any + Send>;

/// The structures of one scene that are at rest. Their hierarchy is always that of the scene as it
/// was loaded, so that what rays hit does not depend on what was traced before.
pub struct Followers {
    backend: Backend,
    tightness: OnceLock<Tightness>,
    idle: Mutex<Vec<Follower>>,
}

struct Follower {
    accel: Accel,
    _keep: Keep,
}

impl Followers {
    /// None yet.
    pub fn new(backend: Backend) -> Self {
        Self {
            backend,
            tightness: OnceLock::new(),
            idle: Mutex::default(),
        }
    }

    /// A structure over `moved`, the scene `base` with other vertices, both about `origin`:
    /// refitted, or built anew where boxes would get loose.
    pub fn follow(
        &self,
        [base, moved]: [&Scene; 2],
        origin: Vec3,
        edits: &Edits,
        threads: usize,
    ) -> Result<Lease, EngineError> {
        let failed = |error: TraceError| EngineError::Failed(error.to_string());
        let options = AccelOptions::new(true, threads).on(self.backend);
        let [base, now] = [base, moved].map(|scene| Placed::new(&scene.meshes, origin));
        let [base, now] = [base.views(), now.views()];
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

    /// Takes back a structure that can follow again, if nobody else has it and there is room to
    /// keep it.
    pub fn give_back(&self, lease: Lease, keep: impl FnOnce() -> Option<Keep>) {
        let Lease::Refitted(accel) = lease else {
            return;
        };
        if let (Ok(accel), Some(keep)) = (Arc::try_unwrap(accel), keep()) {
            self.lock().push(Follower { accel, _keep: keep });
        }
    }

    fn lock(&self) -> MutexGuard<'_, Vec<Follower>> {
        self.idle.lock().unwrap_or_else(PoisonError::into_inner)
    }
}
