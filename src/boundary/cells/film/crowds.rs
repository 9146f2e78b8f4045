//! Where on the film silhouettes stand closer than the lattice's points.
//!
//! A border's velocity is known but for its part along the border, which brings nothing in sum over
//! rows and columns. The shortest velocity has the least noise where each border is found with
//! certainty. In a crowd a border is found now and then, together with others, and stands for what
//! is not found: its weight is large. There each point of a border had better move as it does on
//! its surface. The two borders of a thin thing then move alike, what they bring cancels but for
//! what the filter changes by between them, and that is bounded however thin the thing is.
//!
//! Rows and columns have to agree on which velocity a border has, so that this may depend on
//! nothing but the place. It is told by a *pilot*: short lines of rays, as far apart as the
//! lattice's points, of which no sample knows. A border between two of them is *unresolved* if
//! their next neighbours do not see the same surfaces.

use super::cell::LatticeCells;
use crate::discontinuity::boundary::dvec3;
use crate::lanes::LANES;
use crate::paths::counts::Counts;
use crate::paths::dimensions::Single;
use crate::paths::rays::{RayPacket, from_lanes, splat};
use crate::trace::Coherence;
use std::collections::BTreeMap;

/// Pixels along a side of a block, for all of which one decision is made.
const BLOCK: f64 = 4.0;
/// The pilot's lines through a block.
const LINES: u32 = 8;
/// The most, until one of them meets a border.
const MOST_LINES: u32 = 96;
/// A block is crowded if more than one in this many of its borders is unresolved.
const CROWD: usize = 2;

/// The blocks of a tile about which has been asked.
pub struct Crowds<'a> {
    cells: LatticeCells<'a>,
    known: BTreeMap<[i32; 2], bool>,
}

impl<'a> Crowds<'a> {
    pub fn new(cells: LatticeCells<'a>) -> Self {
        Self {
            cells,
            known: BTreeMap::new(),
        }
    }

    /// Whether a film position lies in a crowd.
    pub fn contain(&mut self, at: [f64; 2], counts: &mut Counts) -> bool {
        let start = self.cells.film.tile.start;
        let block = [0, 1].map(|i| ((at[i] - f64::from(start[i])) / BLOCK).floor() as i32);
        if let Some(&known) = self.known.get(&block) {
            return known;
        }
        let crowded = self.is_crowded(block, counts);
        self.known.insert(block, crowded);
        crowded
    }

    fn is_crowded(&self, block: [i32; 2], counts: &mut Counts) -> bool {
        let [mut met, mut unresolved] = [0; 2];
        for line in 0..MOST_LINES {
            if line >= LINES && met > 0 {
                break;
            }
            let [more, of_them] = self.look(block, line, counts);
            met += more;
            unresolved += of_them;
        }
        // What the pilot does not meet at all is small.
        met == 0 || CROWD * unresolved > met
    }

    /// How many borders lie on a line through a block, and how many of them are unresolved.
    fn look(&self, block: [i32; 2], line: u32, counts: &mut Counts) -> [usize; 2] {
        let (view, tile) = (self.cells.scene.view, self.cells.film.tile);
        let camera = &view.camera;
        let axis = (line % 2) as usize;
        let mut place = [0, 1].map(|i| {
            // Blocks beyond the tile's start have negative numbers.
            let number = (block[1] + 1) << 16 | (block[0] + 1);
            let name = [number as u32, line, i as u32];
            let random = f64::from(tile.stream.single(Single::CrowdLine, name));
            f64::from(tile.start[i]) + (f64::from(block[i]) + random) * BLOCK
        });
        place[axis] -= 0.5 * (LANES - 1) as f64 * tile.step[axis];
        let directions: [_; LANES] = std::array::from_fn(|ray| {
            let mut at = place;
            at[axis] += ray as f64 * tile.step[axis];
            dvec3(camera.direction(at[0], at[1]))
        });
        let rays = RayPacket {
            active: u32::MAX >> (32 - LANES),
            origin: splat(camera.origin),
            direction: from_lanes(&directions.map(|d| d.as_vec3())),
            near: camera.near_clip,
            far: camera.far_clip,
        };
        counts.probe += LANES as u64;
        let seen = view.intersect(&rays, Coherence::Coherent);
        let goes_on: [bool; LANES - 1] = std::array::from_fn(|i| {
            self.cells
                .goes_on([directions[i], directions[i + 1]], [seen[i], seen[i + 1]])
        });
        let borders = (1..LANES - 2).filter(|&i| !goes_on[i]);
        let [mut met, mut unresolved] = [0; 2];
        for i in borders {
            met += 1;
            unresolved += (!goes_on[i - 1] || !goes_on[i + 1]) as usize;
        }
        [met, unresolved]
    }
}
