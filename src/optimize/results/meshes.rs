//! Meshes as files: binary PLY and OBJ, in world space.

use crate::jobs::failure::Failure;
use crate::output::atomic;
use crate::scene::{Layout, Mesh, Normals, Texture};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

/// Writes a mesh as PLY: positions, normals that are its own data, texture coordinates, triangles,
/// and `attributes` of vertices and faces.
pub fn ply(path: &Path, mesh: &Mesh, attributes: &[&Texture]) -> Result<(), Failure> {
    let normals = match &mesh.normals {
        Normals::Given(normals) => Some(normals),
        // Who reads the file computes them, as was done here.
        _ => None,
    };
    let has_uvs = !mesh.uvs.is_empty();
    let of_layout = |layout| move |texture: &&&Texture| texture.layout == layout;
    let of_vertices: Vec<_> = attributes
        .iter()
        .filter(of_layout(Layout::Vertices))
        .collect();
    let of_faces: Vec<_> = attributes.iter().filter(of_layout(Layout::Faces)).collect();
    let mut header = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n",
        mesh.positions.len()
    );
    if normals.is_some() {
        header += "property float nx\nproperty float ny\nproperty float nz\n";
    }
    if has_uvs {
        header += "property float u\nproperty float v\n";
    }
    of_vertices.iter().for_each(|t| header += &properties(t));
    let _ = write!(
        header,
        "element face {}\nproperty list uchar int vertex_indices\n",
        mesh.triangles.len()
    );
    of_faces.iter().for_each(|t| header += &properties(t));
    header += "end_header\n";
    let mut bytes = header.into_bytes();
    for (i, position) in mesh.positions.iter().enumerate() {
        let mut numbers = position.to_array().to_vec();
        numbers.extend(normals.iter().flat_map(|n| n[i].to_array()));
        numbers.extend(mesh.uvs.get(i).iter().flat_map(|uv| uv.to_array()));
        numbers.extend(of_vertices.iter().flat_map(|t| &t.texels[i][..t.channels]));
        bytes.extend(numbers.iter().flat_map(|v| v.to_le_bytes()));
    }
    for (i, triangle) in mesh.triangles.iter().enumerate() {
        bytes.push(3);
        bytes.extend(triangle.iter().flat_map(|v| v.to_le_bytes()));
        let numbers = of_faces.iter().flat_map(|t| &t.texels[i][..t.channels]);
        bytes.extend(numbers.flat_map(|v| v.to_le_bytes()));
    }
    atomic::write(path, |file| file.write_all(&bytes))?;
    Ok(())
}

/// The properties of an attribute, one for each channel.
fn properties(attribute: &Texture) -> String {
    let name = attribute.attribute().unwrap_or_default();
    let name = name.split_once('_').map_or(name, |(_, name)| name);
    let channels = 0..attribute.channels;
    channels
        .map(|c| format!("property float {name}_{c}\n"))
        .collect()
}

/// Writes a mesh as OBJ. Its texture coordinates run upwards there, as programs expect.
pub fn obj(path: &Path, mesh: &Mesh) -> Result<(), Failure> {
    let mut text = format!("o {}\n", mesh.id.replace(char::is_whitespace, "_"));
    for p in &mesh.positions {
        let _ = writeln!(text, "v {} {} {}", p.x, p.y, p.z);
    }
    for uv in &mesh.uvs {
        let _ = writeln!(text, "vt {} {}", uv.x, 1.0 - uv.y);
    }
    for triangle in &mesh.triangles {
        text.push('f');
        for v in triangle {
            let v = v + 1;
            let _ = match mesh.uvs.is_empty() {
                true => write!(text, " {v}"),
                false => write!(text, " {v}/{v}"),
            };
        }
        text.push('\n');
    }
    atomic::write(path, |file| file.write_all(text.as_bytes()))?;
    Ok(())
}
