//! Our own estimator: the domain of each integral is cut into cells by lines, and what jumps is
//! found between their ends.

mod bright;
mod chain;
mod delta;
pub mod environment;
pub mod film;
mod light;
mod line_search;
pub mod lobe;

use crate::boundary::search_scene::{SearchScene, Things};
use crate::discontinuity::adjacency::Adjacency;
use crate::paths::at::At;
use crate::paths::bounce::Bounce;
use crate::paths::boundary_sample::Found;
use crate::paths::estimator::{BoundaryEstimator, FilmTile, LightDraw, WholeFilm};
use crate::paths::film::drift::Drift;
use crate::paths::lobe_drift::LobeDrift;
use crate::paths::moving::Moving;
use crate::paths::scene_view::SceneView;
use film::drift::Follows;
use std::sync::OnceLock;

/// Of the usual lines, where there are few.
const FEW_LINES: f32 = 0.25;

/// Changes of variables that hold the discontinuities still in cells (`docs/method.md`).
pub struct Cells<'a> {
    adjacency: &'a Adjacency,
    /// What moves, of what there are boundaries.
    moving: &'a Moving,
    things: Things,
    /// Whether directions drift also from points that rest.
    drifts_from_rest: bool,
    /// How often diffuse and wide lobes are searched, of what is usual.
    lines_over_lobes: f32,
    lobe_drift: OnceLock<Option<LobeDrift>>,
}

impl<'a> Cells<'a> {
    pub fn new(adjacency: &'a Adjacency, moving: &'a Moving) -> Self {
        Self {
            adjacency,
            moving,
            things: Things::default(),
            drifts_from_rest: true,
            lines_over_lobes: 1.0,
            lobe_drift: OnceLock::new(),
        }
    }

    /// The same for lobes of points that move only.
    pub fn from_moving_points(adjacency: &'a Adjacency, moving: &'a Moving) -> Self {
        Self {
            drifts_from_rest: false,
            ..Self::new(adjacency, moving)
        }
    }

    /// The same with fewer lines over diffuse and wide lobes, for scenes in which each meets much
    /// that brings little.
    pub fn with_few_lines(adjacency: &'a Adjacency, moving: &'a Moving) -> Self {
        Self {
            lines_over_lobes: FEW_LINES,
            ..Self::new(adjacency, moving)
        }
    }

    /// What carries the film's samples, if the film follows this.
    pub fn drift_with(&self, film: &WholeFilm, follows: Follows) -> Option<Drift> {
        film::drift::find(&self.scene(film.view), film, follows)
    }

    /// What jumps over the lobes of some lanes.
    pub fn lobes_of(&self, lanes: u32, at: &At, bounce: &Bounce, out: &mut Found) {
        if lanes & at.vertices.hit != 0 {
            lobe::packet::find(&self.scene(at.view), at, (bounce, lanes), out);
        }
    }

    fn scene<'s>(&'s self, view: &'s SceneView<'s>) -> SearchScene<'s> {
        SearchScene {
            view,
            adjacency: self.adjacency,
            moving: self.moving,
            things: &self.things,
            lobe_drift: self.lobe_drift.get().and_then(Option::as_ref),
            lines_over_lobes: self.lines_over_lobes,
        }
    }
}

impl BoundaryEstimator for Cells<'_> {
    fn moving(&self) -> Option<&Moving> {
        Some(self.moving)
    }

    fn closes_lattice(&self) -> bool {
        true
    }

    fn drift(&self, film: &WholeFilm) -> Option<Drift> {
        self.drift_with(film, Follows::WhatPays)
    }

    fn lobe_drift(&self, view: &SceneView) -> Option<&LobeDrift> {
        let make = || {
            let drift = lobe::drift::find(&self.scene(view))?;
            Some(if self.drifts_from_rest {
                drift
            } else {
                drift.from_moving_points()
            })
        };
        self.lobe_drift.get_or_init(make).as_ref()
    }

    fn film(&self, film: &FilmTile, out: &mut Found) {
        film::search::find(&self.scene(film.view), film, out);
    }

    fn light(&self, at: &At, draw: &LightDraw, out: &mut Found) {
        light::find(&self.scene(at.view), at, draw, out);
    }

    fn environment(&self, at: &At, out: &mut Found) {
        environment::map::find(&self.scene(at.view), at, out);
    }

    fn lobe(&self, at: &At, bounce: &Bounce, out: &mut Found) {
        self.lobes_of(u32::MAX, at, bounce, out);
    }
}
