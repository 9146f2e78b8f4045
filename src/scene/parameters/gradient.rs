//! The derivative of a number by the scene, as far as it is known.

use super::cotangent::reduce;
use super::parameter::Parameter;
use super::target::Target;
use crate::scene::data::Scene;
use crate::scene::differential::SceneDifferential;

/// The derivative of a number by what a scene is made of, or directly by some parameters.
#[derive(Clone, Debug)]
pub struct Gradient {
    /// By vertices, texels and so on. Zeros for what was not asked for.
    pub cotangent: SceneDifferential,
    /// By parameters, which come before what the cotangent says of them.
    pub numbers: Vec<(Target, Vec<f32>)>,
}

impl Gradient {
    /// By one parameter, of its shape; empty if that is not differentiable. What is not known
    /// counts as zero.
    pub fn by(&self, scene: &Scene, parameter: &Parameter) -> Vec<f32> {
        let of = |(target, _): &&(Target, Vec<f32>)| Some(*target) == parameter.target;
        match self.numbers.iter().find(of) {
            Some((_, numbers)) => numbers.clone(),
            None => reduce(scene, parameter, &self.cotangent),
        }
    }
}

impl From<SceneDifferential> for Gradient {
    fn from(cotangent: SceneDifferential) -> Self {
        Self {
            cotangent,
            numbers: Vec::new(),
        }
    }
}
