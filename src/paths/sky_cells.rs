//! Where something begins to hide an environment map, seen from a vertex: in the map's own coordinates.
//!
//! As `paths::light_cells` for area lights. The jump is the map's radiance where the silhouette is.

use super::bounce_cells::BounceCrossing;
use super::bounce_lines::{above_horizon, line_weight};
use super::materials::LightKind;
use super::moving::Sector;
use super::occluders::{SurfacePoint, shadow_edges};
use super::random::Stream;
use super::rays::{RayPacket, from_lanes, lane_of, leave, to_rays};
use super::runs::Runs;
use super::shadow_draws::{ShadowEnd, ShadowLine, Shadows};
use super::sky::{Sky, SkyLine};
use super::store::Vertices;
use super::surface::Surface;
use super::tracer::{Counts, Tracer};
use crate::lanes::LANES;
use crate::scene::Environment;
use crate::trace::Coherence;
use crate::warp::adjacency::Adjacency;
use crate::warp::boundary::Boundary;
use glam::{DVec3, Vec3};
use std::f64::consts::FRAC_1_PI;

/// Points on a line besides its ends on the horizon, at quantiles of the line's power.
const INNER_POINTS: usize = 4;

/// A lane's line above its horizon.
struct Seen<'a> {
    sky: &'a Sky,
    line: SkyLine,
    ends: [f64; 2],
    psi: Vec<f64>,
}

/// Finds the crossings on one line of every lane of `lit` about `axis`, drawn by `place` and with points at
/// `jitter`; `draws` are for other points of a lane's line.
#[allow(clippy::too_many_arguments)]
pub fn find(
    tracer: &Tracer,
    sky: &Sky,
    environment: &Environment,
    adjacency: &Adjacency,
    vertices: &Vertices,
    surface: &Surface,
    lit: u32,
    axis: usize,
    [place, jitter]: [[f32; LANES]; 2],
    draws: impl Fn(usize) -> Stream,
    counts: &mut Counts,
    out: &mut Vec<BounceCrossing>,
) {
    let lines: [Option<Seen>; LANES] = std::array::from_fn(|lane| {
        if lit >> lane & 1 == 0 {
            return None;
        }
        let line = sky.line(axis, place[lane] as f64);
        let n = lane_of(surface.n, lane).as_dvec3();
        let sector = Sector {
            origin: lane_of(surface.x, lane).as_dvec3(),
            normal: line.pole.cross(line.middle),
            inward: [line.middle, n],
        };
        let moves = vertices.moves >> lane & 1 == 1 || tracer.moving.meets(&sector);
        if moves {
            Seen::new(
                sky,
                line,
                n,
                [jitter[lane], draws(lane).uniform(0)].map(f64::from),
            )
        } else {
            None
        }
    });
    let points = lines.iter().flatten().map(|l| l.psi.len()).max();
    let open: Vec<u32> = (0..points.unwrap_or(0))
        .map(|i| unblocked(tracer, surface, &lines, i, counts))
        .collect();
    for (lane, seen) in lines.iter().enumerate() {
        let Some(seen) = seen else { continue };
        let open: Vec<bool> = open[..seen.psi.len()]
            .iter()
            .map(|o| o >> lane & 1 == 1)
            .collect();
        if open.windows(2).all(|o| o[0] == o[1]) {
            continue;
        }
        let mut finder = Finder {
            tracer,
            sky,
            environment,
            adjacency,
            vertices,
            surface,
            lane,
            seen,
            counts,
        };
        finder.shadows(&open, &draws(lane), out);
    }
}

impl<'a> Seen<'a> {
    /// The part of a line above the horizon of `n`.
    fn new(sky: &'a Sky, line: SkyLine, n: DVec3, random: [f64; 2]) -> Option<Self> {
        let mut seen = Self {
            sky,
            ends: above_horizon(line.pole, line.middle, n)?,
            line,
            psi: Vec::new(),
        };
        seen.psi = seen.points(random);
        Some(seen)
    }

    /// Its ends, jittered points, and one anywhere: without that there would be shadows that are never found, as on lights
    /// (`super::light_cells`).
    fn points(&self, [jitter, extra]: [f64; 2]) -> Vec<f64> {
        let [low, high] = self.ends;
        let mut psi: Vec<f64> = (0..INNER_POINTS)
            .map(|k| (k as f64 + jitter) / INNER_POINTS as f64)
            .chain([extra])
            .map(|part| self.sky.quantile(&self.line, part))
            .filter(|p| (low..high).contains(p))
            .collect();
        psi.extend([low, high]);
        psi.sort_by(f64::total_cmp);
        psi
    }
}

impl ShadowLine for Seen<'_> {
    fn draw(&self, random: &mut dyn FnMut() -> f64) -> Vec<f64> {
        self.points([random(), random()])
    }

    fn between(&self, ends: [f64; 2]) -> impl Fn(f64) -> DVec3 {
        let [a, b] = ends.map(|psi| direction(&self.line, psi));
        move |s| a * (1.0 - s) + b * s
    }

    fn coordinate(&self, ends: [f64; 2], s: f64) -> f64 {
        psi_of(&self.line, self.between(ends)(s))
    }

    fn far(&self) -> f32 {
        f32::INFINITY
    }
}

fn direction(line: &SkyLine, psi: f64) -> DVec3 {
    line.pole * psi.sin() + line.middle * psi.cos().max(0.0)
}

/// Where a direction lies on a line.
fn psi_of(line: &SkyLine, d: DVec3) -> f64 {
    line.pole.dot(d).atan2(line.middle.dot(d))
}

/// Which lanes see the sky at point `i` of their lines.
fn unblocked(
    tracer: &Tracer,
    surface: &Surface,
    lines: &[Option<Seen>; LANES],
    i: usize,
    counts: &mut Counts,
) -> u32 {
    let mut directions = [Vec3::Z; LANES];
    let mut wanted = 0u32;
    for (lane, seen) in lines.iter().enumerate() {
        if let Some(seen) = seen
            && let Some(&psi) = seen.psi.get(i)
        {
            directions[lane] = direction(&seen.line, psi).as_vec3();
            wanted |= 1 << lane;
        }
    }
    let directions = from_lanes(&directions);
    let rays = RayPacket {
        active: wanted,
        origin: leave(surface.x, surface.geometric, directions),
        direction: directions,
        near: 0.0,
        far: f32::INFINITY,
    };
    counts.sky_cell += wanted.count_ones() as u64;
    wanted
        & !tracer
            .accel
            .occluded(&to_rays(&rays), wanted, Coherence::Incoherent)
}

struct Finder<'a> {
    tracer: &'a Tracer<'a>,
    sky: &'a Sky,
    environment: &'a Environment,
    adjacency: &'a Adjacency,
    vertices: &'a Vertices,
    surface: &'a Surface,
    lane: usize,
    seen: &'a Seen<'a>,
    counts: &'a mut Counts,
}

impl Finder<'_> {
    /// The silhouettes of whatever hides the sky at some of the points of the line.
    fn shadows(&mut self, open: &[bool], draws: &Stream, out: &mut Vec<BounceCrossing>) {
        let Seen { line, psi, .. } = self.seen;
        let point = SurfacePoint::of_lane(self.surface, &self.vertices.triangle, self.lane);
        let directions: Vec<DVec3> = psi.iter().map(|&psi| direction(line, psi)).collect();
        let edges = shadow_edges(
            self.tracer,
            self.adjacency,
            &point,
            &directions,
            open,
            self.counts,
        );
        let ends: Vec<ShadowEnd> = edges
            .iter()
            .map(|edge| ShadowEnd::of_edge(edge, psi, psi_of(line, edge.direction)))
            .collect();
        let shadows = Shadows {
            tracer: self.tracer,
            adjacency: self.adjacency,
            point: &point,
            line: self.seen,
            ends: &ends,
        };
        let power = |end: &ShadowEnd| self.sky.power_below(line, end.at);
        let place = |end| power(end) * INNER_POINTS as f64;
        let runs = Runs::with_extra(ends.iter().map(place).collect(), ends.iter().map(power));
        let weights = shadows.weights(&runs, draws, self.counts);
        for ((edge, end), weight) in edges.into_iter().zip(&ends).zip(weights) {
            if let Some(boundary) = edge.boundary {
                out.extend(self.crossing(end.at, boundary, edge.sign() * weight));
            }
        }
    }

    fn crossing(&mut self, psi: f64, boundary: Boundary, weight: f64) -> Option<BounceCrossing> {
        let line = &self.seen.line;
        let d = direction(line, psi);
        let lane = self.lane;
        let x = self.vertices.position(self.tracer.geometry, lane);
        let c = boundary.normal(self.tracer.geometry, x);
        let per_side = line_weight(self.sky.poles(), line.axis, c, d)? * line.inverse_density;
        let cos = lane_of(self.surface.n, lane).as_dvec3().dot(d).max(0.0);
        let w = from_lanes(&[d.as_vec3(); LANES]);
        let value = self
            .tracer
            .value_toward(self.vertices, self.surface, w, LightKind::Sampled);
        let radiance = self.tracer.environment_radiance(self.environment, w);
        let colour = lane_of(self.vertices.throughput, lane)
            * lane_of(value, lane)
            * lane_of(radiance, lane);
        // One of two families is drawn.
        let scale = 2.0 * weight * per_side * cos * FRAC_1_PI;
        let brings = colour.as_dvec3() * scale;
        if !brings.is_finite() {
            self.counts.boundary_not_finite += 1;
            return None;
        }
        Some(BounceCrossing {
            boundary,
            lane: lane as u8,
            in_sky: true,
            local: d.to_array(),
            radiance_per_side: brings.as_vec3().to_array(),
        })
    }
}
