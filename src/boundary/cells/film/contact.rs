//! Which meshes lie flat upon another, where a node of the film's drift looks.
//!
//! A sheet lies on a table, a picture hangs on a wall. From a point of the table at the distance r
//! from the sheet's edge that edge turns by one over r as the sheet moves, and so does what light
//! it hides. r is as small as the gap between both, and of 1/r the mean square is one over the gap:
//! a few samples in the sheet's contact shadow have nearly all of the noise. If the film follows
//! the sheet the table's points keep their distance from its edge. That costs what an image's noise
//! brings while its filter slides, in proportion to one over a pixel, which is less where the gap
//! is a part of a pixel. A lamp is so bright that its image's noise would be worse.

use crate::boundary::search_scene::SearchScene;
use crate::lanes::LANES;
use crate::paths::film::node_hits::Hit;
use crate::paths::leaving::OFFSET;
use glam::DVec3;
use std::collections::{BTreeMap, BTreeSet};

/// What is nearer than so many pixels are wide lies upon another.
const NEAR_PIXELS: f64 = 0.25;

/// A point that a node sees, and its triangle's plane.
struct Seen {
    mesh: u32,
    moves: bool,
    point: DVec3,
    /// Toward the camera.
    normal: DVec3,
    /// What is near there, and nearer than what rays leave beyond.
    near: f64,
    clearance: f64,
}

impl Seen {
    fn height_above(&self, other: &Self) -> f64 {
        (self.point - other.point).dot(other.normal)
    }

    fn lies_upon(&self, other: &Self) -> bool {
        let height = self.height_above(other);
        height > self.clearance && height < self.near && other.height_above(self).abs() < other.near
    }
}

/// The meshes that move and lie upon others, as most of these points say that see both. Directions
/// are those of the camera's rays.
pub fn meshes(scene: &SearchScene, directions: &[DVec3; LANES], hits: &[Hit]) -> BTreeSet<u32> {
    let seen: Vec<Seen> = hits.iter().map(|hit| see(scene, directions, hit)).collect();
    // How many pairs of points there are of two meshes, and how many of them say so.
    let mut pairs: BTreeMap<[u32; 2], [usize; 2]> = BTreeMap::new();
    let is_lamp = |it: &Seen| {
        scene.view.scene.meshes[it.mesh as usize]
            .area_light
            .is_some()
    };
    for upper in seen.iter().filter(|it| it.moves && !is_lamp(it)) {
        for lower in seen.iter().filter(|it| it.mesh != upper.mesh) {
            let [all, flat] = pairs.entry([upper.mesh, lower.mesh]).or_default();
            *all += 1;
            *flat += usize::from(upper.lies_upon(lower));
        }
    }
    let flat = pairs.iter().filter(|(_, [all, flat])| 2 * flat > *all);
    flat.map(|([upper, _], _)| *upper).collect()
}

fn see(scene: &SearchScene, directions: &[DVec3; LANES], hit: &Hit) -> Seen {
    let geometry = scene.view.geometry;
    let camera = &scene.view.camera;
    let [p, q, r] = geometry.triangles[hit.triangle as usize]
        .map(|v| geometry.positions[v as usize].as_dvec3());
    let pixel = camera.direction_per_pixel()[0].length();
    let d = directions[hit.lane];
    let n = (q - p).cross(r - p).normalize();
    let point = camera.eye() + d * hit.distance;
    Seen {
        mesh: hit.mesh,
        moves: hit.moves,
        point,
        normal: n * -n.dot(d).signum(),
        near: NEAR_PIXELS * pixel * hit.distance,
        clearance: f64::from(OFFSET) * geometry.room(point),
    }
}
