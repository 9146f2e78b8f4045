//! The meshes of the small scenes. Triangles are counter-clockwise from outside.

use crate::chance::{between, chance};
use crate::mesh::{Mesh, Point};
use std::collections::HashMap;
use std::f64::consts::{PI, TAU};

/// A sphere with blunt arms of uneven length, within the unit ball: concave, and it hides itself.
/// 5120 triangles.
pub fn star() -> Mesh {
    const ARMS: u64 = 17;
    // Directions on a spiral, nearly even, so that arms seldom line up.
    let arms: Vec<(Point, f64)> = (0..ARMS)
        .map(|i| {
            let z = 1.0 - (2.0 * i as f64 + 1.0) / ARMS as f64;
            let turn = i as f64 * PI * (3.0 - 5f64.sqrt()) + 0.4 * chance(i, 0);
            let r = (1.0 - z * z).sqrt();
            (
                [r * turn.cos(), r * turn.sin(), z],
                between(0.25, 0.5, i, 1),
            )
        })
        .collect();
    let mut mesh = icosphere(4);
    for point in &mut mesh.points {
        let bumps: f64 = arms
            .iter()
            .map(|(arm, length)| length * (18.0 * (dot(*arm, *point) - 1.0)).exp())
            .sum();
        let ripple = 0.02 * (11.0 * point[0]).sin() * (9.0 * point[1] + 1.0).sin();
        *point = point.map(|x| x * (0.48 + bumps + ripple));
    }
    mesh
}

/// A unit icosahedron, each triangle cut in four as many times as is said, on the unit sphere.
pub fn icosphere(cuts: usize) -> Mesh {
    let golden = (1.0 + 5f64.sqrt()) / 2.0;
    let mut mesh = Mesh::default();
    for [x, y] in [
        [-1.0, golden],
        [1.0, golden],
        [-1.0, -golden],
        [1.0, -golden],
    ] {
        mesh.points.push(unit([x, y, 0.0]));
    }
    for [y, z] in [
        [-1.0, golden],
        [1.0, golden],
        [-1.0, -golden],
        [1.0, -golden],
    ] {
        mesh.points.push(unit([0.0, y, z]));
    }
    for [z, x] in [
        [-1.0, golden],
        [1.0, golden],
        [-1.0, -golden],
        [1.0, -golden],
    ] {
        mesh.points.push(unit([x, 0.0, z]));
    }
    // Corners are neighbours at the edge's length, 2 before they were put on the sphere.
    let edge = 2.0 / (1.0 + golden * golden).sqrt();
    let near = |a: Point, b: Point| dot(minus(a, b), minus(a, b)).sqrt() < 1.01 * edge;
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                let [p, q, r] = [a, b, c].map(|i| mesh.points[i]);
                if near(p, q) && near(q, r) && near(r, p) {
                    let outward = dot(cross(minus(q, p), minus(r, p)), p) > 0.0;
                    mesh.triangles
                        .push(if outward { [a, b, c] } else { [a, c, b] });
                }
            }
        }
    }
    for _ in 0..cuts {
        let mut middles = HashMap::new();
        let coarse = std::mem::take(&mut mesh.triangles);
        for [a, b, c] in coarse {
            let [ab, bc, ca] = [(a, b), (b, c), (c, a)].map(|(i, k)| {
                *middles.entry((i.min(k), i.max(k))).or_insert_with(|| {
                    let (p, q) = (mesh.points[i], mesh.points[k]);
                    mesh.points.push(unit(std::array::from_fn(|d| p[d] + q[d])));
                    mesh.points.len() - 1
                })
            });
            mesh.triangles
                .extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
    }
    mesh
}

/// A square of `side`, its normal up, with waves so flat that a mirror of it bends what it shows
/// and hides nothing.
pub fn waves(side: f64, cells: usize) -> Mesh {
    let height = |x: f64, y: f64| {
        0.005 * (5.0 * x + 2.0 * y).sin()
            + 0.004 * (2.0 * x - 6.5 * y + 1.0).sin()
            + 0.002 * (9.0 * x + 7.0 * y + 2.0).cos()
    };
    let mut mesh = Mesh::default();
    let place = |i: usize| side * (i as f64 / cells as f64 - 0.5);
    for j in 0..=cells {
        for i in 0..=cells {
            let (x, y) = (place(i), place(j));
            mesh.points.push([x, y, height(x, y)]);
        }
    }
    let at = |i: usize, j: usize| j * (cells + 1) + i;
    for j in 0..cells {
        for i in 0..cells {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// A round bar that winds about the z axis, from z = −1 to 1: turned about it, its outline runs up
/// or down, which no point of it does.
pub fn corkscrew() -> Mesh {
    const TURNS: usize = 4;
    // Whole quarters of each turn, so that the bounding box, whose centre is the pivot, lies about
    // the axis.
    const ROWS: usize = 24 * TURNS;
    rod(ROWS, 48, |t, turn| {
        0.35 + 0.15 * (turn - TAU * TURNS as f64 * t).cos()
    })
}

/// Along the z axis from −1 to 1, of radius 1.
pub fn cylinder() -> Mesh {
    rod(8, 64, |_, _| 1.0)
}

/// A closed surface about the z axis from −1 to 1, `radius` away from it at height t in 0…1 and the
/// angle about it.
fn rod(rows: usize, around: usize, radius: impl Fn(f64, f64) -> f64) -> Mesh {
    let mut mesh = Mesh::default();
    for j in 0..=rows {
        let t = j as f64 / rows as f64;
        for i in 0..around {
            let turn = TAU * i as f64 / around as f64;
            let r = radius(t, turn);
            mesh.points
                .push([r * turn.cos(), r * turn.sin(), 2.0 * t - 1.0]);
        }
    }
    let at = |i: usize, j: usize| j * around + i % around;
    for j in 0..rows {
        for i in 0..around {
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    let (bottom, top) = (mesh.points.len(), mesh.points.len() + 1);
    mesh.points.extend([[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]);
    for i in 0..around {
        mesh.triangles.push([bottom, at(i + 1, 0), at(i, 0)]);
        mesh.triangles.push([top, at(i, rows), at(i + 1, rows)]);
    }
    mesh
}

pub fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn minus(a: Point, b: Point) -> Point {
    std::array::from_fn(|i| a[i] - b[i])
}

pub fn cross(a: Point, b: Point) -> Point {
    [
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    ]
}

pub fn unit(a: Point) -> Point {
    let length = dot(a, a).sqrt();
    a.map(|x| x / length)
}
