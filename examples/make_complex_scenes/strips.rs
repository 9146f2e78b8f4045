//! Long and thin things: slats and hairs, of which ever more fit into a pixel.

use crate::bands::{bright_wall, wall};
use crate::chance::{between, chance};
use crate::lights::ball;
use crate::made::{Density, Made};
use crate::mesh::{Mesh, Point};
use crate::placing::{across, on_sphere, strip};
use crate::shapes::unit;
use crate::xml::{Scene, constant, floor, lamp, ply};
use std::f64::consts::TAU;

/// Upright slats, half as wide as they are apart (2.9, 0.6 and 0.12 pixels of 64), and three bars.
/// The lamp is behind the camera: what is nearest to its plane, seen or not, decides how far finite
/// differences step.
pub fn fence(density: Density) -> Made {
    const HALF_LENGTH: f64 = 2.0;
    let count = density.of([20, 100, 500]);
    let apart = 2.0 * HALF_LENGTH / count as f64;
    let mut mesh = Mesh::default();
    for i in 0..count {
        let x = -HALF_LENGTH + apart * (i as f64 + 0.5);
        let top = 1.1 + between(-0.08, 0.08, i, 0);
        let half = 0.25 * apart;
        bar(&mut mesh, [x - half, -half, 0.02], [x + half, half, top]);
    }
    for z in [0.25, 0.6, 0.95] {
        // Behind the slats, which they do not touch.
        let y = 0.25 * apart + 0.01;
        bar(
            &mut mesh,
            [-HALF_LENGTH, y, z - 0.025],
            [HALF_LENGTH, y + 0.05, z + 0.025],
        );
    }
    Made {
        scene: Scene {
            name: "fence",
            comment: "A fence before a wall with a picture on it. The camera moves past it.",
            max_depth: 3,
            fov: 40.0,
            origin: "0.4, -2.8, 1.1",
            target: "0, 0, 0.6",
            body: ply("fence", "fence", "true", "", "0.6, 0.5, 0.38")
                + &floor(8.0)
                + &wall("wall", 4.0, 3.0)
                + &lamp(
                    "lamp",
                    r#"<scale value="0.5"/><rotate x="1" angle="45"/>
      <translate x="-1" y="-4.5" z="4"/>"#,
                    "50, 47, 42",
                )
                + &constant("0.35, 0.4, 0.5"),
        },
        meshes: vec![("fence", mesh)],
        bent: "fence",
        bands: true,
    }
}

/// The same fence, dark, before a picture that shines, in paths of one segment.
pub fn fence_film(density: Density) -> Made {
    let made = fence(density);
    Made {
        scene: Scene {
            name: "fence_film",
            comment: "A fence before a wall with a picture that shines. The camera moves past it.",
            max_depth: 1,
            body: ply("fence", "fence", "true", "", "0.6, 0.5, 0.38")
                + &bright_wall("wall", 4.0, 3.0),
            ..made.scene
        },
        ..made
    }
}

/// A box between two corners, its triangles counter-clockwise from outside.
fn bar(mesh: &mut Mesh, low: Point, high: Point) {
    let first = mesh.points.len();
    for corner in 0..8 {
        mesh.points.push(std::array::from_fn(|c| {
            if corner >> c & 1 == 0 {
                low[c]
            } else {
                high[c]
            }
        }));
    }
    for [a, b, c, d] in [
        [0, 4, 6, 2],
        [1, 3, 7, 5],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 2, 3, 1],
        [4, 5, 7, 6],
    ] {
        mesh.triangles
            .extend([[a, b, c], [a, c, d]].map(|t| t.map(|i| first + i)));
    }
}

/// Ribbons of eight segments that grow from a ball and hang: 0.2, 0.06 and 0.02 pixels of 64 wide.
/// Unless `flat` is said, their normals change across them, and fast, since they are narrow.
pub fn hair(density: Density) -> Made {
    let count = density.of([200, 2_000, 20_000]);
    let width = 0.0066 / (count as f64 / 200.0).sqrt();
    let mut mesh = Mesh::default();
    for i in 0..count {
        hang(&mut mesh, i, width);
    }
    Made {
        scene: Scene {
            name: "hair",
            comment: "A ball with thin hairs, in the light of a lamp and of the sky.",
            max_depth: 3,
            fov: 30.0,
            origin: "0, -4, 1.3",
            target: "0, 0, 0.75",
            body: ply("hair", "hair", "$flat", "", "0.5, 0.25, 0.08")
                + &ply("ball", "ball", "false", "", "0.7, 0.65, 0.6")
                + &floor(6.0)
                + &lamp(
                    "lamp",
                    r#"<scale value="0.4"/><rotate y="1" angle="25"/>
      <translate x="-1.2" y="-1" z="3.2"/>"#,
                    "50, 47, 42",
                )
                + &constant("0.35, 0.42, 0.5"),
        },
        meshes: vec![("hair", mesh), ("ball", ball(BALL, RADIUS, 4))],
        bent: "hair",
        bands: false,
    }
}

const BALL: Point = [0.0, 0.0, 0.9];
const RADIUS: f64 = 0.35;

/// One hair: it leaves the ball at any place but the lowest ones, and turns downwards.
fn hang(mesh: &mut Mesh, number: u64, width: f64) {
    const SEGMENTS: usize = 8;
    let mut way = on_sphere(number, 0);
    way[2] = 0.6 * way[2] + 0.4;
    way = unit(way);
    let step = between(0.05, 0.08, number, 2);
    let aside = across(way, TAU * chance(number, 3))[0];
    let curl: Point = std::array::from_fn(|c| between(-0.15, 0.15, number, 4 + c as u64));
    let mut middle: Point = std::array::from_fn(|c| BALL[c] + 0.99 * RADIUS * way[c]);
    let mut rows = Vec::with_capacity(SEGMENTS + 1);
    for k in 0..=SEGMENTS {
        // Still half as wide at its tip.
        let half = 0.5 * width * (1.0 - 0.5 * k as f64 / SEGMENTS as f64);
        rows.push((middle, aside.map(|x| half * x)));
        middle = std::array::from_fn(|c| middle[c] + step * way[c]);
        let pull = [0.0, 0.0, -0.25];
        way = unit(std::array::from_fn(|c| way[c] + pull[c] + curl[c]));
    }
    strip(mesh, &rows);
}
