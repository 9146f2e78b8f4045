//! What a surface sees: where the radiance jumps over the hemisphere above a vertex.
//!
//! The narrow kernels and spherical convolutions of Loubet et al. (2019, §5) exist because their rotations need
//! a small support. A cell needs none: as on the film and on the lights, the hemisphere is cut along *lines*, here great
//! half-circles from one point of the horizon, −P, to the opposite one, P. With the direction written as
//! d = P·sin ψ + (T·cos φ + N·sin φ)·cos ψ, the cosine-weighted measure is cos θ dω = cos²ψ dψ · sin φ dφ, so the line through
//! a cosine-distributed direction has density sin φ/2 in φ. A silhouette that crosses it at ψ with angular speed ψ̇
//! contributes, per unit of reflectance, (1/π)·(L₋ − L₊)·ψ̇·2 cos²ψ.
//!
//! Two families of lines are used, about two orthogonal axes of the horizon. Each could find every silhouette, so they are
//! combined by weights W_f = F_f² / (F₁² + F₂²), F_f being the derivative of F along the line: that removes the 1/F_f of
//! ψ̇ = −Ḟ/F_f, which is singular for silhouettes along a line.

use super::occluders::{OccluderEnd, PROBE, SurfacePoint, follow_occluders};
use super::random::Stream;
use super::store::{TileStore, Vertices};
use super::tracer::{Counts, RayPacket, Surface, Tracer, from_lanes, lane_of, leave, to_rays};
use crate::kernels::frame::direction_from_local;
use crate::lanes::{LANES, Lane, V3};
use crate::scene::Rgb;
use crate::trace::Coherence;
use crate::trace::geometry::NO_TRIANGLE;
use crate::warp::adjacency::Adjacency;
use crate::warp::boundary::Boundary;
use crate::warp::resolve::{Crossing, Unresolved, between};
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

/// Points on a line besides its bounce and its two ends on the horizon: jittered, so that no silhouette hides between
/// the same two points for all vertices.
const INNER_POINTS: usize = 4;
/// Runs that are met with less than this chance are weighed as if it were this.
const SMALLEST_CHANCE: f64 = 1e-3;

/// Finds the crossings on a line through each lane's bounce `rays`, for the vertex stored last; `depth` is that of the
/// vertices the bounces lead to. One of the two families is drawn for the whole packet.
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
    let (_, jitter) = stream.pair(index, depth * super::tracer::PAIRS_PER_VERTEX - 1);
    let axis = (stream.uniform(AXIS + index[0].wrapping_mul(8).wrapping_add(depth)) * 2.0) as usize;
    let lines = Lines::new(surface, rays.direction, axis, jitter);
    let triangle = store
        .vertices
        .last()
        .map_or([NO_TRIANGLE; LANES], |v| v.triangle);
    let mut finder = Finder {
        tracer,
        adjacency,
        surface,
        triangle: &triangle,
        rays,
        lines,
        counts,
        out: &mut store.bounce_crossings,
    };
    // Where only the environment shines a line needs no more than occlusion; else every line costs walks over whatever
    // is seen, and one lane stands for all.
    let at_last = depth + 1 >= tracer.limits.max_depth;
    match seen {
        Seen::Environment(free) => finder.environment(free),
        Seen::Triangles(triangles) if at_last => {
            if tracer.scene.environment.is_some() {
                let free = (0..LANES)
                    .filter(|&l| triangles[l] == NO_TRIANGLE)
                    .fold(0, |b, l| b | 1 << l);
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

/// Dimension of a stream from which on families of lines are drawn.
const AXIS: u32 = 0x2000_0000;

/// The line of each lane: great half-circles through the bounce.
struct Lines {
    axis: usize,
    /// P and the unit vector orthogonal to it in the line's plane: d = P·sin ψ + M·cos ψ.
    pole: V3<Lane>,
    middle: V3<Lane>,
    /// ψ of all points in each lane, increasing, and which of them is the bounce.
    psi: [[f32; LANES]; INNER_POINTS + 3],
    bounce: [usize; LANES],
}

impl Lines {
    fn new(surface: &Surface, bounce: V3<Lane>, axis: usize, jitter: Lane) -> Self {
        let pole = horizon_axis(surface, axis);
        let sin = bounce.dot(pole);
        let across = bounce - pole * sin;
        let cos = across.length();
        let middle = across * (Lane::splat(1.0) / cos);
        let (sin, cos, jitter) = (sin.to_array(), cos.to_array(), jitter.to_array());
        let mut psi = [[0.0; LANES]; INNER_POINTS + 3];
        let mut place = [0; LANES];
        let quarter = std::f32::consts::FRAC_PI_2;
        for lane in 0..LANES {
            let of_bounce = sin[lane].atan2(cos[lane]);
            let inner = |k: usize| {
                2.0 * quarter * (k as f32 + jitter[lane]) / INNER_POINTS as f32 - quarter
            };
            let before = (0..INNER_POINTS).filter(|&k| inner(k) < of_bounce).count();
            for (i, row) in psi.iter_mut().enumerate() {
                row[lane] = match i {
                    0 => -quarter,
                    i if i == INNER_POINTS + 2 => quarter,
                    i if i == before + 1 => of_bounce,
                    i if i <= before => inner(i - 1),
                    i => inner(i - 2),
                };
            }
            place[lane] = before + 1;
        }
        Self {
            axis,
            pole,
            middle,
            psi,
            bounce: place,
        }
    }

    /// Where a direction that lies on a lane's line lies on it.
    fn psi_of(&self, lane: usize, direction: DVec3) -> f64 {
        let along = |v: V3<Lane>| lane_of(v, lane).as_dvec3().dot(direction);
        along(self.pole).atan2(along(self.middle))
    }

    /// Directions of point `i` in all lanes.
    fn directions(&self, i: usize) -> V3<Lane> {
        let (sin, cos) = Lane::new(self.psi[i]).sin_cos();
        self.pole * sin + self.middle * cos.max(Lane::splat(0.0))
    }
}

/// The chance that a point of a line falls between ψ = `from` and `to`: one of the jittered points, which stand at equal
/// distances, or the bounce, whose density on its line is 2/π cos²ψ.
fn chance_of_meeting(from: f64, to: f64) -> f64 {
    use std::f64::consts::{FRAC_1_PI, PI};
    let jittered = ((to - from) * INNER_POINTS as f64 * FRAC_1_PI).min(1.0);
    let below = |psi: f64| (psi + psi.sin() * psi.cos()) / PI;
    let bounce = below(to) - below(from);
    (1.0 - (1.0 - jittered) * (1.0 - bounce)).max(SMALLEST_CHANCE)
}

/// What stands between two silhouettes of a line is met with a chance that is known once it has been met: its silhouettes
/// stand for all those that were not. `psi` of all silhouettes on the line, increasing; the two ends of the line are
/// always looked at. Returns the weight of each run: before the first silhouette, between them, after the last.
fn run_weights(psi: &[f64]) -> Vec<f64> {
    let mut weights = vec![1.0; psi.len() + 1];
    for (weight, ends) in weights[1..].iter_mut().zip(psi.windows(2)) {
        *weight = 1.0 / chance_of_meeting(ends[0], ends[1]);
    }
    weights
}

fn horizon_axis(surface: &Surface, axis: usize) -> V3<Lane> {
    let (zero, one) = (Lane::splat(0.0), Lane::splat(1.0));
    let [lx, ly] = if axis == 0 { [one, zero] } else { [zero, one] };
    direction_from_local(surface.n, lx, ly, zero)
}

struct Finder<'a> {
    tracer: &'a Tracer<'a>,
    adjacency: &'a Adjacency,
    surface: &'a Surface,
    /// Triangles that the vertex lies on.
    triangle: &'a [u32; LANES],
    rays: &'a RayPacket,
    lines: Lines,
    counts: &'a mut Counts,
    out: &'a mut Vec<BounceCrossing>,
}

/// A crossing on a line among reflecting surfaces, before its jump is known.
struct Found {
    boundary: Boundary,
    arc: Arc,
    /// Where on the arc.
    s: f64,
    /// Where on the line.
    psi: f64,
    is_silhouette: bool,
    /// How many it stands for.
    weight: f64,
}

/// There are two families and one is drawn.
const FAMILIES: f32 = 2.0;

impl Finder<'_> {
    fn environment(&mut self, free: u32) {
        let Some(environment) = &self.tracer.scene.environment else {
            return;
        };
        let radiance = self
            .tracer
            .scene
            .constant(environment.radiance)
            .map(|r| r * FAMILIES);
        let active = self.rays.active;
        let open: [u32; INNER_POINTS + 3] = std::array::from_fn(|i| {
            let is_bounce = (0..LANES)
                .filter(|&l| self.lines.bounce[l] == i)
                .fold(0, |b, l| b | 1 << l)
                & active;
            let wanted = active & !is_bounce;
            if wanted == 0 {
                return free & is_bounce;
            }
            let direction = self.lines.directions(i);
            let origin = leave(self.surface.x, self.surface.geometric, self.surface.n);
            let rays = RayPacket {
                active: wanted,
                origin,
                direction,
                near: 0.0,
                far: f32::INFINITY,
            };
            self.counts.bounce_cell += wanted.count_ones() as u64;
            let blocked =
                self.tracer
                    .accel
                    .occluded(&to_rays(&rays), wanted, Coherence::Incoherent);
            (wanted & !blocked) | (free & is_bounce)
        });
        let changes = open.windows(2).fold(0, |bits, o| bits | (o[0] ^ o[1]));
        for lane in (0..LANES).filter(|&l| changes & active & 1 << l != 0) {
            let mut silhouettes: Vec<(f64, DVec3, Boundary, f32)> = Vec::new();
            let mut all_found = true;
            for i in (0..INNER_POINTS + 2).filter(|&i| (open[i] ^ open[i + 1]) >> lane & 1 == 1) {
                let ends = [i, i + 1].map(|i| lane_of(self.lines.directions(i), lane).as_dvec3());
                let before_is_bright = open[i] >> lane & 1 == 1;
                let cell = if before_is_bright {
                    [1.0, 0.0]
                } else {
                    [0.0, 1.0]
                };
                let direction = |s: f64| ends[0] * (1.0 - s) + ends[1] * s;
                let point = SurfacePoint::of_lane(self.surface, self.triangle, lane);
                let far = f32::INFINITY;
                match follow_occluders(
                    self.tracer,
                    self.adjacency,
                    &point,
                    &direction,
                    cell,
                    far,
                    self.counts,
                ) {
                    Some(OccluderEnd { edge, at: s, .. }) => {
                        let sign = if before_is_bright { 1.0 } else { -1.0 };
                        let direction = direction(s).normalize();
                        let psi = self.lines.psi_of(lane, direction);
                        silhouettes.push((psi, direction, Boundary::Edge(edge), sign));
                    }
                    None => {
                        self.counts.unresolved += 1;
                        all_found = false;
                    }
                }
            }
            let psi: Vec<f64> = silhouettes.iter().map(|s| s.0).collect();
            let weights = run_weights(&psi);
            for (i, (_, direction, boundary, sign)) in silhouettes.into_iter().enumerate() {
                let weight = if all_found {
                    weights[i].max(weights[i + 1]) as f32
                } else {
                    1.0
                };
                self.push(
                    lane,
                    boundary,
                    direction,
                    radiance.map(|r| r * sign * weight),
                );
            }
        }
    }

    fn push(&mut self, lane: usize, boundary: Boundary, direction: DVec3, jump: Rgb) {
        let n = lane_of(self.surface.n, lane).as_dvec3();
        let along = |axis: usize| {
            lane_of(horizon_axis(self.surface, axis), lane)
                .as_dvec3()
                .dot(direction)
        };
        let local = [along(0), along(1), n.dot(direction)];
        self.out.push(BounceCrossing {
            boundary,
            lane: lane as u8,
            axis: self.lines.axis as u8,
            local,
            jump,
        });
    }

    /// A line among reflecting surfaces, for one lane of the packet.
    fn surfaces(
        &mut self,
        triangles: &[u32; LANES],
        depth: u32,
        stream: &Stream,
        index: &[u32; LANES],
    ) {
        let active = self.rays.active;
        let lanes = active.count_ones();
        let choice = |salt: u32| {
            stream.uniform(AXIS + (index[0].wrapping_mul(8).wrapping_add(depth)) * 16 + salt)
        };
        let chosen = ((choice(1) * lanes as f32) as u32).min(lanes.max(1) - 1);
        let Some(lane) = (0..LANES)
            .filter(|&l| active >> l & 1 == 1)
            .nth(chosen as usize)
        else {
            return;
        };
        let point = SurfacePoint::of_lane(self.surface, self.triangle, lane);
        let origin = point.x.as_dvec3();
        let points: [(DVec3, u32); INNER_POINTS + 3] = std::array::from_fn(|i| {
            let d = lane_of(self.lines.directions(i), lane).as_dvec3();
            if i == self.lines.bounce[lane] {
                return (d, triangles[lane]);
            }
            self.counts.bounce_cell += 1;
            (
                d,
                point.first_hit(self.tracer, d, f32::INFINITY, &mut Counts::default()),
            )
        });
        let mut found: Vec<Found> = Vec::new();
        let mut silhouettes: Vec<f64> = Vec::new();
        let mut all_found = true;
        for (i, pair) in points.windows(2).enumerate() {
            let arc = Arc {
                origin,
                a: pair[0].0,
                b: pair[1].0,
            };
            let choice = choice(2 + i as u32) as f64;
            match between(
                self.tracer.geometry,
                self.adjacency,
                &arc,
                [pair[0].1, pair[1].1],
                choice,
                2.0 * PROBE,
            ) {
                Ok([silhouette, ridge]) => {
                    for (crossing, is_silhouette) in [(silhouette, true), (ridge, false)] {
                        let Some(Crossing { boundary, s, count }) = crossing else {
                            continue;
                        };
                        let psi = self.lines.psi_of(lane, arc.direction(s));
                        if is_silhouette {
                            silhouettes.push(psi);
                        }
                        found.push(Found {
                            boundary,
                            arc,
                            s,
                            psi,
                            is_silhouette,
                            weight: count as f64,
                        });
                    }
                }
                Err(Unresolved) => {
                    self.counts.unresolved += 1;
                    all_found = false;
                }
            }
        }
        if all_found {
            let weights = run_weights(&silhouettes);
            for found in &mut found {
                let run = silhouettes.partition_point(|&p| p < found.psi);
                found.weight *= if found.is_silhouette {
                    weights[run].max(weights[run + 1])
                } else {
                    weights[run]
                };
            }
        }
        // Look on both sides of each silhouette: the jump is taken where it is, not at the ends of the cell.
        for (number, group) in found.chunks(LANES / 2).enumerate() {
            let mut directions = [Vec3::Z; LANES];
            let mut packet = 0;
            for (i, Found { arc, s, .. }) in group.iter().enumerate() {
                for (k, side) in [-PROBE, PROBE].into_iter().enumerate() {
                    directions[2 * i + k] = arc.direction(s + side).normalize().as_vec3();
                    packet |= 1 << (2 * i + k);
                }
            }
            let directions = from_lanes(&directions);
            let geometric = from_lanes(&[point.geometric; LANES]);
            let origin = leave(from_lanes(&[point.x; LANES]), geometric, directions);
            let rays = RayPacket {
                active: packet,
                origin,
                direction: directions,
                near: 0.0,
                far: f32::INFINITY,
            };
            // Both sides share their random numbers.
            let index = std::array::from_fn(|l| {
                PROBE_INDEX + index[0] * 4 + (number * LANES / 2 + l / 2) as u32
            });
            let radiance = self
                .tracer
                .radiance_along(rays, depth, stream, &index, self.counts);
            for (i, found) in group.iter().enumerate() {
                let [before, after] = [2 * i, 2 * i + 1].map(|l| lane_of(radiance, l));
                let weight = FAMILIES * lanes as f32 * found.weight as f32;
                let jump = ((before - after) * weight).to_array();
                if jump.iter().all(|j| j.is_finite()) {
                    let direction = found.arc.direction(found.s).normalize();
                    self.push(lane, found.boundary, direction, jump);
                } else {
                    self.counts.not_finite += 1;
                }
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
        let scale =
            -along[self.axis as usize] / norm * 2.0 * cos2_psi * std::f64::consts::FRAC_1_PI;
        let survival = vertices.survival;
        let colour = lane_of(
            vertices.throughput.times(vertices.reflectance) * survival,
            lane,
        )
        .to_array();
        Some(std::array::from_fn(|i| {
            scale * (colour[i] * self.jump[i]) as f64
        }))
    }
}
