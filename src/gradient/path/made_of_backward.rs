//! What surfaces are made of, backwards: from slots and fractions to texels.

use super::backward::{BackwardSweep, Solved};
use super::bars::VertexBars;
use crate::gradient::scene::backward::TileSums;
use crate::lanes::{LANES, Lane};
use crate::paths::surface::interface::slot_values;
use crate::paths::surface::layers::numbers;
use crate::paths::surface::materials::SLOTS;
use glam::Vec3;

impl BackwardSweep<'_> {
    /// From what surfaces are made of to texels, and to where on the surface that is.
    pub(super) fn slots(&self, here: &Solved, bars: &mut VertexBars, sums: &mut TileSums) {
        let view = self.view;
        let is_textured = view.materials.any_texture && self.wanted.attached();
        if !self.wanted.colours() && !is_textured {
            return;
        }
        let vertices = here.vertices;
        let (b1, b2) = (here.b[0].to_array(), here.b[1].to_array());
        let mut b_bar = bars.b.map(Lane::to_array);
        let lanes = vertices.hit & !vertices.kinds.black;
        for lane in (0..LANES).filter(|&l| lanes >> l & 1 == 1) {
            let slot_bars = slot_values(&bars.interface, lane);
            let layer_bars = bars.layers.as_ref().map(|l| numbers(l.as_ref()));
            view.for_each_slot(vertices, lane, [b1[lane], b2[lane]], |s| {
                let bar = match (s.slot < SLOTS, &layer_bars) {
                    (true, _) => slot_bars[s.slot],
                    (false, Some(bars)) => Vec3::X * bars[s.slot - SLOTS].to_array()[lane],
                    (false, None) => Vec3::ZERO,
                };
                sums.add_texture(self.wanted, s.texture, &s.lookup, bar);
                for (sum, by) in b_bar.iter_mut().zip(s.by_barycentric) {
                    sum[lane] += by.dot(bar);
                }
            });
        }
        bars.b = b_bar.map(Lane::new);
    }

    /// From the path's weight after the choice among materials to that before, and to what says how
    /// likely each is.
    pub(super) fn choice(&self, here: &Solved, bars: &mut VertexBars, sums: &mut TileSums) {
        let vertices = here.vertices;
        let Some(choice) = &vertices.choice else {
            bars.arriving = bars.arriving + bars.throughput;
            return;
        };
        let factors = self.view.choice_factors(vertices, choice, here.b);
        bars.arriving = bars.arriving + bars.throughput * factors;
        let factor_bar = bars.throughput.dot(choice.arriving).to_array();
        let mut b_bar = bars.b.map(Lane::to_array);
        self.view.for_each_choice(vertices, choice, here.b, |s| {
            let bar = Vec3::X * (factor_bar[s.lane] * s.slope);
            sums.add_texture(self.wanted, s.texture, &s.lookup, bar);
            for (sum, by) in b_bar.iter_mut().zip(s.by_barycentric) {
                sum[s.lane] += by.dot(bar);
            }
        });
        bars.b = b_bar.map(Lane::new);
    }
}
