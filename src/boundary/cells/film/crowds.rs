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
//! their next neighbours do not see the same surfaces. If what ends there is parallel to it nothing
//! is said: the borders of a hair have the same shortest velocity anyhow, and their points may
//! slide along it.

use super::cell::LatticeCells;
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::arc::Arc;
use crate::discontinuity::between::between;
use crate::discontinuity::boundary::dvec3;
use crate::lanes::LANES;
use crate::paths::counts::Counts;
use crate::paths::dimensions::Single;
use crate::trace::Coherence;
use glam::{DVec2, DVec3};
use std::collections::BTreeMap;

/// Pixels along a side of a block, for all of which one decision is made.
const BLOCK: f64 = 4.0;
/// The pilot's lines through a block.
const LINES: u32 = 8;
/// The most, until one of them meets a border that tells.
const MOST_LINES: u32 = 96;
/// So many parallel borders are those of hairs.
const MANY_PARALLEL: usize = 8;
/// A block is crowded if more than one in this many of its borders is unresolved.
const CROWD: usize = 2;

/// Borders that the pilot has met.
#[derive(Default)]
struct Met {
    resolved: usize,
    unresolved: usize,
    /// Unresolved, but parallel to their neighbours.
    parallel: usize,
}

/// The blocks about which a tile has asked. Others that see through the same point of the lens have
/// the same answers: blocks lie alike for all tiles, and so do the pilot's lines.
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
        let [start, _] = self.cells.film.tile.film;
        let block = [0, 1].map(|i| ((at[i] - f64::from(start[i])) / BLOCK).floor() as i32);
        if let Some(&known) = self.known.get(&block) {
            return known;
        }
        let crowded = self.is_crowded(block, counts);
        self.known.insert(block, crowded);
        crowded
    }

    /// How far a straight way of less than a block goes on before it comes to a crowd, in parts of
    /// the way; infinite if it does not.
    pub fn free_way(&mut self, at: [f64; 2], way: [f64; 2], counts: &mut Counts) -> f64 {
        let [start, _] = self.cells.film.tile.film;
        let mut borders = [0, 1].map(|i| {
            if way[i] == 0.0 {
                return f64::INFINITY;
            }
            let blocks = (at[i] - f64::from(start[i])) / BLOCK;
            let next = match way[i] > 0.0 {
                true => blocks.floor() + 1.0,
                false => blocks.ceil() - 1.0,
            };
            (next - blocks) * BLOCK / way[i]
        });
        borders.sort_by(f64::total_cmp);
        for border in borders.into_iter().filter(|border| *border < 1.0) {
            let beyond = border + 1e-6;
            let place = [0, 1].map(|i| at[i] + beyond * way[i]);
            if self.contain(place, counts) {
                return border;
            }
        }
        f64::INFINITY
    }

    fn is_crowded(&self, block: [i32; 2], counts: &mut Counts) -> bool {
        let mut met = Met::default();
        for line in 0..MOST_LINES {
            let tells = met.resolved + met.unresolved > 0 || met.parallel >= MANY_PARALLEL;
            if line >= LINES && tells {
                break;
            }
            self.look(block, line, &mut met, counts);
        }
        CROWD * met.unresolved > met.resolved + met.unresolved
    }

    /// Counts the borders on a line through a block.
    fn look(&self, block: [i32; 2], line: u32, met: &mut Met, counts: &mut Counts) {
        let (view, tile) = (self.cells.scene.view, self.cells.film.tile);
        let camera = &view.camera;
        let axis = (line % 2) as usize;
        let mut place = [0, 1].map(|i| {
            // Blocks beyond the film's start have negative numbers.
            let number = (block[1] + 1) << 16 | (block[0] + 1);
            let name = [number as u32, line, i as u32];
            let random = f64::from(tile.whole.single(Single::CrowdLine, name));
            f64::from(tile.film[0][i]) + (f64::from(block[i]) + random) * BLOCK
        });
        place[axis] -= 0.5 * (LANES - 1) as f64 * tile.step[axis];
        let directions: [_; LANES] = std::array::from_fn(|ray| {
            let mut at = place;
            at[axis] += ray as f64 * tile.step[axis];
            dvec3(camera.direction(at[0], at[1]))
        });
        let rays = camera.rays_along(&directions, u32::MAX >> (32 - LANES));
        counts.probe += LANES as u64;
        let seen = view.intersect(&rays, Coherence::Coherent);
        // Of each interval: `None` if one surface is seen on both sides.
        let borders: [Option<Normal>; LANES - 1] = std::array::from_fn(|i| {
            let ends = [directions[i], directions[i + 1]];
            self.border(ends, [seen[i], seen[i + 1]])
        });
        for i in 1..LANES - 2 {
            let Some(normal) = borders[i] else { continue };
            let mut beside = [borders[i - 1], borders[i + 1]].into_iter().flatten();
            if [borders[i - 1], borders[i + 1]] == [None; 2] {
                met.resolved += 1;
            } else if beside.all(|n| is_parallel(normal, n)) {
                met.parallel += 1;
            } else {
                met.unresolved += 1;
            }
        }
    }

    /// What lies between two directions in which these triangles are seen, if they are not of one
    /// surface.
    fn border(&self, [a, b]: [DVec3; 2], seen: [u32; 2]) -> Option<Normal> {
        let SearchScene {
            view, adjacency, ..
        } = *self.cells.scene;
        if seen[0] == seen[1] {
            return None;
        }
        let origin = view.camera.eye();
        let arc = Arc { origin, a, b };
        match between(view.geometry, adjacency, &arc, seen, None, 0.0) {
            Ok([None, _]) => None,
            Ok([Some(crossing), _]) => {
                let c = crossing.boundary.normal(view.geometry, origin);
                let normal = view.camera.direction_per_pixel().map(|d| c.dot(d));
                Some(DVec2::from(normal).try_normalize())
            }
            Err(_) => Some(None),
        }
    }
}

/// Of a border on the film, if it was found.
type Normal = Option<DVec2>;

/// The shortest velocities of borders that are less than some ten degrees from parallel are alike.
const PARALLEL: f64 = 0.2;

fn is_parallel(a: Normal, b: Normal) -> bool {
    matches!((a, b), (Some(a), Some(b)) if a.perp_dot(b).abs() < PARALLEL)
}
