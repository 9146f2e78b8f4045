//! New triangles on the way: the scene, its structures, the variable and the optimiser's memory
//! change with them.

use super::Problem;
use super::base::SceneBase;
use super::variable::Variable;
use crate::jobs::failure::Failure;
use crate::optimize::optimizer::Memory;
use crate::optimize::run::state::State;
use crate::optimize::shape::remesh::remesh;
use crate::scene::{Mesh, Normals, vertex_normals};
use glam::Vec3;

impl Problem {
    /// Puts the meshes of a state into the scene, if they have other triangles than it was loaded
    /// with.
    pub fn restore_meshes(&mut self, state: &State) -> Result<(), Failure> {
        for (i, mesh) in state.meshes.iter().enumerate() {
            if let Some(mesh) = mesh {
                self.replace_mesh(i, mesh)?;
            }
        }
        Ok(())
    }

    /// Makes new triangles, if the next step asks for them.
    pub fn remesh(&mut self, state: &mut State) -> Result<(), Failure> {
        for i in 0..self.variables.len() {
            let variable = &self.variables[i];
            let (Some(settings), Some(m)) = (variable.remeshing().cloned(), variable.mesh()) else {
                continue;
            };
            if !settings.at.contains(&state.step) {
                continue;
            }
            let old = &self.base.scene.meshes[m];
            let values = variable.values(&state.latents[i]);
            let before: Vec<Vec3> = values
                .as_chunks::<3>()
                .0
                .iter()
                .map(|p| vector(*p))
                .collect();
            let (positions, triangles) = remesh(&before, &old.triangles, settings.edge);
            let mesh = Mesh {
                positions,
                triangles,
                ..Mesh::default()
            };
            let memory = std::mem::take(&mut state.memories[i]);
            self.replace_mesh(i, &mesh)?;
            let after: Vec<f64> = mesh
                .positions
                .iter()
                .flat_map(|p| p.as_dvec3().to_array())
                .collect();
            let variable = &self.variables[i];
            state.latents[i] = variable.latent(&after);
            let length = state.latents[i].len();
            state.memories[i] = match settings.carry && memory.first.len() == 3 * before.len() {
                true => carried(&memory, &before, &mesh.positions),
                false => Memory::new(length, variable.kind()),
            };
            state.meshes[i] = Some(mesh);
        }
        Ok(())
    }

    /// Gives a variable's mesh other triangles, and builds everything over them.
    fn replace_mesh(&mut self, i: usize, new: &Mesh) -> Result<(), Failure> {
        let Some(m) = self.variables[i].mesh() else {
            return Ok(());
        };
        let settings = self.variables[i].settings.clone();
        let mut scene = self.base.scene.clone();
        if !scene.meshes[m].uvs.is_empty() {
            return Err(Failure::Input(format!(
                "{}: remesh: {} has texture coordinates, which new triangles would not have; take remesh or the texture out",
                settings.place, scene.meshes[m].id
            )));
        }
        put(&mut scene.meshes[m], new);
        let machine = &self.machine;
        let silhouette = match &self.silhouette {
            None => None,
            Some(base) => {
                let mut scene = base.scene.clone();
                put(&mut scene.meshes[m], new);
                Some(SceneBase::new(
                    scene,
                    &machine.workers,
                    machine.backend,
                    true,
                )?)
            }
        };
        self.variables[i] = Variable::new(&scene, &settings, &self.config)?;
        self.base = SceneBase::new(scene, &machine.workers, machine.backend, true)?;
        self.silhouette = silhouette;
        Ok(())
    }
}

fn put(mesh: &mut Mesh, new: &Mesh) {
    mesh.positions.clone_from(&new.positions);
    mesh.triangles.clone_from(&new.triangles);
    if !matches!(mesh.normals, Normals::Flat) {
        mesh.normals = Normals::Computed(vertex_normals(&mesh.positions, &mesh.triangles));
    }
}

fn vector(numbers: [f64; 3]) -> Vec3 {
    Vec3::from(numbers.map(|v| v as f32))
}

/// What was remembered of the nearest old vertex.
fn carried(memory: &Memory, before: &[Vec3], after: &[Vec3]) -> Memory {
    let nearest = |p: &Vec3| {
        let distances = before.iter().map(|q| q.distance_squared(*p)).enumerate();
        distances
            .min_by(|a, b| a.1.total_cmp(&b.1))
            .map_or(0, |(i, _)| i)
    };
    let sources: Vec<usize> = after.iter().map(nearest).collect();
    let pick = |all: &[f64]| match all.is_empty() {
        true => Vec::new(),
        false => sources
            .iter()
            .flat_map(|&i| all[3 * i..3 * i + 3].to_vec())
            .collect(),
    };
    Memory {
        steps: memory.steps,
        first: pick(&memory.first),
        second: pick(&memory.second),
    }
}
