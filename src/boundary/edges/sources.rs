//! What edges are drawn from, made when it is first asked for.

use super::lights::LightsAround;
use super::scene_edges::SceneEdges;
use super::set::EdgeSet;
use super::tile_edges::TileEdges;
use super::tree::EdgeTree;
use crate::boundary::search_scene::{SearchScene, Things};
use crate::discontinuity::adjacency::Adjacency;
use crate::paths::estimator::FilmTile;
use crate::paths::moving::Moving;
use crate::paths::scene_view::SceneView;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, OnceLock};

/// Points on edges, drawn by what they may bring.
pub struct Edges<'a> {
    adjacency: &'a Adjacency,
    pub moving: &'a Moving,
    /// All edges, and those of what moves.
    all: OnceLock<EdgeSet>,
    moved: OnceLock<EdgeSet>,
    lights: OnceLock<LightsAround>,
    things: Things,
    /// The edges that the camera sees in each tile, by the tile's first pixel.
    tiles: Mutex<HashMap<[i32; 2], Arc<TileEdges>>>,
}

impl<'a> Edges<'a> {
    pub fn new(adjacency: &'a Adjacency, moving: &'a Moving) -> Self {
        Self {
            adjacency,
            moving,
            all: OnceLock::new(),
            moved: OnceLock::new(),
            lights: OnceLock::new(),
            things: Things::default(),
            tiles: Mutex::default(),
        }
    }

    /// The scene as probes see it.
    pub fn scene<'s>(&'s self, view: &'s SceneView<'s>) -> SearchScene<'s> {
        SearchScene {
            view,
            adjacency: self.adjacency,
            moving: self.moving,
            lobe_drift: None,
            lines_over_lobes: 1.0,
            things: &self.things,
        }
    }

    /// The edges that move as seen from a point that moves or rests; `None` if there are none.
    pub fn set(&self, view: &SceneView, point_moves: bool) -> Option<&EdgeSet> {
        let geometry = view.geometry;
        let with_tree = |edges: SceneEdges| EdgeSet {
            tree: EdgeTree::new(geometry, &edges),
            edges,
        };
        // What moves may cut what it touches along an edge that rests.
        let may_move = |mesh: usize| {
            let [first, end] = [mesh, mesh + 1].map(|m| geometry.first_vertex[m]);
            self.moving.moves_mesh(mesh) || self.moving.touches(geometry, first..end)
        };
        let set = if point_moves {
            let all = || with_tree(SceneEdges::new(geometry, self.adjacency, |_| true));
            self.all.get_or_init(all)
        } else {
            self.moved.get_or_init(|| {
                let mut moved = SceneEdges::new(geometry, self.adjacency, may_move);
                let moves = |ends: [u32; 2]| {
                    self.moving.vertex(geometry, ends[0]) || self.moving.touches(geometry, ends)
                };
                moved.edges.retain(|edge| moves(edge.ends));
                with_tree(moved)
            })
        };
        (!set.edges.edges.is_empty()).then_some(set)
    }

    /// What is known of the lights.
    pub fn lights(&self, view: &SceneView) -> &LightsAround {
        self.lights.get_or_init(|| LightsAround::new(view))
    }

    /// The edges in a tile, which all groups of samples share unless each looks through a point of
    /// the lens of its own.
    pub fn in_tile(&self, set: &EdgeSet, film: &FilmTile) -> Arc<TileEdges> {
        if film.view.camera.lens_point != [0.0; 2] {
            return Arc::new(TileEdges::new(set, film));
        }
        let known =
            |tiles: &HashMap<[i32; 2], Arc<TileEdges>>| tiles.get(&film.tile.start).cloned();
        let lock = || self.tiles.lock().unwrap_or_else(|e| e.into_inner());
        if let Some(found) = known(&lock()) {
            return found;
        }
        // Whoever is second finds the same.
        let found = Arc::new(TileEdges::new(set, film));
        lock().insert(film.tile.start, found.clone());
        found
    }
}
