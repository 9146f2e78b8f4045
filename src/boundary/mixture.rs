//! Our cells and points drawn on edges, mixed: one on the film, one over lobes.
//!
//! Both find the whole of each integral's boundary term, so any mixture of them is right. Which has
//! the least noise depends on the scene (`docs/method.md`, 14). Over lights and environment maps it
//! is always the cells.
//!
//! Seen from a point that rests only the edges of what moves do. Where these are few, as those of a
//! lamp over a meadow, it is better to draw them than to look for them among all that rests; and
//! nothing that rests has to have edges that can be drawn.

use super::cells::Cells;
use super::cells::film::drift::Follows;
use super::edges::Edges;
use crate::discontinuity::adjacency::Adjacency;
use crate::paths::at::At;
use crate::paths::bounce::Bounce;
use crate::paths::boundary_sample::Found;
use crate::paths::estimator::{BoundaryEstimator, FilmTile, LightDraw, WholeFilm};
use crate::paths::film::drift::Drift;
use crate::paths::lobe_drift::LobeDrift;
use crate::paths::moving::Moving;
use crate::paths::scene_view::SceneView;

/// What finds what.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Mixture {
    pub film: OnFilm,
    pub lobes: OverLobes,
}

/// What finds borders on the film.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OnFilm {
    /// Cells on a film that may drift.
    #[default]
    Drifting,
    /// Cells on a film that rests.
    Resting,
    /// Cells on a film that drifts with all that it sees.
    WithAll,
    Edges,
}

/// What finds borders over lobes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OverLobes {
    #[default]
    Cells,
    /// Cells on fewer lines over diffuse and wide lobes.
    SeldomCells,
    /// Edges from points that rest, and cells from those that move.
    EdgesFromRest,
}

/// The estimator of a mixture.
pub struct Mixed<'a> {
    mixture: Mixture,
    cells: Cells<'a>,
    edges: Edges<'a>,
}

impl<'a> Mixed<'a> {
    pub fn new(mixture: Mixture, adjacency: &'a Adjacency, moving: &'a Moving) -> Self {
        let cells = match mixture.lobes {
            OverLobes::EdgesFromRest => Cells::from_moving_points(adjacency, moving),
            OverLobes::Cells => Cells::new(adjacency, moving),
            OverLobes::SeldomCells => Cells::with_few_lines(adjacency, moving),
        };
        Self {
            mixture,
            cells,
            edges: Edges::new(adjacency, moving),
        }
    }

    fn on_film(&self) -> &dyn BoundaryEstimator {
        match self.mixture.film {
            OnFilm::Drifting | OnFilm::Resting | OnFilm::WithAll => &self.cells,
            OnFilm::Edges => &self.edges,
        }
    }
}

impl BoundaryEstimator for Mixed<'_> {
    fn moving(&self) -> Option<&Moving> {
        self.cells.moving()
    }

    fn closes_lattice(&self) -> bool {
        self.on_film().closes_lattice()
    }

    fn drift(&self, film: &WholeFilm) -> Option<Drift> {
        let follows = match self.mixture.film {
            OnFilm::Drifting => Follows::WhatPays,
            OnFilm::WithAll => Follows::All,
            OnFilm::Resting | OnFilm::Edges => return None,
        };
        self.cells.drift_with(film, follows)
    }

    fn lobe_drift(&self, view: &SceneView) -> Option<&LobeDrift> {
        self.cells.lobe_drift(view)
    }

    fn film(&self, film: &FilmTile, out: &mut Found) {
        self.on_film().film(film, out);
    }

    fn light(&self, at: &At, draw: &LightDraw, out: &mut Found) {
        self.cells.light(at, draw, out);
    }

    fn environment(&self, at: &At, out: &mut Found) {
        self.cells.environment(at, out);
    }

    fn lobe(&self, at: &At, bounce: &Bounce, out: &mut Found) {
        match self.mixture.lobes {
            OverLobes::Cells | OverLobes::SeldomCells => self.cells.lobe(at, bounce, out),
            OverLobes::EdgesFromRest => {
                let moves = at.vertices.moves;
                self.cells.lobes_of(moves, at, bounce, out);
                self.edges.lobes_of(!moves, at, out);
            }
        }
    }
}
