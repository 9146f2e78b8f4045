//! Values for the `$name`s of a scene.

use schemars::JsonSchema;
use serde::Deserialize;

/// The value of a `$name`.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "a text, a number, true or false")]
pub enum Define {
    Text(String),
    Number(serde_json::Number),
    Truth(bool),
}

impl Define {
    /// As it would be typed after `-D name=`.
    pub fn text(&self) -> String {
        match self {
            Define::Text(text) => text.clone(),
            Define::Number(number) => number.to_string(),
            Define::Truth(truth) => truth.to_string(),
        }
    }
}
