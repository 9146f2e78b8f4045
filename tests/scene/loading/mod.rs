//! Good scenes: Mitsuba's defaults and conventions.

mod defaults;
mod lights;
mod materials;
mod meshes;
mod sources;
mod textures;
mod tolerance;

use glam::Vec3;
use warpath::scene::source::Memory;
use warpath::scene::{Rgb, Scene, load_from};

const SENSOR: &str =
    "<sensor type=\"perspective\" id=\"cam\"><float name=\"fov\" value=\"40\"/></sensor>";

fn with_files(inside: &str, files: Memory, defines: &[(&str, &str)]) -> Scene {
    let files = files.with(
        "s/s.xml",
        format!("<scene version=\"3.0.0\">\n{inside}</scene>"),
    );
    let defines: Vec<_> = defines
        .iter()
        .map(|(n, v)| (n.to_string(), v.to_string()))
        .collect();
    load_from(&files, "s/s.xml", &defines).unwrap_or_else(|e| panic!("{e}"))
}

fn scene(inside: &str) -> Scene {
    with_files(&format!("{inside}{SENSOR}"), Memory::new(), &[])
}

/// The triangle's geometric normal.
fn face_normal(scene: &Scene, mesh: usize, triangle: usize) -> Vec3 {
    let mesh = &scene.meshes[mesh];
    let [a, b, c] = mesh.triangles[triangle].map(|i| mesh.positions[i as usize]);
    (b - a).cross(c - a).normalize()
}

fn colour(scene: &Scene, material: usize) -> Rgb {
    let texture = scene.materials[material].bsdf.colour();
    scene.constant(texture.expect("a colour"))
}

/// A picture file of 32-bit floating-point numbers (PFM, bottom row first) with `colour` at each
/// column and row from the top.
fn floats(width: u32, height: u32, colour: impl Fn(u32, u32) -> Rgb) -> Vec<u8> {
    let mut bytes = format!("PF\n{width} {height}\n-1.0\n").into_bytes();
    for y in (0..height).rev() {
        for x in 0..width {
            bytes.extend(colour(x, y).into_iter().flat_map(f32::to_le_bytes));
        }
    }
    bytes
}
