//! What a job computes.

use crate::output::results;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// The image.
    Render,
    /// The gradient image along one direction.
    Forward,
    /// The gradient of one number by every parameter listed.
    Backward,
}

/// How an image is compared with its target.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Loss {
    /// The mean over pixels and channels of |difference|.
    L1,
    /// The mean of its square.
    #[default]
    L2,
}

impl Mode {
    /// As in a job, and the command that does the same.
    pub fn name(self) -> &'static str {
        match self {
            Mode::Render => "render",
            Mode::Forward => "forward",
            Mode::Backward => "backward",
        }
    }

    /// The files it writes.
    pub fn files(self) -> &'static [&'static str] {
        match self {
            Mode::Render => &results::RENDER,
            Mode::Forward => &results::FORWARD,
            Mode::Backward => &results::BACKWARD,
        }
    }
}
