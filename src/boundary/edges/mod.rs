//! Boundary sampling, after \[Li2018\]: points are drawn on the edges of meshes instead of being
//! found between neighbouring rays.
//!
//! Edges that the camera sees are drawn by their length on the film, those that a vertex sees by
//! the angle under which it sees them, from a tree. What jumps there is probed as for cells.
//! Nothing is missed because it is small, and no weight grows with what stands beside an edge; but
//! an edge is drawn whether something hides it or not, and where a vertex has many about it, few
//! matter.
//!
//! The plane of the triangle that a vertex lies on is a border, too, where smooth normals lean over
//! it.

mod directions;
mod film;
mod horizon;
pub mod intersections;
mod light;
mod lights;
mod lobe;
mod point;
mod scene_edges;
mod set;
mod sources;
mod surface;
mod tile_edges;
mod tree;

use crate::paths::at::At;
use crate::paths::bounce::Bounce;
use crate::paths::boundary_sample::Found;
use crate::paths::estimator::{BoundaryEstimator, FilmTile, LightDraw};
use crate::paths::moving::Moving;
pub use sources::Edges;

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
        self.lobes_of(u32::MAX, at, out);
    }
}

impl Edges<'_> {
    /// What jumps over the lobes of some lanes.
    pub fn lobes_of(&self, lanes: u32, at: &At, out: &mut Found) {
        lobe::find(self, &self.scene(at.view), (at, lanes), out);
    }
}
