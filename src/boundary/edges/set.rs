//! The edges that are drawn from, with a tree over them.

use super::scene_edges::SceneEdges;
use super::tree::EdgeTree;

/// Edges and a tree over them.
pub struct EdgeSet {
    pub edges: SceneEdges,
    pub tree: EdgeTree,
}
