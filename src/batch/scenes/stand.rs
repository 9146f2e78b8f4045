//! A loaded scene with the values that a job gives.

use super::loaded::{Lease, Loaded};
use crate::jobs::failure::Failure;
use crate::jobs::job::Job;
use crate::methods::{Edits, Prepared, Workers, check_meshes};
use crate::room::Cancelled;
use crate::scene::Scene;
use crate::scene::parameters::{self, Target};

/// The scene of a job with its `set` values, ready to be traced.
pub struct Stand<'a> {
    loaded: &'a Loaded,
    /// The scene with the job's values, if it has any.
    changed: Option<Scene>,
    edits: Edits,
    lease: Option<Lease>,
}

impl<'a> Stand<'a> {
    /// Applies the job's values.
    pub fn new(job: &Job, loaded: &'a Loaded, threads: usize) -> Result<Self, Failure> {
        let mut edits = Edits::none(&loaded.scene);
        if job.set.0.is_empty() {
            return Ok(Self {
                loaded,
                changed: None,
                edits,
                lease: None,
            });
        }
        let mut scene = loaded.scene.clone();
        for (key, numbers) in &job.set.0 {
            let parameter = parameters::find(&scene, key)?;
            let values = numbers.exactly(&parameter, key)?;
            parameters::apply(&mut scene, &parameter, &values)?;
            mark(&mut edits, parameter.target);
        }
        let lease = match edits.moved.contains(&true) {
            true => {
                check_meshes(&scene).map_err(|error| Failure::from_engine(error, None))?;
                Some(loaded.follow(&scene, &edits, threads)?)
            }
            false => None,
        };
        Ok(Self {
            loaded,
            changed: Some(scene),
            edits,
            lease,
        })
    }

    /// The scene as the job has it.
    pub fn scene(&self) -> &Scene {
        self.changed.as_ref().unwrap_or(&self.loaded.scene)
    }

    /// Whether its structure was built anew, if vertices have moved.
    pub fn is_rebuilt(&self) -> Option<bool> {
        let lease = self.lease.as_ref()?;
        Some(matches!(lease, Lease::Rebuilt(_)))
    }

    /// Makes what the job's values have changed, and shares the rest.
    pub fn prepare(
        &self,
        workers: &Workers,
        cancelled: Cancelled,
    ) -> Result<Prepared<'_>, Failure> {
        let shared = &self.loaded.parts;
        let parts = match &self.changed {
            None => shared.clone(),
            Some(scene) => {
                let lease = self.lease.as_ref();
                let accel = lease.map_or(shared.accel(), Lease::accel);
                shared
                    .edited(scene, &self.edits, accel.clone(), workers, cancelled)
                    .map_err(|error| Failure::from_engine(error, None))?
            }
        };
        Ok(Prepared {
            scene: self.scene(),
            parts,
            workers: workers.clone(),
            build_seconds: 0.0,
        })
    }

    /// Gives back what the next job can use.
    pub fn finish(self) {
        if let Some(lease) = self.lease {
            self.loaded.give_back(lease);
        }
    }
}

fn mark(edits: &mut Edits, target: Option<Target>) {
    match target {
        Some(
            Target::VertexPositions(mesh)
            | Target::ShapeTranslation(mesh)
            | Target::ShapeRotation(mesh)
            | Target::ShapeScale(mesh),
        ) => edits.moved[mesh] = true,
        Some(Target::Texels(texture) | Target::Texel { texture, .. } | Target::ToUv(texture)) => {
            edits.textures[texture] = true
        }
        Some(Target::EnvironmentScale | Target::EnvironmentRotation) => edits.environment = true,
        // Cameras and lights without an extent are read from the scene itself.
        Some(
            Target::SensorTranslation(_)
            | Target::SensorRotation(_)
            | Target::SensorXFov(_)
            | Target::DeltaLightPosition(_)
            | Target::DeltaLightTranslation(_),
        )
        | None => {}
    }
}
