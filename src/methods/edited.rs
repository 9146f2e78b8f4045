//! A scene with other values than it was loaded with, ready to be traced.

use super::edits::Edits;
use super::error::EngineError;
use super::followers::{Followers, Lease};
use super::parts::Parts;
use super::prepared::Prepared;
use super::reach::check_meshes;
use super::workers::Workers;
use crate::room::Cancelled;
use crate::scene::parameters::{self, Parameter};
use crate::scene::{Scene, SceneError};

/// A scene as it was loaded, and what is shared by all that is made of it.
#[derive(Clone, Copy)]
pub struct Base<'a> {
    pub scene: &'a Scene,
    pub parts: &'a Parts,
    pub followers: &'a Followers,
}

/// A scene with values of its own.
pub struct EditedScene<'a> {
    base: Base<'a>,
    /// The scene with its own values, if it has any.
    changed: Option<Scene>,
    edits: Edits,
    lease: Option<Lease>,
}

impl<'a> EditedScene<'a> {
    /// Nothing is edited yet.
    pub fn new(base: Base<'a>) -> Self {
        Self {
            base,
            changed: None,
            edits: Edits::none(base.scene),
            lease: None,
        }
    }

    /// Gives a parameter other values.
    pub fn set(&mut self, parameter: &Parameter, values: &[f32]) -> Result<(), SceneError> {
        let scene = self.changed.get_or_insert_with(|| self.base.scene.clone());
        parameters::apply(scene, parameter, values)?;
        if let Some(target) = parameter.target {
            self.edits.mark(target);
        }
        Ok(())
    }

    /// Takes the scene at a distance along a direction in place of its own.
    pub fn displace(
        &mut self,
        direction: &[(Parameter, Vec<f32>)],
        distance: f64,
    ) -> Result<(), SceneError> {
        let displaced = parameters::displace(self.base.scene, direction, distance)?;
        self.changed = Some(displaced);
        let targets = direction
            .iter()
            .filter_map(|(parameter, _)| parameter.target);
        targets.for_each(|target| self.edits.mark(target));
        Ok(())
    }

    /// When all is set: gets a structure over the vertices, if any have moved.
    pub fn follow(&mut self, threads: usize) -> Result<(), EngineError> {
        if let Some(scene) = &self.changed
            && self.edits.moved.contains(&true)
        {
            check_meshes(scene)?;
            let Base {
                scene: base,
                parts,
                followers,
            } = self.base;
            let scenes = [base, scene];
            self.lease = Some(followers.follow(scenes, parts.origin(), &self.edits, threads)?);
        }
        Ok(())
    }

    /// The scene as it is now.
    pub fn scene(&self) -> &Scene {
        self.changed.as_ref().unwrap_or(self.base.scene)
    }

    /// Whether its structure was built anew, if vertices have moved.
    pub fn is_rebuilt(&self) -> Option<bool> {
        let lease = self.lease.as_ref()?;
        Some(matches!(lease, Lease::Rebuilt(_)))
    }

    /// Makes what the values have changed, and shares the rest.
    pub fn prepare(
        &self,
        workers: &Workers,
        cancelled: Cancelled,
    ) -> Result<Prepared<'_>, EngineError> {
        let shared = self.base.parts;
        let parts = match &self.changed {
            None => shared.clone(),
            Some(scene) => {
                let lease = self.lease.as_ref();
                let accel = lease.map_or(shared.accel(), Lease::accel);
                shared.edited(scene, &self.edits, accel.clone(), workers, cancelled)?
            }
        };
        Ok(Prepared {
            scene: self.scene(),
            parts,
            workers: workers.clone(),
            build_seconds: 0.0,
        })
    }

    /// What others can use now.
    pub fn finish(self) -> Option<Lease> {
        self.lease
    }
}
