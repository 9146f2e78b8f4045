//! A direction that bends a mesh: every vertex has its own velocity, and neighbours nearly the
//! same, so that no triangle degenerates and nothing of the motion is rigid.

use crate::chance::between;
use crate::mesh::{Mesh, Point};
use std::error::Error;
use std::path::Path;
use warpath::output::npy;

const BUMPS: u64 = 6;
/// Of a bump, in half diagonals of the mesh's bounding box.
const WIDTH: f64 = 0.3;

/// Writes the velocities as a direction for `MESH.vertex_positions`, about one at their largest.
pub fn write(path: &Path, mesh: &Mesh) -> Result<(), Box<dyn Error>> {
    let [low, high] = bounds(mesh);
    let half: Point = std::array::from_fn(|c| 0.5 * (high[c] - low[c]));
    let width = WIDTH * half.iter().map(|x| x * x).sum::<f64>().sqrt();
    let bumps: Vec<(Point, Point)> = (0..BUMPS)
        .map(|k| {
            let random = |property: u64| between(-1.0, 1.0, k, property);
            let centre =
                std::array::from_fn(|c| 0.5 * (low[c] + high[c]) + half[c] * random(30 + c as u64));
            (centre, std::array::from_fn(|c| random(33 + c as u64)))
        })
        .collect();
    let velocity = |point: &Point| {
        bumps.iter().fold([0.0; 3], |sum: Point, (centre, push)| {
            let square: f64 = (0..3).map(|c| (point[c] - centre[c]).powi(2)).sum();
            let share = (-0.5 * square / (width * width)).exp();
            std::array::from_fn(|c| sum[c] + share * push[c])
        })
    };
    let values = mesh.points.iter().flat_map(velocity).map(|x| x as f32);
    Ok(npy::write(path, &[mesh.points.len(), 3], values)?)
}

fn bounds(mesh: &Mesh) -> [Point; 2] {
    let first = [[f64::INFINITY; 3], [f64::NEG_INFINITY; 3]];
    mesh.points.iter().fold(first, |[low, high], p| {
        [
            std::array::from_fn(|c| low[c].min(p[c])),
            std::array::from_fn(|c| high[c].max(p[c])),
        ]
    })
}
