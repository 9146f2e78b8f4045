//! Mesh files.

use super::{Case, mesh, ply};
use flate2::Compression;
use flate2::write::ZlibEncoder;
use std::io::Write;

fn binary_ply(vertices: usize, faces: usize, payload: &[u8]) -> Vec<u8> {
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
         property float z\nelement face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    .into_bytes();
    bytes.extend_from_slice(payload);
    bytes
}

/// Three vertices, then one face with these corners.
fn binary_triangle(corners: [i32; 3]) -> Vec<u8> {
    let mut payload = Vec::new();
    for v in [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        payload.extend(v.to_le_bytes());
    }
    payload.push(3);
    for corner in corners {
        payload.extend(corner.to_le_bytes());
    }
    payload
}

/// A mesh of three vertices and one face with these corners, as Mitsuba writes it, but the last so
/// many bytes of its stream; and a list of one mesh.
fn serialized(corners: [u32; 3], missing: usize) -> Vec<u8> {
    let mut stream = 0x1000u32.to_le_bytes().to_vec();
    stream.push(0);
    stream.extend([3u64, 1].into_iter().flat_map(u64::to_le_bytes));
    let positions = [0f32, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
    stream.extend(positions.into_iter().flat_map(f32::to_le_bytes));
    stream.extend(corners.into_iter().flat_map(u32::to_le_bytes));
    stream.truncate(stream.len() - missing);
    let mut zlib = ZlibEncoder::new(vec![0x1c, 4, 4, 0], Compression::default());
    zlib.write_all(&stream).expect("memory");
    let mut bytes = zlib.finish().expect("memory");
    bytes.extend(0u64.to_le_bytes());
    bytes.extend(1u32.to_le_bytes());
    bytes
}

// One line a case, however long.
#[rustfmt::skip]
pub fn cases() -> Vec<Case> {
    let good = "0 0 0\n1 0 0\n0 1 0\n";
    vec![
        mesh("empty serialized", "m.serialized", "", &["m.serialized", "no serialized mesh"]),
        mesh("serialized of version 2", "m.serialized", [0x1c, 4, 2, 0], &["version 2", "3 or 4"]),
        mesh("serialized without a stream", "m.serialized", [0x1c, 4, 4, 0], &["m.serialized", "truncated"]),
        mesh("serialized of noise", "m.serialized", [0x1c, 4, 4, 0, 1, 2, 3, 4, 5, 6, 7, 8], &["m.serialized", "broken"]),
        mesh("serialized, cut", "m.serialized", serialized([0, 1, 2], 1), &["m.serialized", "truncated"]),
        mesh("serialized, corner", "m.serialized", serialized([0, 1, 3], 0), &["m.serialized, face 0", "vertex 3", "has 3"]),
        mesh("empty ply", "m.ply", "", &["m.ply", "s.xml:2:1"]),
        mesh("not a ply", "m.ply", "hello\n", &["m.ply:1", "PLY header"]),
        mesh("header line", "m.ply", "ply\nformat ascii 1.0\nelemnt vertex 3\nend_header\n", &["m.ply:3"]),
        mesh("header without end", "m.ply", "ply\nformat ascii 1.0\nelement vertex 3\n", &["m.ply", "end_header"]),
        mesh("no faces declared", "m.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n0 0 0\n", &["m.ply", "\"face\""]),
        mesh("no z", "m.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n0 0\n", &["m.ply", "\"z\""]),
        mesh("no corners", "m.ply", "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face 0\nproperty int material\nend_header\n", &["m.ply", "vertex_indices"]),
        mesh("same property twice", "m.ply", "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float x\nproperty float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n", &["m.ply", "same name"]),
        mesh("element without properties", "m.ply", "ply\nformat binary_little_endian 1.0\nelement nothing 18446744073709551615\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nelement face 0\nproperty list uchar int vertex_indices\nend_header\n", &["m.ply", "\"nothing\""]),
        mesh("billions claimed", "m.ply", binary_ply(4_000_000_000, 4_000_000_000, &[0; 100]), &["m.ply", "truncated", "100 bytes"]),
        mesh("truncated binary", "m.ply", binary_ply(3, 1, &binary_triangle([0, 1, 2])[..45]), &["m.ply", "face 0", "truncated"]),
        mesh("more than declared", "m.ply", binary_ply(3, 1, &[binary_triangle([0, 1, 2]), vec![0; 4]].concat()), &["m.ply", "4 bytes follow"]),
        mesh("index out of range", "m.ply", binary_ply(3, 1, &binary_triangle([0, 1, 3])), &["m.ply", "face 0", "index 3", "3 vertices"]),
        mesh("negative index", "m.ply", binary_ply(3, 1, &binary_triangle([0, 1, -1])), &["m.ply", "face 0", "-1"]),
        mesh("truncated ascii", "m.ply", ply("0 0 0\n1 0 0\n"), &["m.ply", "truncated"]),
        mesh("a word in ascii", "m.ply", ply("0 0 0\n1 zero 0\n0 1 0\n3 0 1 2\n"), &["m.ply:11", "\"zero\"", "vertex 1"]),
        mesh("NaN vertex", "m.ply", ply("0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n"), &["m.ply", "vertex 1", "not finite"]),
        mesh("ascii index", "m.ply", ply(&format!("{good}3 0 1 9\n")), &["m.ply", "face 0", "index 9"]),
        mesh("ascii negative index", "m.ply", ply(&format!("{good}3 0 1 -2\n")), &["m.ply:13", "\"-2\""]),
        mesh("two corners", "m.ply", ply(&format!("{good}2 0 1\n")), &["m.ply", "face 0", "3 corners"]),
        mesh("ascii rest", "m.ply", ply(&format!("{good}3 0 1 2\n3 0 1 2\n")), &["m.ply:14", "more after"]),
        mesh("empty obj", "m.obj", "", &["m.obj", "empty"]),
        mesh("obj vertex", "m.obj", "v 0 0\n", &["m.obj:1", "three numbers"]),
        mesh("obj word", "m.obj", "# made by hand\nv 0 0 zero\n", &["m.obj:2", "\"zero\""]),
        mesh("obj infinity", "m.obj", "v 0 0 1e999\n", &["m.obj:1", "not finite"]),
        mesh("obj index", "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 4\n", &["m.obj:4", "index 4"]),
        mesh("obj index zero", "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\n", &["m.obj:4", "index 0"]),
        mesh("obj negative index", "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -1 -2 -4\n", &["m.obj:4", "index -4"]),
        mesh("obj normal index", "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1//1 2//1 3//1\n", &["m.obj:4", "normal index 1"]),
        mesh("obj line", "m.obj", "v 0 0 0\nv 1 0 0\nf 1 2\n", &["m.obj:3", "3 corners"]),
        mesh("obj corner", "m.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1/1/1/1 2 3\n", &["m.obj:4", "three indices"]),
    ]
}
