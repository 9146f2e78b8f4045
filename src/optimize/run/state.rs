//! What an optimisation knows between two steps.

use super::record::Record;
use crate::jobs::failure::Failure;
use crate::optimize::optimizer::Memory;
use crate::optimize::problem::Problem;
use crate::scene::Mesh;
use crate::scene::source::Fnv1a;

/// What an optimisation knows between two steps. It decides all that follows, to the byte.
#[derive(Clone, Debug)]
pub struct State {
    /// Steps that are done.
    pub step: u64,
    /// By variable, what the optimiser moves.
    pub latents: Vec<Vec<f64>>,
    pub memories: Vec<Memory>,
    pub history: Vec<Record>,
    /// Samples are the schedule's times two to this power.
    pub doublings: u32,
    /// Steps refused one after another.
    pub refused_in_turn: u32,
    /// By variable: its mesh, once it has got other triangles than it was loaded with.
    pub meshes: Vec<Option<Mesh>>,
    /// Why it ended before its last step.
    pub ended: Option<String>,
}

impl State {
    /// Before the first step.
    pub fn start(problem: &Problem) -> Result<Self, Failure> {
        let mut state = Self {
            step: 0,
            latents: Vec::new(),
            memories: Vec::new(),
            history: Vec::new(),
            doublings: 0,
            refused_in_turn: 0,
            meshes: vec![None; problem.variables.len()],
            ended: None,
        };
        for variable in &problem.variables {
            let latent = variable.latent(&variable.start(&problem.base.scene)?);
            state
                .memories
                .push(Memory::new(latent.len(), variable.kind()));
            state.latents.push(latent);
        }
        Ok(state)
    }

    /// A hash of the numbers, by which processes of one run see that they have the same.
    pub fn fingerprint(&self) -> u64 {
        let mut hash = Fnv1a::default();
        hash.write(&self.step.to_le_bytes());
        for number in self.latents.iter().flatten() {
            hash.write(&number.to_le_bytes());
        }
        hash.0
    }

    /// The variables' values, as the scene takes them.
    pub fn values(&self, problem: &Problem) -> Vec<Vec<f32>> {
        let pairs = problem.variables.iter().zip(&self.latents);
        pairs
            .map(|(variable, latent)| {
                let [low, high] = variable.bounds;
                let values = variable.values(latent);
                values.iter().map(|v| v.clamp(low, high) as f32).collect()
            })
            .collect()
    }
}
