//! Which meshes have pictures whose detail is fine where a node of the film's drift looks.
//!
//! Under a film point that rests the picture on a surface slides that moves, and what is seen
//! changes by the picture's slope. If the point follows the surface its picture rests. That costs
//! what an image's noise brings while its filter slides, which is as if all changed by about
//! itself from pixel to pixel.

use crate::boundary::search_scene::SearchScene;
use crate::paths::film::node_hits::Hit;
use crate::paths::surface::interface::texture_at;
use crate::scene::{Layout, Scene};
use glam::{DVec3, Vec3};
use std::collections::{BTreeMap, BTreeSet};

/// The change over a pixel, over the value, from which detail is fine.
const FINE: f64 = 0.5;

/// Whether a mesh has any picture that slides with it.
pub fn has_any(scene: &Scene, mesh: usize) -> bool {
    textures(scene, mesh).next().is_some()
}

fn textures(scene: &Scene, mesh: usize) -> impl Iterator<Item = usize> {
    let all = scene.textures_of(scene.meshes[mesh].material).into_iter();
    all.filter(|&t| {
        matches!(
            scene.textures[t].layout,
            Layout::Bitmap { bilinear: true, .. } | Layout::Vertices
        )
    })
}

/// The meshes that move and have fine pictures where these rays of the camera meet them.
pub fn meshes(scene: &SearchScene, hits: &[Hit]) -> BTreeSet<u32> {
    let geometry = scene.view.geometry;
    let per_distance = scene.view.camera.direction_per_pixel()[0].length();
    // Of every mesh and texture: values, and squares of what they change by over a pixel.
    let mut seen: BTreeMap<(u32, usize), Vec<[f64; 2]>> = BTreeMap::new();
    for hit in hits.iter().filter(|h| h.moves) {
        let [p, q, r] = geometry.triangles[hit.triangle as usize]
            .map(|v| geometry.positions[v as usize].as_dvec3());
        let pixel = hit.distance * per_distance;
        for texture in textures(scene.view.scene, hit.mesh as usize) {
            let b = hit.barycentrics.map(|b| b as f32);
            let (found, slopes) = texture_at(scene.view.scene, geometry, texture, hit.triangle, b);
            let change = slope_squared([q - p, r - p], slopes) * pixel.powi(2);
            let value = f64::from(found.value.length());
            let points = seen.entry((hit.mesh, texture)).or_default();
            points.push([value, change]);
        }
    }
    let is_fine = |points: &Vec<[f64; 2]>| {
        let count = points.len() as f64;
        let value = points.iter().map(|p| p[0]).sum::<f64>() / count;
        let change = points.iter().map(|p| p[1]).sum::<f64>() / count;
        change > (FINE * value).powi(2)
    };
    let fine = seen.iter().filter(|(_, points)| is_fine(points));
    fine.map(|((mesh, _), _)| *mesh).collect()
}

/// The squared slope over a triangle's plane, of all channels, given what they change by along two
/// edges.
fn slope_squared([a, b]: [DVec3; 2], along: [Vec3; 2]) -> f64 {
    let [s, t] = along.map(|s| s.as_dvec3());
    let [aa, ab, bb] = [a.dot(a), a.dot(b), b.dot(b)];
    let [ss, st, tt] = [s.dot(s), s.dot(t), t.dot(t)];
    let squared = (bb * ss - 2.0 * ab * st + aa * tt) / (aa * bb - ab * ab);
    if squared.is_finite() { squared } else { 0.0 }
}
