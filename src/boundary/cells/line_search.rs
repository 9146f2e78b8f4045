//! What lies on an interval of a line of rays: searched for from what its ends see, and looked at
//! from both sides.
//!
//! On the film the line is a row or a column of the lattice, over a lobe a half great circle. In
//! both cases two neighbours that see different triangles have a boundary between them
//! (`discontinuity::between`). The radiance is probed right beside it, and where what is seen there
//! is not what the interval's end sees, something else ends between them: the rest of the interval
//! is searched again.

use crate::boundary::inclusion_by_walks::Border;
use crate::boundary::probe::{Probed, Sides};
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::arc::Arc;
use crate::discontinuity::between::{Unresolved, between, between_halves};
use crate::discontinuity::boundary::Boundary;
use crate::discontinuity::crossing::{Crossing, Kind};
use crate::lanes::{LANES, Lane, V3};
use crate::paths::counts::Counts;
use crate::paths::rays::lane_of;
use glam::{DVec3, Vec3};
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

    /// Whether silhouettes in it may be looked at again: what brings nothing at a first look is
    /// kept, then.
    fn is_looked_at_again(&self) -> bool;
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

/// A crossing at which the radiance jumps, or may at another look.
pub struct Jump<C> {
    pub at: Candidate<C>,
    /// Radiance before minus radiance after it, times how many crossings it stands for.
    pub jump: DVec3,
}

/// A search on one line, or on several.
pub struct LineSearch<'a, C: Cell> {
    scene: &'a SearchScene<'a>,
    pub counts: &'a mut Counts,
    pub met: Vec<Jump<C>>,
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
        self.counts.unresolved += unresolved.len() as u64;
        for ([from, to], seen) in unresolved {
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

    /// Looks on both sides of each candidate and keeps those at which the radiance jumps. Returns
    /// what else must lie in their cells. `look` is given up to LANES / 2 candidates, and the
    /// directions beside them in pairs of lanes.
    pub fn probe(
        &mut self,
        candidates: &[Candidate<C>],
        mut look: impl FnMut(&[Candidate<C>], &[Vec3; LANES], Sides, &mut Counts) -> Probed,
    ) -> Vec<Candidate<C>> {
        let mut rest = Vec::new();
        for group in candidates.chunks(LANES / 2) {
            let (directions, sides) = beside(group);
            let (radiance, seen) = look(group, &directions, sides, self.counts);
            for (i, candidate) in group.iter().enumerate() {
                let jump = candidate.jump(radiance, i);
                let seen = [2 * i, 2 * i + 1].map(|l| seen[l]);
                rest.extend(self.settle(candidate, jump, seen));
            }
        }
        rest
    }

    /// Looks again at what was met, as often as `again` says of each, and takes the mean of these
    /// looks. `look` is given the numbers of the lanes' looks.
    pub fn look_again(
        &mut self,
        again: &[Range<u32>],
        mut look: impl FnMut(&[u32; LANES], &[Vec3; LANES], Sides, &mut Counts) -> Probed,
    ) {
        for (met, again) in self.met.iter_mut().zip(again) {
            if !again.is_empty() {
                met.jump = DVec3::ZERO;
            }
        }
        for round in 0..again.iter().map(Range::len).max().unwrap_or(0) {
            let rest: Vec<usize> = (0..again.len())
                .filter(|&i| again[i].len() > round)
                .collect();
            for group in rest.chunks(LANES / 2) {
                let candidates: Vec<_> = group.iter().map(|&i| self.met[i].at).collect();
                let (directions, sides) = beside(&candidates);
                let number = |&i: &usize| again[i].start + round as u32;
                let numbers = std::array::from_fn(|lane| group.get(lane / 2).map_or(0, number));
                let (radiance, _) = look(&numbers, &directions, sides, self.counts);
                for (lane, &i) in group.iter().enumerate() {
                    let looks = again[i].len() as f64;
                    self.met[i].jump += candidates[lane].jump(radiance, lane) / looks;
                }
            }
        }
    }

    /// Keeps a candidate if the radiance jumps there, and returns what else must lie in its cell.
    fn settle(
        &mut self,
        candidate: &Candidate<C>,
        jump: DVec3,
        seen: [u32; 2],
    ) -> Vec<Candidate<C>> {
        let Candidate { crossing, .. } = *candidate;
        if !jump.is_finite() {
            self.counts.boundary_not_finite += 1;
        } else if (jump != DVec3::ZERO || candidate.may_jump()) && !self.is_hidden(candidate, seen)
        {
            self.met.push(Jump {
                at: *candidate,
                jump,
            });
        }
        if crossing.is_silhouette() {
            self.rest(candidate, seen)
        } else {
            Vec::new()
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
                rest.extend(self.rest(candidate, seen));
            }
            found = rest;
        }
    }

    /// Keeps the border at a silhouette beside which `seen` is seen, unless it lies behind that;
    /// and returns the silhouettes in the rest of its cell: where what is seen beside it is not
    /// what an end of the cell sees, something else ends in between.
    fn rest(&mut self, candidate: &Candidate<C>, seen: [u32; 2]) -> Vec<Candidate<C>> {
        let Candidate { crossing, cell, .. } = candidate;
        let places = candidate.places_beside();
        if !self.is_hidden(candidate, seen) {
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

    /// Whether another look may find a jump, where the first one has found none.
    pub fn may_jump(&self) -> bool {
        self.crossing.is_silhouette()
            && self.cell.is_looked_at_again()
            && self.cell.moves(&self.crossing.boundary)
    }

    /// The jump of what a pair of lanes sees, times how many crossings it stands for.
    fn jump(&self, radiance: V3<Lane>, pair: usize) -> DVec3 {
        let [before, after] = [0, 1].map(|side| lane_of(radiance, 2 * pair + side).as_dvec3());
        (before - after) * self.crossing.count
    }
}

/// The directions on both sides of candidates, in pairs of lanes, and what is asked of them.
fn beside<C: Cell>(candidates: &[Candidate<C>]) -> ([Vec3; LANES], Sides) {
    let mut directions = [Vec3::Z; LANES];
    let mut sides = Sides::default();
    for (i, candidate) in candidates.iter().enumerate() {
        let Candidate { crossing, cell, .. } = candidate;
        for (k, s) in candidate.places_beside().into_iter().enumerate() {
            directions[2 * i + k] = cell.direction(s).as_vec3();
        }
        let moves = cell.moves(&crossing.boundary);
        sides.add(i, moves, crossing.kind == Kind::FacetEdge);
    }
    (directions, sides)
}
