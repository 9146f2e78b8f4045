//! Which elements stand around other bsdfs, and what may not stand in which.

use super::principled;
use crate::scene::error::SceneError;
use crate::scene::xml::{Child, Object};

/// Whether an element mixes others.
pub(super) fn is_mixed(object: &Object) -> bool {
    matches!(object.plugin.as_str(), "mask" | "blendbsdf")
}

/// Whether an element turns normals.
pub(super) fn turns_normals(object: &Object) -> bool {
    matches!(object.plugin.as_str(), "normalmap" | "bumpmap")
}

/// Refuses what lets light through inside a `twosided`.
pub(super) fn refuse_transmission(inner: &Object, child: &Child) -> Result<(), SceneError> {
    let transmits = [
        "dielectric",
        "roughdielectric",
        "thindielectric",
        "null",
        "mask",
    ];
    let is_layered = inner.plugin == "principled" && principled::transmits(inner)?;
    if !is_layered && !transmits.contains(&inner.plugin.as_str()) {
        return Ok(());
    }
    let what = format!(
        "{} lets light through and has both sides already; it cannot stand inside a twosided",
        inner.shown()
    );
    Err(SceneError::at(&child.place, what))
}
