//! What a surface sees: where the radiance jumps over the hemisphere above a vertex, or below it
//! where it refracts.
//!
//! The narrow kernels and spherical convolutions of Loubet et al. (2019) exist because their
//! rotations need a small support. A cell needs none: as on the film and on the lights, the
//! hemisphere is cut along lines (`boundary::cells::lobe::line`), whose points are the ends of
//! cells.

use super::line::{LaneSurface, Line};
use crate::boundary::cells::chain::follow::normal_through;
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::boundary::Boundary;
use crate::lanes::LANES;
use crate::paths::at::At;
use crate::paths::bounce::Bounce;
use crate::paths::boundary_sample::{BoundarySample, Coordinate, Found, Shadow};
use crate::paths::chain_vertex::ChainVertex;
use crate::paths::moving::Sector;
use crate::paths::rays::lane_of;
use glam::DVec3;

/// There are two families and one is drawn.
pub const FAMILIES: f64 = 2.0;

/// Looks on the lines of one packet's vertices.
pub struct LobeSearch<'a> {
    pub scene: &'a SearchScene<'a>,
    pub at: &'a At<'a>,
    pub bounce: &'a Bounce<'a>,
    /// The lanes that look.
    pub lanes: u32,
    /// The family of lines that was drawn.
    pub axis: usize,
    pub jitter: [f32; LANES],
    /// Whether no light samples are taken where the bounces lead.
    pub at_last: bool,
    pub out: &'a mut Found,
}

/// What jumps in a direction: a boundary that is seen there, or through a chain of smooth surfaces,
/// or that of a shadow on what is seen.
#[derive(Clone, Copy)]
pub struct Border<'a> {
    pub boundary: Boundary,
    /// The triangles on its two sides, where it is seen directly.
    pub beside: Option<[u32; 2]>,
    pub shadow: Option<Shadow>,
    pub chain: &'a [ChainVertex],
}

impl Border<'_> {
    /// One that is seen.
    pub fn seen(boundary: Boundary, beside: Option<[u32; 2]>) -> Self {
        Self {
            boundary,
            beside,
            shadow: None,
            chain: &[],
        }
    }
}

impl LobeSearch<'_> {
    /// Whether what a line sees may lie in a delta light's shadow that moves.
    pub fn has_sharp_shadows(&self) -> bool {
        let lights = &self.scene.view.delta_lights;
        !self.at_last && !lights.is_empty() && self.scene.moving.anything()
    }

    /// Whether something may be found on a line that moves as seen by its lane.
    pub fn moves(&self, lane: usize, line: &Line, at: &LaneSurface) -> bool {
        let x = lane_of(self.at.surface.x, lane).as_dvec3();
        self.sector_moves(lane, || line.sector(x, at))
    }

    /// The same of a line in a sector.
    pub fn sector_moves(&self, lane: usize, sector: impl FnOnce() -> Sector) -> bool {
        if self.at.vertices.moves >> lane & 1 == 1 {
            return true;
        }
        let sector = sector();
        let drifts = self.at.vertices.drifts >> lane & 1 == 1;
        let drift = self.scene.lobe_drift.filter(|_| drifts);
        self.scene.moving.meets(&sector) || drift.is_some_and(|drift| drift.meets(&sector))
    }

    /// Whether all that a lane sees over its lobe moves, or directions do.
    pub fn lane_moves(&self, lane: usize) -> bool {
        let vertices = self.at.vertices;
        (vertices.moves | vertices.drifts) >> lane & 1 == 1
    }

    /// Keeps what jumps by `jump` in a direction on a line, seen through a chain if there is one,
    /// so many times.
    pub fn push(
        &mut self,
        at: &mut LaneSurface,
        line: &Line,
        Border {
            boundary,
            beside,
            shadow,
            chain,
        }: Border,
        direction: DVec3,
        (jump, times): (DVec3, f64),
    ) {
        let (lane, vertices) = (at.lane(), self.at.vertices);
        let geometry = self.scene.view.geometry;
        let x = vertices.position(geometry, lane);
        // The borders of what lines mostly miss cancel, if they move alike.
        let is_seen = chain.is_empty() && shadow.is_none();
        let boundary = if is_seen && self.scene.is_small(&boundary, x) {
            line.family.of_point(boundary, geometry, x, direction)
        } else {
            beside.map_or(boundary, |beside| boundary.standing(geometry, beside))
        };
        let c = normal_through(self.scene.view, chain, (&boundary, shadow), x, direction);
        let (Some((local, value, density)), Some(weight)) = (
            at.value(direction),
            line.family.weight(&boundary, c, direction),
        ) else {
            return;
        };
        let weight = weight * line.inverse_density * density * times;
        let chance = vertices.lobe_chance.to_array()[lane] as f64;
        let survival = vertices.line_survival.to_array()[lane] as f64;
        let throughput = lane_of(vertices.throughput, lane).as_dvec3();
        let jump = throughput * jump / chance;
        let radiance = value * jump * (weight * survival);
        if !radiance.is_finite() {
            self.out.counts.boundary_not_finite += 1;
            return;
        }
        let chain = self.out.add_chain(chain);
        self.out.samples.push(BoundarySample {
            boundary,
            shadow,
            lane: lane as u8,
            at: Coordinate::Lobe(local.to_array()),
            chain,
            weight: radiance.as_vec3().to_array(),
            jump: (at.weight_of_path(local, value) * jump).length() as f32,
        });
    }
}
