//! The meshes and pictures of the battery.

use crate::chance::between;
use crate::mesh::{Mesh, Point};
use crate::shapes::{corkscrew, icosphere};
use std::error::Error;
use std::path::Path;
use warpath::methods::Image;
use warpath::output::{exr, png};

/// Writes all of them.
pub fn write(folder: &Path) -> Result<(), Box<dyn Error>> {
    let meshes = folder.join("meshes");
    std::fs::create_dir_all(&meshes)?;
    let all = [
        ("ball", icosphere(3)),
        ("corkscrew", corkscrew()),
        ("cube_shared", cube(true)),
        ("cube_seamed", cube(false)),
        ("blades", blades(400)),
        ("specks", specks(150)),
        ("broken", broken()),
        ("shell", shell()),
        ("leaves", leaves()),
        ("slit_box", slit_box()),
    ];
    for (name, mesh) in all {
        mesh.write_binary(&meshes.join(format!("{name}.ply")))?;
    }
    sun(&folder.join("one_texel_sun.exr"))?;
    tiles(&folder.join("tiles.png"))
}

/// A sky with all its light in one texel but for a little.
fn sun(path: &Path) -> Result<(), Box<dyn Error>> {
    const SIZE: [usize; 2] = [64, 32];
    let mut pixels = vec![[0.1, 0.12, 0.15]; SIZE[0] * SIZE[1]];
    pixels[8 * SIZE[0] + 9] = [400.0, 380.0, 340.0];
    let image = Image {
        width: SIZE[0],
        height: SIZE[1],
        pixels,
    };
    Ok(exr::write(path, &image)?)
}

fn tiles(path: &Path) -> Result<(), Box<dyn Error>> {
    let grey = |i: u64| between(0.1, 0.8, i, 0) as f32;
    let image = Image {
        width: 8,
        height: 8,
        pixels: (0..64)
            .map(|i| [grey(i), grey(i + 64), grey(i + 128)])
            .collect(),
    };
    Ok(png::write_image(path, &image)?)
}

fn quad(mesh: &mut Mesh, corners: [Point; 4]) {
    let at = mesh.points.len();
    mesh.points.extend(corners);
    mesh.triangles
        .extend([[at, at + 1, at + 2], [at, at + 2, at + 3]]);
}

/// The cube of half side 0.5: its corners shared by its sides, or each side with its own, as UV
/// seams leave them.
fn cube(is_shared: bool) -> Mesh {
    let mut mesh = Mesh::default();
    for axis in 0..3 {
        for side in [-0.5, 0.5] {
            let corner = |u: f64, v: f64| {
                let mut point = [0.0; 3];
                point[axis] = side;
                point[(axis + 1) % 3] = u;
                point[(axis + 2) % 3] = v * side.signum();
                point
            };
            quad(
                &mut mesh,
                [
                    corner(-0.5, -0.5),
                    corner(0.5, -0.5),
                    corner(0.5, 0.5),
                    corner(-0.5, 0.5),
                ],
            );
        }
    }
    if is_shared {
        let points = std::mem::take(&mut mesh.points);
        for triangle in &mut mesh.triangles {
            for i in triangle {
                let known = mesh.points.iter().position(|p| *p == points[*i]);
                *i = known.unwrap_or_else(|| {
                    mesh.points.push(points[*i]);
                    mesh.points.len() - 1
                });
            }
        }
    }
    mesh
}

/// Upright triangles on a square of side 2.
pub fn blades(count: u64) -> Mesh {
    let mut mesh = Mesh::default();
    let width = 1.2 / (count as f64).sqrt();
    for i in 0..count {
        let [x, y] = [0, 1].map(|axis| between(-1.0, 1.0, i, axis));
        let (sin, cos) = between(0.0, std::f64::consts::PI, i, 2).sin_cos();
        let [dx, dy] = [width * cos, width * sin];
        let at = mesh.points.len();
        let lean = [3, 4].map(|axis| between(-0.15, 0.15, i, axis));
        let height = between(0.3, 0.6, i, 5);
        mesh.points.extend([
            [x - dx, y - dy, 0.0],
            [x + dx, y + dy, 0.0],
            [x + lean[0], y + lean[1], height],
        ]);
        mesh.triangles.push([at, at + 1, at + 2]);
    }
    mesh
}

/// Tetrahedra of a quarter of a pixel in a ball.
fn specks(count: u64) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..count {
        let centre: Point = std::array::from_fn(|axis| between(-0.8, 0.8, i, axis as u64));
        let at = mesh.points.len();
        for corner in [
            [1.0, 1.0, 1.0],
            [1.0, -1.0, -1.0],
            [-1.0, 1.0, -1.0],
            [-1.0, -1.0, 1.0f64],
        ] {
            mesh.points
                .push([0, 1, 2].map(|axis| centre[axis] + 0.014 * corner[axis]));
        }
        let sides = [[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]];
        mesh.triangles
            .extend(sides.map(|side| side.map(|corner| at + corner)));
    }
    mesh
}

/// A ball with what scanners leave: slivers, triangles of no area, some twice, some turned round.
fn broken() -> Mesh {
    let mut mesh = icosphere(2);
    for point in &mut mesh.points {
        *point = point.map(|x| 0.6 * x);
    }
    let known = mesh.triangles.clone();
    for (i, [a, b, c]) in known.into_iter().enumerate() {
        match i % 12 {
            0 => mesh.triangles.push([a, b, c]),
            3 => mesh.triangles.push([a, a, b]),
            6 => mesh.triangles[i] = [a, c, b],
            // A millionth as high as it is long, along an edge of the ball.
            9 => {
                let [p, q] = [mesh.points[a], mesh.points[b]];
                let middle = [0, 1, 2].map(|axis| (p[axis] + q[axis]) * (0.5 + 5e-7));
                mesh.points.push(middle);
                mesh.triangles.push([a, b, mesh.points.len() - 1]);
            }
            _ => {}
        }
    }
    mesh
}

/// The upper part of a sphere: an open border, and an inside to be seen.
fn shell() -> Mesh {
    let mut mesh = icosphere(3);
    let points = mesh.points.clone();
    mesh.triangles
        .retain(|t| t.iter().all(|i| points[*i][2] > -0.15));
    for point in &mut mesh.points {
        *point = point.map(|x| 0.7 * x);
    }
    mesh
}

/// Leaves that pass through each other.
fn leaves() -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..12 {
        let (sin, cos) = (i as f64 * 0.26).sin_cos();
        let tilt = between(-0.3, 0.3, i, 0);
        let corner = |along: f64, up: f64| [along * cos + tilt * up, along * sin, up];
        quad(
            &mut mesh,
            [
                corner(-0.7, -0.5),
                corner(0.7, -0.5),
                corner(0.5, 0.6),
                corner(-0.5, 0.6),
            ],
        );
    }
    mesh
}

/// A box without lid but for two boards that leave a slit.
fn slit_box() -> Mesh {
    let mut mesh = Mesh::default();
    let (a, h, slit) = (0.4, 0.4, 0.06);
    let sides = [[-a, -a], [a, -a], [a, a], [-a, a]];
    for i in 0..4 {
        let ([x, y], [u, v]) = (sides[i], sides[(i + 1) % 4]);
        quad(&mut mesh, [[x, y, -h], [u, v, -h], [u, v, h], [x, y, h]]);
    }
    for (from, to) in [(-a, -slit / 2.0), (slit / 2.0, a)] {
        quad(
            &mut mesh,
            [[from, -a, -h], [to, -a, -h], [to, a, -h], [from, a, -h]],
        );
    }
    quad(&mut mesh, [[-a, -a, h], [a, -a, h], [a, a, h], [-a, a, h]]);
    mesh
}
