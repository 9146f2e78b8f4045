//! What lies on an interval of a line of rays: searched for from what its ends see, and looked at
//! from both sides.
//!
//! On the film the line is a row or a column of the lattice, over a lobe a half great circle. In
//! both cases two neighbours that see different triangles have a boundary between them
//! (`discontinuity::between`). The radiance is probed right beside it, and where what is seen there
//! is not what the interval's end sees, something else ends between them: the rest of the interval
//! is searched again.

use crate::boundary::inclusion_by_walks::Border;
use crate::boundary::probe::Sides;
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::arc::Arc;
use crate::discontinuity::between::{Unresolved, between, between_halves};
use crate::discontinuity::boundary::Boundary;
use crate::discontinuity::crossing::{Crossing, Kind};
use crate::lanes::{LANES, Lane, V3};
use crate::paths::counts::Counts;
use crate::paths::rays::lane_of;
use crate::trace::geometry::NO_TRIANGLE;
use glam::DVec3;
use std::collections::BTreeMap;
use std::ops::Range;

/// An interval of a line, or a part of one. Places on it go from 0 to 1.
pub trait Cell: Copy {
    /// Which line it is of.
    type Line: Ord + Copy;

    fn line(&self) -> Self::Line;

    /// What its ends see.
    fn triangles(&self) -> [u32; 2];

    /// The part between two places, at which these triangles are seen.
    fn part(&self, ends: [f64; 2], triangles: [u32; 2]) -> Self;

    /// The rays of its ends.
    fn arc(&self) -> Arc;

    /// The direction of the ray at a place, as long as rays are.
    fn direction(&self, s: f64) -> DVec3;

    /// The line's coordinate of a place.
    fn coordinate(&self, s: f64) -> f64;

    /// The triangle that is seen at a place.
    fn first_hit(&self, s: f64) -> u32;

    /// Edges within what is seen that are nearer to the next one than this are taken as one with
    /// it.
    fn gap(&self) -> f64;

    /// How far beside a crossing probes look.
    fn beside(&self, crossing: &Crossing) -> f64;

    /// Whether a boundary moves as seen from where the rays start.
    fn moves(&self, boundary: &Boundary) -> bool;

    /// How many cells it stands for.
    fn weight(&self) -> f64;
}

/// A crossing before its jump is known.
#[derive(Clone, Copy)]
pub struct Candidate<C> {
    pub crossing: Crossing,
    /// Where it was found.
    pub cell: C,
    /// How far beside it probes look.
    beside: f64,
}

/// A crossing that is seen, at which the radiance may jump.
pub struct Met<C> {
    pub at: Candidate<C>,
    /// The triangles on its two sides.
    pub seen: [u32; 2],
    /// Radiance before minus radiance after it, times how many crossings it stands for: zero until
    /// it has been looked at.
    pub jump: DVec3,
}

/// A packet of looks at the radiance, in pairs of lanes on the two sides of what was met.
pub struct Look {
    pub directions: [DVec3; LANES],
    pub sides: Sides,
    /// The triangles that the lanes see.
    pub seen: [u32; LANES],
    /// Which of the looks of what was met it is.
    pub numbers: [u32; LANES],
}

/// A search on one line, or on several.
pub struct LineSearch<'a, C: Cell> {
    scene: &'a SearchScene<'a>,
    pub counts: &'a mut Counts,
    pub met: Vec<Met<C>>,
    /// Where something else begins to be seen, whether it is known why or not.
    pub borders: BTreeMap<C::Line, Vec<Border>>,
}

impl<'a, C: Cell> LineSearch<'a, C> {
    pub fn new(scene: &'a SearchScene<'a>, counts: &'a mut Counts) -> Self {
        Self {
            scene,
            counts,
            met: Vec::new(),
            borders: BTreeMap::new(),
        }
    }

    /// What lies between the ends of a cell, also where something stands in front of what both see.
    /// Of several edges within what is seen `choice` in [0, 1) picks one; without it none are
    /// looked for.
    pub fn candidates(&mut self, cell: &C, choice: Option<f64>) -> Vec<Candidate<C>> {
        let mut probes = 0;
        let seen = |s: f64| {
            probes += 1;
            cell.first_hit(s)
        };
        let find = |ends, triangles| self.between(cell.part(ends, triangles), choice);
        let (found, unresolved) = between_halves(cell.triangles(), seen, find);
        self.counts.probe += probes;
        for (([from, to], seen), why) in unresolved {
            self.counts.miss(why);
            self.add_border(
                cell,
                Border {
                    at: cell.coordinate(0.5 * (from + to)),
                    beside: [from, to].map(|s| cell.coordinate(s)),
                    seen,
                },
            );
        }
        found.into_iter().flatten().flatten().collect()
    }

    /// What lies between the triangles seen at the ends of a cell.
    fn between(
        &self,
        cell: C,
        choice: Option<f64>,
    ) -> Result<[Option<Candidate<C>>; 2], Unresolved> {
        let (geometry, adjacency) = (self.scene.view.geometry, self.scene.adjacency);
        let gap = choice.map_or(0.0, |_| cell.gap());
        let found = between(
            geometry,
            adjacency,
            &cell.arc(),
            cell.triangles(),
            choice,
            gap,
        )?;
        let candidate = |mut crossing: Crossing| {
            crossing.count *= cell.weight();
            Candidate {
                beside: cell.beside(&crossing),
                crossing,
                cell,
            }
        };
        Ok(found.map(|crossing| {
            let counts = crossing.filter(|crossing| !self.scene.is_bare_facet(crossing));
            counts.map(candidate)
        }))
    }

    /// Looks at what is seen on both sides of each candidate and keeps those that lie before all
    /// else and move. Returns what else must lie in their cells. `first_hits` is given directions
    /// and the lanes that have one.
    pub fn see(
        &mut self,
        candidates: &[Candidate<C>],
        first_hits: impl Fn(&[DVec3; LANES], u32) -> [u32; LANES],
    ) -> Vec<Candidate<C>> {
        let mut rest = Vec::new();
        for group in candidates.chunks(LANES / 2) {
            let (directions, sides) = beside(group);
            let seen = first_hits(&directions, sides.active);
            self.counts.probe += u64::from(sides.active.count_ones());
            for (i, candidate) in group.iter().enumerate() {
                rest.extend(self.settle(candidate, [2 * i, 2 * i + 1].map(|l| seen[l])));
            }
        }
        rest
    }

    /// Looks at the radiance on both sides of what was met, as often as `looks` says of each, and
    /// takes the mean of these jumps. What is not looked at stays as it is.
    pub fn look(
        &mut self,
        looks: &[Range<u32>],
        mut look: impl FnMut(&Look, &mut Counts) -> V3<Lane>,
    ) {
        for round in 0..looks.iter().map(Range::len).max().unwrap_or(0) {
            let wanted = (0..looks.len()).filter(|&i| looks[i].len() > round);
            let wanted: Vec<usize> = wanted.collect();
            for group in wanted.chunks(LANES / 2) {
                let candidates: Vec<_> = group.iter().map(|&i| self.met[i].at).collect();
                let (directions, sides) = beside(&candidates);
                let of_lane = |lane: usize| group.get(lane / 2).copied();
                let radiance = look(
                    &Look {
                        directions,
                        sides,
                        seen: std::array::from_fn(|lane| {
                            of_lane(lane).map_or(NO_TRIANGLE, |i| self.met[i].seen[lane % 2])
                        }),
                        numbers: std::array::from_fn(|lane| {
                            of_lane(lane).map_or(0, |i| looks[i].start + round as u32)
                        }),
                    },
                    self.counts,
                );
                for (pair, &i) in group.iter().enumerate() {
                    let jump = candidates[pair].jump(radiance, pair);
                    self.met[i].jump += jump / looks[i].len() as f64;
                }
            }
        }
        for met in &mut self.met {
            if !met.jump.is_finite() {
                self.counts.boundary_not_finite += 1;
                met.jump = DVec3::ZERO;
            }
        }
    }

    /// Keeps a candidate if it lies before all else and moves, and returns what else must lie in
    /// its cell.
    fn settle(&mut self, candidate: &Candidate<C>, seen: [u32; 2]) -> Vec<Candidate<C>> {
        let Candidate { crossing, cell, .. } = candidate;
        let is_hidden = self.is_hidden(candidate, seen);
        let (geometry, moving) = (self.scene.view.geometry, self.scene.moving);
        let boundary = crossing.boundary.standing(geometry, seen);
        if !is_hidden && cell.moves(&boundary) {
            let stands = boundary != crossing.boundary && moving.either(geometry, seen);
            self.counts.standing += u64::from(stands);
            self.met.push(Met {
                at: *candidate,
                seen,
                jump: DVec3::ZERO,
            });
        }
        match crossing.is_silhouette() {
            true => self.rest(candidate, seen, is_hidden),
            false => Vec::new(),
        }
    }

    /// Whether a crossing is not that between the triangles which are seen on its two sides, but
    /// lies behind them: something ends between the two sides of an edge within a surface, or one
    /// surface goes on between those of a silhouette.
    fn is_hidden(&self, candidate: &Candidate<C>, seen: [u32; 2]) -> bool {
        let Candidate { crossing, cell, .. } = candidate;
        if seen[0] == seen[1] {
            return crossing.is_hidden(seen);
        }
        let geometry = self.scene.view.geometry;
        let mesh_of = |t: u32| geometry.mesh_of_triangle.get(t as usize);
        let goes_on = mesh_of(seen[0]).is_some() && mesh_of(seen[0]) == mesh_of(seen[1]) && {
            let arc = cell.part(candidate.places_beside(), seen).arc();
            let found = between(geometry, self.scene.adjacency, &arc, seen, None, 0.0);
            matches!(found, Ok([None, _]))
        };
        goes_on == crossing.is_silhouette()
    }

    /// Adds the borders of a cell, whose jumps are of no interest.
    pub fn add_borders(&mut self, cell: &C, rounds: u32) {
        let mut found = self.candidates(cell, None);
        for _ in 0..rounds {
            let mut rest = Vec::new();
            for candidate in &found {
                let places = candidate.places_beside();
                let seen = places.map(|s| candidate.cell.first_hit(s));
                self.counts.probe += 2;
                let is_hidden = self.is_hidden(candidate, seen);
                rest.extend(self.rest(candidate, seen, is_hidden));
            }
            found = rest;
        }
    }

    /// Keeps the border at a silhouette beside which `seen` is seen, unless it lies behind that;
    /// and returns the silhouettes in the rest of its cell: where what is seen beside it is not
    /// what an end of the cell sees, something else ends in between.
    fn rest(
        &mut self,
        candidate: &Candidate<C>,
        seen: [u32; 2],
        is_hidden: bool,
    ) -> Vec<Candidate<C>> {
        let Candidate { crossing, cell, .. } = candidate;
        let places = candidate.places_beside();
        if !is_hidden {
            self.add_border(
                cell,
                Border {
                    at: cell.coordinate(crossing.s),
                    beside: places.map(|s| cell.coordinate(s)),
                    seen,
                },
            );
        }
        let [a, b] = cell.triangles();
        let [before, after] = places;
        let parts = [([0.0, before], [a, seen[0]]), ([after, 1.0], [seen[1], b])];
        let mut rest = Vec::new();
        for (ends @ [from, to], triangles) in parts {
            if triangles[0] != triangles[1] && from < to {
                // Edges within what is seen were chosen for the whole cell already.
                rest.extend(self.candidates(&cell.part(ends, triangles), None));
            }
        }
        rest
    }

    fn add_border(&mut self, cell: &C, border: Border) {
        self.borders.entry(cell.line()).or_default().push(border);
    }
}

impl<C: Cell> Candidate<C> {
    /// The line's coordinate.
    pub fn coordinate(&self) -> f64 {
        self.cell.coordinate(self.crossing.s)
    }

    /// Where probes look, on either side.
    fn places_beside(&self) -> [f64; 2] {
        [-self.beside, self.beside].map(|side| self.crossing.s + side)
    }

    /// The jump of what a pair of lanes sees, times how many crossings it stands for.
    fn jump(&self, radiance: V3<Lane>, pair: usize) -> DVec3 {
        let [before, after] = [0, 1].map(|side| lane_of(radiance, 2 * pair + side).as_dvec3());
        (before - after) * self.crossing.count
    }
}

/// The directions on both sides of candidates, in pairs of lanes, and what is asked of them.
fn beside<C: Cell>(candidates: &[Candidate<C>]) -> ([DVec3; LANES], Sides) {
    let mut directions = [DVec3::Z; LANES];
    let mut sides = Sides::default();
    for (i, candidate) in candidates.iter().enumerate() {
        let Candidate { crossing, cell, .. } = candidate;
        for (k, s) in candidate.places_beside().into_iter().enumerate() {
            directions[2 * i + k] = cell.direction(s);
        }
        sides.add(i, crossing.kind == Kind::FacetEdge);
    }
    (directions, sides)
}
