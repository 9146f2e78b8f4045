//! Shadows: where the light's visibility jumps inside the light's own square.
//!
//! For a vertex x and a patch, L(θ) = ∫₀¹∫₀¹ g(s, r) vis(s, r) ds dr. On a line of fixed r, cut at
//! any points s₀ = 0 < s₁ < … < 1, the change of variables of each cell shifts its interior rigidly
//! by V_s, the speed of the silhouette that was found in it, and leaves ∂L = ∫∂(g)·vis + Σ_cells
//! V_s·(g₋ − g₊) at the jump (a rotation of the bundle seen from x; Loubet 2019). Lines of fixed r
//! give the part of the motion along s, lines of fixed s the part along r, and their sum is the
//! whole: V·n dl = V_s dr + V_r ds.
//!
//! Each vertex draws one uniform (s, r), which is its light sample, and the two lines through it;
//! the lines' ends lie on the light's rim, so that the cells cover them without gaps, and jittered
//! points divide them. No kernel width: a silhouette that crosses a line is found with certainty if
//! it crosses the cell once. A shadow that is shorter than the spacing of the points may be missed,
//! and is weighed for that (`crate::boundary::shadows`).

use super::line::{PAIRS, POINTS, chance_of_point, points, unclear};
use crate::boundary::clearance::Lit;
use crate::boundary::light_samples;
use crate::boundary::occlusion::{OccluderEnd, SurfacePoint};
use crate::boundary::search_scene::SearchScene;
use crate::boundary::shadows::{ShadowLine, Shadows};
use crate::discontinuity::boundary::{Boundary, velocity_per_side};
use crate::lanes::LANES;
use crate::paths::at::At;
use crate::paths::boundary_sample::{BoundarySample, Coordinate, Found, NO_CHAIN};
use crate::paths::estimator::LightDraw;
use crate::paths::leaving::SHADOW_FAR;
use crate::paths::light::patches::Patch;
use crate::paths::moving::Sector;
use crate::paths::rays::lane_of;
use crate::trace::geometry::Geometry;
use glam::{DVec3, Vec3};

/// The ends of a line lie this far inside the light, where no ray grazes its border.
const RIM: f32 = 1e-4;

/// Finds what jumps on both lines through the light samples of these lanes, if they stand on the
/// bright side of their patches.
pub fn find(scene: &SearchScene, at: &At, draw: &LightDraw, lanes: u32, out: &mut Found) {
    let facing = lanes & facing_light(at, &draw.patch);
    let facing = unclear(scene, at, facing, |lane| {
        let patch = &at.view.lights.patches[draw.patch[lane] as usize];
        Some((around(at.view.geometry, patch), patch.lower[0]))
    });
    if facing == 0 {
        return;
    }
    for (axis, pair) in PAIRS.into_iter().enumerate() {
        let (jitter, extra) = at.numbers.pair(pair);
        let lines = LightLines {
            scene,
            at,
            draw,
            axis,
            jitter: jitter.to_array(),
            extra: extra.to_array(),
        };
        lines.find(facing, out);
    }
}

/// Lanes that stand on the bright side of their patch.
fn facing_light(at: &At, patch: &[u32; LANES]) -> u32 {
    let front = |l: &usize| {
        let p = &at.view.lights.patches[patch[*l] as usize];
        let normal = p.edges[0].cross(p.edges[1]);
        normal.dot(lane_of(at.surface.x, *l) - p.corner) > 0.0
    };
    (0..LANES).filter(front).fold(0, |bits, l| bits | 1 << l)
}

/// The lines of one direction of all lanes.
struct LightLines<'a> {
    scene: &'a SearchScene<'a>,
    at: &'a At<'a>,
    draw: &'a LightDraw,
    /// The lines go along this axis of the patches.
    axis: usize,
    jitter: [f32; LANES],
    /// Where one more point of each line lies.
    extra: [f32; LANES],
}

impl LightLines<'_> {
    fn find(&self, facing: u32, out: &mut Found) {
        let (mut active, mut ends) = (0u32, [[RIM; 2]; LANES]);
        for lane in (0..LANES).filter(|&l| facing >> l & 1 == 1) {
            if let Some(part) = self.part_that_matters(lane) {
                active |= 1 << lane;
                ends[lane] = part;
            }
        }
        let positions: [[f32; LANES]; POINTS] = {
            let points: [_; LANES] =
                std::array::from_fn(|l| points(ends[l], [self.jitter[l], self.extra[l]]));
            std::array::from_fn(|i| std::array::from_fn(|l| points[l][i] as f32))
        };
        let visible = positions.map(|along| self.visible(&along, active, out));
        // Where all points are hidden light may yet pass between them, and the shadows that reach
        // to the rims are taken to be met with certainty.
        let hidden = visible.iter().fold(0, |bits, open| bits | (active & !open));
        for lane in (0..LANES).filter(|&l| hidden >> l & 1 == 1) {
            let line = LightLine {
                at: self.at,
                lane,
                axis: self.axis,
                patch: self.draw.patch[lane],
                fixed: self.fixed()[lane],
                ends: ends[lane],
                point: SurfacePoint::of_lane(self.at, lane),
            };
            let points = positions.map(|at| at[lane] as f64);
            let is_open = visible.map(|v| v >> lane & 1 == 1);
            let shadows = Shadows {
                scene: self.scene,
                point: &line.point,
                line: &line,
                points: &points,
                is_open: &is_open,
            };
            for edge in shadows.edges(&mut out.counts) {
                out.samples.push(line.sample(edge.end, edge.at, edge.jump));
            }
        }
    }

    /// Each lane's coordinate across its line.
    fn fixed(&self) -> &[f32; LANES] {
        &self.draw.square[1 - self.axis]
    }

    /// The part of a lane's line that is above its horizon; `None` if nothing may be found there
    /// that moves.
    fn part_that_matters(&self, lane: usize) -> Option<[f32; 2]> {
        let SearchScene { view, moving, .. } = *self.scene;
        let (vertices, surface) = (self.at.vertices, self.at.surface);
        let patch = &view.lights.patches[self.draw.patch[lane] as usize];
        let fixed = self.fixed()[lane];
        let range = [RIM, patch.line_end(fixed) - RIM];
        let point = |along: f32| point_on_line(patch, self.axis, along, fixed);
        let (x, n) = (lane_of(surface.x, lane), lane_of(surface.n, lane));
        let part = above_horizon(range, range.map(|at| n.dot(point(at) - x)))?;
        let [a, b] = part.map(|at| (point(at) - x).as_dvec3());
        let moves = vertices.moves >> lane & 1 == 1
            || moving.vertex(view.geometry, patch.lower[0])
            || (moving.meets(&Sector::between(x.as_dvec3(), a, b))
                && !self
                    .scene
                    .sees_all_of(self.at, lane, &around(view.geometry, patch)));
        moves.then_some(part)
    }

    /// The lanes that see their patch at this place of their line.
    fn visible(&self, along: &[f32; LANES], active: u32, out: &mut Found) -> u32 {
        let (view, surface) = (self.at.view, self.at.surface);
        let (s, r) = if self.axis == 0 {
            (along, self.fixed())
        } else {
            (self.fixed(), along)
        };
        let y = view.patch_points(&self.draw.patch, s, r);
        let rays = view.toward(surface.x, surface.geometric, y, active);
        view.unoccluded(&rays, &mut out.counts.light_cell)
    }
}

/// A patch that is looked at as a whole.
fn around(geometry: &Geometry, patch: &Patch) -> Lit {
    let middle = patch.point(0.5, 0.5).as_dvec3();
    let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
    let away = corners.map(|[s, r]| (patch.point(s, r).as_dvec3() - middle).abs());
    Lit {
        middle,
        half: away.into_iter().fold(DVec3::ZERO, DVec3::max),
        reach: 1.0,
        mesh: geometry.mesh_of_vertex(patch.lower[0]),
        is_one: false,
    }
}

/// The part of a line whose points stand higher than the surface's horizon, given the heights at
/// its ends.
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

fn point_on_line(patch: &Patch, axis: usize, along: f32, fixed: f32) -> Vec3 {
    if axis == 0 {
        patch.point(along, fixed)
    } else {
        patch.point(fixed, along)
    }
}

/// A line on a light, as seen by a lane.
struct LightLine<'a> {
    at: &'a At<'a>,
    lane: usize,
    axis: usize,
    patch: u32,
    fixed: f32,
    /// Along the axis.
    ends: [f32; 2],
    point: SurfacePoint,
}

impl ShadowLine for LightLine<'_> {
    /// To the light, of full length.
    fn between(&self, ends: [f64; 2]) -> impl Fn(f64) -> DVec3 {
        move |s| {
            let along = self.coordinate(ends, s) as f32;
            let y = point_on_line(self.patch(), self.axis, along, self.fixed).as_dvec3();
            self.point.toward(y)
        }
    }

    fn coordinate(&self, [from, to]: [f64; 2], s: f64) -> f64 {
        from + (to - from) * s
    }

    fn far(&self) -> f32 {
        SHADOW_FAR
    }

    fn chance_between(&self, [low, high]: [f64; 2]) -> f64 {
        let [from, to] = self.ends.map(f64::from);
        let part = (high - low) / (to - from);
        chance_of_point(part)
    }
}

impl LightLine<'_> {
    fn patch(&self) -> &Patch {
        &self.at.view.lights.patches[self.patch as usize]
    }

    fn sample(&self, end: OccluderEnd, along: f64, jump: f64) -> BoundarySample {
        let OccluderEnd { edge, .. } = end;
        let line = self.patch().edges[1 - self.axis].as_dvec3();
        let boundary = match end.along {
            Some(along) => Boundary::Point { edge, along, line },
            None => Boundary::Edge(edge),
        };
        let fixed = self.fixed as f64;
        let at = if self.axis == 0 {
            [along, fixed]
        } else {
            [fixed, along]
        };
        let brings = light_samples::of_patch(self.at, self.lane, self.patch, at);
        let times = jump * self.velocity_per_side(boundary).unwrap_or(0.0);
        BoundarySample {
            boundary,
            shadow: None,
            lane: self.lane as u8,
            at: Coordinate::Light {
                patch: self.patch,
                at,
            },
            chain: NO_CHAIN,
            weight: (brings * times).as_vec3().to_array(),
            jump: brings.length() as f32,
        }
    }

    /// V/Ḟ of a border, along the line.
    fn velocity_per_side(&self, boundary: Boundary) -> Option<f64> {
        let At { view, vertices, .. } = *self.at;
        let x = vertices.position(view.geometry, self.lane);
        let c = boundary.normal(view.geometry, x);
        let edges = self.patch().edges.map(|e| e.as_dvec3());
        let gradient = edges.map(|e| c.dot(e));
        let metric = [
            edges[0].dot(edges[0]),
            edges[0].dot(edges[1]),
            edges[1].dot(edges[1]),
        ];
        velocity_per_side(gradient, metric, self.axis)
    }
}
