//! A scene with what tracing needs of it, made once for all images and gradients of that scene.

use super::refusals::check_meshes;
use super::tails::object_of;
use super::{
    BackwardGradient, EngineError, Evaluation, ForwardGradient, Method, Objective, Progress,
    Rendering, Settings, backward, differences, forward, render,
};
use crate::paths::lights::Lights;
use crate::paths::materials::MaterialTable;
use crate::paths::sky::Sky;
use crate::room::{Cancelled, Unfinished};
use crate::scene::parameters::{self, Parameter};
use crate::scene::{Mesh, Scene};
use crate::trace::geometry::Geometry;
use crate::trace::{Accel, AccelOptions, Backend, MeshView};
use crate::warp::adjacency::Adjacency;
use std::sync::{Arc, OnceLock};
use std::time::Instant;

/// Threads that work through tiles. Clones share them.
#[derive(Clone)]
pub struct Workers {
    pub(super) pool: Arc<rayon::ThreadPool>,
    pub(super) threads: usize,
}

impl Workers {
    /// Starts `threads` threads.
    pub fn new(threads: usize) -> Result<Self, EngineError> {
        let threads = threads.max(1);
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|error| EngineError::Failed(error.to_string()))?;
        Ok(Self {
            pool: Arc::new(pool),
            threads,
        })
    }
}

/// What is computed from a scene before anything is traced. Clones share it.
#[derive(Clone)]
pub struct Parts {
    pub(super) geometry: Arc<Geometry>,
    pub(super) accel: Arc<Accel>,
    pub(super) lights: Arc<Lights>,
    pub(super) materials: Arc<MaterialTable>,
    pub(super) sky: Option<Arc<Sky>>,
    /// Made when silhouettes are first asked for.
    pub(super) adjacency: Arc<OnceLock<Adjacency>>,
}

/// What of a scene is no longer as it was when its [`Parts`] were made.
#[derive(Clone, Debug, PartialEq)]
pub struct Edits {
    /// Per mesh: whether its vertices or normals have moved.
    pub moved: Vec<bool>,
    /// Per texture: whether any of its numbers has changed.
    pub textures: Vec<bool>,
    /// Whether the environment map has turned, or its scale has changed.
    pub environment: bool,
}

impl Edits {
    /// None yet.
    pub fn none(scene: &Scene) -> Self {
        Self {
            moved: vec![false; scene.meshes.len()],
            textures: vec![false; scene.textures.len()],
            environment: false,
        }
    }

    fn lights(&self, scene: &Scene) -> bool {
        let mut radiances = scene.area_lights.iter().map(|light| light.radiance);
        self.moved.contains(&true) || radiances.any(|texture| self.textures[texture])
    }

    /// A table of materials keeps nothing of their colours.
    fn materials(&self, scene: &Scene) -> bool {
        let slots = scene.materials.iter().flat_map(|m| m.bsdf.slots());
        let mut kept = slots.filter(|(name, _)| matches!(*name, "alpha" | "eta"));
        kept.any(|(_, texture)| self.textures[texture])
    }

    fn sky(&self, scene: &Scene) -> bool {
        let radiance = scene.environment.as_ref().map(|e| e.radiance);
        self.environment || radiance.is_some_and(|texture| self.textures[texture])
    }
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
        let accel = Accel::build(
            &views(&scene.meshes),
            AccelOptions::new(true, workers.threads).on(backend),
        )
        .map_err(|error| EngineError::Failed(error.to_string()))?;
        let geometry = Geometry::new(scene);
        Ok(Self {
            lights: lights(scene, &geometry, workers),
            materials: Arc::new(MaterialTable::new(scene)),
            sky: sky(scene, workers, cancelled)?,
            adjacency: Arc::default(),
            geometry: Arc::new(geometry),
            accel: Arc::new(accel),
        })
    }

    /// The parts of an edited scene: only what the edits touch is made anew. `accel` is over the edited meshes.
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
            true => Arc::new(Geometry::new(scene)),
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
            sky: match edits.sky(scene) {
                true => sky(scene, workers, cancelled)?,
                false => self.sky.clone(),
            },
            adjacency,
            geometry,
            accel,
        })
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

fn sky(
    scene: &Scene,
    workers: &Workers,
    cancelled: Cancelled,
) -> Result<Option<Arc<Sky>>, Unfinished> {
    let Some(environment) = &scene.environment else {
        return Ok(None);
    };
    let Some(map) = &environment.map else {
        return Ok(None);
    };
    let texture = &scene.textures[environment.radiance];
    let made = workers.pool.install(|| Sky::new(texture, map, cancelled));
    Ok(Some(Arc::new(made?)))
}

/// The meshes as they are traced.
pub fn views(meshes: &[Mesh]) -> Vec<MeshView<'_>> {
    meshes
        .iter()
        .map(|mesh| MeshView {
            positions: &mesh.positions,
            triangles: &mesh.triangles,
        })
        .collect()
}

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

    /// Renders the image.
    pub fn render(
        &self,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Rendering, EngineError> {
        render::render(self, settings, progress)
    }

    /// Forward mode: the derivative of the image along one direction in parameter space.
    pub fn forward(
        &self,
        settings: &Settings,
        direction: &[(Parameter, Vec<f32>)],
        progress: &dyn Progress,
    ) -> Result<ForwardGradient, EngineError> {
        if settings.method == Method::Fd {
            return differences::forward(self.scene, &self.workers, settings, direction, progress);
        }
        let named: Vec<(&str, &[f32])> = direction
            .iter()
            .map(|(p, v)| (p.key.as_str(), v.as_slice()))
            .collect();
        let tangent = parameters::tangent(self.scene, &named, settings.sensor)?;
        forward::forward(self, settings, &tangent, progress)
    }

    /// The value of an objective and its derivative by the image.
    pub fn evaluate(
        &self,
        settings: &Settings,
        objective: &Objective,
        progress: &dyn Progress,
    ) -> Result<Evaluation, EngineError> {
        backward::evaluate(self, settings, objective, progress)
    }

    /// Reverse mode: the derivative of an objective with respect to all the parameters, in one pass.
    pub fn backward(
        &self,
        settings: &Settings,
        wanted: &[Parameter],
        objective: &Objective,
        progress: &dyn Progress,
    ) -> Result<BackwardGradient, EngineError> {
        let request = parameters::wanted(self.scene, wanted, settings.sensor)?;
        let mut done = backward::backward(self, settings, &request, objective, progress)?;
        for parameter in wanted {
            let object = parameter.target.and_then(object_of);
            let share = object.and_then(|object| done.terms.largest_share(object));
            let parts = &mut done.statistics.largest_parts;
            parts.extend(share.map(|share| (parameter.key.clone(), share)));
        }
        Ok(done)
    }
}
