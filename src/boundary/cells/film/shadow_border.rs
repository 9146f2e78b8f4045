//! Where a delta light's shadow ends on the film, and what that brings.

use super::cell::{LatticeCells, LatticeLine};
use crate::boundary::cells::chain::follow::normal_through;
use crate::boundary::cells::delta::follow::Rays;
use crate::boundary::cells::delta::value::brought;
use crate::boundary::cells::line_search::Cell;
use crate::discontinuity::boundary::{Boundary, velocity_per_side};
use crate::lanes::LANES;
use crate::paths::boundary_sample::{BoundarySample, Coordinate, Found, NO_CHAIN, Piece, Shadow};
use crate::paths::counts::Counts;
use glam::DVec3;

/// Shadows are taken to be met with this chance at least: it bounds the weight of their ends.
pub const SMALLEST_CHANCE: f64 = 1e-3;

/// How far beside a border the light is looked at, in pixels.
const BESIDE_PIXELS: f64 = 1e-3;

/// The border of a shadow, or of a beam.
pub struct Border {
    pub boundary: Boundary,
    pub shadow: Shadow,
    /// Whether the edge that throws the shadow is the receiver's own.
    pub is_own: bool,
    pub axis: usize,
    pub at: [f64; 2],
    /// On which side of it the light is looked at, ±1 along the line, where it has no value on the
    /// border itself; else 0.
    pub lit_side: f64,
    /// What the light's radiance is multiplied with: +1 if it is hidden beyond, −1 if before, over
    /// the chance of finding it.
    pub jump: f64,
}

/// Keeps the borders at which the radiance jumps.
pub fn add(cells: &LatticeCells, borders: &[Border], out: &mut Found) {
    for group in borders.chunks(LANES) {
        let jumps = jumps(cells, group, &mut out.counts);
        for (border, jump) in group.iter().zip(jumps) {
            if !jump.is_finite() {
                out.counts.boundary_not_finite += 1;
            } else if jump != DVec3::ZERO {
                out.samples.extend(sample(cells, border, jump));
            }
        }
    }
}

/// The rays from one point of a line to one beside it.
pub fn between<'a>(
    cells: &LatticeCells<'a>,
    line: LatticeLine,
    [from, to]: [i64; 2],
    counts: &mut Counts,
) -> Rays<impl Fn(f64) -> u32 + use<'a>> {
    let cell = cells.cell(line, from.min(to), counts);
    let is_reversed = to < from;
    let (mut arc, mut seen) = (cell.arc(), cell.triangles());
    if is_reversed {
        arc = arc.reversed();
        seen.reverse();
    }
    Rays {
        arc,
        seen,
        first_hit: move |s: f64| cell.first_hit(if is_reversed { 1.0 - s } else { s }),
    }
}

/// What the radiance jumps by at each of a group of borders.
fn jumps(cells: &LatticeCells, group: &[Border], counts: &mut Counts) -> Vec<DVec3> {
    let mut directions = [DVec3::Z; LANES];
    let [mut receivers, mut lights] = [[0; LANES]; 2];
    for (lane, border) in group.iter().enumerate() {
        let mut at = border.at;
        at[border.axis] += border.lit_side * BESIDE_PIXELS;
        directions[lane] = cells.direction_at(at);
        receivers[lane] = border.shadow.receiver;
        lights[lane] = border.shadow.light;
    }
    let active = u32::MAX >> (32 - group.len());
    let camera = &cells.scene.view.camera;
    let rays = camera.rays_along(&directions, active);
    let brought = brought(cells.scene, &rays, &receivers, &lights, counts);
    let jump = |(border, brought): (&Border, DVec3)| brought * border.jump;
    group.iter().zip(brought).map(jump).collect()
}

/// The jump times the border's speed per unit of Ḟ along the line, over the lines' density.
fn sample(cells: &LatticeCells, border: &Border, jump: DVec3) -> Option<BoundarySample> {
    let &Border {
        boundary,
        shadow,
        is_own,
        axis,
        at,
        ..
    } = border;
    let camera = &cells.scene.view.camera;
    let (origin, d) = (camera.eye(), cells.direction_at(at));
    let c = if is_own {
        boundary.normal(cells.scene.view.geometry, origin)
    } else {
        normal_through(cells.scene.view, &[], (&boundary, Some(shadow)), origin, d)
    };
    let gradient = camera.direction_per_pixel().map(|d| c.dot(d));
    let velocity = velocity_per_side(gradient, [1.0, 0.0, 1.0], axis)?;
    let weight = jump * (velocity * cells.film.tile.step[1 - axis]);
    Some(BoundarySample {
        chain: NO_CHAIN,
        boundary,
        shadow: (!is_own).then_some(shadow),
        lane: 0,
        at: Coordinate::Film {
            at,
            piece: Piece::POINT,
        },
        weight: weight.as_vec3().to_array(),
        jump: (jump.length() / border.jump.abs()) as f32,
    })
}
