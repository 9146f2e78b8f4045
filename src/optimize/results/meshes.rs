//! Meshes as files: binary PLY and OBJ, in world space.

use crate::jobs::failure::Failure;
use crate::output::atomic;
use crate::scene::{Mesh, Normals, Rgb};
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

/// Writes a mesh as PLY: positions, normals that are its own data, texture coordinates, colours of
/// vertices (none if there are none), triangles.
pub fn ply(path: &Path, mesh: &Mesh, colours: &[Rgb]) -> Result<(), Failure> {
    let normals = match &mesh.normals {
        Normals::Given(normals) => Some(normals),
        // Who reads the file computes them, as was done here.
        _ => None,
    };
    let has_uvs = !mesh.uvs.is_empty();
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
    if !colours.is_empty() {
        header += "property float r\nproperty float g\nproperty float b\n";
    }
    let _ = write!(
        header,
        "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
        mesh.triangles.len()
    );
    let mut bytes = header.into_bytes();
    for (i, position) in mesh.positions.iter().enumerate() {
        let mut numbers = position.to_array().to_vec();
        numbers.extend(normals.iter().flat_map(|n| n[i].to_array()));
        numbers.extend(mesh.uvs.get(i).iter().flat_map(|uv| uv.to_array()));
        numbers.extend(colours.get(i).iter().copied().flatten());
        bytes.extend(numbers.iter().flat_map(|v| v.to_le_bytes()));
    }
    for triangle in &mesh.triangles {
        bytes.push(3);
        bytes.extend(triangle.iter().flat_map(|v| v.to_le_bytes()));
    }
    atomic::write(path, |file| file.write_all(&bytes))?;
    Ok(())
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
