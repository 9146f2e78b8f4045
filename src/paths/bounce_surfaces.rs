//! Lines over the hemisphere of a vertex that other surfaces surround.
//!
//! What lies beyond a silhouette has to be known here: the ends of cells are first hits, silhouettes are walked to from both, and a
//! path is traced on either side of each.

use super::bounce_cells::{AXIS, FAMILIES, Finder, Seen};
use super::bounce_lines::{LaneSurface, Line, Lobe};
use super::occluders::{PROBE, SurfacePoint};
use super::random::Stream;
use super::rays::{RayPacket, from_lanes, lane_of, leave};
use super::tracer::Counts;
use crate::lanes::LANES;
use crate::warp::boundary::Boundary;
use crate::warp::resolve::{Crossing, between, between_halves};
use crate::warp::walk::Arc;
use glam::{DVec3, Vec3};

/// Streams of paths that look beside silhouettes are kept apart from all others by this dimension offset.
const PROBE_INDEX: u32 = 0x4000_0000;
/// One silhouette, found on two arcs of a line, has the same coordinate in both up to this angle in radians.
const ROUNDING: f64 = 1e-6;
/// A crossing on a line among reflecting surfaces, before its jump is known.
struct Found {
    boundary: Boundary,
    arc: Arc,
    /// Where on the arc.
    s: f64,
    /// Where on the line.
    psi: f64,
    is_silhouette: bool,
    /// How many it stands for.
    weight: f64,
    /// What the ends of the arc see.
    triangles: [u32; 2],
}

/// Silhouettes behind one another that are looked for in one cell.
const ROUNDS: usize = 4;

impl Finder<'_> {
    /// A line among reflecting surfaces, for one lane of the packet.
    pub(super) fn surfaces(
        &mut self,
        seen: Seen,
        depth: u32,
        stream: &Stream,
        index: &[u32; LANES],
    ) {
        let active = self.rays.active;
        let lanes = active.count_ones();
        let number = index[0].wrapping_mul(8).wrapping_add(depth);
        let choice = |salt: u32| stream.uniform(AXIS + number * 16 + salt) as f64;
        let chosen = ((choice(1) * lanes as f64) as u32).min(lanes.max(1) - 1);
        let Some(lane) = (0..LANES)
            .filter(|&l| active >> l & 1 == 1)
            .nth(chosen as usize)
        else {
            return;
        };
        let Some(lobe) = Lobe::of_lane(self.vertices, lane) else {
            return;
        };
        let scene = self.tracer.scene;
        // What light samples find at the last vertex has lines of its own, on the lights.
        let is_narrow = lobe != Lobe::Diffuse && self.vertices.kinds.wide >> lane & 1 == 0;
        let has_even_sky = scene.environment.as_ref().is_some_and(|e| e.map.is_none());
        if self.at_last && !has_even_sky && !is_narrow {
            return;
        }
        let mut at = LaneSurface::new(self.vertices, self.surface, lane, lobe);
        let jitter = self.jitter[lane] as f64;
        let line = if lobe == Lobe::Diffuse {
            let bounce = lane_of(self.rays.direction, lane).as_dvec3().normalize();
            let is_known = matches!(seen, Seen::Triangles(_));
            Some(Line::diffuse(&at, bounce, self.axis, jitter, is_known))
        } else {
            Line::lobe(&at, self.axis, choice(2), jitter)
        };
        let Some(line) = line else { return };
        let mut found = self.crossings(&line, lane, seen, |i| choice(3 + i));
        for round in 0..ROUNDS as u32 {
            // Both sides of a crossing share their random numbers, and nothing else does.
            let index = PROBE_INDEX + (index[0] * ROUNDS as u32 + round) * 16;
            found = self.probe(
                &mut at, &line, lane, lanes, is_narrow, &found, depth, stream, index,
            );
            if found.is_empty() {
                break;
            }
        }
    }

    /// Everything on a line at which the radiance may jump.
    fn crossings(
        &mut self,
        line: &Line,
        lane: usize,
        seen: Seen,
        choice: impl Fn(u32) -> f64,
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
        let mut silhouettes: Vec<f64> = Vec::new();
        let mut all_found = true;
        for (i, pair) in points.windows(2).enumerate() {
            let arc = Arc {
                origin: point.leave(pair[0].0 + pair[1].0).as_dvec3(),
                a: pair[0].0,
                b: pair[1].0,
            };
            let ends = [pair[0].1, pair[1].1];
            let before = found.len();
            all_found &= self.between(line, &point, &arc, ends, choice(i as u32), &mut found);
            let silhouettes_here = found[before..].iter().filter(|f| f.is_silhouette);
            silhouettes.extend(silhouettes_here.map(|f| f.psi));
        }
        if all_found {
            let weights = self.run_weights(line, &point, &points, &silhouettes);
            for found in &mut found {
                let run = silhouettes.partition_point(|&p| p < found.psi);
                found.weight *= if found.is_silhouette {
                    weights[run].max(weights[run + 1])
                } else {
                    weights[run]
                };
            }
        }
        found
    }

    /// The weights of the runs between silhouettes ([`Line::run_weights`]), but for those that would have been found without a
    /// point in them: because what is seen on either side could not be explained otherwise, or because they hide the
    /// silhouette that would seem to.
    fn run_weights(
        &self,
        line: &Line,
        point: &SurfacePoint,
        points: &[(DVec3, u32)],
        silhouettes: &[f64],
    ) -> Vec<f64> {
        let mut weights = line.run_weights(silhouettes);
        for (run, ends) in silhouettes.windows(2).enumerate() {
            let weight = &mut weights[run + 1];
            if *weight <= 1.0 {
                continue;
            }
            let [from, to] = [ends[0], ends[1]];
            let first = line.psi.partition_point(|&p| p < from);
            let after = line.psi.partition_point(|&p| p <= to);
            if first == 0 || first >= after || after == points.len() {
                *weight = 1.0;
                continue;
            }
            let [(a, seen_a), (b, seen_b)] = [points[first - 1], points[after]];
            let arc = Arc {
                origin: point.leave(a + b).as_dvec3(),
                a,
                b,
            };
            let (geometry, adjacency) = (self.tracer.geometry, self.adjacency);
            let seen = [seen_a, seen_b];
            let is_found_anyway = match between(geometry, adjacency, &arc, seen, 0.0, PROBE) {
                Err(_) => true,
                Ok([Some(crossing), _]) => {
                    let psi = line.psi_of(arc.direction(crossing.s));
                    (from - ROUNDING..=to + ROUNDING).contains(&psi)
                }
                Ok([None, _]) => false,
            };
            if is_found_anyway {
                *weight = 1.0;
            }
        }
        weights
    }

    /// Adds what lies on an arc between two directions in which these triangles are seen. Whether all of it was found.
    fn between(
        &mut self,
        line: &Line,
        point: &SurfacePoint,
        arc: &Arc,
        ends: [u32; 2],
        choice: f64,
        found: &mut Vec<Found>,
    ) -> bool {
        let (tracer, adjacency) = (self.tracer, self.adjacency);
        let mut probes = Counts::default();
        let seen = |s: f64| point.first_hit(tracer, arc.direction(s), f32::INFINITY, &mut probes);
        let find = |[from, to]: [f64; 2], triangles: [u32; 2]| {
            let arc = Arc {
                a: arc.direction(from),
                b: arc.direction(to),
                ..*arc
            };
            let gap = 2.0 * PROBE;
            let crossings = between(tracer.geometry, adjacency, &arc, triangles, choice, gap)?;
            Ok((arc, triangles, crossings))
        };
        let (parts, unresolved) = between_halves(ends, seen, find);
        self.counts.unresolved += unresolved;
        for (arc, triangles, [silhouette, ridge]) in parts {
            for (crossing, is_silhouette) in [(silhouette, true), (ridge, false)] {
                let Some(Crossing { boundary, s, count }) = crossing else {
                    continue;
                };
                found.push(Found {
                    boundary,
                    arc,
                    s,
                    psi: line.psi_of(arc.direction(s)),
                    is_silhouette,
                    weight: count as f64,
                    triangles,
                });
            }
        }
        *self.counts += probes;
        unresolved == 0
    }

    /// Looks on both sides of each crossing: the jump is taken where it is, not at the ends of the cell. Returns what else
    /// must lie in their cells.
    #[allow(clippy::too_many_arguments)]
    fn probe(
        &mut self,
        at: &mut LaneSurface,
        line: &Line,
        lane: usize,
        lanes: u32,
        with_emission: bool,
        found: &[Found],
        depth: u32,
        stream: &Stream,
        index: u32,
    ) -> Vec<Found> {
        let mut rest = Vec::new();
        let point = SurfacePoint::of_lane(self.surface, &self.vertices.triangle, lane);
        for (number, group) in found.chunks(LANES / 2).enumerate() {
            let mut directions = [Vec3::Z; LANES];
            let mut packet = 0;
            for (i, Found { arc, s, .. }) in group.iter().enumerate() {
                for (k, side) in [-PROBE, PROBE].into_iter().enumerate() {
                    directions[2 * i + k] = arc.direction(s + side).normalize().as_vec3();
                    packet |= 1 << (2 * i + k);
                }
            }
            let directions = from_lanes(&directions);
            let geometric = from_lanes(&[point.geometric; LANES]);
            let origin = leave(from_lanes(&[point.x; LANES]), geometric, directions);
            let rays = RayPacket {
                active: packet,
                origin,
                direction: directions,
                near: 0.0,
                far: f32::INFINITY,
            };
            let index = std::array::from_fn(|l| index + (number * LANES / 2 + l / 2) as u32);
            let (radiance, seen) =
                self.tracer
                    .radiance_along(rays, depth, with_emission, stream, &index, self.counts);
            for (i, found) in group.iter().enumerate() {
                let [before, after] = [2 * i, 2 * i + 1].map(|l| lane_of(radiance, l).as_dvec3());
                let jump = (before - after) * (FAMILIES * lanes as f64 * found.weight);
                if !jump.is_finite() {
                    self.counts.not_finite += 1;
                } else if jump != DVec3::ZERO {
                    let direction = found.arc.direction(found.s).normalize();
                    self.push(at, line, lane, found.boundary, direction, jump);
                }
                if found.is_silhouette {
                    let seen = [seen[2 * i], seen[2 * i + 1]];
                    rest.extend(self.rest(line, &point, found, seen));
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
    ) -> Vec<Found> {
        let Found { arc, s, weight, .. } = *found;
        let [a, b] = found.triangles;
        let parts = [(0.0, s - PROBE, [a, before]), (s + PROBE, 1.0, [after, b])];
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
            let mut found = Vec::new();
            self.between(line, point, &arc, triangles, 0.0, &mut found);
            // Edges within what is seen were chosen for the whole cell already.
            found.retain(|f| f.is_silhouette);
            found.iter_mut().for_each(|f| f.weight = weight);
            rest.extend(found);
        }
        rest
    }
}
