//! Silhouettes before a constant environment, as seen from diffuse surfaces at the last vertex: all
//! that matters on a line is where it is hidden, so that its points are occlusion queries and all
//! lanes of a packet have lines.

use crate::boundary::cells::lobe::line::{LaneSurface, Line, Lobe};
use crate::boundary::cells::lobe::vertex::{FAMILIES, LobeSearch};
use crate::boundary::inclusion::Intervals;
use crate::boundary::occlusion::SurfacePoint;
use crate::boundary::reciprocal::{ShadowLine, Shadows};
use crate::discontinuity::boundary::Boundary;
use crate::lanes::LANES;
use crate::paths::dimensions::Branch;
use crate::paths::rays::{RayPacket, from_lanes, lane_of};
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;

/// Finds what hides a constant environment from diffuse lanes at their last bounce; those in `free`
/// see it.
pub fn find(search: &mut LobeSearch, free: u32) {
    let Some(environment) = &search.scene.view.scene.environment else {
        return;
    };
    let scene = search.scene.view.scene;
    let radiance = Vec3::from(scene.constant(environment.radiance)).as_dvec3();
    let active = search.bounce.rays.active;
    let lines: [Option<Line>; LANES] = std::array::from_fn(|lane| {
        if active >> lane & 1 == 0 {
            return None;
        }
        let at = LaneSurface::new(search.at, lane, Lobe::Diffuse);
        let bounce = lane_of(search.bounce.rays.direction, lane)
            .as_dvec3()
            .normalize();
        let jitter = search.jitter[lane] as f64;
        let line = Line::diffuse(&at, bounce, search.axis, jitter, true);
        search.moves(lane, &line, &at).then_some(line)
    });
    let points = lines.iter().flatten().map(|l| l.psi.len()).max();
    let open: Vec<u32> = (0..points.unwrap_or(0))
        .map(|i| open(search, &lines, i, free))
        .collect();
    for (lane, line) in lines.iter().enumerate() {
        if let Some(line) = line {
            let is_open: Vec<bool> = open.iter().map(|o| o >> lane & 1 == 1).collect();
            shadows(search, lane, line, &is_open, radiance);
        }
    }
}

/// Which lanes see the environment at point `i` of their lines.
fn open(search: &mut LobeSearch, lines: &[Option<Line>; LANES], i: usize, free: u32) -> u32 {
    let mut directions = [Vec3::Z; LANES];
    let (mut wanted, mut known) = (0u32, 0u32);
    for (lane, line) in lines.iter().enumerate() {
        if let Some(line) = line {
            if line.bounce == Some(i) {
                known |= free & 1 << lane;
            } else {
                wanted |= 1 << lane;
            }
            directions[lane] = line.direction(line.psi[i]).as_vec3();
        }
    }
    let surface = search.at.surface;
    let directions = from_lanes(&directions);
    let rays = RayPacket::leaving(surface.x, surface.geometric, directions, wanted);
    let view = search.scene.view;
    view.unoccluded(&rays, &mut search.out.counts.bounce_cell) | known
}

/// The silhouettes of whatever hides the environment at some of the points of a lane's line.
fn shadows(search: &mut LobeSearch, lane: usize, line: &Line, is_open: &[bool], radiance: DVec3) {
    let numbers = &search.at.numbers;
    let name = [numbers.index[lane], numbers.depth, 0];
    let draws = numbers.stream.branch(Branch::ConstantShadow, name);
    let shadows = Shadows {
        scene: search.scene,
        point: &SurfacePoint::of_lane(search.at, lane),
        line,
    };
    let edges = shadows.edges(&line.psi, is_open, &draws, &mut search.out.counts);
    let mut at = LaneSurface::new(search.at, lane, Lobe::Diffuse);
    for edge in edges {
        let boundary = Boundary::Edge(edge.end.edge);
        let jump = radiance * (edge.jump * FAMILIES);
        search.push(&mut at, line, boundary, line.direction(edge.at), jump);
    }
}

/// Where another bounce lies on its line, from two uniform numbers: sin ψ is a coordinate of a
/// point of the disk, over which cosine-distributed directions are uniform.
fn bounce_on_line([u, v]: [f64; 2]) -> f64 {
    (u.sqrt() * (v * TAU).cos()).asin()
}

impl ShadowLine for Line {
    fn draw(&self, random: &mut dyn FnMut() -> f64) -> Vec<f64> {
        Line::points(random(), Some(bounce_on_line([random(), random()]))).0
    }

    fn between(&self, ends: [f64; 2]) -> impl Fn(f64) -> DVec3 {
        let [a, b] = ends.map(|psi| self.direction(psi));
        move |s| a * (1.0 - s) + b * s
    }

    fn coordinate(&self, ends: [f64; 2], s: f64) -> f64 {
        self.psi_of(self.between(ends)(s))
    }

    fn far(&self) -> f32 {
        f32::INFINITY
    }

    fn intervals(&self, borders: &[f64]) -> Intervals {
        Line::intervals(self, borders)
    }
}

#[cfg(test)]
mod tests {
    use super::bounce_on_line;
    use std::f64::consts::FRAC_1_PI;

    /// The density of a bounce on its line is 2/π cos²ψ, as `Line::intervals` has it.
    #[test]
    fn bounces_lie_on_lines_as_their_density_says() {
        const SIDE: usize = 1000;
        let middle = |i: usize| (i as f64 + 0.5) / SIDE as f64;
        for psi in [-1.4f64, -0.6, 0.0, 0.3, 1.2] {
            let below = (0..SIDE * SIDE)
                .filter(|i| bounce_on_line([middle(i % SIDE), middle(i / SIDE)]) < psi)
                .count();
            let expected = 0.5 + (psi + psi.sin() * psi.cos()) * FRAC_1_PI;
            let share = below as f64 / (SIDE * SIDE) as f64;
            // The curve passes through at most some four cells a row.
            assert!(
                (share - expected).abs() < 4.0 / SIDE as f64,
                "{share} for {expected}"
            );
        }
    }
}
