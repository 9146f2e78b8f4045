//! Where small things stand and which way they face.

use crate::chance::{between, chance};
use crate::mesh::{Mesh, Point};
use crate::shapes::{cross, unit};
use std::f64::consts::TAU;

/// Even over the unit sphere.
pub fn on_sphere(number: u64, property: u64) -> Point {
    let (z, turn) = (
        between(-1.0, 1.0, number, property),
        TAU * chance(number, property + 1),
    );
    let across = (1.0 - z * z).sqrt();
    [across * turn.cos(), across * turn.sin(), z]
}

/// Even in the unit ball.
pub fn in_ball(number: u64, property: u64) -> Point {
    let r = chance(number, property + 2).cbrt();
    on_sphere(number, property).map(|x| r * x)
}

/// Two axes at right angles, in a plane of any direction, turned in it by chance.
pub fn axes(number: u64, property: u64) -> [Point; 2] {
    across(
        on_sphere(number, property),
        TAU * chance(number, property + 2),
    )
}

/// Two axes at right angles to each other and to `normal`, the first at an angle from some origin.
pub fn across(normal: Point, turn: f64) -> [Point; 2] {
    let helper = if normal[2].abs() < 0.9 {
        [0.0, 0.0, 1.0]
    } else {
        [1.0, 0.0, 0.0]
    };
    let a = unit(cross(helper, normal));
    let b = cross(normal, a);
    let (sin, cos) = turn.sin_cos();
    [
        std::array::from_fn(|c| a[c] * cos + b[c] * sin),
        std::array::from_fn(|c| b[c] * cos - a[c] * sin),
    ]
}

/// `centre` + x `a` + y `b`.
pub fn place(centre: Point, a: Point, x: f64, b: Point, y: f64) -> Point {
    std::array::from_fn(|c| centre[c] + x * a[c] + y * b[c])
}

/// Adds a strip: at each of its places along it a middle and half a width, as a vector. It ends in
/// a point where the last half width is nothing.
pub fn strip(mesh: &mut Mesh, rows: &[(Point, Point)]) {
    let first = mesh.points.len();
    for (middle, half) in rows {
        let pointed = half.iter().all(|x| *x == 0.0);
        let sides = if pointed { &[0.0][..] } else { &[-1.0, 1.0] };
        for side in sides {
            mesh.points
                .push(std::array::from_fn(|c| middle[c] + side * half[c]));
        }
    }
    let points = mesh.points.len();
    for a in (first..points - 2).step_by(2) {
        mesh.triangles.push([a, a + 1, a + 2]);
        if a + 3 < points {
            mesh.triangles.push([a + 1, a + 3, a + 2]);
        }
    }
}
