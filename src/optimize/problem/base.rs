//! A scene with what tracing needs of it, made once and refitted for every step.

use crate::jobs::failure::Failure;
use crate::methods::{Base, EditedScene, EngineError, Followers, Lease, Parts, Workers};
use crate::optimize::problem::variable::Variable;
use crate::scene::Scene;
use crate::trace::Backend;

/// A scene, its structures, and those that follow its moved vertices.
pub struct SceneBase {
    pub scene: Scene,
    parts: Parts,
    followers: Followers,
}

impl SceneBase {
    /// Builds everything over a scene. `links` makes what silhouettes are found with.
    pub fn new(
        scene: Scene,
        workers: &Workers,
        backend: Backend,
        links: bool,
    ) -> Result<Self, Failure> {
        let parts = Parts::new(&scene, workers, backend, &|| false).map_err(failed)?;
        if links {
            parts.link(workers);
        }
        Ok(Self {
            scene,
            parts,
            followers: Followers::new(backend),
        })
    }

    /// The scene with the values of some variables, its structure refitted.
    pub fn with<'a>(
        &'a self,
        variables: &[Variable],
        values: &[Vec<f32>],
        which: &[usize],
        threads: usize,
    ) -> Result<EditedScene<'a>, Failure> {
        let mut edited = EditedScene::new(Base {
            scene: &self.scene,
            parts: &self.parts,
            followers: &self.followers,
        });
        for &i in which {
            edited.set(&variables[i].parameter, &values[i])?;
        }
        edited.follow(threads).map_err(failed)?;
        Ok(edited)
    }

    /// Takes a structure back, for the next step.
    pub fn give_back(&self, lease: Option<Lease>) {
        if let Some(lease) = lease {
            self.followers.give_back(lease, || Some(Box::new(())));
        }
    }
}

fn failed(error: EngineError) -> Failure {
    Failure::from_engine(error, None)
}
