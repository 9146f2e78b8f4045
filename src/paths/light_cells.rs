//! Shadows: where the light's visibility jumps inside the light's own square.
//!
//! For a vertex x and a patch, L(θ) = ∫₀¹∫₀¹ g(s, r) vis(s, r) ds dr. On a line of fixed r, cut at any points
//! s₀ = 0 < s₁ < … < 1, the change of variables of each cell shifts its interior rigidly by V_s, the speed of the
//! silhouette that was found in it, and leaves ∂L = ∫∂(g)·vis + Σ_cells V_s·(g₋ − g₊) at the jump (a rotation of
//! the bundle seen from x; Loubet 2019, §4–5). Lines of fixed r give the part of the motion along s, lines of fixed s
//! the part along r, and their sum is the whole: V·n dl = V_s dr + V_r ds.
//!
//! Each vertex draws one uniform (s, r), which is its light sample, and the two lines through it; the lines' ends lie
//! on the light's rim, so that the cells cover them without gaps. That makes five shadow rays, each of them one end
//! of a pair, and no kernel width: a silhouette that crosses a line is found with certainty if it crosses the
//! cell once. Two silhouettes in one cell are missed together; where they move alike their parts cancel.

use super::occluders::{OccluderEnd, SurfacePoint, follow_occluders};
use super::store::{LightCrossing, Vertices, lane_mask};
use super::tracer::{Counts, RayPacket, SHADOW_FAR, Surface, Tracer, lane_of, leave, to_rays};
use crate::lanes::{LANES, Lane, Real};
use crate::trace::Coherence;
use crate::warp::adjacency::Adjacency;
use crate::warp::boundary::Boundary;
use glam::DVec3;

/// The ends of a line lie this far inside the light, where no ray grazes its border.
const RIM: f32 = 1e-4;

/// The (unfolded) numbers of a light sample, and whether it lies on the lines through them.
pub struct LineChoice {
    pub s: [f32; LANES],
    pub r: [f32; LANES],
    /// Lanes whose light sample was tested and is (s, r) itself.
    pub on_lines: u32,
    /// Lanes whose light sample is visible.
    pub visible: u32,
}

/// Finds the crossings on both lines of every lane and appends them.
#[allow(clippy::too_many_arguments)]
pub fn find(
    tracer: &Tracer,
    adjacency: &Adjacency,
    vertices: &Vertices,
    surface: &Surface,
    patch: &[u32; LANES],
    choice: &LineChoice,
    counts: &mut Counts,
    out: &mut Vec<LightCrossing>,
) {
    let facing = facing_light(tracer, vertices, surface, patch);
    if facing == 0 {
        return;
    }
    for axis in 0..2 {
        let mut active = facing;
        let fixed = if axis == 0 { &choice.r } else { &choice.s };
        let middle = if axis == 0 { &choice.s } else { &choice.r };
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
                Some([from, to]) => (ends[0][lane], ends[1][lane]) = (from, to),
                None => active &= !(1 << lane),
            }
        }
        let visible = ends.map(|end| {
            let (s, r) = if axis == 0 {
                (&end, fixed)
            } else {
                (fixed, &end)
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
        let jumps = (visible[0] ^ visible[1])
            | choice.on_lines & ((visible[0] ^ choice.visible) | (visible[1] ^ choice.visible));
        for lane in (0..LANES).filter(|&l| (active & jumps) >> l & 1 == 1) {
            let sees = |bits: u32| bits >> lane & 1 == 1;
            let mut points = vec![(ends[0][lane], sees(visible[0]))];
            if sees(choice.on_lines) {
                points.push((middle[lane], sees(choice.visible)));
            }
            points.push((ends[1][lane], sees(visible[1])));
            for pair in points.windows(2).filter(|p| p[0].1 != p[1].1) {
                let cell = Cell {
                    lane,
                    axis,
                    patch: patch[lane],
                    fixed: fixed[lane],
                    ends: [pair[0], pair[1]],
                };
                match cell.resolve(tracer, adjacency, surface, &vertices.triangle, counts) {
                    Some(crossing) => out.push(crossing),
                    None => counts.unresolved += 1,
                }
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
    let mut bits = 0;
    for l in (0..LANES).filter(|&l| vertices.hit >> l & 1 == 1) {
        let p = &tracer.lights.patches[patch[l] as usize];
        let front = p.edges[0]
            .cross(p.edges[1])
            .dot(lane_of(surface.x, l) - p.corner)
            > 0.0;
        bits |= (front as u32) << l;
    }
    let rho = vertices.reflectance;
    bits & lane_mask(vertices.hit).to_bits()
        & rho.x.max(rho.y).max(rho.z).gt(Lane::splat(0.0)).to_bits()
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
        triangle: &[u32; LANES],
        counts: &mut Counts,
    ) -> Option<LightCrossing> {
        let patch = &tracer.lights.patches[self.patch as usize];
        let x = lane_of(surface.x, self.lane).as_dvec3();
        let point = |at: f64| -> DVec3 {
            let at = at as f32;
            let y = if self.axis == 0 {
                patch.point(at, self.fixed)
            } else {
                patch.point(self.fixed, at)
            };
            y.as_dvec3() - x
        };
        let (dark, bright) = if self.ends[0].1 { (1, 0) } else { (0, 1) };
        let (from, to) = (self.ends[dark].0 as f64, self.ends[bright].0 as f64);
        let from_surface = SurfacePoint::of_lane(surface, triangle, self.lane);
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
        Some(LightCrossing {
            boundary,
            lane: self.lane as u8,
            axis: self.axis as u8,
            patch: self.patch,
            at: if self.axis == 0 {
                [at, fixed]
            } else {
                [fixed, at]
            },
            jump: if dark == 0 { -1.0 } else { 1.0 },
        })
    }
}
