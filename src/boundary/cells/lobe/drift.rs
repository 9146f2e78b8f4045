//! What directions over diffuse lobes drift with (`paths::lobe_drift`).

use crate::boundary::search_scene::SearchScene;
use crate::paths::lobe_drift::LobeDrift;

/// Follows the pieces of metal, glass and plastic: their light changes along them.
pub fn find(scene: &SearchScene) -> Option<LobeDrift> {
    let view = scene.view;
    let mode = std::env::var("WP_LD").unwrap_or_default();
    if mode == "none" || !scene.moving.anything() {
        return None;
    }
    if mode != "all" && !view.materials.any_special {
        return None;
    }
    let geometry = view.geometry;
    let is_special = |v: u32| {
        let mesh = geometry.first_vertex.partition_point(|&first| first <= v) - 1;
        mode == "all" || view.materials.is_special(view.scene.meshes[mesh].material)
    };
    LobeDrift::new(geometry, scene.pieces(), scene.moving, is_special)
}
