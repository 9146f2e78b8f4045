//! Makes the meshes of `scenes/` and of `scenes/materials/`: `cargo run --release --example
//! make_meshes -- scenes`.

#[path = "shared/mesh.rs"]
mod mesh;

use mesh::{Mesh, Point};
use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

fn main() -> std::io::Result<()> {
    let scenes = PathBuf::from(std::env::args().nth(1).unwrap_or("scenes".into()));
    let folder = scenes.join("meshes");
    let materials = scenes.join("materials/meshes");
    std::fs::create_dir_all(&folder)?;
    std::fs::create_dir_all(&materials)?;
    tube(200, 20, 0.11, trefoil).write_binary(&folder.join("knot.ply"))?;
    tube(48, 16, 0.25, |t| [t.cos(), t.sin(), 0.0]).write_binary(&folder.join("ring.ply"))?;
    write_ascii(&folder.join("wedge.ply"), &wedge())?;
    write_ball(&materials.join("ball.ply"), 50, 50, false)?;
    write_ball(&materials.join("gem.ply"), 12, 7, false)?;
    write_ball(&materials.join("painted.ply"), 12, 7, true)
}

/// A trefoil knot that fits into the unit ball.
fn trefoil(t: f64) -> Point {
    let radius = 2.0 + (3.0 * t).cos();
    [
        radius * (2.0 * t).cos(),
        radius * (2.0 * t).sin(),
        (3.0 * t).sin(),
    ]
    .map(|x| x / 3.2)
}

/// A closed tube around `curve`, which goes once round for t from 0 to 2π, shut with
/// `along`·`around` quadrilaterals.
fn tube(along: usize, around: usize, thickness: f64, curve: impl Fn(f64) -> Point) -> Mesh {
    let mut points = Vec::new();
    for i in 0..along {
        let t = TAU * i as f64 / along as f64;
        let centre = curve(t);
        let tangent = unit(minus(curve(t + 1e-4), curve(t - 1e-4)));
        // The direction from the axis stands for the frame: it closes where the curve does.
        let outward = unit(minus(centre, [0.0, 0.0, 0.3 * centre[2]]));
        let side = unit(cross(tangent, outward));
        let up = cross(side, tangent);
        for k in 0..around {
            let (sin, cos) = (TAU * k as f64 / around as f64).sin_cos();
            points.push(std::array::from_fn(|c| {
                centre[c] + thickness * (cos * up[c] + sin * side[c])
            }));
        }
    }
    let at = |i: usize, k: usize| (i % along) * around + k % around;
    let mut triangles = Vec::new();
    for i in 0..along {
        for k in 0..around {
            let (a, b, c, d) = (at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1));
            triangles.extend([[a, c, b], [a, d, c]]);
        }
    }
    Mesh { points, triangles }
}

/// A prism over a right triangle: sharp edges, flat sides.
fn wedge() -> Mesh {
    let points = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0]]
        .into_iter()
        .flat_map(|[x, z]| [[x, -1.0, z], [x, 1.0, z]])
        .collect();
    let triangles = vec![
        [0, 2, 4],
        [1, 5, 3],
        [0, 1, 3],
        [0, 3, 2],
        [2, 3, 5],
        [2, 5, 4],
        [4, 5, 1],
        [4, 1, 0],
    ];
    Mesh { points, triangles }
}

fn minus(a: Point, b: Point) -> Point {
    std::array::from_fn(|i| a[i] - b[i])
}

fn cross(a: Point, b: Point) -> Point {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

fn unit(a: Point) -> Point {
    let length = a.iter().map(|x| x * x).sum::<f64>().sqrt();
    a.map(|x| x / length)
}

fn write_ascii(path: &Path, mesh: &Mesh) -> std::io::Result<()> {
    let mut text = mesh.header("ascii");
    for [x, y, z] in &mesh.points {
        text += &format!("{x} {y} {z}\n");
    }
    for [a, b, c] in &mesh.triangles {
        text += &format!("3 {a} {b} {c}\n");
    }
    std::fs::write(path, text)
}

/// The unit sphere, z up, `around` quadrilaterals by `down`, those at the poles triangles; each
/// vertex has its normal (its place) and texture coordinates: u once around from +x by +y, v from 0
/// at +z to 1 at -z. If it is painted vertices and faces have a colour, and faces a weight, too.
fn write_ball(path: &Path, around: usize, down: usize, is_painted: bool) -> std::io::Result<()> {
    let mut triangles = Vec::new();
    for j in 0..down {
        for i in 0..around {
            let at = |i: usize, j: usize| j * (around + 1) + i;
            let (a, b, c, d) = (at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
            if j + 1 < down {
                triangles.push([a, b, c]);
            }
            if j > 0 {
                triangles.push([a, c, d]);
            }
        }
    }
    let (colours, of_faces) = if is_painted {
        let of_faces = [
            "property float color_0\nproperty float color_1\nproperty float color_2\n",
            "property float weight_0\n",
        ];
        let of_vertices = "property float red\nproperty float green\nproperty float blue\n";
        (of_vertices, of_faces.concat())
    } else {
        ("", String::new())
    };
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         property float nx\nproperty float ny\nproperty float nz\nproperty float u\nproperty float v\n{colours}\
         element face {}\nproperty list uchar int vertex_indices\n{of_faces}end_header\n",
        (around + 1) * (down + 1),
        triangles.len()
    )
    .into_bytes();
    for j in 0..=down {
        for i in 0..=around {
            let (u, v) = (i as f64 / around as f64, j as f64 / down as f64);
            let ((sin_phi, cos_phi), (sin_theta, cos_theta)) =
                ((TAU * u).sin_cos(), (TAU / 2.0 * v).sin_cos());
            let n = [sin_theta * cos_phi, sin_theta * sin_phi, cos_theta];
            for x in n.iter().chain(&n).chain(&[u, v]) {
                bytes.extend((*x as f32).to_le_bytes());
            }
            if is_painted {
                for x in [
                    0.5 + 0.4 * n[0],
                    0.5 - 0.4 * n[1],
                    ((i + j) % 3) as f64 / 2.0,
                ] {
                    bytes.extend((x as f32).to_le_bytes());
                }
            }
        }
    }
    for (number, triangle) in triangles.iter().enumerate() {
        bytes.push(3);
        for i in triangle {
            bytes.extend((*i as i32).to_le_bytes());
        }
        if is_painted {
            let [a, b, c] = [3, 5, 7].map(|n| (number % n) as f32 / n as f32);
            for x in [0.1 + a, 0.2 + b, 0.9 - c, 0.05 + b] {
                bytes.extend(x.to_le_bytes());
            }
        }
    }
    std::fs::write(path, bytes)
}
