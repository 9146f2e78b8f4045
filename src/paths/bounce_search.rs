//! What lies on one line over the hemisphere of a vertex: searched for, and looked at from both sides.

use super::beside::Beside;
use super::bounce_cells::{FAMILIES, Finder, Seen};
use super::bounce_lines::{LaneSurface, Line};
use super::line_runs::{Border, LineRuns, RayLine};
use super::occluders::{NEAREST, PROBE, SurfacePoint, probe_angle};
use super::random::Stream;
use super::rays::{RayPacket, from_lanes, lane_of, leave};
use super::tracer::Counts;
use crate::lanes::{LANES, Lane, V3};
use crate::warp::boundary::Boundary;
use crate::warp::crossing::{Crossing, Kind};
use crate::warp::resolve::{between, between_halves};
use crate::warp::walk::Arc;
use glam::{DVec3, Vec3};

/// A crossing on a line among reflecting surfaces, before its jump is known.
struct Found {
    crossing: Crossing,
    arc: Arc,
    /// Where on the line.
    psi: f64,
    /// How far beside it is looked, on the arc.
    beside: f64,
    /// What the ends of the arc see.
    triangles: [u32; 2],
    /// The points of the line between which it was found.
    cell: [f64; 2],
}

/// A crossing that was looked at.
struct Met {
    boundary: Boundary,
    psi: f64,
    is_silhouette: bool,
    cell: [f64; 2],
    /// Of the radiance.
    jump: DVec3,
}

/// What was found on a line.
#[derive(Default)]
struct OnLine {
    met: Vec<Met>,
    /// Where something else begins to be seen, whether it is known why or not.
    borders: Vec<Border>,
}

/// A line, and where its rays start.
struct FromHere<'a> {
    line: &'a Line,
    point: &'a SurfacePoint,
}

/// Whose line it is, how much that stands for, and how paths go on from what is found on it.
pub(super) struct Way<'a> {
    pub lane: usize,
    pub weight: f64,
    pub is_narrow: bool,
    pub depth: u32,
    pub stream: &'a Stream,
}

impl RayLine for FromHere<'_> {
    const ROUNDS: u32 = ROUNDS;

    fn arc(&self, ends: [f64; 2]) -> Arc {
        let [a, b] = ends.map(|psi| self.line.direction(psi));
        Arc {
            origin: self.point.leave(a + b).as_dvec3(),
            a,
            b,
        }
    }

    fn coordinate(&self, arc: &Arc, _: [f64; 2], s: f64) -> f64 {
        self.line.psi_of(arc.direction(s))
    }
}

/// Silhouettes behind one another that are looked for in one cell.
const ROUNDS: u32 = 8;
/// Random numbers of what looks beside crossings, in packets: of one part of a line, and of the whole line with its own plane.
pub(super) const PROBES_OF_PART: u32 = ROUNDS * 4;
pub(super) const PROBES: u32 = 2 * PROBES_OF_PART + 1;

impl Finder<'_> {
    /// What is found on a line, all of which lies on one side of the triangle it starts on.
    pub(super) fn part(
        &mut self,
        line: &Line,
        at: &mut LaneSurface,
        way: &Way,
        seen: Seen,
        choice: &dyn Fn(u32) -> f64,
        probes: impl Fn(u32) -> u32,
    ) {
        let lane = way.lane;
        let mut on_line = OnLine::default();
        let mut found = self.crossings(line, lane, seen, choice, &mut on_line);
        for round in 0..ROUNDS {
            found = self.probe(line, way, &found, probes(round * 4), &mut on_line);
            if found.is_empty() {
                break;
            }
        }
        let point = SurfacePoint::of_lane(self.surface, &self.vertices.triangle, lane);
        let OnLine { met, borders } = on_line;
        let (geometry, adjacency) = (self.tracer.geometry, self.adjacency);
        let from_here = FromHere {
            line,
            point: &point,
        };
        let mut runs = LineRuns::new(geometry, adjacency, &from_here, borders, |psi| {
            line.runs(&psi)
        });
        for met in met {
            let chance = if met.is_silhouette {
                runs.chance_of_border(met.psi, met.cell)
            } else {
                runs.chance_of_ridge(met.psi)
            };
            let jump = met.jump * (FAMILIES * way.weight / chance);
            let direction = line.direction(met.psi);
            self.push(at, line, lane, met.boundary, direction, jump);
        }
    }

    /// The jump where a line crosses the plane of the triangle it starts on, which turns with the triangle.
    pub(super) fn own_plane(
        &mut self,
        before: &Line,
        beyond: &Line,
        psi: f64,
        at: &mut LaneSurface,
        way: &Way,
        index: u32,
    ) {
        let lane = way.lane;
        let (Some(&end), Some(&start)) = (before.psi.last(), beyond.psi.first()) else {
            return;
        };
        if self.vertices.moves >> lane & 1 == 0 {
            return;
        }
        let point = SurfacePoint::of_lane(self.surface, &self.vertices.triangle, lane);
        let [a, b] = [end, start].map(|psi| before.direction(psi).as_vec3());
        let directions = from_lanes(&std::array::from_fn(|l| if l == 0 { a } else { b }));
        let mut sides = Beside::default();
        sides.add(0, true, false);
        let (radiance, _) = self.radiance_beside(&point, directions, sides, way, &[index; LANES]);
        let [before_it, beyond_it] = [0, 1].map(|l| lane_of(radiance, l).as_dvec3());
        let jump = (before_it - beyond_it) * (FAMILIES * way.weight);
        if jump != DVec3::ZERO {
            let boundary = Boundary::Edge(point.plane_edge(self.tracer));
            self.push(at, before, lane, boundary, before.direction(psi), jump);
        }
    }

    /// Radiance from these directions, and the triangles that all that are `active` see.
    fn radiance_beside(
        &mut self,
        point: &SurfacePoint,
        directions: V3<Lane>,
        beside: Beside,
        way: &Way,
        index: &[u32; LANES],
    ) -> (V3<Lane>, [u32; LANES]) {
        let normal = from_lanes(&[point.geometric; LANES]);
        let rays = RayPacket {
            active: beside.active,
            origin: leave(from_lanes(&[point.x; LANES]), normal, directions),
            direction: directions,
            near: 0.0,
            far: f32::INFINITY,
        };
        self.tracer.radiance_along(
            rays,
            beside,
            way.depth,
            way.is_narrow,
            way.stream,
            index,
            self.counts,
        )
    }

    /// Everything on a line at which the radiance may jump.
    fn crossings(
        &mut self,
        line: &Line,
        lane: usize,
        seen: Seen,
        choice: &dyn Fn(u32) -> f64,
        on_line: &mut OnLine,
    ) -> Vec<Found> {
        let point = SurfacePoint::of_lane(self.surface, &self.vertices.triangle, lane);
        let points: Vec<(DVec3, u32)> = line
            .psi
            .iter()
            .enumerate()
            .map(|(i, &psi)| {
                let d = line.direction(psi);
                if let (true, Seen::Triangles(triangles)) = (line.bounce == Some(i), seen) {
                    return (d, triangles[lane]);
                }
                self.counts.bounce_cell += 1;
                let far = f32::INFINITY;
                (
                    d,
                    point.first_hit(self.tracer, d, far, &mut Counts::default()),
                )
            })
            .collect();
        let mut found: Vec<Found> = Vec::new();
        for (i, pair) in points.windows(2).enumerate() {
            let arc = Arc {
                origin: point.leave(pair[0].0 + pair[1].0).as_dvec3(),
                a: pair[0].0,
                b: pair[1].0,
            };
            let ends = [pair[0].1, pair[1].1];
            let cell = [line.psi[i], line.psi[i + 1]];
            let choice = Some(choice(i as u32));
            found.extend(self.between(line, &point, &arc, cell, ends, choice, on_line));
        }
        found
    }

    /// What lies on an arc, in a cell of the line, between two directions in which these triangles are seen.
    #[allow(clippy::too_many_arguments)]
    fn between(
        &mut self,
        line: &Line,
        point: &SurfacePoint,
        arc: &Arc,
        cell: [f64; 2],
        ends: [u32; 2],
        choice: Option<f64>,
        on_line: &mut OnLine,
    ) -> Vec<Found> {
        let (tracer, adjacency) = (self.tracer, self.adjacency);
        let mut probes = Counts::default();
        let seen = |s: f64| point.first_hit(tracer, arc.direction(s), f32::INFINITY, &mut probes);
        let find = |[from, to]: [f64; 2], triangles: [u32; 2]| {
            let arc = Arc {
                a: arc.direction(from),
                b: arc.direction(to),
                ..*arc
            };
            let gap = (2.0 * NEAREST / arc.a.angle_between(arc.b)).min(2.0 * PROBE);
            let crossings = between(tracer.geometry, adjacency, &arc, triangles, choice, gap)?;
            Ok((arc, triangles, crossings))
        };
        let (parts, unresolved) = between_halves(ends, seen, find);
        self.counts.unresolved += unresolved.len() as u64;
        let psi_at = |s: f64| line.psi_of(arc.direction(s));
        on_line
            .borders
            .extend(unresolved.into_iter().map(|([from, to], seen)| Border {
                at: psi_at(0.5 * (from + to)),
                beside: [from, to].map(psi_at),
                seen,
            }));
        let mut found = Vec::new();
        for (arc, triangles, crossings) in parts {
            for crossing in crossings.into_iter().flatten() {
                let [angle, most] = probe_angle(tracer.geometry, &crossing, arc.origin);
                found.push(Found {
                    crossing,
                    arc,
                    beside: (angle / arc.a.angle_between(arc.b)).min(most),
                    psi: line.psi_of(arc.direction(crossing.s)),
                    triangles,
                    cell,
                });
            }
        }
        *self.counts += probes;
        found
    }

    /// Looks on both sides of each crossing: the jump is taken where it is, not at the ends of the cell. Returns what else
    /// must lie in their cells.
    fn probe(
        &mut self,
        line: &Line,
        way: &Way,
        found: &[Found],
        index: u32,
        on_line: &mut OnLine,
    ) -> Vec<Found> {
        let mut rest = Vec::new();
        let geometry = self.tracer.geometry;
        let lane = way.lane;
        let point = SurfacePoint::of_lane(self.surface, &self.vertices.triangle, lane);
        let moves = |f: &Found| {
            self.vertices.moves >> lane & 1 == 1
                || self.tracer.moving.boundary(geometry, &f.crossing.boundary)
        };
        let moves: Vec<bool> = found.iter().map(moves).collect();
        for (number, group) in found.chunks(LANES / 2).enumerate() {
            let mut directions = [Vec3::Z; LANES];
            let mut sides = Beside::default();
            for (i, found) in group.iter().enumerate() {
                for (k, side) in [-found.beside, found.beside].into_iter().enumerate() {
                    directions[2 * i + k] = found
                        .arc
                        .direction(found.crossing.s + side)
                        .normalize()
                        .as_vec3();
                }
                sides.add(
                    i,
                    moves[number * LANES / 2 + i],
                    found.crossing.kind == Kind::Bend,
                );
            }
            let index = std::array::from_fn(|l| index + (number * LANES / 2 + l / 2) as u32);
            let (radiance, seen) =
                self.radiance_beside(&point, from_lanes(&directions), sides, way, &index);
            for (i, found) in group.iter().enumerate() {
                let [before, after] = [2 * i, 2 * i + 1].map(|l| lane_of(radiance, l).as_dvec3());
                let seen = [seen[2 * i], seen[2 * i + 1]];
                let jump = (before - after) * found.crossing.count;
                let is_hidden = found.crossing.is_hidden(seen);
                if !jump.is_finite() {
                    self.counts.boundary_not_finite += 1;
                } else if jump != DVec3::ZERO && !is_hidden {
                    on_line.met.push(Met {
                        boundary: found.crossing.boundary,
                        psi: found.psi,
                        is_silhouette: found.crossing.is_silhouette(),
                        cell: found.cell,
                        jump,
                    });
                }
                if found.crossing.is_silhouette() {
                    if seen[0] != seen[1] {
                        let beside =
                            [-found.beside, found.beside].map(|side| found.crossing.s + side);
                        on_line.borders.push(Border {
                            at: found.psi,
                            beside: beside.map(|s| line.psi_of(found.arc.direction(s))),
                            seen,
                        });
                    }
                    rest.extend(self.rest(line, &point, found, seen, on_line));
                }
            }
        }
        rest
    }

    /// The silhouettes in the rest of the cell in which one was found, beside which `seen` is seen: where that is not what
    /// the ends see, something else ends in between.
    fn rest(
        &mut self,
        line: &Line,
        point: &SurfacePoint,
        found: &Found,
        [before, after]: [u32; 2],
        on_line: &mut OnLine,
    ) -> Vec<Found> {
        let Found {
            crossing: Crossing { s, .. },
            arc,
            beside,
            cell,
            ..
        } = *found;
        let [a, b] = found.triangles;
        let parts = [
            (0.0, s - beside, [a, before]),
            (s + beside, 1.0, [after, b]),
        ];
        let mut rest = Vec::new();
        for (from, to, triangles) in parts {
            if triangles[0] == triangles[1] || from >= to {
                continue;
            }
            let arc = Arc {
                a: arc.direction(from),
                b: arc.direction(to),
                ..arc
            };
            // Edges within what is seen were chosen for the whole cell already.
            rest.extend(self.between(line, point, &arc, cell, triangles, None, on_line));
        }
        rest
    }
}
