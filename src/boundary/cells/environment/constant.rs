//! Silhouettes before a constant environment, as seen from diffuse surfaces at the last vertex: all
//! that matters on a line is where it is hidden, so that its points are occlusion queries and all
//! lanes of a packet have lines.

use crate::boundary::cells::bright::{Bright, Over};
use crate::boundary::cells::lobe::line::{INNER_POINTS, LaneSurface, Line, Lobe, RIM};
use crate::boundary::cells::lobe::vertex::{Border, FAMILIES, LobeSearch};
use crate::boundary::occlusion::SurfacePoint;
use crate::boundary::shadows::{ShadowLine, Shadows};
use crate::discontinuity::boundary::Boundary;
use crate::kernels::frame::direction_from_local;
use crate::lanes::{LANES, Lane, V3};
use crate::paths::moving::Sector;
use crate::paths::rays::lane_of;
use glam::{DVec3, Vec3};
use std::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_4};

/// Of a line besides its bounce.
const POINTS: usize = INNER_POINTS + 2;

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
    let rows = Rows::new(search);
    let lanes = (0..LANES)
        .filter(|&lane| bright.lanes >> lane & 1 == 1 && rows.moves(search, lane))
        .fold(0, |bits, lane| bits | 1 << lane);
    let open = rows.open(search, lanes);
    // Most see nothing else.
    let is_hidden = lanes & !open.iter().fold(free, |all, open| all & open);
    for lane in (0..LANES).filter(|&lane| is_hidden >> lane & 1 == 1) {
        let at = LaneSurface::new(search.at, lane, Lobe::Diffuse);
        let bounce = lane_of(search.bounce.rays.direction, lane)
            .as_dvec3()
            .normalize();
        let jitter = search.jitter[lane] as f64;
        let line = Line::diffuse(&at, bounce, search.axis, jitter, true);
        let mut is_open: Vec<bool> = open.iter().map(|o| o >> lane & 1 == 1).collect();
        if let Some(place) = line.bounce {
            is_open.insert(place, free >> lane & 1 == 1);
        }
        shadows(search, lane, &line, &is_open, radiance);
    }
    bright.weigh(&mut search.out.samples[first..]);
}

/// The lines through the bounces of a packet, without what is known of them.
struct Rows {
    pole: V3<Lane>,
    middle: V3<Lane>,
    /// Sine and cosine of how far the points inside lie beyond quarters of the line.
    turn: [Lane; 2],
}

impl Rows {
    fn new(search: &LobeSearch) -> Self {
        let surface = search.at.surface;
        let unit = |i: usize| Lane::splat(if i == search.axis { 1.0 } else { 0.0 });
        let pole = direction_from_local(surface.n, V3::new(unit(0), unit(1), unit(2)));
        let bounce = search.bounce.rays.direction;
        let turn = Lane::new(search.jitter) * Lane::splat(FRAC_PI_4);
        let (sin, cos) = turn.sin_cos();
        Self {
            pole,
            middle: (bounce - pole * bounce.dot(pole)).normalize(),
            turn: [sin, cos],
        }
    }

    /// Whether something may be found on a lane's that moves as seen from there.
    fn moves(&self, search: &LobeSearch, lane: usize) -> bool {
        let [pole, middle] = [self.pole, self.middle].map(|v| lane_of(v, lane).as_dvec3());
        let n = lane_of(search.at.surface.n, lane).as_dvec3();
        search.sector_moves(lane, || Sector {
            origin: lane_of(search.at.surface.x, lane).as_dvec3(),
            normal: pole.cross(middle),
            inward: [middle, n],
        })
    }

    /// Which of these lanes see the environment at each point of their lines but the bounces.
    fn open(&self, search: &mut LobeSearch, lanes: u32) -> [u32; POINTS] {
        if lanes == 0 {
            return [0; POINTS];
        }
        let [s, c] = self.turn;
        let half = Lane::splat(FRAC_1_SQRT_2);
        let (sum, difference) = ((s + c) * half, (s - c) * half);
        let [one, rim] = [1.0, RIM as f32].map(Lane::splat);
        // Sines and cosines: of the rims, and of quarters of the half circle between them.
        let points = [
            (-one, rim),
            (-c, s.max(rim)),
            (difference, sum),
            (s, c),
            (sum, -difference),
            (one, rim),
        ];
        let (view, surface) = (search.scene.view, search.at.surface);
        points.map(|(sin, cos)| {
            let directions = self.pole * sin + self.middle * cos;
            let rays = view.leaving(surface.x, surface.geometric, directions, lanes);
            view.unoccluded(&rays, &mut search.out.counts.bounce_cell)
        })
    }
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
        let border = Border::seen(boundary, None);
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
