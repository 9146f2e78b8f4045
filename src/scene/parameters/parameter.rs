//! One parameter as users see it.

use super::entry::Entry;
use super::target::Target;
use super::value::Value;
use crate::scene::data::Scene;
use crate::scene::error::SceneError;
use crate::scene::nearest::shown;

/// Something of a scene that has a key.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// As `mi.traverse` prints it, or `<id>.translation`, …
    pub key: String,
    /// Other spellings that [`super::find`] takes.
    pub aliases: Vec<String>,
    /// As of a NumPy array; one number is `[1]`.
    pub shape: Vec<usize>,
    /// Whether a gradient with respect to it can be asked for: it has a target then.
    pub differentiable: bool,
    /// Whether it moves what hides what.
    pub moves_visibility: bool,
    /// What it is now.
    pub value: Value,
    /// What it stands for, if it is differentiable.
    pub target: Option<Target>,
}

/// Its key.
impl AsRef<str> for Parameter {
    fn as_ref(&self) -> &str {
        &self.key
    }
}

impl Parameter {
    /// How many numbers it has.
    pub fn len(&self) -> usize {
        self.shape.iter().product()
    }

    /// Whether it has no numbers at all.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    pub(super) fn from_entry(scene: &Scene, entry: Entry) -> Self {
        Self {
            value: Value::of(&entry, scene),
            differentiable: entry.target.is_some(),
            moves_visibility: entry.target.is_some_and(|t| t.moves_visibility(scene)),
            key: entry.key,
            aliases: entry.aliases,
            shape: entry.shape,
            target: entry.target,
        }
    }

    /// The target; a sentence that refuses if there is none.
    pub(super) fn target(&self) -> Result<Target, SceneError> {
        self.target.ok_or_else(|| not_differentiable(&self.key))
    }

    /// Refuses what belongs to another sensor than `sensor`, the one that renders.
    pub fn check_sensor(&self, scene: &Scene, sensor: usize) -> Result<(), SceneError> {
        match self.target.and_then(Target::sensor) {
            Some(other) if other != sensor => {
                let rendered = scene.sensors.get(sensor).map_or("none", |s| s.id.as_str());
                Err(SceneError::parameter(format!(
                    "{} belongs to sensor {other}, but sensor {sensor} (\"{rendered}\") renders: its image does \
                     not depend on it; choose --sensor {other}",
                    self.key
                )))
            }
            _ => Ok(()),
        }
    }

    /// As many numbers as the parameter has: all given, or those of the last axis repeated.
    pub fn broadcast(&self, values: &[f32]) -> Result<Vec<f32>, SceneError> {
        if let Some(bad) = values.iter().find(|v| !v.is_finite()) {
            return Err(SceneError::parameter(format!(
                "{}: {bad} is not a finite number",
                self.key
            )));
        }
        let last = self.shape.last().copied().unwrap_or(1);
        // One number stands for a grey colour.
        let is_colour = matches!(self.target, Some(Target::Texels(_) | Target::Texel { .. }));
        if values.len() == self.len() {
            Ok(values.to_vec())
        } else if values.len() == 1 && is_colour {
            Ok(values.repeat(self.len()))
        } else if values.len() == last {
            Ok(values.repeat(self.len() / last.max(1)))
        } else {
            let shape: Vec<String> = self.shape.iter().map(usize::to_string).collect();
            let all = match self.shape.len() {
                0 | 1 => String::new(),
                _ => format!(" ({}), or {last} for all its rows", shape.join("×")),
            };
            Err(SceneError::parameter(format!(
                "{} takes {} number{}{all}; {} given",
                self.key,
                self.len(),
                if self.len() == 1 { "" } else { "s" },
                match values.len() {
                    1 => "1 is".to_string(),
                    given => format!("{given} are"),
                }
            )))
        }
    }
}

/// The sentence that refuses a key.
pub(super) fn not_differentiable(key: &str) -> SceneError {
    SceneError::parameter(format!(
        "{} cannot be differentiated: the image has no derivative by it, or none is implemented",
        shown(key)
    ))
}
