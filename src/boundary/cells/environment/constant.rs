//! Silhouettes before a constant environment, as seen from diffuse surfaces at the last vertex: all
//! that matters on a line is where it is hidden, so that its points are occlusion queries and all
//! lanes of a packet have lines.

use crate::boundary::cells::bright::{Bright, Over};
use crate::boundary::cells::lobe::line::{LaneSurface, Line, Lobe};
use crate::boundary::cells::lobe::vertex::{Border, FAMILIES, LobeSearch};
use crate::boundary::occlusion::SurfacePoint;
use crate::boundary::shadows::{ShadowLine, Shadows};
use crate::discontinuity::boundary::Boundary;
use crate::lanes::LANES;
use crate::paths::rays::{from_lanes, lane_of};
use glam::{DVec3, Vec3};

/// Finds what hides a constant environment from diffuse lanes at their last bounce; those in `free`
/// see it.
pub fn find(search: &mut LobeSearch, free: u32) {
    let Some(environment) = &search.scene.view.scene.environment else {
        return;
    };
    let scene = search.scene.view.scene;
    let radiance = Vec3::from(scene.constant(environment.radiance)).as_dvec3();
    let active = search.bounce.rays.active & search.lanes;
    let bright = Bright::new(search.at, Over::EvenEnvironment, active);
    let first = search.out.samples.len();
    let lines: [Option<Line>; LANES] = std::array::from_fn(|lane| {
        if bright.lanes >> lane & 1 == 0 {
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
    bright.weigh(&mut search.out.samples[first..]);
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
    let view = search.scene.view;
    let rays = view.leaving(surface.x, surface.geometric, directions, wanted);
    view.unoccluded(&rays, &mut search.out.counts.bounce_cell) | known
}

/// The silhouettes of whatever hides the environment at some of the points of a lane's line.
fn shadows(search: &mut LobeSearch, lane: usize, line: &Line, is_open: &[bool], radiance: DVec3) {
    let shadows = Shadows {
        scene: search.scene,
        point: &SurfacePoint::of_lane(search.at, lane),
        line,
        points: &line.psi,
        is_open,
    };
    let edges = shadows.edges(&mut search.out.counts);
    let mut at = LaneSurface::new(search.at, lane, Lobe::Diffuse);
    for edge in edges {
        let boundary = Boundary::Edge(edge.end.edge);
        let border = Border::seen(boundary);
        let jump = (radiance, edge.jump * FAMILIES);
        search.push(&mut at, line, border, line.direction(edge.at), jump);
    }
}

impl ShadowLine for Line {
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

    fn chance_between(&self, interval: [f64; 2]) -> f64 {
        Line::chance_between(self, interval)
    }
}
