//! Which lane of a packet looks.
//!
//! As a point moves past an edge at the distance r, the direction to it turns by one over r: under
//! the rim of a lamp that hangs close to a ceiling a thousand times as fast as elsewhere. Where one
//! lane looks for all, it is mostly not the one that is there, and what is found there stands for
//! all lanes. So a lane looks with a chance that grows with how near it is to other things, as
//! boxes around meshes tell.

use crate::lanes::{LANES, Lane, Real, V3};
use crate::trace::geometry::Geometry;
use glam::Vec3;

/// So many meshes are looked at, the largest.
const MOST_BOXES: usize = 32;
/// Of a box's diagonal: what is nearer lies on it.
const ON_IT: f32 = 1e-4;
/// The part of all chances that does not depend on nearness.
const EVEN: f32 = 0.75;

/// Boxes around meshes.
pub struct Surroundings {
    boxes: Vec<[Vec3; 2]>,
}

impl Surroundings {
    pub fn new(geometry: &Geometry) -> Self {
        let around = |mesh: &[u32]| {
            let vertices = &geometry.positions[mesh[0] as usize..mesh[1] as usize];
            let low = vertices.iter().copied().reduce(Vec3::min)?;
            let high = vertices.iter().copied().reduce(Vec3::max)?;
            Some([low, high])
        };
        let meshes = geometry.first_vertex.windows(2);
        let mut boxes: Vec<[Vec3; 2]> = meshes.filter_map(around).collect();
        boxes.sort_by(|a, b| diagonal(b).total_cmp(&diagonal(a)));
        boxes.truncate(MOST_BOXES);
        Self { boxes }
    }

    /// The one of these lanes, which are at `x`, that looks, drawn by a uniform number; and as how
    /// many it counts. `None` if there are none.
    pub fn draw(&self, x: V3<Lane>, lanes: u32, number: f32) -> Option<(usize, f64)> {
        // By rounding all chances may sum up to less than the number.
        let last = lanes.checked_ilog2()? as usize;
        let chances = self.chances(x, lanes);
        let mut below = 0.0;
        let is_beyond = |&lane: &usize| {
            below += chances[lane];
            below > number
        };
        let lane = (0..last).find(is_beyond).unwrap_or(last);
        Some((lane, f64::from(chances[lane]).recip()))
    }

    /// The chance of each; they sum up to one.
    fn chances(&self, x: V3<Lane>, lanes: u32) -> [f32; LANES] {
        let zero = Lane::splat(0.0);
        let mut nearest = Lane::splat(f32::MAX);
        for around in &self.boxes {
            let [low, high] = around.map(|p| [p.x, p.y, p.z].map(Lane::splat));
            let outside = |x: Lane, axis: usize| (low[axis] - x).max(x - high[axis]).max(zero);
            let to = V3::new(outside(x.x, 0), outside(x.y, 1), outside(x.z, 2));
            let squared = to.dot(to);
            let least = (ON_IT * diagonal(around)).powi(2);
            let is_near = Real::gt(squared, Lane::splat(least)) & Real::lt(squared, nearest);
            nearest = <Lane as Real>::select(is_near, squared, nearest);
        }
        let nearness = nearest.to_array().map(|squared| squared.sqrt().recip());
        let is_one = |&lane: &usize| lanes >> lane & 1 == 1;
        let sum: f32 = (0..LANES).filter(is_one).map(|l| nearness[l]).sum();
        let even = 1.0 / lanes.count_ones() as f32;
        let chance = |lane: usize| EVEN * even + (1.0 - EVEN) * nearness[lane] / sum;
        std::array::from_fn(|lane| if is_one(&lane) { chance(lane) } else { 0.0 })
    }
}

fn diagonal([low, high]: &[Vec3; 2]) -> f32 {
    low.distance(*high)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lanes one after another farther from a plate, all of them on a floor.
    #[test]
    fn who_is_near_looks() {
        let boxes = vec![
            [Vec3::new(-9.0, -9.0, 0.0), Vec3::new(9.0, 9.0, 0.0)],
            [Vec3::new(-1.0, -1.0, 0.0), Vec3::new(0.0, 1.0, 0.1)],
        ];
        let surroundings = Surroundings { boxes };
        let x = std::array::from_fn(|lane| 0.01 * (1.0 + lane as f32).powi(2));
        let x = V3::new(Lane::new(x), Lane::splat(0.5), Lane::splat(0.0));
        let lanes = !0b10 & (u32::MAX >> (32 - LANES));
        let chances = surroundings.chances(x, lanes);
        assert!(
            (chances.iter().sum::<f32>() - 1.0).abs() < 1e-6,
            "{chances:?}"
        );
        assert_eq!(chances[1], 0.0);
        let others = lanes.count_ones() as f32;
        assert!(
            chances
                .iter()
                .enumerate()
                .all(|(l, &c)| l == 1 || c >= EVEN / others)
        );
        // One over the distances, beside the even part.
        let nearness = |lane: usize| chances[lane] - EVEN / others;
        assert!(
            (nearness(0) / nearness(2) - 9.0).abs() < 1e-3,
            "{chances:?}"
        );
    }

    /// In the mean over numbers every lane counts once.
    #[test]
    fn all_count_once() {
        let boxes = vec![[Vec3::new(-1.0, -1.0, 0.0), Vec3::new(0.0, 1.0, 0.1)]];
        let surroundings = Surroundings { boxes };
        let x = std::array::from_fn(|lane| 0.01 * (1.0 + lane as f32).powi(2));
        let x = V3::new(Lane::new(x), Lane::splat(0.5), Lane::splat(0.0));
        let lanes = !0b10 & (u32::MAX >> (32 - LANES));
        let many = 100_000;
        let mut counts = [0.0; LANES];
        for i in 0..many {
            let number = (i as f32 + 0.5) / many as f32;
            let (lane, weight) = surroundings.draw(x, lanes, number).unwrap();
            counts[lane] += weight / f64::from(many);
        }
        for (lane, count) in counts.into_iter().enumerate() {
            let expected = f64::from(lanes >> lane & 1);
            assert!((count - expected).abs() < 1e-2, "{lane}: {counts:?}");
        }
        assert_eq!(surroundings.draw(x, 0, 0.5), None);
    }

    /// Where nothing is outside of which a point lies, all look alike.
    #[test]
    fn alone_all_look_alike() {
        let surroundings = Surroundings { boxes: Vec::new() };
        let chances = surroundings.chances(V3::splat(0.0), 0b111);
        let third = |c: &f32| (c - 1.0 / 3.0).abs() < 1e-6;
        assert!(chances[..3].iter().all(third), "{chances:?}");
    }
}
