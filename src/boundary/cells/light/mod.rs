//! What hides a light, in the light's own coordinates.

mod lamp;
mod line;
mod patch;

use super::bright::{Bright, Over};
use crate::boundary::search_scene::SearchScene;
use crate::lanes::LANES;
use crate::paths::at::At;
use crate::paths::boundary_sample::Found;
use crate::paths::estimator::LightDraw;
use line::lamp_of;

/// Finds what hides the lights of which a packet's lanes have drawn samples.
pub fn find(scene: &SearchScene, at: &At, draw: &LightDraw, out: &mut Found) {
    let (view, vertices) = (at.view, at.vertices);
    let lit = vertices.hit & vertices.kinds.lit_by_samples() & !view.reflects_nothing(vertices);
    let bright = Bright::new(at, Over::Lights, lit);
    let lanes = bright.lanes;
    let first = out.samples.len();
    let sees_lamp = |lane: &usize| lanes >> lane & 1 == 1 && lamp_of(at, draw, *lane).is_some();
    let lamps = (0..LANES)
        .filter(sees_lamp)
        .fold(0, |bits, l| bits | 1 << l);
    patch::find(scene, at, draw, lanes & !lamps, out);
    lamp::find(scene, at, draw, lamps, out);
    bright.weigh(&mut out.samples[first..]);
}
