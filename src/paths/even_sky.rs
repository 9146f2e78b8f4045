//! Silhouettes before a constant environment, as seen from diffuse surfaces at the last vertex: all that matters on a line is
//! where it is hidden, so that its points are occlusion queries and all lanes of a packet have lines.

use super::bounce_cells::{FAMILIES, Finder};
use super::bounce_lines::{LaneSurface, Line, Lobe};
use super::occluders::{SurfacePoint, shadow_edges};
use super::random::Stream;
use super::rays::{RayPacket, from_lanes, lane_of, leave, to_rays};
use super::shadow_draws::{ShadowEnd, ShadowLine, Shadows};
use crate::lanes::LANES;
use crate::trace::Coherence;
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;

/// Streams of other draws of these lines are told by this, and the depth, from those on lights and maps.
const DRAWS: u32 = 0x100;

impl Finder<'_> {
    /// Diffuse lanes under a constant environment, at their last bounce; those in `free` see it.
    pub(super) fn environment(
        &mut self,
        free: u32,
        depth: u32,
        stream: &Stream,
        index: &[u32; LANES],
    ) {
        let Some(environment) = &self.tracer.scene.environment else {
            return;
        };
        let radiance = Vec3::from(self.tracer.scene.constant(environment.radiance)).as_dvec3();
        let active = self.rays.active;
        let lines: [Option<Line>; LANES] = std::array::from_fn(|lane| {
            if active >> lane & 1 == 0 {
                return None;
            }
            let at = LaneSurface::new(self.vertices, self.surface, lane, Lobe::Diffuse);
            let bounce = lane_of(self.rays.direction, lane).as_dvec3().normalize();
            let line = Line::diffuse(&at, bounce, self.axis, self.jitter[lane] as f64, true);
            self.moves(lane, &line, &at).then_some(line)
        });
        let points = lines.iter().flatten().map(|l| l.psi.len()).max();
        let open: Vec<u32> = (0..points.unwrap_or(0))
            .map(|i| self.open(&lines, i, free))
            .collect();
        let changes = open.windows(2).fold(0, |bits, o| bits | (o[0] ^ o[1])) & active;
        for (lane, line) in lines.iter().enumerate() {
            if let (Some(line), true) = (line, changes >> lane & 1 == 1) {
                let open: Vec<bool> = open.iter().map(|o| o >> lane & 1 == 1).collect();
                let stream = stream.branch([index[lane], DRAWS + depth]);
                self.shadows(lane, line, &open, radiance, &stream);
            }
        }
    }

    /// Which lanes see the sky at point `i` of their lines.
    fn open(&mut self, lines: &[Option<Line>; LANES], i: usize, free: u32) -> u32 {
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
        let directions = from_lanes(&directions);
        let rays = RayPacket {
            active: wanted,
            origin: leave(self.surface.x, self.surface.geometric, directions),
            direction: directions,
            near: 0.0,
            far: f32::INFINITY,
        };
        self.counts.bounce_cell += wanted.count_ones() as u64;
        let blocked = self
            .tracer
            .accel
            .occluded(&to_rays(&rays), wanted, Coherence::Incoherent);
        (wanted & !blocked) | known
    }

    /// The silhouettes of whatever hides the sky at some of the points of a lane's line.
    fn shadows(
        &mut self,
        lane: usize,
        line: &Line,
        open: &[bool],
        radiance: DVec3,
        stream: &Stream,
    ) {
        let point = SurfacePoint::of_lane(self.surface, &self.vertices.triangle, lane);
        let directions: Vec<DVec3> = line.psi.iter().map(|&psi| line.direction(psi)).collect();
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
            .map(|edge| ShadowEnd::of_edge(edge, &line.psi, line.psi_of(edge.direction)))
            .collect();
        let shadows = Shadows {
            tracer: self.tracer,
            adjacency: self.adjacency,
            point: &point,
            line,
            ends: &ends,
        };
        let psi: Vec<f64> = ends.iter().map(|end| end.at).collect();
        let weights = shadows.weights(&line.runs(&psi), stream, self.counts);
        let mut at = LaneSurface::new(self.vertices, self.surface, lane, Lobe::Diffuse);
        for ((edge, psi), weight) in edges.into_iter().zip(psi).zip(weights) {
            let Some(boundary) = edge.boundary else {
                continue;
            };
            let jump = radiance * (edge.sign() * weight * FAMILIES);
            self.push(&mut at, line, lane, boundary, line.direction(psi), jump);
        }
    }
}

/// Where another bounce lies on its line, from two uniform numbers: sin ψ is a coordinate of a point of the disk, over which
/// cosine-distributed directions are uniform.
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
}

#[cfg(test)]
mod tests {
    use super::bounce_on_line;
    use std::f64::consts::FRAC_1_PI;

    /// The density of a bounce on its line is 2/π cos²ψ, as `Line::runs` has it.
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
