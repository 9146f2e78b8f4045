//! Lights without a sharp border.

use glam::Vec2;
use warpath::scene::{Layout, Scene, Wrap};

/// Texels along a side; the outermost are black.
const SIDE: u32 = 12;

/// Has the light of the mesh `id` fade to black at its border: texture coordinates are x and y.
pub fn fading(mut scene: Scene, id: &str) -> Scene {
    let number = scene.meshes.iter().position(|m| m.id == id);
    let number = number.expect("a mesh");
    let mesh = &mut scene.meshes[number];
    let flat = || mesh.positions.iter().map(|p| p.truncate());
    let low = flat().fold(Vec2::INFINITY, Vec2::min);
    let high = flat().fold(Vec2::NEG_INFINITY, Vec2::max);
    mesh.uvs = flat().map(|p| (p - low) / (high - low)).collect();
    let light = scene.area_lights.iter().find(|l| l.mesh == number);
    let texture = &mut scene.textures[light.expect("a light").radiance];
    let bright = texture.texels[0];
    let inside = |i: u32| i > 0 && i + 1 < SIDE;
    texture.texels = (0..SIDE * SIDE)
        .map(|i| match inside(i % SIDE) && inside(i / SIDE) {
            true => bright,
            false => [0.0; 3],
        })
        .collect();
    texture.layout = Layout::Bitmap {
        width: SIDE,
        height: SIDE,
        wrap: Wrap::Clamp,
        bilinear: true,
        to_uv: glam::Affine2::IDENTITY,
    };
    scene
}
