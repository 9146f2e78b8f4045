//! A scene with what tracing needs of it, made once for all images and gradients of that scene.

use super::error::EngineError;
use super::parts::Parts;
use super::settings::Settings;
use super::workers::Workers;
use crate::room::Cancelled;
use crate::scene::Scene;
use crate::trace::Backend;
use std::time::Instant;

/// A scene that is ready to be traced, by threads that are there.
#[derive(Clone)]
pub struct Prepared<'a> {
    pub scene: &'a Scene,
    pub parts: Parts,
    pub workers: Workers,
    /// What making the parts took, for whoever pays for it.
    pub build_seconds: f64,
}

impl<'a> Prepared<'a> {
    /// Prepares `scene` for the threads and the backend of the settings.
    pub fn new(
        scene: &'a Scene,
        settings: &Settings,
        cancelled: Cancelled,
    ) -> Result<Self, EngineError> {
        let workers = Workers::new(settings.threads)?;
        Self::with_workers(scene, &workers, settings.backend, cancelled)
    }

    /// Prepares `scene` for threads that are there already.
    pub fn with_workers(
        scene: &'a Scene,
        workers: &Workers,
        backend: Backend,
        cancelled: Cancelled,
    ) -> Result<Self, EngineError> {
        let start = Instant::now();
        Ok(Self {
            scene,
            parts: Parts::new(scene, workers, backend, cancelled)?,
            workers: workers.clone(),
            build_seconds: start.elapsed().as_secs_f64(),
        })
    }
}
