//! The seam between rendering and the boundary terms of its gradient.
//!
//! An integral whose integrand jumps has a derivative with two terms: the integral of the
//! integrand's own derivative, and a term of the places where it jumps. The first needs nothing but
//! the stored paths. For the second the integrator calls an estimator wherever it estimates such an
//! integral: over the film, over a light, over the environment, over the directions of a lobe. The
//! estimator leaves [`BoundarySample`]s there, all of one kind, which the sweeps differentiate.
//! Neither the integrator nor the sweeps know which estimator left them.
//!
//! [`BoundarySample`]: crate::paths::boundary_sample::BoundarySample

use crate::lanes::LANES;
use crate::paths::at::At;
use crate::paths::bounce::Bounce;
use crate::paths::boundary_sample::Found;
use crate::paths::film::drift::Drift;
use crate::paths::film::filter::FilmFilter;
use crate::paths::film::lattice::{Lattice, LatticeImage, Tile};
use crate::paths::integral::Integral;
use crate::paths::lobe_drift::LobeDrift;
use crate::paths::moving::Moving;
use crate::paths::scene_view::SceneView;
use crate::paths::warp::seam::Warp;
use crate::scene::Filter;

/// Finds what jumps in the integrals along paths. Every method has a default that finds nothing.
pub trait BoundaryEstimator: Sync {
    /// What moves, if the estimator wants [`Vertices::moves`] to be told.
    ///
    /// [`Vertices::moves`]: crate::paths::store::Vertices::moves
    fn moving(&self) -> Option<&Moving> {
        None
    }

    /// What moves samples, if the estimator does that instead of finding borders.
    fn warp(&self) -> Option<&dyn Warp> {
        None
    }

    /// Whether the film's lattice needs one point more beyond each side of a tile, so that its
    /// cells cover the tile.
    fn closes_lattice(&self) -> bool {
        false
    }

    /// The velocity field that carries the film's samples, before any of them is traced; `None`
    /// where they rest.
    fn drift(&self, _film: &WholeFilm) -> Option<Drift> {
        None
    }

    /// What directions over lobes move with; `None` if all keep their places in their frames.
    fn lobe_drift(&self, _view: &SceneView) -> Option<&LobeDrift> {
        None
    }

    /// Whether it wants to know what bounces from the last vertices meet, and not only which light
    /// they see.
    fn asks_what_bounces_meet(&self) -> bool {
        true
    }

    /// Over the film: jumps of the radiance in a tile, whose samples have been traced.
    fn film(&self, _film: &FilmTile, _out: &mut Found) {}

    /// Over a light: jumps of its visibility and its radiance, seen from a vertex that has drawn a
    /// sample of it.
    fn light(&self, _at: &At, _draw: &LightDraw, _out: &mut Found) {}

    /// Over an environment map: jumps of its visibility, seen from a vertex that has drawn a sample
    /// of it.
    fn environment(&self, _at: &At, _out: &mut Found) {}

    /// Over the directions of a lobe: jumps of the radiance that arrives at a vertex whose bounce
    /// has been traced.
    fn lobe(&self, _at: &At, _bounce: &Bounce, _out: &mut Found) {}
}

/// The same, counting what is found and what is lost.
impl dyn BoundaryEstimator + '_ {
    pub fn search_film(&self, film: &FilmTile, out: &mut Found) {
        out.search(Integral::Film, |out| self.film(film, out));
    }

    pub fn search_light(&self, at: &At, draw: &LightDraw, out: &mut Found) {
        out.search(Integral::Lights, |out| self.light(at, draw, out));
    }

    pub fn search_environment(&self, at: &At, out: &mut Found) {
        out.search(Integral::Environment, |out| self.environment(at, out));
    }

    pub fn search_lobe(&self, at: &At, bounce: &Bounce, out: &mut Found) {
        out.search(Integral::Lobes, |out| self.lobe(at, bounce, out));
    }
}

/// The estimator that finds nothing: what is left is the derivative that ignores visibility.
pub struct Interior;

impl BoundaryEstimator for Interior {
    fn asks_what_bounces_meet(&self) -> bool {
        false
    }
}

/// The film before anything is traced.
pub struct WholeFilm<'a> {
    pub view: &'a SceneView<'a>,
    pub lattice: &'a Lattice,
    pub filter: &'a FilmFilter,
    pub seed: u64,
}

/// A tile of the film, and what its samples saw.
#[derive(Clone, Copy)]
pub struct FilmTile<'a> {
    pub view: &'a SceneView<'a>,
    pub tile: &'a Tile,
    pub image: &'a LatticeImage,
    pub filter: Filter,
    pub drift: Option<&'a Drift>,
}

impl FilmTile<'_> {
    /// Whether the film may drift at a point.
    pub fn drifts(&self, at: [f64; 2]) -> bool {
        self.drift.is_some_and(|drift| drift.moves(at))
    }
}

/// The sample of a light in each lane, as it was drawn.
pub struct LightDraw {
    pub patch: [u32; LANES],
    /// Uniform in the unit square, also where the light is a triangle.
    pub square: [[f32; LANES]; 2],
}
