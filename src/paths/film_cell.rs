//! An interval of a line of the film's lattice, and what is found in it.

use super::lattice::Tile;
use super::line_runs::Border;
use super::occluders::{MOST_PROBE, nearest_angle, probe_angle};
use super::tracer::{Counts, Tracer};
use crate::trace::geometry::NO_TRIANGLE;
use crate::warp::adjacency::Adjacency;
use crate::warp::boundary::dvec3;
use crate::warp::crossing::{Crossing, Kind};
use crate::warp::resolve::{Unresolved, between, between_halves};
use crate::warp::walk::Arc;
use glam::DVec3;
use std::collections::BTreeMap;

/// How far beside a silhouette the probes look at most, in pixels.
const PROBE_PIXELS: f64 = 1e-3;

/// Where something else begins to be seen on lines of the lattice; coordinates are steps from the line's first point.
pub(super) type Borders = BTreeMap<LatticeLine, Vec<Border>>;

/// A row (axis 0) or a column (axis 1) of the lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct LatticeLine {
    pub axis: usize,
    pub number: usize,
}

/// A crossing before its jump is known.
pub(super) struct Candidate<'a> {
    pub crossing: Crossing,
    pub at: [f64; 2],
    /// Where it was found.
    pub cell: Cell<'a>,
}

/// The interval between two neighbours, or a part of it.
#[derive(Clone, Copy)]
pub(super) struct Cell<'a> {
    pub tracer: &'a Tracer<'a>,
    pub adjacency: &'a Adjacency,
    pub tile: &'a Tile,
    pub start: [f64; 2],
    pub line: LatticeLine,
    /// Pixels along the line.
    pub length: f64,
    /// What its ends see.
    pub triangles: [u32; 2],
    /// How many cells it stands for.
    pub weight: u32,
    /// Its own among those of the tile.
    pub number: u32,
}

impl<'a> Cell<'a> {
    /// Film position and direction at `s`.
    fn at(&self, s: f64) -> ([f64; 2], DVec3) {
        let mut at = self.start;
        at[self.line.axis] += s * self.length;
        (at, dvec3(self.tracer.camera.direction(at[0], at[1])))
    }

    /// What lies between the triangles seen at its ends.
    fn crossings(&self, choice: Option<f64>) -> Result<[Option<Candidate<'a>>; 2], Unresolved> {
        let arc = Arc {
            origin: self.tracer.camera.origin.as_dvec3(),
            a: self.at(0.0).1,
            b: self.at(1.0).1,
        };
        let found = between(
            self.tracer.geometry,
            self.adjacency,
            &arc,
            self.triangles,
            choice,
            choice.map_or(0.0, |_| 2.0 * self.nearest() / self.length),
        )?;
        let candidate = |crossing: Option<Crossing>| {
            let mut crossing = crossing?;
            crossing.count *= self.weight as f64;
            Some(Candidate {
                crossing,
                at: self.at(crossing.s).0,
                cell: *self,
            })
        };
        Ok(found.map(candidate))
    }

    /// How near to an edge of what its ends see probes look at most, in pixels: what they have between them are edges
    /// of their own, however fine the mesh.
    fn nearest(&self) -> f64 {
        let (geometry, camera) = (self.tracer.geometry, &self.tracer.camera);
        let origin = camera.origin.as_dvec3();
        let seen = self.triangles.iter().filter(|&&t| t != NO_TRIANGLE);
        let angles = seen.map(|&t| {
            let [vertex, _, _] = geometry.triangles[t as usize];
            nearest_angle(geometry.positions[vertex as usize].as_dvec3(), origin)
        });
        let angle = angles.fold(0.0, f64::max);
        let angle_per_pixel = self.angle_per_pixel(self.at(0.5).1);
        (angle / angle_per_pixel).min(beside(self.tile, self.line.axis))
    }

    /// The angle of a pixel along the line, in a direction.
    fn angle_per_pixel(&self, direction: DVec3) -> f64 {
        let per_pixel = self.tracer.camera.direction_per_pixel()[self.line.axis];
        direction.cross(per_pixel).length() / direction.length_squared()
    }

    /// The same where something else may stand in front of both triangles.
    pub fn all_crossings(
        &self,
        choice: Option<f64>,
        borders: &mut Borders,
        counts: &mut Counts,
    ) -> Vec<Candidate<'a>> {
        let mut probes = 0;
        let seen = |s: f64| {
            probes += 1;
            first_hit(self.tracer, self.at(s).0)
        };
        let find = |place, triangles| self.part(place, triangles).crossings(choice);
        let (found, unresolved) = between_halves(self.triangles, seen, find);
        counts.probe += probes;
        counts.unresolved += unresolved.len() as u64;
        for ([from, to], seen) in unresolved {
            let at = |s: f64| steps(self.tile, self.line, self.at(s).0);
            borders.entry(self.line).or_default().push(Border {
                at: at(0.5 * (from + to)),
                beside: [from, to].map(at),
                seen,
            });
        }
        found.into_iter().flatten().flatten().collect()
    }

    /// The part between two places, at which these triangles are seen.
    fn part(&self, [from, to]: [f64; 2], triangles: [u32; 2]) -> Self {
        Self {
            start: self.at(from).0,
            length: (to - from) * self.length,
            triangles,
            ..*self
        }
    }
}

impl<'a> Candidate<'a> {
    /// How far beside it probes look, in pixels.
    fn distance(&self) -> f64 {
        let Cell { tracer, tile, .. } = self.cell;
        let axis = self.cell.line.axis;
        let camera = &tracer.camera;
        let origin = camera.origin.as_dvec3();
        let [angle, _] = probe_angle(tracer.geometry, &self.crossing, origin);
        let direction = dvec3(camera.direction(self.at[0], self.at[1]));
        let angle_per_pixel = self.cell.angle_per_pixel(direction);
        let most = if self.crossing.kind == Kind::ThinSilhouette {
            MOST_PROBE * tile.step[axis]
        } else {
            beside(tile, axis)
        };
        (angle / angle_per_pixel).min(most)
    }

    /// The film positions on either side, where probes look.
    pub fn beside(&self) -> [[f64; 2]; 2] {
        let axis = self.cell.line.axis;
        let beside = self.distance();
        [-beside, beside].map(|side| {
            let mut at = self.at;
            at[axis] += side;
            at
        })
    }

    /// Adds a silhouette beside which `seen` is seen, unless it lies behind that.
    pub fn add_border(&self, seen: [u32; 2], borders: &mut Borders) {
        let Cell { tile, line, .. } = self.cell;
        if seen[0] != seen[1] {
            borders.entry(line).or_default().push(Border {
                at: steps(tile, line, self.at),
                beside: self.beside().map(|at| steps(tile, line, at)),
                seen,
            });
        }
    }

    /// The silhouettes in the rest of its cell: where what is seen beside it is not what an end of the cell sees, something
    /// else ends in between.
    pub fn rest(
        &self,
        seen: [u32; 2],
        borders: &mut Borders,
        counts: &mut Counts,
    ) -> Vec<Candidate<'a>> {
        let Self {
            cell,
            crossing: Crossing { s, .. },
            ..
        } = self;
        let beside = self.distance() / cell.length;
        let [a, b] = cell.triangles;
        let [before, after] = seen;
        let parts = [
            (0.0, s - beside, [a, before]),
            (s + beside, 1.0, [after, b]),
        ];
        let mut rest = Vec::new();
        for (from, to, triangles) in parts {
            if triangles[0] == triangles[1] || from >= to {
                continue;
            }
            // Edges within what is seen were chosen for the whole cell already.
            let part = cell.part([from, to], triangles);
            rest.extend(part.all_crossings(None, borders, counts));
        }
        rest
    }
}

/// Distance of a film position from a line's first point in steps of the lattice.
pub(super) fn steps(tile: &Tile, line: LatticeLine, at: [f64; 2]) -> f64 {
    (at[line.axis] - tile.first[line.axis]) / tile.step[line.axis]
}

/// The same for the probes of a cell.
fn beside(tile: &Tile, axis: usize) -> f64 {
    PROBE_PIXELS.min(MOST_PROBE * tile.step[axis])
}

/// The triangle seen at a film position.
pub(super) fn first_hit(tracer: &Tracer, [u, v]: [f64; 2]) -> u32 {
    let camera = &tracer.camera;
    let direction = dvec3(camera.direction(u, v)).as_vec3();
    tracer.first_hit(camera.origin, direction, camera.near_clip, camera.far_clip)
}
