//! What a surface sees: where the radiance jumps over the hemisphere above a vertex, or below it where it refracts.
//!
//! The narrow kernels and spherical convolutions of Loubet et al. (2019) exist because their rotations need
//! a small support. A cell needs none: as on the film and on the lights, the hemisphere is cut along lines
//! (`paths::bounce_lines`), whose points are the ends of cells.

use super::bounce_lines::{LaneSurface, Line};
use super::random::Stream;
use super::rays::{RayPacket, lane_of};
use super::store::{TileStore, Vertices};
use super::surface::Surface;
use super::tracer::{Counts, PAIRS_PER_VERTEX, Tracer};
use crate::lanes::LANES;
use crate::scene::Rgb;
use crate::trace::geometry::NO_TRIANGLE;
use crate::warp::adjacency::Adjacency;
use crate::warp::boundary::Boundary;
use glam::DVec3;

/// A jump of the radiance that arrives at a vertex.
#[derive(Clone, Copy, Debug)]
pub struct BounceCrossing {
    pub boundary: Boundary,
    pub lane: u8,
    /// Whether it hides an environment map, and keeps its place on that.
    pub in_sky: bool,
    /// Coordinate of the crossing in the frame of the shading normal, for the lane's lobe (`kernels::interface`); in the
    /// sky its world direction.
    pub local: [f64; 3],
    /// Radiance of the path per unit of Ḟ, all at θ₀.
    pub radiance_per_side: Rgb,
}

/// What the bounces of a packet ended on.
#[derive(Clone, Copy)]
pub enum Seen<'a> {
    /// At the last vertex only the environment shines: lanes that see it.
    Environment(u32),
    /// Triangles, or none; the paths go on from there.
    Triangles(&'a [u32; LANES]),
}

/// Dimension of a stream from which on families of lines are drawn.
pub(super) const AXIS: u32 = 0x2000_0000;
/// There are two families and one is drawn.
pub(super) const FAMILIES: f64 = 2.0;

/// Finds the crossings on a line for the vertex stored last, whose bounces are `rays`; `depth` is that of the
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
    let Some(vertices) = store.vertices.last() else {
        return;
    };
    // Those that hide an environment map are there already.
    let first = if vertices.bounce_crossings[1] > vertices.bounce_crossings[0] {
        vertices.bounce_crossings[0]
    } else {
        store.bounce_crossings.len() as u32
    };
    let (_, jitter) = stream.pair(index, depth * PAIRS_PER_VERTEX - 1);
    let number = index[0].wrapping_mul(8).wrapping_add(depth);
    let axis = (stream.uniform(AXIS + number) * 2.0) as usize;
    let at_last = depth + 1 >= tracer.limits.max_depth;
    let mut finder = Finder {
        tracer,
        adjacency,
        vertices,
        surface,
        rays,
        axis,
        jitter: jitter.to_array(),
        at_last,
        counts,
        out: &mut store.bounce_crossings,
    };
    let environment = tracer.scene.environment.as_ref();
    let is_even = environment.is_none_or(|e| e.map.is_none()) && vertices.kinds.special() == 0;
    // Where only an even environment shines a line needs no more than occlusion; else every line costs walks over
    // whatever is seen, and one lane stands for all.
    if at_last && is_even {
        if environment.is_some() {
            let free = match seen {
                Seen::Environment(free) => free,
                Seen::Triangles(triangles) => (0..LANES)
                    .filter(|&l| triangles[l] == NO_TRIANGLE)
                    .fold(0, |b, l| b | 1 << l),
            };
            finder.environment(free, depth, stream, index);
        }
    } else {
        finder.surfaces(seen, depth, stream, index);
    }
    let end = store.bounce_crossings.len() as u32;
    if let Some(vertices) = store.vertices.last_mut() {
        vertices.bounce_crossings = [first, end];
    }
}

/// Looks on the lines of one packet's vertices.
pub(super) struct Finder<'a> {
    pub(super) tracer: &'a Tracer<'a>,
    pub(super) adjacency: &'a Adjacency,
    pub(super) vertices: &'a Vertices,
    pub(super) surface: &'a Surface,
    pub(super) rays: &'a RayPacket,
    pub(super) axis: usize,
    pub(super) jitter: [f32; LANES],
    pub(super) at_last: bool,
    pub(super) counts: &'a mut Counts,
    pub(super) out: &'a mut Vec<BounceCrossing>,
}

impl Finder<'_> {
    /// Whether something may be found on a line that moves as seen by its lane.
    pub(super) fn moves(&self, lane: usize, line: &Line, at: &LaneSurface) -> bool {
        let x = lane_of(self.surface.x, lane).as_dvec3();
        self.vertices.moves >> lane & 1 == 1 || self.tracer.moving.meets(&line.sector(x, at))
    }

    pub(super) fn push(
        &mut self,
        at: &mut LaneSurface,
        line: &Line,
        lane: usize,
        boundary: Boundary,
        direction: DVec3,
        jump: DVec3,
    ) {
        let x = self.vertices.position(self.tracer.geometry, lane);
        let c = boundary.normal(self.tracer.geometry, x);
        let (Some((local, value)), Some(weight)) = (
            at.value(self.tracer, direction),
            line.crossing_weight(c, direction),
        ) else {
            return;
        };
        let chance = self.vertices.lobe_chance.to_array()[lane] as f64;
        let survival = self.vertices.line_survival.to_array()[lane] as f64;
        let throughput = lane_of(self.vertices.throughput, lane).as_dvec3();
        let radiance = throughput * value * jump * (weight * survival / chance);
        if !radiance.is_finite() {
            self.counts.boundary_not_finite += 1;
            return;
        }
        self.out.push(BounceCrossing {
            boundary,
            lane: lane as u8,
            in_sky: false,
            local: local.to_array(),
            radiance_per_side: radiance.as_vec3().to_array(),
        });
    }
}
