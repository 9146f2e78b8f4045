//! Which vertices look for borders.
//!
//! A line is as dear for a vertex that brings little as for one that brings much. So later vertices
//! look as often as they are bright, and what they find stands for more.

use crate::lanes::LANES;
use crate::paths::at::At;
use crate::paths::boundary_sample::BoundarySample;
use crate::paths::dimensions::Single;
use crate::paths::rays::lane_of;

/// No vertex looks less often.
const LEAST_CHANCE: f32 = 0.1;

/// Where borders are looked for, each with numbers of its own.
#[derive(Clone, Copy)]
pub enum Over {
    Lights,
    EnvironmentMap,
    EvenEnvironment,
}

/// The lanes that look.
pub struct Bright {
    pub lanes: u32,
    chance: [f32; LANES],
}

impl Bright {
    /// Of these lanes.
    pub fn new(at: &At, over: Over, lanes: u32) -> Self {
        let chance: [f32; LANES] = std::array::from_fn(|lane| {
            let arrives = lane_of(at.vertices.throughput, lane).max_element();
            arrives.clamp(LEAST_CHANCE, 1.0)
        });
        let numbers = &at.numbers;
        let looks = |lane: usize| {
            let name = [numbers.index[lane], numbers.depth, over as u32];
            chance[lane] >= 1.0 || numbers.stream.single(Single::Looks, name) < chance[lane]
        };
        let lanes = (0..LANES)
            .filter(|&lane| lanes >> lane & 1 == 1 && looks(lane))
            .fold(0, |bits, lane| bits | 1 << lane);
        Self { lanes, chance }
    }

    /// Has what was found stand for what was not looked for.
    pub fn weigh(&self, found: &mut [BoundarySample]) {
        for sample in found {
            let chance = self.chance[sample.lane as usize];
            sample.weight = sample.weight.map(|w| w / chance);
        }
    }
}
