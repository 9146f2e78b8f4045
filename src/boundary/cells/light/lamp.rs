//! Shadows on lamps of many triangles (`paths::light::lamp`).
//!
//! A line on one of a thousand triangles meets a shadow a thousand times as seldom as one over the
//! whole lamp. Here lines are arcs over the cone in which a lamp's sphere is seen, of two families
//! about two axes across the cone's own (`boundary::cells::lobe::line`), one of each for a vertex.
//! What is nearer than a plane just behind the lamp's centre hides it; the lamp's own outline is no
//! border in the lamp's coordinates, since light leaves it there along the surface.
//!
//! A border's velocity is that of its point, relative to the lamp's point behind it: a₁t₁ + a₂t₂
//! with t the directions of both families there. Lines of a family bring its part of the sum.

use super::line::{PAIRS, POINTS, chance_of_point, lamp_of, points, unclear};
use crate::boundary::cells::lobe::families::Family;
use crate::boundary::cells::lobe::line::above_horizon;
use crate::boundary::clearance::Lit;
use crate::boundary::light_samples;
use crate::boundary::occlusion::{
    MOST_PROBE, OccluderEnd, SurfacePoint, is_occluder, nearest_angle,
};
use crate::boundary::search_scene::SearchScene;
use crate::boundary::shadows::{ShadowLine, Shadows};
use crate::discontinuity::boundary::{Boundary, vector};
use crate::kernels::triangle::triangle_hit;
use crate::lanes::LANES;
use crate::paths::at::At;
use crate::paths::boundary_sample::{BoundarySample, Coordinate, Found, NO_CHAIN};
use crate::paths::counts::Counts;
use crate::paths::estimator::LightDraw;
use crate::paths::leaving::SHADOW_FAR;
use crate::paths::light::lamp::Lamp;
use crate::paths::moving::Sector;
use crate::paths::rays::{from_lanes, lane_of};
use crate::paths::surface::kinds::LightKind;
use crate::trace::Coherence;
use glam::{DVec3, Vec3};
use std::f64::consts::FRAC_1_PI;

/// How far beside a shadow's end the lamp is looked for: a part of the line, and an angle under
/// which the distance from surfaces at which rays start is seen from the lamp.
const BESIDE: f64 = 2e-4;
const CLEAR: f64 = 10.0;

/// Finds what hides their lamps from these lanes.
pub fn find(scene: &SearchScene, at: &At, draw: &LightDraw, lanes: u32, out: &mut Found) {
    let of_lane = |lane: usize| {
        lamp_of(at, draw, lane).map(|lamp| (around(scene, at, lane, lamp), lamp.vertex))
    };
    let lanes = unclear(scene, at, lanes, of_lane);
    if lanes == 0 {
        return;
    }
    for (axis, pair) in PAIRS.into_iter().enumerate() {
        let (jitter, extra) = at.numbers.pair(pair);
        let random = [jitter.to_array(), extra.to_array()];
        let lines: [Option<LampLine>; LANES] = std::array::from_fn(|lane| {
            let drawn = (lanes >> lane & 1 == 1).then(|| lamp_of(at, draw, lane));
            let place = f64::from(draw.square[1 - axis][lane]);
            let random = random.map(|r| r[lane]);
            LampLine::new(scene, (at, lane), drawn??, axis, (place, random))
        });
        let open: Vec<u32> = (0..POINTS)
            .map(|i| open(scene, at, &lines, i, out))
            .collect();
        for (lane, line) in lines.iter().enumerate() {
            let Some(line) = line else { continue };
            let is_open: Vec<bool> = open.iter().map(|o| o >> lane & 1 == 1).collect();
            let shadows = Shadows {
                scene,
                point: &line.point,
                line,
                points: &line.points,
                is_open: &is_open,
            };
            for edge in shadows.edges(&mut out.counts) {
                let place = (edge.at, edge.jump);
                let sample = line.sample(scene, edge.end, place, &mut out.counts);
                out.samples.extend(sample);
            }
        }
    }
}

/// A lamp that is looked at as far as the plane behind which nothing of it is seen.
fn around(scene: &SearchScene, at: &At, lane: usize, lamp: &Lamp) -> Lit {
    let geometry = scene.view.geometry;
    let x = lane_of(at.surface.x, lane).as_dvec3();
    let sine = lamp.radius / x.distance(lamp.centre);
    Lit {
        middle: lamp.centre,
        // Of the cone, beside the centre.
        half: DVec3::splat(lamp.radius / (1.0 - sine * sine).sqrt()),
        reach: 1.0 + sine,
        mesh: geometry.mesh_of_vertex(lamp.vertex),
        is_one: true,
    }
}

/// The lanes from whose lamps nothing hides point `i` of their lines.
fn open(
    scene: &SearchScene,
    at: &At,
    lines: &[Option<LampLine>; LANES],
    i: usize,
    out: &mut Found,
) -> u32 {
    let mut ends = [Vec3::ZERO; LANES];
    let mut active = 0u32;
    for (lane, line) in lines.iter().enumerate() {
        if let Some(line) = line {
            ends[lane] = line.end(line.points[i]).as_vec3();
            active |= 1 << lane;
        }
    }
    if active == 0 {
        return 0;
    }
    let surface = at.surface;
    let rays = scene
        .view
        .toward(surface.x, surface.geometric, from_lanes(&ends), active);
    out.counts.light_cell += u64::from(active.count_ones());
    let seen = scene.view.intersect(&rays, Coherence::Incoherent);
    let is_open = |(lane, line): (usize, &Option<LampLine>)| {
        let hidden = line
            .as_ref()
            .is_some_and(|l| is_occluder(seen[lane], Some(l.lamp)));
        u32::from(!hidden) << lane
    };
    lines.iter().enumerate().map(is_open).sum::<u32>() & active
}

/// An arc over the cone in which a vertex sees a lamp.
struct LampLine<'a> {
    at: &'a At<'a>,
    lane: usize,
    lamp: &'a Lamp,
    point: SurfacePoint,
    x: DVec3,
    /// Toward the lamp's centre, of full length.
    way: DVec3,
    family: Family,
    middle: DVec3,
    /// 1/p(φ).
    inverse_density: f64,
    /// Angles to the middle.
    points: [f64; POINTS],
}

impl<'a> LampLine<'a> {
    /// A lane's line, if anything may be found on it that moves.
    fn new(
        scene: &SearchScene,
        (at, lane): (&'a At<'a>, usize),
        lamp: &'a Lamp,
        axis: usize,
        (place, random): (f64, [f32; 2]),
    ) -> Option<Self> {
        let x = lane_of(at.surface.x, lane).as_dvec3();
        let n = lane_of(at.surface.n, lane).as_dvec3();
        let way = lamp.centre - x;
        let main = way.normalize();
        let poles: [DVec3; 2] = main.any_orthonormal_pair().into();
        // The cone's half angle, and the turn about the pole.
        let half = (lamp.radius / way.length()).asin();
        let phi = half * (2.0 * place - 1.0);
        let (pole, other) = (poles[axis], poles[1 - axis]);
        let middle = main * phi.cos() + other * phi.sin();
        let reach = (half.cos() / phi.cos()).min(1.0).acos();
        let [low, high] = above_horizon(pole, middle, n)?;
        let ends = [low.max(-reach), high.min(reach)];
        let sector = Sector {
            origin: x,
            normal: pole.cross(middle),
            inward: [middle, n],
        };
        let moves = at.vertices.moves >> lane & 1 == 1
            || scene.moving.vertex(scene.view.geometry, lamp.vertex)
            || (scene.moving.meets(&sector)
                && !scene.sees_all_of(at, lane, &around(scene, at, lane, lamp)));
        (moves && ends[0] < ends[1]).then(|| Self {
            at,
            lane,
            lamp,
            point: SurfacePoint::of_lane(at, lane),
            x,
            way,
            family: Family { poles, axis },
            middle,
            inverse_density: 2.0 * half,
            points: points(ends, random),
        })
    }

    /// The unit direction at an angle.
    fn direction(&self, psi: f64) -> DVec3 {
        self.family.pole() * psi.sin() + self.middle * psi.cos()
    }

    /// Where it meets the plane across the way to the lamp behind which nothing of it is seen: what
    /// hides the lamp is nearer.
    fn end(&self, psi: f64) -> DVec3 {
        let d = self.direction(psi);
        let distance = self.way.length();
        self.x + d * (distance * (distance + self.lamp.behind) / self.way.dot(d))
    }

    /// The triangle of the lamp that is seen beside the end of a shadow. `None`, and counted, where
    /// one side is not open or the other not hidden: then it is no end.
    fn beside(
        &self,
        scene: &SearchScene,
        end: &OccluderEnd,
        (psi, jump): (f64, f64),
        counts: &mut Counts,
    ) -> Option<u32> {
        let extent = self.points[POINTS - 1] - self.points[0];
        let offset = f64::from(self.point.clearance);
        let angle = (BESIDE * extent).max(CLEAR * offset / self.way.length());
        let angle = angle.max(self.nearest(scene, end).min(MOST_PROBE * extent));
        let seen = [-1.0, 1.0].map(|side| {
            let at = psi + side * jump.signum() * angle;
            let toward = self.between([at, at])(0.0);
            self.point.first_hit(scene.view, toward, self.far())
        });
        counts.probe += 2;
        let [hidden_before, hidden_behind] =
            seen.map(|triangle| is_occluder(triangle, Some(self.lamp)));
        if hidden_before || !hidden_behind {
            counts.unresolved += 1;
            return None;
        }
        self.lamp.patch(seen[0]).map(|_| seen[0])
    }

    /// The angle at which single precision still tells rays on the two sides of an end apart.
    fn nearest(&self, scene: &SearchScene, end: &OccluderEnd) -> f64 {
        let geometry = scene.view.geometry;
        let [v, w] = end.edge.map(|v| geometry.positions[v as usize].as_dvec3());
        let edge_point = |along: f64| nearest_angle(geometry, v.lerp(w, along), self.x, 0.0);
        end.along.map_or(0.0, edge_point)
    }

    /// What the end of a shadow brings, if the lamp is seen beside it.
    fn sample(
        &self,
        scene: &SearchScene,
        end: OccluderEnd,
        (psi, jump): (f64, f64),
        counts: &mut Counts,
    ) -> Option<BoundarySample> {
        let (view, geometry) = (scene.view, scene.view.geometry);
        let At {
            vertices, surface, ..
        } = *self.at;
        let triangle = self.beside(scene, &end, (psi, jump), counts)?;
        let patch = self.lamp.patch(triangle)?;
        let d = self.direction(psi);
        let corners = geometry.triangles[triangle as usize];
        let [v0, v1, v2] = corners.map(|v| vector(geometry.positions[v as usize].as_dvec3()));
        let (t, b1, b2) = triangle_hit(vector(self.x), vector(d), v0, v1, v2);
        let place = view.lights.patches[patch as usize].place_on(triangle, [b1, b2]);

        let lane = self.lane;
        let x = vertices.position(geometry, lane);
        let edge = Boundary::Edge(end.edge);
        let boundary = match end.along {
            Some(_) => self.family.of_point(edge, geometry, x, d),
            None => edge,
        };
        let c = boundary.normal(geometry, x);
        let per_side = self.family.weight(&boundary, c, d)?;
        let [s, r] = place.map(|p| p as f32);
        let radiance = Vec3::from(view.patch_radiance(patch, s, r));
        let w = from_lanes(&[d.as_vec3(); LANES]);
        let value = view.bsdf_evaluate(vertices, surface, w, LightKind::Sampled);
        let colour = lane_of(vertices.throughput, lane) * lane_of(value, lane) * radiance;
        let cos = lane_of(surface.n, lane).as_dvec3().dot(d).max(0.0);
        // F is linear in the direction, which is of length t where the sweeps evaluate it.
        let density = self.inverse_density / (t * self.lamp.chance);
        let brings = colour.as_dvec3() * (jump * per_side * cos * FRAC_1_PI * density);
        if !brings.is_finite() {
            counts.boundary_not_finite += 1;
            return None;
        }
        Some(BoundarySample {
            boundary,
            shadow: None,
            lane: lane as u8,
            at: Coordinate::Light { patch, at: place },
            chain: NO_CHAIN,
            weight: brings.as_vec3().to_array(),
            jump: light_samples::of_patch(self.at, lane, patch, place).length() as f32,
        })
    }
}

impl ShadowLine for LampLine<'_> {
    fn between(&self, ends: [f64; 2]) -> impl Fn(f64) -> DVec3 {
        let [a, b] = ends.map(|psi| self.end(psi));
        move |s| {
            let y = a.lerp(b, s);
            self.point.toward(y)
        }
    }

    fn coordinate(&self, ends: [f64; 2], s: f64) -> f64 {
        let [a, b] = ends.map(|psi| self.end(psi));
        let d = a.lerp(b, s) - self.x;
        self.family.pole().dot(d).atan2(self.middle.dot(d))
    }

    fn far(&self) -> f32 {
        SHADOW_FAR
    }

    fn lamp(&self) -> Option<&Lamp> {
        Some(self.lamp)
    }

    fn chance_between(&self, [low, high]: [f64; 2]) -> f64 {
        chance_of_point((high - low) / (self.points[POINTS - 1] - self.points[0]))
    }
}
