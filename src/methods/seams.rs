//! Seams of texture coordinates: edges within a mesh across which a picture does not fit together.

use crate::paths::texture::lookup;
use crate::scene::{Layout, Mesh, Texture};
use crate::warp::walk::{FLAT, bend};
use glam::Vec3;
use std::collections::HashMap;

/// A jump of a texture that an image may show.
const VISIBLE: f32 = 1e-3;

/// Whether a texture jumps across an edge of the mesh that the search for edges does not look at: one that smooth shading
/// hides, or that lies in a plane.
pub(super) fn jumps_at_a_seam(mesh: &Mesh, texture: &Texture) -> bool {
    if texture.layout == Layout::Constant || mesh.uvs.is_empty() {
        return false;
    }
    let position = |v: u32| mesh.positions[v as usize];
    let key = |v: u32| position(v).to_array().map(|x| (x + 0.0).to_bits());
    let corners = |t: &[u32; 3]| t.map(|v| position(v).as_dvec3());
    let is_smooth = mesh.normals.vertex().is_some();
    // The triangle and vertices on the other side of each directed edge met so far.
    let mut open: HashMap<[[u32; 3]; 2], (usize, [u32; 2])> = HashMap::new();
    for (i, triangle) in mesh.triangles.iter().enumerate() {
        for c in 0..3 {
            let edge = [triangle[c], triangle[(c + 1) % 3]];
            let [from, to] = edge.map(key);
            if let Some(&(other, twin)) = open.get(&[to, from]) {
                let bend = bend(corners(triangle), corners(&mesh.triangles[other]));
                let is_followed = !is_smooth && bend > FLAT;
                if !is_followed && differs(mesh, texture, edge, [twin[1], twin[0]]) {
                    return true;
                }
            }
            open.insert([from, to], (i, edge));
        }
    }
    false
}

/// Whether the texture along two edges that lie in one place is not the same.
fn differs(mesh: &Mesh, texture: &Texture, a: [u32; 2], b: [u32; 2]) -> bool {
    let uv = |v: u32| mesh.uvs[v as usize];
    let [a, b] = [a, b].map(|e| e.map(uv));
    if a == b {
        return false;
    }
    (0..=8).any(|i| {
        let along = |[p, q]: [glam::Vec2; 2]| p.lerp(q, i as f32 / 8.0);
        let difference: Vec3 = lookup(texture, along(a)).value - lookup(texture, along(b)).value;
        difference.abs().max_element() > VISIBLE
    })
}
