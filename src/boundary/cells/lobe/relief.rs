//! By how much pictures turn the normals of a mesh.

use crate::boundary::search_scene::SearchScene;
use crate::paths::surface::texture::{lookup, rise};
use crate::scene::{Layout, Relief, Texture};
use glam::{Vec2, Vec3};

/// About so many points of a mesh tell.
const POINTS: usize = 1 << 10;

/// By how much reliefs turn a mesh's normals over a unit of length, from texel to texel, in the
/// mean over its surface; of several materials that of the most. Zero without pictures that do.
pub fn turn_rad_per_length(scene: &SearchScene, mesh: usize) -> f64 {
    let view = scene.view;
    let parts = view.scene.parts_of(view.scene.meshes[mesh].material);
    let reliefs = parts
        .into_iter()
        .filter_map(|part| view.scene.materials[part].relief);
    let turns = reliefs.map(|relief| mean_turn(scene, mesh, &relief));
    turns.fold(0.0, f64::max)
}

/// Of one relief.
fn mean_turn(scene: &SearchScene, mesh: usize, relief: &Relief) -> f64 {
    let geometry = scene.view.geometry;
    let texture = &scene.view.scene.textures[relief.texture];
    let Layout::Bitmap {
        width,
        height,
        to_uv,
        ..
    } = texture.layout
    else {
        return 0.0;
    };
    let texels =
        |uv: Vec2| (to_uv.transform_vector2(uv) * Vec2::new(width as f32, height as f32)).length();
    let triangles =
        geometry.first_triangle[mesh] as usize..geometry.first_triangle[mesh + 1] as usize;
    let step = triangles.len().div_ceil(POINTS).max(1);
    let points = POINTS / triangles.len().clamp(1, POINTS);
    let [mut area, mut turn] = [0.0f64; 2];
    for corners in geometry.triangles[triangles].iter().step_by(step) {
        let [p, q, r] = corners.map(|v| geometry.positions[v as usize]);
        let [s, t, w] = corners.map(|v| geometry.uvs.get(v as usize).copied().unwrap_or_default());
        let edges = [(q - p, t - s), (r - p, w - s)];
        let own = f64::from((q - p).cross(r - p).length());
        for point in 0..points {
            // Of additive recurrences by the plastic number, folded into the triangle.
            let place = (point as f32 + 0.5) * Vec2::new(0.754_877_7, 0.569_840_3);
            let b = place - place.floor();
            let b = if b.element_sum() > 1.0 { 1.0 - b } else { b };
            let uv = s + (t - s) * b.x + (w - s) * b.y;
            let at = |uv: Vec2| normal(texture, relief, uv, edges);
            let along = |&(x, by): &(Vec3, Vec2)| {
                // A texel further.
                let part = texels(by).recip();
                at(uv).distance(at(uv + by * part)) / (x.length() * part)
            };
            let per_length = edges.iter().map(along).sum::<f32>() / 2.0;
            if per_length.is_finite() {
                area += own;
                turn += own * f64::from(per_length);
            }
        }
    }
    turn / area.max(f64::MIN_POSITIVE)
}

/// The normal in the frame of the surface, of a triangle whose edges and their texture coordinates
/// are these.
fn normal(texture: &Texture, relief: &Relief, uv: Vec2, edges: [(Vec3, Vec2); 2]) -> Vec3 {
    let Some(height) = relief.bumps else {
        return (lookup(texture, uv).value * 2.0 - 1.0).normalize_or(Vec3::Z);
    };
    let [u, v] = rise(texture, uv).by_uv;
    // What a unit of texture coordinates is long, by the ratio of areas.
    let [(a, s), (b, t)] = edges;
    let length = (a.cross(b).length() / s.perp_dot(t).abs()).sqrt();
    Vec3::new(-u * height / length, -v * height / length, 1.0).normalize()
}
