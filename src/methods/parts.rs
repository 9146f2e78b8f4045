//! What is computed from a scene before anything is traced.

use super::decisions::Decisions;
use super::edits::Edits;
use super::error::EngineError;
use super::followers::Followers;
use super::placed::Placed;
use super::reach::check_meshes;
use super::workers::Workers;
use crate::discontinuity::adjacency::Adjacency;
use crate::paths::environment::distribution::MapDistribution;
use crate::paths::light::patches::Lights;
use crate::paths::surface::materials::MaterialTable;
use crate::room::{Cancelled, Unfinished};
use crate::scene::Scene;
use crate::trace::geometry::Geometry;
use crate::trace::{Accel, AccelOptions, Backend};
use glam::Vec3;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// What is computed from a scene before anything is traced. Clones share it.
#[derive(Clone)]
pub struct Parts {
    pub(super) geometry: Arc<Geometry>,
    pub(super) accel: Arc<Accel>,
    pub(super) lights: Arc<Lights>,
    pub(super) materials: Arc<MaterialTable>,
    pub(super) map_distribution: Option<Arc<MapDistribution>>,
    /// Made when silhouettes are first asked for.
    pub(super) adjacency: Arc<OnceLock<Adjacency>>,
    /// What pilots have come to.
    pub(super) decisions: Arc<Decisions>,
    /// What a pilot has made for displaced scenes, until it is taken.
    followers: Arc<Mutex<Option<Followers>>>,
}

impl Parts {
    /// Makes everything of `scene`.
    pub fn new(
        scene: &Scene,
        workers: &Workers,
        backend: Backend,
        cancelled: Cancelled,
    ) -> Result<Self, EngineError> {
        check_meshes(scene)?;
        let geometry = Geometry::new(scene);
        let accel = Accel::build(
            &Placed::new(&scene.meshes, geometry.origin).views(),
            AccelOptions::new(true, workers.threads).on(backend),
        )
        .map_err(|error| EngineError::Failed(error.to_string()))?;
        Ok(Self {
            lights: lights(scene, &geometry, workers),
            materials: Arc::new(MaterialTable::new(scene)),
            map_distribution: map_distribution(scene, workers, cancelled)?,
            adjacency: Arc::default(),
            decisions: Arc::default(),
            followers: Arc::default(),
            geometry: Arc::new(geometry),
            accel: Arc::new(accel),
        })
    }

    /// The parts of an edited scene: only what the edits touch is made anew. `accel` is over the
    /// edited meshes.
    pub fn edited(
        &self,
        scene: &Scene,
        edits: &Edits,
        accel: Arc<Accel>,
        workers: &Workers,
        cancelled: Cancelled,
    ) -> Result<Self, EngineError> {
        let moves = edits.moved.contains(&true);
        let geometry = match moves {
            true => Arc::new(Geometry::about(scene, self.geometry.origin)),
            false => self.geometry.clone(),
        };
        let adjacency = match self.adjacency.get() {
            _ if !moves => self.adjacency.clone(),
            Some(before) => {
                let link = || before.with_moved(&geometry, &edits.moved);
                let linked = workers.pool.install(link);
                Arc::new(OnceLock::from(linked))
            }
            None => Arc::default(),
        };
        Ok(Self {
            lights: match edits.lights(scene) {
                true => lights(scene, &geometry, workers),
                false => self.lights.clone(),
            },
            materials: match edits.materials(scene) {
                true => Arc::new(MaterialTable::new(scene)),
                false => self.materials.clone(),
            },
            map_distribution: match edits.environment_changes(scene) {
                true => map_distribution(scene, workers, cancelled)?,
                false => self.map_distribution.clone(),
            },
            adjacency,
            decisions: Arc::default(),
            followers: Arc::default(),
            geometry,
            accel,
        })
    }

    /// Links the triangles now, so that edited scenes need only link what has moved.
    pub fn link(&self, workers: &Workers) {
        let make = || workers.pool.install(|| Adjacency::new(&self.geometry));
        self.adjacency.get_or_init(make);
    }

    /// The same without links between triangles, which displaced scenes would have to make anew.
    pub fn unlinked(&self) -> Self {
        Self {
            adjacency: Arc::default(),
            ..self.clone()
        }
    }

    /// Structures for displaced scenes: those that were kept, or none yet.
    pub fn take_followers(&self, backend: Backend) -> Followers {
        let kept = self.kept_followers().take();
        kept.unwrap_or_else(|| Followers::new(backend))
    }

    /// Keeps them for who takes them next.
    pub fn keep_followers(&self, followers: Followers) {
        *self.kept_followers() = Some(followers);
    }

    fn kept_followers(&self) -> MutexGuard<'_, Option<Followers>> {
        self.followers
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
    }

    /// The point of the world that is traced as (0, 0, 0).
    pub fn origin(&self) -> Vec3 {
        self.geometry.origin
    }

    /// What rays are traced against.
    pub fn accel(&self) -> &Arc<Accel> {
        &self.accel
    }
}

fn lights(scene: &Scene, geometry: &Geometry, workers: &Workers) -> Arc<Lights> {
    let new = || Lights::new(scene, geometry, false);
    Arc::new(workers.pool.install(new))
}

fn map_distribution(
    scene: &Scene,
    workers: &Workers,
    cancelled: Cancelled,
) -> Result<Option<Arc<MapDistribution>>, Unfinished> {
    let Some(environment) = &scene.environment else {
        return Ok(None);
    };
    let Some(map) = &environment.map else {
        return Ok(None);
    };
    let texture = &scene.textures[environment.radiance];
    let made = workers
        .pool
        .install(|| MapDistribution::new(texture, map, cancelled));
    Ok(Some(Arc::new(made?)))
}
