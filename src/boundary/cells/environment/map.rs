//! Where something begins to hide an environment map, seen from a vertex: in the map's own
//! coordinates.
//!
//! As `boundary::cells::light` for area lights. The jump is the map's radiance where the silhouette
//! is.

use crate::boundary::cells::bright::{Bright, Over};
use crate::boundary::cells::lobe::families::Family;
use crate::boundary::cells::lobe::line::above_horizon;
use crate::boundary::occlusion::SurfacePoint;
use crate::boundary::search_scene::SearchScene;
use crate::boundary::shadows::{ShadowLine, Shadows, chance_of_any};
use crate::discontinuity::boundary::Boundary;
use crate::lanes::LANES;
use crate::paths::at::At;
use crate::paths::boundary_sample::{BoundarySample, Coordinate, Found, NO_CHAIN};
use crate::paths::dimensions::{Pair, Single};
use crate::paths::environment::distribution::{MapDistribution, Meridian};
use crate::paths::moving::Sector;
use crate::paths::rays::{from_lanes, lane_of};
use crate::paths::surface::kinds::LightKind;
use crate::scene::Environment;
use glam::{DVec3, Vec3};
use std::f64::consts::FRAC_1_PI;

/// Points on a line besides its ends on the horizon, at quantiles of the line's power.
const INNER_POINTS: usize = 4;

/// Finds what hides the map on one line of every lane, about one of two axes.
pub fn find(scene: &SearchScene, at: &At, out: &mut Found) {
    let view = scene.view;
    let (Some(distribution), Some(environment)) = (view.map_distribution, &view.scene.environment)
    else {
        return;
    };
    let numbers = &at.numbers;
    let (place, jitter) = numbers.pair(Pair::EnvironmentLine);
    let (extra, _) = numbers.pair(Pair::EnvironmentPoint);
    let name = [numbers.index[0], numbers.depth, 0];
    let family = numbers.stream.single(Single::EnvironmentFamily, name);
    let lines = MapLines {
        scene,
        at,
        distribution,
        environment,
        axis: (family * 2.0) as usize,
        place: place.to_array(),
        jitter: jitter.to_array(),
        extra: extra.to_array(),
    };
    lines.find(out);
}

/// The lines of all lanes of a packet.
struct MapLines<'a> {
    scene: &'a SearchScene<'a>,
    at: &'a At<'a>,
    distribution: &'a MapDistribution,
    environment: &'a Environment,
    axis: usize,
    /// What draws each line, and its points.
    place: [f32; LANES],
    jitter: [f32; LANES],
    /// Where one more point of it lies.
    extra: [f32; LANES],
}

impl<'a> MapLines<'a> {
    fn find(&self, out: &mut Found) {
        let lit = self.at.view.lit_by_map(self.at.vertices);
        let bright = Bright::new(self.at, Over::EnvironmentMap, lit);
        let first = out.samples.len();
        let lines: [Option<MapLine>; LANES] = std::array::from_fn(|lane| {
            (bright.lanes >> lane & 1 == 1)
                .then(|| self.line_of_lane(lane))
                .flatten()
        });
        let points = lines.iter().flatten().map(|l| l.psi.len()).max();
        let open: Vec<u32> = (0..points.unwrap_or(0))
            .map(|i| self.open(&lines, i, out))
            .collect();
        for (lane, line) in lines.iter().enumerate() {
            let Some(line) = line else { continue };
            let is_open: Vec<bool> = open[..line.psi.len()]
                .iter()
                .map(|o| o >> lane & 1 == 1)
                .collect();
            let shadows = Shadows {
                scene: self.scene,
                point: &SurfacePoint::of_lane(self.at, lane),
                line,
                points: &line.psi,
                is_open: &is_open,
            };
            for edge in shadows.edges(&mut out.counts) {
                let boundary = Boundary::Edge(edge.end.edge);
                self.push(lane, line, edge.at, boundary, edge.jump, out);
            }
        }
        bright.weigh(&mut out.samples[first..]);
    }

    /// A lane's line, unless nothing may be found on it that moves.
    fn line_of_lane(&self, lane: usize) -> Option<MapLine<'a>> {
        let line = self.distribution.line(self.axis, self.place[lane] as f64);
        let n = lane_of(self.at.surface.n, lane).as_dvec3();
        let sector = Sector {
            origin: lane_of(self.at.surface.x, lane).as_dvec3(),
            normal: line.pole.cross(line.middle),
            inward: [line.middle, n],
        };
        let moves = self.at.vertices.moves >> lane & 1 == 1 || self.scene.moving.meets(&sector);
        if !moves {
            return None;
        }
        let random = [self.jitter[lane], self.extra[lane]];
        MapLine::new(self.distribution, line, n, random.map(f64::from))
    }

    /// Which lanes see the environment at point `i` of their lines.
    fn open(&self, lines: &[Option<MapLine>; LANES], i: usize, out: &mut Found) -> u32 {
        let mut directions = [Vec3::Z; LANES];
        let mut wanted = 0u32;
        for (lane, line) in lines.iter().enumerate() {
            if let Some(line) = line
                && let Some(&psi) = line.psi.get(i)
            {
                directions[lane] = direction(&line.line, psi).as_vec3();
                wanted |= 1 << lane;
            }
        }
        let surface = self.at.surface;
        let directions = from_lanes(&directions);
        let view = self.scene.view;
        let rays = view.leaving(surface.x, surface.geometric, directions, wanted);
        view.unoccluded(&rays, &mut out.counts.environment_cell)
    }

    /// Keeps what jumps by `jump` times the map's radiance at `psi` of a lane's line.
    fn push(
        &self,
        lane: usize,
        line: &MapLine,
        psi: f64,
        boundary: Boundary,
        jump: f64,
        out: &mut Found,
    ) {
        let At {
            view,
            vertices,
            surface,
            ..
        } = *self.at;
        let d = direction(&line.line, psi);
        let x = vertices.position(view.geometry, lane);
        let family = Family {
            poles: self.distribution.poles(),
            axis: line.line.axis,
        };
        let boundary = if self.scene.is_small(&boundary, x) {
            family.of_point(boundary, view.geometry, x, d)
        } else {
            boundary
        };
        let c = boundary.normal(view.geometry, x);
        let Some(per_side) = family.weight(&boundary, c, d) else {
            return;
        };
        let per_side = per_side * line.line.inverse_density;
        let cos = lane_of(surface.n, lane).as_dvec3().dot(d).max(0.0);
        let w = from_lanes(&[d.as_vec3(); LANES]);
        let value = view.bsdf_evaluate(vertices, surface, w, LightKind::Sampled);
        let radiance = view.environment_radiance(self.environment, w);
        let colour =
            lane_of(vertices.throughput, lane) * lane_of(value, lane) * lane_of(radiance, lane);
        // One of two families is drawn.
        let colour = colour.as_dvec3() * (cos * FRAC_1_PI);
        let brings = colour * (2.0 * jump * per_side);
        if !brings.is_finite() {
            out.counts.boundary_not_finite += 1;
            return;
        }
        out.samples.push(BoundarySample {
            boundary,
            shadow: None,
            lane: lane as u8,
            at: Coordinate::Environment(d.to_array()),
            chain: NO_CHAIN,
            weight: brings.as_vec3().to_array(),
            jump: colour.length() as f32 / self.distribution.pdf(d.as_vec3()),
        });
    }
}

/// A lane's line above its horizon.
struct MapLine<'a> {
    distribution: &'a MapDistribution,
    line: Meridian,
    ends: [f64; 2],
    psi: Vec<f64>,
}

impl<'a> MapLine<'a> {
    /// The part of a line above the horizon of `n`.
    fn new(
        distribution: &'a MapDistribution,
        line: Meridian,
        n: DVec3,
        random: [f64; 2],
    ) -> Option<Self> {
        let mut own = Self {
            distribution,
            ends: above_horizon(line.pole, line.middle, n)?,
            line,
            psi: Vec::new(),
        };
        own.psi = own.points(random);
        Some(own)
    }

    /// Its ends, jittered points, and one anywhere: without that there would be shadows that are
    /// never found, as on lights (`boundary::cells::light`).
    fn points(&self, [jitter, extra]: [f64; 2]) -> Vec<f64> {
        let [low, high] = self.ends;
        let mut psi: Vec<f64> = (0..INNER_POINTS)
            .map(|k| (k as f64 + jitter) / INNER_POINTS as f64)
            .chain([extra])
            .map(|part| self.distribution.quantile(&self.line, part))
            .filter(|p| (low..high).contains(p))
            .collect();
        psi.extend([low, high]);
        psi.sort_by(f64::total_cmp);
        psi
    }
}

impl ShadowLine for MapLine<'_> {
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

    fn chance_between(&self, interval: [f64; 2]) -> f64 {
        let [below, above] = interval.map(|psi| self.distribution.power_below(&self.line, psi));
        let part = above - below;
        chance_of_any(part * INNER_POINTS as f64, part)
    }
}

fn direction(line: &Meridian, psi: f64) -> DVec3 {
    line.pole * psi.sin() + line.middle * psi.cos().max(0.0)
}

/// Where a direction lies on a line.
fn psi_of(line: &Meridian, d: DVec3) -> f64 {
    line.pole.dot(d).atan2(line.middle.dot(d))
}
