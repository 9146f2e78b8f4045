//! The scene as searches for boundaries see it.

use crate::discontinuity::adjacency::Adjacency;
use crate::paths::moving::Moving;
use crate::paths::scene_view::SceneView;

/// What rays see, which triangles are neighbours, and what moves.
#[derive(Clone, Copy)]
pub struct SearchScene<'a> {
    pub view: &'a SceneView<'a>,
    pub adjacency: &'a Adjacency,
    pub moving: &'a Moving,
}
