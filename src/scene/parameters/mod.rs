//! The scene's parameters: what can be listed, differentiated, moved and set, by Mitsuba's keys.

mod cotangent;
mod entries;
mod motion;
mod surfaces;
mod tangent;
#[cfg(test)]
mod tests;

pub use cotangent::{reduce, wanted};
pub use motion::{apply, displace};
pub use tangent::tangent;

use super::data::{Bsdf, Scene};
use super::error::SceneError;
use super::nearest::{nearest, shown};
use entries::{Entry, entries};

/// Something of a scene that has a key.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// As `mi.traverse` prints it, or `<id>.translation`, …
    pub key: String,
    /// Other spellings that [`find`] takes.
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

/// What a parameter is at present.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// All its numbers.
    Numbers(Vec<f64>),
    /// The smallest and the largest of many.
    Range {
        /// The smallest.
        min: f64,
        /// The largest.
        max: f64,
    },
}

/// What a differentiable parameter stands for. Indices are into the vectors of [`Scene`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Target {
    /// All vertices of a mesh, world units.
    VertexPositions(usize),
    /// A rigid translation of a mesh, world units.
    ShapeTranslation(usize),
    /// A rotation of a mesh: radians about the world axes through its bounding-box centre.
    ShapeRotation(usize),
    /// A factor on the distances from the mesh's bounding-box centre; 1 at present.
    ShapeScale(usize),
    /// A translation of a sensor, world units.
    SensorTranslation(usize),
    /// A rotation of a sensor: radians about the world axes through its position.
    SensorRotation(usize),
    /// The horizontal opening angle of a sensor, degrees.
    SensorXFov(usize),
    /// All texels of a texture.
    Texels(usize),
    /// One texel of a texture: a colour of a checkerboard.
    Texel {
        /// Index into [`Scene::textures`].
        texture: usize,
        /// Index into its texels.
        texel: usize,
    },
    /// The two rows of the transform of a bitmap's texture coordinates.
    ToUv(usize),
    /// The factor on the environment map.
    EnvironmentScale,
    /// A rotation of the environment map: radians about the world axes.
    EnvironmentRotation,
    /// Where a point light is, world units.
    DeltaLightPosition(usize),
    /// A translation of a point light, world units.
    DeltaLightTranslation(usize),
}

impl Target {
    /// The sensor it belongs to, if it belongs to one.
    pub fn sensor(self) -> Option<usize> {
        match self {
            Target::SensorTranslation(s) | Target::SensorRotation(s) | Target::SensorXFov(s) => {
                Some(s)
            }
            _ => None,
        }
    }

    fn moves_visibility(self, scene: &Scene) -> bool {
        match self {
            // What is seen through a smooth interface moves with its index of refraction.
            Target::Texels(t) => scene.materials.iter().any(
                |m| matches!(m.bsdf, Bsdf::Dielectric { eta, microfacets: None, .. } if eta == t),
            ),
            Target::Texel { .. }
            | Target::ToUv(_)
            | Target::EnvironmentScale
            | Target::EnvironmentRotation => false,
            _ => true,
        }
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

    fn from_entry(scene: &Scene, entry: Entry) -> Self {
        Self {
            value: entry.value(scene),
            differentiable: entry.target.is_some(),
            moves_visibility: entry.target.is_some_and(|t| t.moves_visibility(scene)),
            key: entry.key,
            aliases: entry.aliases,
            shape: entry.shape,
            target: entry.target,
        }
    }

    /// The target; a sentence that refuses if there is none.
    fn target(&self) -> Result<Target, SceneError> {
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
        if values.len() == self.len() {
            Ok(values.to_vec())
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

/// Every parameter of the scene.
pub fn list(scene: &Scene) -> Vec<Parameter> {
    let entries = entries(scene).into_iter();
    entries.map(|e| Parameter::from_entry(scene, e)).collect()
}

/// The differentiable parameter of this key or alias; the error names the nearest key, or says why it cannot
/// be differentiated.
pub fn find(scene: &Scene, key: &str) -> Result<Parameter, SceneError> {
    let entries = entries(scene);
    let matches = |e: &Entry| e.key == key || e.aliases.iter().any(|a| a == key);
    if let Some(index) = entries.iter().position(matches) {
        let Some(entry) = entries.into_iter().nth(index) else {
            return Err(not_differentiable(key));
        };
        return match (entry.target, entry.refusal) {
            (Some(_), _) => Ok(Parameter::from_entry(scene, entry)),
            (None, Some(why)) => Err(SceneError::parameter(format!(
                "{} cannot be differentiated: {why}",
                shown(key)
            ))),
            (None, None) => Err(not_differentiable(key)),
        };
    }
    // What can be differentiated is more likely meant.
    let differentiable = entries.iter().filter(|e| e.target.is_some());
    let names = differentiable.flat_map(|e| std::iter::once(&e.key).chain(&e.aliases));
    Err(SceneError::parameter(
        match nearest(key, names.map(String::as_str)) {
            Some(near) => format!(
                "there is no parameter \"{}\"; the nearest is \"{near}\" (`warpath params` lists all)",
                shown(key)
            ),
            None => format!("there is no parameter \"{}\"", shown(key)),
        },
    ))
}

fn not_differentiable(key: &str) -> SceneError {
    SceneError::parameter(format!(
        "{} cannot be differentiated: the image has no derivative by it, or none is implemented",
        shown(key)
    ))
}
