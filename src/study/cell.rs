//! What is found of one method with one number of samples on one direction.

use super::quantities::Figures;
use super::verdict::Verdict;
use serde::{Deserialize, Serialize};

/// One direction of one scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Row {
    pub scene: String,
    pub direction: String,
    pub symptom: String,
    /// What the file of other programs calls the scene, and which of its filters this one has.
    pub peer: String,
    pub filter: String,
    /// Width and height in pixels.
    pub size: [usize; 2],
    pub reference: ReferenceFigures,
    pub cells: Vec<Cell>,
}

/// How sure the reference is.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct ReferenceFigures {
    /// Root mean square of the gradient; none if nothing stands out of the noise.
    pub rms: Option<f64>,
    /// Root mean square of its standard errors, in units of `rms` (of 1 if there is none).
    pub noise: f64,
    /// Runs at each step, and samples a pixel of an image of one.
    pub runs: usize,
    pub spp: u32,
    pub ladder: super::reference::Ladder,
}

/// One method with one number of samples.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Cell {
    pub method: String,
    /// What its pilot has come to, in words.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub way: Option<String>,
    pub spp: u32,
    pub repeats: usize,
    pub verdict: Verdict,
    /// None if the method refused.
    pub figures: Option<Figures>,
    /// What another run would find otherwise.
    pub times: Option<Times>,
}

/// What a run took; medians over the repeats.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Times {
    pub seconds: f64,
    /// Of all cores together.
    pub processor_seconds: f64,
    /// The most the process held in any repeat.
    pub memory_bytes: Option<u64>,
    /// 1/(rmse² · processor seconds).
    pub efficiency: Option<f64>,
    /// Over that of finite differences with as many samples.
    pub relative_efficiency: Option<f64>,
    /// Standard deviation in equal processor time, over that of finite differences.
    pub relative_noise: Option<f64>,
}
