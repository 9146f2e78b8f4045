//! What a surface sees: where the radiance jumps over the hemisphere above a vertex.
//!
//! The narrow kernels and spherical convolutions of Loubet et al. (2019, §5) exist because their rotations need
//! a small support. A cell needs none: as on the film and on the lights, the hemisphere is cut along *lines*, here great
//! half-circles from one point of the horizon, −P, to the opposite one, P. With the direction written as
//! d = P·sin ψ + (T·cos φ + N·sin φ)·cos ψ, the cosine-weighted measure is cos θ dω = cos²ψ dψ · sin φ dφ, so the line through
//! a cosine-distributed direction has density sin φ/2 in φ. A silhouette that crosses it at ψ with angular speed ψ̇
//! contributes, per unit of reflectance, (1/π)·(L₋ − L₊)·ψ̇·2 cos²ψ.
//!
//! Two families of lines are used, about two orthogonal axes of the horizon. Each finds every silhouette, so they are
//! combined by weights W_f = F_f² / (F₁² + F₂²), F_f being the derivative of F along the line: that removes the 1/F_f of
//! ψ̇ = −Ḟ/F_f, which is singular for silhouettes along a line.

use super::occluders::{PROBE, SurfacePoint, follow_occluders};
use super::random::Stream;
use super::store::{TileStore, Vertices};
use super::tracer::{Counts, RayPacket, Surface, Tracer, from_lanes, lane_of, leave, to_rays};
use crate::kernels::frame::direction_from_local;
use crate::lanes::{LANES, Lane, V3};
use crate::scene::Rgb;
use crate::trace::geometry::NO_TRIANGLE;
use crate::trace::Coherence;
use crate::warp::adjacency::Adjacency;
use crate::warp::boundary::Boundary;
use crate::warp::resolve::{Between, between};
use crate::warp::walk::Arc;
use glam::{DVec3, Vec3};

/// A jump of the radiance that arrives at a vertex.
#[derive(Clone, Copy, Debug)]
pub struct BounceCrossing {
    pub boundary: Boundary,
    pub lane: u8,
    /// Which horizon axis the line runs to: 0 or 1.
    pub axis: u8,
    /// Direction of the crossing in the frame of the shading normal, unit.
    pub local: [f64; 3],
    /// Radiance before minus after the crossing, toward the horizon axis; times the weight of its having been sought.
    pub jump: Rgb,
}

/// What the bounces of a packet ended on.
#[derive(Clone, Copy)]
pub enum Seen<'a> {
    /// At the last vertex only the environment shines: lanes that see it.
    Environment(u32),
    /// Triangles, or none; the paths go on from there.
    Triangles(&'a [u32; LANES]),
}

/// Streams of paths that look beside silhouettes are kept apart from all others by this dimension offset.
const PROBE_INDEX: u32 = 0x4000_0000;

/// Finds the crossings on both lines through each lane's bounce `rays`, for the vertex stored last; `depth` is that of
/// the vertices the bounces lead to.
#[allow(clippy::too_many_arguments)]
pub fn find(
    tracer: &Tracer,
    adjacency: &Adjacency,
    surface: &Surface,
    rays: &RayPacket,
    seen: Seen,
    depth: u32,
    stream: &Stream,
    index: &[u32; LANES],
    counts: &mut Counts,
    store: &mut TileStore,
) {
    let first = store.bounce_crossings.len() as u32;
    let mut finder = Finder { tracer, adjacency, surface, rays, counts, out: &mut store.bounce_crossings };
    // Where only the environment shines a line needs no more than occlusion; else every line costs walks over whatever
    // is seen, and one lane stands for all.
    let at_last = depth + 1 >= tracer.limits.max_depth;
    match seen {
        Seen::Environment(free) => finder.environment(free),
        Seen::Triangles(triangles) if at_last => {
            if tracer.scene.environment.is_some() {
                let free = (0..LANES).filter(|&l| triangles[l] == NO_TRIANGLE).fold(0, |b, l| b | 1 << l);
                finder.environment(free & rays.active);
            }
        }
        Seen::Triangles(triangles) => finder.surfaces(triangles, depth, stream, index),
    }
    let end = store.bounce_crossings.len() as u32;
    if let Some(vertices) = store.vertices.last_mut() {
        vertices.bounce_crossings = [first, end];
    }
}

struct Finder<'a> {
    tracer: &'a Tracer<'a>,
    adjacency: &'a Adjacency,
    surface: &'a Surface,
    rays: &'a RayPacket,
    counts: &'a mut Counts,
    out: &'a mut Vec<BounceCrossing>,
}

impl Finder<'_> {
    /// Unit vectors of a horizon axis in each lane.
    fn pole(&self, axis: usize, sign: f64) -> V3<Lane> {
        let (zero, one) = (Lane::splat(0.0), Lane::splat(sign as f32));
        let [lx, ly] = if axis == 0 { [one, zero] } else { [zero, one] };
        direction_from_local(self.surface.n, lx, ly, zero)
    }

    fn environment(&mut self, free: u32) {
        let Some(environment) = &self.tracer.scene.environment else { return };
        let radiance = environment.radiance;
        let active = self.rays.active;
        for axis in 0..2 {
            for sign in [-1.0, 1.0] {
                let pole = self.pole(axis, sign);
                let origin = leave(self.surface.x, self.surface.geometric, self.surface.n);
                let rays = RayPacket { active, origin, direction: pole, near: 0.0, far: f32::INFINITY };
                self.counts.bounce_cell += active.count_ones() as u64;
                let open = active & !self.tracer.accel.occluded(&to_rays(&rays), active, Coherence::Incoherent);
                for lane in (0..LANES).filter(|&l| (open ^ free) & active & 1 << l != 0) {
                    let ends = [lane_of(self.rays.direction, lane), lane_of(pole, lane)].map(|d| d.as_dvec3());
                    let pole_is_dark = open >> lane & 1 == 0;
                    let (dark, bright) = if pole_is_dark { (1.0, 0.0) } else { (0.0, 1.0) };
                    let direction = |s: f64| ends[0] * (1.0 - s) + ends[1] * s;
                    let point = SurfacePoint::of_lane(self.surface, lane);
                    let found = follow_occluders(
                        self.tracer, self.adjacency, &point, &direction, [dark, bright], f32::INFINITY, self.counts,
                    );
                    // Along ψ (toward +P): the bright side lies before the crossing if the dark end is the one at +P, or
                    // the bright end is the one at −P.
                    let before_is_bright = pole_is_dark == (sign > 0.0);
                    let jump = radiance.map(|r| if before_is_bright { r } else { -r });
                    match found {
                        Some((fold, s)) => self.push(lane, axis, Boundary::Edge(fold.edge), direction(s), jump),
                        None => self.counts.unresolved += 1,
                    }
                }
            }
        }
    }

    fn push(&mut self, lane: usize, axis: usize, boundary: Boundary, direction: DVec3, jump: Rgb) {
        let direction = direction.normalize();
        let n = lane_of(self.surface.n, lane).as_dvec3();
        let along = |axis: usize| lane_of(self.pole(axis, 1.0), lane).as_dvec3().dot(direction);
        let local = [along(0), along(1), n.dot(direction)];
        self.out.push(BounceCrossing { boundary, lane: lane as u8, axis: axis as u8, local, jump });
    }

    /// Lines among reflecting surfaces, for one lane of the packet.
    fn surfaces(&mut self, triangles: &[u32; LANES], depth: u32, stream: &Stream, index: &[u32; LANES]) {
        let active = self.rays.active;
        let lanes = active.count_ones();
        let chosen = (stream.pair(index, depth * super::tracer::PAIRS_PER_VERTEX + 3).1.to_array()[0] * lanes as f32) as u32;
        let Some(lane) = (0..LANES).filter(|&l| active >> l & 1 == 1).nth(chosen.min(lanes.max(1) - 1) as usize) else {
            return;
        };
        let point = SurfacePoint::of_lane(self.surface, lane);
        let origin = point.x.as_dvec3();
        let here = (lane_of(self.rays.direction, lane).as_dvec3(), triangles[lane]);
        let mut found: Vec<(usize, Boundary, Arc, f64)> = Vec::new();
        for axis in 0..2 {
            for sign in [-1.0, 1.0] {
                let pole = lane_of(self.pole(axis, sign), lane).as_dvec3();
                self.counts.bounce_cell += 1;
                let there = point.first_hit(self.tracer, pole, f32::INFINITY, self.counts);
                let (a, b) = if sign > 0.0 { (here, (pole, there)) } else { ((pole, there), here) };
                let arc = Arc { origin, a: a.0, b: b.0 };
                match between(self.tracer.geometry, self.adjacency, &arc, a.1, b.1) {
                    Between::Nothing => {}
                    Between::Crease { boundary, s } => found.push((axis, boundary, arc, s)),
                    Between::Silhouette(fold) | Between::Ridge(fold) =>
                        found.push((axis, Boundary::Edge(fold.edge), arc, fold.s)),
                    Between::Unresolved => self.counts.unresolved += 1,
                }
            }
        }
        // Look on both sides of each silhouette: the jump is taken where it is, not at the ends of the line.
        for group in found.chunks(LANES / 2) {
            let mut directions = [Vec3::Z; LANES];
            let mut packet = 0;
            for (i, (_, _, arc, s)) in group.iter().enumerate() {
                for (k, side) in [-PROBE, PROBE].into_iter().enumerate() {
                    directions[2 * i + k] = arc.direction(s + side).normalize().as_vec3();
                    packet |= 1 << (2 * i + k);
                }
            }
            let directions = from_lanes(&directions);
            let geometric = from_lanes(&[point.geometric; LANES]);
            let origin = leave(from_lanes(&[point.x; LANES]), geometric, directions);
            let rays = RayPacket { active: packet, origin, direction: directions, near: 0.0, far: f32::INFINITY };
            let index = std::array::from_fn(|l| PROBE_INDEX + index[l]);
            let (radiance, _) = self.tracer.reflected_radiance(rays, depth, stream, &index, self.counts);
            for (i, (axis, boundary, arc, s)) in group.iter().enumerate() {
                let [before, after] = [2 * i, 2 * i + 1].map(|l| lane_of(radiance, l));
                let jump = ((before - after) * lanes as f32).to_array();
                self.push(lane, *axis, *boundary, arc.direction(*s), jump);
            }
        }
    }
}

impl BounceCrossing {
    /// Radiance of the path per unit of Ḟ, all at θ₀ (see the module's derivation).
    pub fn radiance_per_side(&self, tracer: &Tracer, vertices: &Vertices) -> Option<[f64; 3]> {
        let lane = self.lane as usize;
        let x = vertices.position(tracer.geometry, lane);
        let c = self.boundary.normal(tracer.geometry, x);
        let n = lane_of(vertices.normal(tracer), lane).as_dvec3();
        let frame = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], self.local].map(|[lx, ly, lz]| {
            let n = crate::warp::boundary::vector(n);
            crate::warp::boundary::dvec3(direction_from_local(n, lx, ly, lz))
        });
        let d = frame[2];
        // Unit tangents of both lines through d, toward their poles.
        let along = [0, 1].map(|f| {
            let toward = frame[f] - d * d.dot(frame[f]);
            c.dot(toward) / toward.length()
        });
        let norm = along[0] * along[0] + along[1] * along[1];
        if norm.is_nan() || norm <= 0.0 {
            return None;
        }
        let sin_psi = self.local[self.axis as usize];
        let cos2_psi = 1.0 - sin_psi * sin_psi;
        let scale = -along[self.axis as usize] / norm * 2.0 * cos2_psi * std::f64::consts::FRAC_1_PI;
        let survival = vertices.survival;
        let colour = lane_of(vertices.throughput.times(vertices.reflectance) * survival, lane).to_array();
        Some(std::array::from_fn(|i| scale * (colour[i] * self.jump[i]) as f64))
    }
}
