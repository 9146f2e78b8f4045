//! Whether a mesh passes through itself.

use super::weld::Weld;
use glam::{DVec3, Vec3};
use std::collections::{BTreeSet, HashMap};

/// Meshes of more triangles are not looked at: the look is for a warning only.
const MOST_TRIANGLES: usize = 200_000;
/// Entries of the grid.
const MOST_CELLS: f64 = 2e7;

/// How many pairs of triangles that share no point cross each other; none if there are too many to
/// look at.
pub fn count(positions: &[Vec3], triangles: &[[u32; 3]]) -> Option<usize> {
    if triangles.len() > MOST_TRIANGLES {
        return None;
    }
    let weld = Weld::new(positions);
    let corners = |t: usize| triangles[t].map(|i| positions[i as usize].as_dvec3());
    let places = |t: usize| triangles[t].map(|i| weld.place[i as usize]);
    let mut crossing = 0;
    let mut looked: BTreeSet<(usize, usize)> = BTreeSet::new();
    for inside in cells(triangles.len(), corners)?.into_values() {
        for (n, &a) in inside.iter().enumerate() {
            for &b in &inside[n + 1..] {
                let shares = places(a).iter().any(|p| places(b).contains(p));
                if !shares && looked.insert((a, b)) && cross(corners(a), corners(b)) {
                    crossing += 1;
                }
            }
        }
    }
    Some(crossing)
}

/// Triangles by the cells of a grid that their boxes reach, each list in order.
fn cells(
    count: usize,
    corners: impl Fn(usize) -> [DVec3; 3],
) -> Option<HashMap<[i64; 3], Vec<usize>>> {
    let boxed = |t: usize| {
        let [a, b, c] = corners(t);
        (a.min(b).min(c), a.max(b).max(c))
    };
    let sides = (0..count).map(|t| {
        let (low, high) = boxed(t);
        (high - low).max_element()
    });
    let side = (2.0 * sides.sum::<f64>() / count.max(1) as f64).max(1e-12);
    let mut cells: HashMap<[i64; 3], Vec<usize>> = HashMap::new();
    let mut reached = 0.0;
    for t in 0..count {
        let (low, high) = boxed(t);
        // A few huge triangles among many tiny ones would fill the whole grid.
        reached += ((high - low) / side + DVec3::ONE).element_product();
        if reached > MOST_CELLS {
            return None;
        }
        let [low, high] = [low, high].map(|p| (p / side).floor().as_i64vec3());
        for x in low.x..=high.x {
            for y in low.y..=high.y {
                for z in low.z..=high.z {
                    cells.entry([x, y, z]).or_default().push(t);
                }
            }
        }
    }
    Some(cells)
}

/// Whether an edge of one goes through the other. Those in one plane do not count.
fn cross(a: [DVec3; 3], b: [DVec3; 3]) -> bool {
    let goes_through = |from: [DVec3; 3], through: [DVec3; 3]| {
        (0..3).any(|i| pierces(from[i], from[(i + 1) % 3], through))
    };
    goes_through(a, b) || goes_through(b, a)
}

/// Whether a segment goes through a triangle, by the signs of volumes.
fn pierces(p: DVec3, q: DVec3, [a, b, c]: [DVec3; 3]) -> bool {
    let volume = |a: DVec3, b: DVec3, c: DVec3, d: DVec3| (b - a).cross(c - a).dot(d - a);
    let (above, below) = (volume(a, b, c, p), volume(a, b, c, q));
    if above * below >= 0.0 {
        return false;
    }
    let sides = [volume(p, q, a, b), volume(p, q, b, c), volume(p, q, c, a)];
    sides.iter().all(|s| *s > 0.0) || sides.iter().all(|s| *s < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn triangles_that_cross_are_counted_once() {
        let flat = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let through = |z: f32| {
            [
                Vec3::new(0.2, 0.2, z),
                Vec3::new(0.3, 0.2, z),
                Vec3::new(0.2, 0.2, z + 1.0),
            ]
        };
        let of = |second: [Vec3; 3]| {
            let points: Vec<Vec3> = flat.into_iter().chain(second).collect();
            count(&points, &[[0, 1, 2], [3, 4, 5]]).unwrap()
        };
        assert_eq!(of(through(-0.5)), 1);
        assert_eq!(of(through(0.5)), 0);
        // Neighbours share a point and do not count.
        let points = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE];
        assert_eq!(count(&points, &[[0, 1, 2], [1, 3, 2]]), Some(0));
    }
}
