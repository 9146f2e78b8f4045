//! The scene's parameters: what can be listed, differentiated, moved and set, by Mitsuba's keys.

mod cotangent;
mod entries;
mod entry;
mod gradient;
mod motion;
mod parameter;
mod surfaces;
mod tangent;
mod target;
#[cfg(test)]
mod tests;
mod to_uv;
mod to_world;
mod unknown_key;
mod value;

pub use cotangent::{reduce, wanted};
pub use gradient::Gradient;
pub use motion::{apply, displace, pivot};
pub use parameter::Parameter;
pub use tangent::tangent;
pub use target::Target;
pub use value::Value;

use super::data::Scene;
use super::error::SceneError;
use super::nearest::shown;
use entries::entries;
use entry::Entry;
use parameter::not_differentiable;

/// Every parameter of the scene.
pub fn list(scene: &Scene) -> Vec<Parameter> {
    let entries = entries(scene).into_iter();
    entries.map(|e| Parameter::from_entry(scene, e)).collect()
}

/// The differentiable parameter of this key or alias; the error names the nearest key, or says why
/// it cannot be differentiated.
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
    let names: Vec<&str> = names.map(String::as_str).collect();
    Err(SceneError::parameter(unknown_key::sentence(key, &names)))
}
