//! Shadows: where the light's visibility jumps inside the light's own square.
//!
//! For a vertex x and a patch, L(θ) = ∫₀¹∫₀¹ g(s, r) vis(s, r) ds dr. On a line of fixed r, cut at any points
//! s₀ = 0 < s₁ < … < 1, the change of variables of each cell shifts its interior rigidly by V_s, the speed of the
//! silhouette that was found in it, and leaves ∂L = ∫∂(g)·vis + Σ_cells V_s·(g₋ − g₊) at the jump (a rotation of
//! the bundle seen from x; Loubet 2019). Lines of fixed r give the part of the motion along s, lines of fixed s
//! the part along r, and their sum is the whole: V·n dl = V_s dr + V_r ds.
//!
//! Each vertex draws one uniform (s, r), which is its light sample, and the two lines through it; the lines' ends lie
//! on the light's rim, so that the cells cover them without gaps, and jittered points divide them. No kernel width: a
//! silhouette that crosses a line is found with certainty if it crosses the cell once. A shadow that is shorter than the
//! spacing of the points may be missed, and is weighed for that (`super::shadow_draws`).

use super::materials::LightKind;
use super::moving::Sector;
use super::occluders::{OccluderEnd, SurfacePoint, follow_occluders};
use super::random::Stream;
use super::rays::{RayPacket, SHADOW_FAR, from_lanes, lane_of, leave, to_rays};
use super::runs::Runs;
use super::shadow_draws::{ShadowEnd, ShadowLine, Shadows};
use super::store::{LightCrossing, Vertices};
use super::surface::Surface;
use super::tracer::{Counts, Tracer};
use crate::kernels::light::triangle_irradiance;
use crate::lanes::LANES;
use crate::scene::Rgb;
use crate::trace::Coherence;
use crate::warp::adjacency::Adjacency;
use crate::warp::boundary::{Boundary, vector, velocity_per_side};
use glam::{DVec3, Vec3};

/// The ends of a line lie this far inside the light, where no ray grazes its border.
const RIM: f32 = 1e-4;

/// Jittered points between the ends of a line.
const INNER_POINTS: usize = 2;
/// Of a line: its ends, those, and one more.
const POINTS: usize = INNER_POINTS + 3;

/// The lines of each lane: of fixed r and of fixed s, both uniform, and where their inner points lie.
pub struct Lines {
    pub s: [f32; LANES],
    pub r: [f32; LANES],
    pub jitter: [f32; LANES],
}

/// Finds the crossings on both lines of every lane and appends them; `draws` are for other points of a lane's line about an axis.
#[allow(clippy::too_many_arguments)]
pub fn find(
    tracer: &Tracer,
    adjacency: &Adjacency,
    vertices: &Vertices,
    surface: &Surface,
    patch: &[u32; LANES],
    lines: &Lines,
    draws: impl Fn(usize, usize) -> Stream,
    counts: &mut Counts,
    out: &mut Vec<LightCrossing>,
) {
    let facing = facing_light(tracer, vertices, surface, patch);
    if facing == 0 {
        return;
    }
    // Whether something may be found on a line between these points of a lane's patch that moves against either.
    let moves = |lane: usize, ends: [Vec3; 2]| {
        let x = lane_of(surface.x, lane);
        let [a, b] = ends.map(|y| (y - x).as_dvec3());
        let light = tracer.lights.patches[patch[lane] as usize].lower[0];
        vertices.moves >> lane & 1 == 1
            || tracer.moving.vertex(tracer.geometry, light)
            || tracer.moving.meets(&Sector::between(x.as_dvec3(), a, b))
    };
    for axis in 0..2 {
        let mut active = facing;
        let fixed = if axis == 0 { &lines.r } else { &lines.s };
        let mut ends = [[RIM; LANES]; 2];
        for lane in 0..LANES {
            let p = &tracer.lights.patches[patch[lane] as usize];
            let range = [RIM, p.line_end(fixed[lane]) - RIM];
            let point = |at: f32| {
                if axis == 0 {
                    p.point(at, fixed[lane])
                } else {
                    p.point(fixed[lane], at)
                }
            };
            let (x, n) = (lane_of(surface.x, lane), lane_of(surface.n, lane));
            match above_horizon(range, range.map(|at| n.dot(point(at) - x))) {
                Some(part) if moves(lane, part.map(point)) => {
                    [ends[0][lane], ends[1][lane]] = part;
                }
                _ => active &= !(1 << lane),
            }
        }
        let positions: [[f32; LANES]; POINTS] = {
            let points: [_; LANES] = std::array::from_fn(|l| {
                let extra = draws(l, axis).uniform(0);
                points([ends[0][l], ends[1][l]], lines.jitter[l], extra)
            });
            std::array::from_fn(|i| std::array::from_fn(|l| points[l][i]))
        };
        let visible = positions.map(|at| {
            let (s, r) = if axis == 0 {
                (&at, fixed)
            } else {
                (fixed, &at)
            };
            let y = tracer.patch_points(patch, s, r);
            let origin = leave(surface.x, surface.geometric, y - surface.x);
            let rays = RayPacket {
                active,
                origin,
                direction: y - origin,
                near: 0.0,
                far: SHADOW_FAR,
            };
            counts.light_cell += active.count_ones() as u64;
            !tracer
                .accel
                .occluded(&to_rays(&rays), active, Coherence::Incoherent)
        });
        let jumps = visible.windows(2).fold(0, |bits, v| bits | (v[0] ^ v[1]));
        for lane in (0..LANES).filter(|&l| (active & jumps) >> l & 1 == 1) {
            let line = LightLine {
                tracer,
                lane,
                axis,
                patch: patch[lane],
                fixed: fixed[lane],
                ends: [ends[0][lane], ends[1][lane]],
                point: SurfacePoint::of_lane(surface, &vertices.triangle, lane),
            };
            let point = |i: usize| (positions[i][lane] as f64, visible[i] >> lane & 1 == 1);
            let points = std::array::from_fn(point);
            line.shadows(
                &points,
                adjacency,
                surface,
                vertices,
                &draws(lane, axis),
                counts,
                out,
            );
        }
    }
}

/// The points of a line, increasing: its ends, jittered ones, and one anywhere. Without that there would be shadows that are never
/// found: those that always have the line's end for a neighbour, where that is hidden by something else.
fn points([from, to]: [f32; 2], jitter: f32, extra: f32) -> [f32; POINTS] {
    let mut points = [from; POINTS];
    for (i, point) in points[1..=INNER_POINTS].iter_mut().enumerate() {
        *point += (to - from) * (i as f32 + jitter) / INNER_POINTS as f32;
    }
    points[POINTS - 2] += (to - from) * extra;
    points[POINTS - 1] = to;
    points.sort_by(f32::total_cmp);
    points
}

/// The part of a line whose points stand higher than the surface's horizon, given the heights at its ends.
fn above_horizon([from, to]: [f32; 2], [low, high]: [f32; 2]) -> Option<[f32; 2]> {
    let crossing = from + (to - from) * low / (low - high);
    match (low > 0.0, high > 0.0) {
        (true, true) => Some([from, to]),
        (true, false) => Some([from, crossing - RIM]),
        (false, true) => Some([crossing + RIM, to]),
        (false, false) => None,
    }
    .filter(|[from, to]| from < to)
}

/// Lanes that stand on the bright side of their patch and reflect anything.
fn facing_light(
    tracer: &Tracer,
    vertices: &Vertices,
    surface: &Surface,
    patch: &[u32; LANES],
) -> u32 {
    let mut bits = 0u32;
    for l in (0..LANES).filter(|&l| vertices.hit >> l & 1 == 1) {
        let p = &tracer.lights.patches[patch[l] as usize];
        let front = p.edges[0]
            .cross(p.edges[1])
            .dot(lane_of(surface.x, l) - p.corner)
            > 0.0;
        bits |= (front as u32) << l;
    }
    bits & vertices.kinds.lit_by_samples() & !tracer.reflects_nothing(vertices)
}

/// A line on a light, as seen by a lane.
struct LightLine<'a> {
    tracer: &'a Tracer<'a>,
    lane: usize,
    axis: usize,
    patch: u32,
    fixed: f32,
    /// Along the axis.
    ends: [f32; 2],
    point: SurfacePoint,
}

impl ShadowLine for LightLine<'_> {
    fn draw(&self, random: &mut dyn FnMut() -> f64) -> Vec<f64> {
        points(self.ends, random() as f32, random() as f32)
            .map(f64::from)
            .to_vec()
    }

    /// To the light, of full length.
    fn between(&self, ends: [f64; 2]) -> impl Fn(f64) -> DVec3 {
        let patch = &self.tracer.lights.patches[self.patch as usize];
        move |s| {
            let at = self.coordinate(ends, s) as f32;
            let y = if self.axis == 0 {
                patch.point(at, self.fixed)
            } else {
                patch.point(self.fixed, at)
            };
            let y = y.as_dvec3();
            y - self.point.leave(y - self.point.x.as_dvec3()).as_dvec3()
        }
    }

    fn coordinate(&self, [from, to]: [f64; 2], s: f64) -> f64 {
        from + (to - from) * s
    }

    fn far(&self) -> f32 {
        SHADOW_FAR
    }
}

impl LightLine<'_> {
    /// The ends of all shadows between its points, of which is known where they lie and whether they are lit.
    #[allow(clippy::too_many_arguments)]
    fn shadows(
        &self,
        points: &[(f64, bool); POINTS],
        adjacency: &Adjacency,
        surface: &Surface,
        vertices: &Vertices,
        stream: &Stream,
        counts: &mut Counts,
        out: &mut Vec<LightCrossing>,
    ) {
        let mut ends = Vec::new();
        let mut found = Vec::new();
        for pair in points.windows(2).filter(|pair| pair[0].1 != pair[1].1) {
            let is_lit_first = pair[0].1;
            let (hidden, free) = if is_lit_first {
                (pair[1].0, pair[0].0)
            } else {
                (pair[0].0, pair[1].0)
            };
            let end = self.follow([hidden, free], adjacency, counts);
            counts.unresolved += end.is_none() as u64;
            let at = end.as_ref().map_or(0.5, |end| end.at);
            ends.push(ShadowEnd {
                at: self.coordinate([hidden, free], at),
                hidden,
                free,
                is_found: end.is_some(),
            });
            found.push(end);
        }
        let [from, to] = self.ends.map(f64::from);
        let part = |end: &ShadowEnd| (end.at - from) / (to - from);
        let place = |end| part(end) * INNER_POINTS as f64;
        let runs = Runs::with_extra(ends.iter().map(place).collect(), ends.iter().map(part));
        let shadows = Shadows {
            tracer: self.tracer,
            adjacency,
            point: &self.point,
            line: self,
            ends: &ends,
        };
        let weights = shadows.weights(&runs, stream, counts);
        for ((found, end), weight) in found.into_iter().zip(&ends).zip(weights) {
            let sign = if end.hidden < end.free { -1.0 } else { 1.0 };
            let jump = sign * weight;
            out.extend(found.map(|found| self.crossing(found, end.at, jump, surface, vertices)));
        }
    }

    /// Walks from the occluder that hides one point toward another that is free, on to the next occluder as long as one
    /// stands behind the silhouette.
    fn follow(
        &self,
        ends: [f64; 2],
        adjacency: &Adjacency,
        counts: &mut Counts,
    ) -> Option<OccluderEnd> {
        let whole = [0.0, 1.0];
        let direction = self.between(ends);
        follow_occluders(
            self.tracer,
            adjacency,
            &self.point,
            &direction,
            whole,
            SHADOW_FAR,
            counts,
        )
    }

    fn crossing(
        &self,
        OccluderEnd { edge, along, .. }: OccluderEnd,
        at: f64,
        jump: f64,
        surface: &Surface,
        vertices: &Vertices,
    ) -> LightCrossing {
        let patch = &self.tracer.lights.patches[self.patch as usize];
        let line = patch.edges[1 - self.axis].as_dvec3();
        let boundary = match along {
            Some(along) => Boundary::Point { edge, along, line },
            None => Boundary::Edge(edge),
        };
        let fixed = self.fixed as f64;
        let at = if self.axis == 0 {
            [at, fixed]
        } else {
            [fixed, at]
        };
        LightCrossing {
            boundary,
            lane: self.lane as u8,
            patch: self.patch,
            at,
            radiance_per_side: self.radiance_per_side(surface, vertices, boundary, at, jump),
        }
    }

    /// Radiance of the path per unit of Ḟ, all at θ₀: throughput · πf · Le · irradiance · jump · V/Ḟ over the
    /// probability of the patch.
    fn radiance_per_side(
        &self,
        surface: &Surface,
        vertices: &Vertices,
        boundary: Boundary,
        at: [f64; 2],
        jump: f64,
    ) -> Rgb {
        let (tracer, lane) = (self.tracer, self.lane);
        let geometry = tracer.geometry;
        let patch = &tracer.lights.patches[self.patch as usize];
        let x = vertices.position(geometry, lane);
        let c = boundary.normal(geometry, x);
        let edges = patch.edges.map(|e| e.as_dvec3());
        let gradient = edges.map(|e| c.dot(e));
        let metric = [
            edges[0].dot(edges[0]),
            edges[0].dot(edges[1]),
            edges[1].dot(edges[1]),
        ];
        let Some(velocity) = velocity_per_side(gradient, metric, self.axis) else {
            return [0.0; 3];
        };
        let (s, r) = (at[0] as f32, at[1] as f32);
        let (ids, [b1, b2]) = patch.vertices_at(s, r);
        let [q0, q1, q2] = ids.map(|v| vector(geometry.positions[v as usize].as_dvec3()));
        let n = vector(lane_of(surface.n, lane).as_dvec3());
        let irradiance = triangle_irradiance(vector(x), n, q0, q1, q2, b1 as f64, b2 as f64);
        let scale = irradiance * jump * velocity / patch.probability as f64;
        let radiance = Vec3::from(tracer.patch_radiance(self.patch, s, r));
        let value = if surface.interface.is_some() {
            let w = patch.point(s, r) - lane_of(surface.x, lane);
            let all = tracer.value_toward(
                vertices,
                surface,
                from_lanes(&[w; LANES]),
                LightKind::Sampled,
            );
            lane_of(all, lane)
        } else {
            lane_of(vertices.colour, lane)
        };
        let colour = lane_of(vertices.throughput, lane) * value * radiance;
        (colour.as_dvec3() * scale).as_vec3().to_array()
    }
}
