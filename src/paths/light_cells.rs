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
//! spacing of the points is met by one of them with a known chance, and weighed by its inverse.

use super::moving::Sector;
use super::occluders::{OccluderEnd, SurfacePoint, follow_occluders};
use super::rays::{RayPacket, SHADOW_FAR, from_lanes, lane_of, leave, to_rays};
use super::runs::Runs;
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

/// The lines of each lane: of fixed r and of fixed s, both uniform, and where their inner points lie.
pub struct Lines {
    pub s: [f32; LANES],
    pub r: [f32; LANES],
    pub jitter: [f32; LANES],
}

/// Finds the crossings on both lines of every lane and appends them.
#[allow(clippy::too_many_arguments)]
pub fn find(
    tracer: &Tracer,
    adjacency: &Adjacency,
    vertices: &Vertices,
    surface: &Surface,
    patch: &[u32; LANES],
    lines: &Lines,
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
        let positions: [[f32; LANES]; INNER_POINTS + 2] = std::array::from_fn(|i| {
            std::array::from_fn(|l| {
                let [from, to] = [ends[0][l], ends[1][l]];
                match i {
                    0 => from,
                    i if i == INNER_POINTS + 1 => to,
                    i => {
                        from + (to - from) * (i as f32 - 1.0 + lines.jitter[l])
                            / INNER_POINTS as f32
                    }
                }
            })
        });
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
            let [from, to] = [ends[0][lane] as f64, ends[1][lane] as f64];
            let spacing = (to - from) / INNER_POINTS as f64;
            let mut found = Vec::new();
            let mut places = Vec::new();
            for i in 0..=INNER_POINTS {
                let end = |i: usize| (positions[i][lane], visible[i] >> lane & 1 == 1);
                let ends = [end(i), end(i + 1)];
                if ends[0].1 == ends[1].1 {
                    continue;
                }
                let cell = Cell {
                    lane,
                    axis,
                    patch: patch[lane],
                    fixed: fixed[lane],
                    ends,
                };
                let crossing = cell.resolve(tracer, adjacency, surface, vertices, counts);
                counts.unresolved += crossing.is_none() as u64;
                let middle = 0.5 * (ends[0].0 as f64 + ends[1].0 as f64);
                let at = crossing.as_ref().map_or(middle, |c| c.at[axis]);
                places.push((at - from) / spacing);
                found.push(crossing);
            }
            let weights = Runs::new(places).weights_of_shadows(visible[0] >> lane & 1 == 1);
            for (crossing, weight) in found.into_iter().zip(weights) {
                out.extend(crossing.map(|crossing| LightCrossing {
                    radiance_per_side: crossing.radiance_per_side.map(|r| r * weight as f32),
                    ..crossing
                }));
            }
        }
    }
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

/// An interval of a line whose ends differ in visibility.
struct Cell {
    lane: usize,
    axis: usize,
    patch: u32,
    fixed: f32,
    /// Coordinate along the axis and visibility, in increasing order.
    ends: [(f32, bool); 2],
}

impl Cell {
    /// Walks from the occluder that hides the dark end toward the bright one, on to the next occluder as long as one
    /// stands behind the silhouette.
    fn resolve(
        &self,
        tracer: &Tracer,
        adjacency: &Adjacency,
        surface: &Surface,
        vertices: &Vertices,
        counts: &mut Counts,
    ) -> Option<LightCrossing> {
        let patch = &tracer.lights.patches[self.patch as usize];
        let x = lane_of(surface.x, self.lane).as_dvec3();
        let from_surface = SurfacePoint::of_lane(surface, &vertices.triangle, self.lane);
        let point = |at: f64| -> DVec3 {
            let at = at as f32;
            let y = if self.axis == 0 {
                patch.point(at, self.fixed)
            } else {
                patch.point(self.fixed, at)
            };
            let y = y.as_dvec3();
            y - from_surface.leave(y - x).as_dvec3()
        };
        let (dark, bright) = if self.ends[0].1 { (1, 0) } else { (0, 1) };
        let (from, to) = (self.ends[dark].0 as f64, self.ends[bright].0 as f64);
        let OccluderEnd { edge, along, at } = follow_occluders(
            tracer,
            adjacency,
            &from_surface,
            &point,
            [from, to],
            SHADOW_FAR,
            counts,
        )?;
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
        let jump = if dark == 0 { -1.0 } else { 1.0 };
        Some(LightCrossing {
            boundary,
            lane: self.lane as u8,
            patch: self.patch,
            at,
            radiance_per_side: self
                .radiance_per_side(tracer, surface, vertices, boundary, at, jump),
        })
    }

    /// Radiance of the path per unit of Ḟ, all at θ₀: throughput · πf · Le · irradiance · jump · V/Ḟ over the
    /// probability of the patch.
    fn radiance_per_side(
        &self,
        tracer: &Tracer,
        surface: &Surface,
        vertices: &Vertices,
        boundary: Boundary,
        at: [f64; 2],
        jump: f64,
    ) -> Rgb {
        let lane = self.lane;
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
            let all = tracer.value_toward(vertices, surface, from_lanes(&[w; LANES]));
            lane_of(all, lane)
        } else {
            lane_of(vertices.colour, lane)
        };
        let colour = lane_of(vertices.throughput, lane) * value * radiance;
        (colour.as_dvec3() * scale).as_vec3().to_array()
    }
}
