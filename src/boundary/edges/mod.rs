//! Boundary sampling, after [Li2018]: points are drawn on the edges of meshes instead of being
//! found between neighbouring rays.
//!
//! Edges that the camera sees are drawn by their length on the film, those that a vertex sees by the
//! angle under which it sees them, from a tree. What jumps there is probed as for cells. Nothing is
//! missed because it is small, and no weight grows with what stands beside an edge; but an edge is
//! drawn whether something hides it or not, and where a vertex has many about it, few matter.
//!
//! The plane of the triangle that a vertex lies on is no edge: what jumps there, below the horizon of
//! a shading normal, is left out.

mod directions;
mod film;
pub mod intersections;
mod light;
mod lobe;
mod point;
mod scene_edges;
mod surface;
mod tree;

use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::adjacency::Adjacency;
use crate::discontinuity::pieces::Pieces;
use crate::paths::at::At;
use crate::paths::boundary_sample::Found;
use crate::paths::estimator::{Bounce, BoundaryEstimator, FilmTile, LightDraw};
use crate::paths::moving::Moving;
use crate::paths::scene_view::SceneView;
use directions::Part;
use film::TileEdges;
use glam::DVec3;
use scene_edges::SceneEdges;
use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::{Arc, Mutex, OnceLock};
use tree::EdgeTree;

/// Edges and a tree over them.
pub struct EdgeSet {
    pub edges: SceneEdges,
    pub tree: EdgeTree,
}

/// The lights as edges stand before them.
pub struct LightsAround {
    around: Vec<LightSphere>,
    /// The patch of each triangle that shines.
    patch_of: HashMap<u32, u32>,
}

/// A sphere around a light, and the chance that a sample is of it.
pub struct LightSphere {
    centre: DVec3,
    radius: f64,
    chance: f64,
}

/// Points on edges, drawn by what they may bring.
pub struct Edges<'a> {
    adjacency: &'a Adjacency,
    moving: &'a Moving,
    /// All edges, and those of what moves.
    all: OnceLock<EdgeSet>,
    moved: OnceLock<EdgeSet>,
    lights: OnceLock<LightsAround>,
    pieces: OnceLock<Pieces>,
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
            pieces: OnceLock::new(),
            tiles: Mutex::default(),
        }
    }

    fn scene<'s>(&'s self, view: &'s SceneView<'s>) -> SearchScene<'s> {
        SearchScene {
            view,
            adjacency: self.adjacency,
            moving: self.moving,
            found_pieces: &self.pieces,
        }
    }

    /// The edges that move as seen from a point that moves or rests; `None` if there are none.
    fn set(&self, view: &SceneView, point_moves: bool) -> Option<&EdgeSet> {
        let geometry = view.geometry;
        let make = |wanted: &dyn Fn(u32) -> bool| {
            let edges = SceneEdges::new(geometry, self.adjacency, wanted);
            EdgeSet {
                tree: EdgeTree::new(geometry, &edges),
                edges,
            }
        };
        let moves = |triangle: u32| {
            let [vertex, ..] = geometry.triangles[triangle as usize];
            self.moving.vertex(geometry, vertex)
        };
        let set = if point_moves {
            self.all.get_or_init(|| make(&|_| true))
        } else {
            self.moved.get_or_init(|| make(&moves))
        };
        (!set.edges.edges.is_empty()).then_some(set)
    }

    fn lights(&self, view: &SceneView) -> &LightsAround {
        self.lights.get_or_init(|| LightsAround::new(view))
    }
}

impl LightsAround {
    fn new(view: &SceneView) -> Self {
        let patches = &view.lights.patches;
        let around = (0..view.scene.area_lights.len()).map(|light| {
            let mesh = view.scene.area_lights[light].mesh;
            let [first, end] = [mesh, mesh + 1].map(|m| view.geometry.first_vertex[m] as usize);
            let points = view.geometry.positions[first..end].iter();
            let points = points.map(|p| p.as_dvec3());
            let low = points.clone().fold(DVec3::INFINITY, DVec3::min);
            let high = points.clone().fold(DVec3::NEG_INFINITY, DVec3::max);
            let centre = low.midpoint(high);
            let own = patches.iter().filter(|p| p.light as usize == light);
            LightSphere {
                centre,
                radius: points.map(|p| p.distance(centre)).fold(0.0, f64::max),
                chance: own.map(|p| f64::from(p.probability)).sum(),
            }
        });
        let triangles = |(patch, p): (usize, &crate::paths::light::patches::Patch)| {
            p.triangles().map(move |triangle| (triangle, patch as u32))
        };
        Self {
            around: around.collect(),
            patch_of: patches.iter().enumerate().flat_map(triangles).collect(),
        }
    }
}

impl LightSphere {
    /// What stands before it, as seen from `x`.
    fn cone(&self, x: DVec3) -> Part {
        let way = self.centre - x;
        let distance = way.length();
        let is_outside = distance > self.radius;
        Part::Cone {
            axis: way.normalize_or(DVec3::Z),
            half_rad: if is_outside {
                (self.radius / distance).asin()
            } else {
                PI
            },
            far: distance + self.radius,
        }
    }
}

impl BoundaryEstimator for Edges<'_> {
    fn moving(&self) -> Option<&Moving> {
        Some(self.moving)
    }

    fn film(&self, film: &FilmTile, out: &mut Found) {
        film::find(self, film, out);
    }

    fn light(&self, at: &At, draw: &LightDraw, out: &mut Found) {
        light::find(self, at, draw, out);
    }

    fn environment(&self, at: &At, out: &mut Found) {
        light::find_before_map(self, at, out);
    }

    fn lobe(&self, at: &At, _: &Bounce, out: &mut Found) {
        lobe::find(self, &self.scene(at.view), at, out);
    }
}
