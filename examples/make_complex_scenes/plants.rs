//! Leaves and blades: what hides what changes at very many short edges, most of them behind others.

use crate::chance::{between, chance};
use crate::made::{Density, Made};
use crate::mesh::Mesh;
use crate::placing::{axes, place, strip};
use crate::xml::{Scene, constant, floor, lamp, ply};
use std::f64::consts::TAU;

/// Leaves in a box, of the same area altogether in each density: 2.7, 0.9 and 0.3 pixels across of
/// an image of 64 pixels. Many cut through each other.
pub fn hedge(density: Density) -> Made {
    const AREA: f64 = 8.0;
    let count = density.of([600, 6_000, 60_000]);
    // Of a leaf 1.6 times as long as it is wide, whose area is this squared.
    let size = (AREA / count as f64).sqrt();
    let (length, width) = (0.5 * size * 1.6f64.sqrt(), 0.5 * size / 1.6f64.sqrt());
    let mut leaves = Mesh::default();
    for i in 0..count {
        let centre = [
            between(-1.0, 1.0, i, 0),
            between(-0.5, 0.5, i, 1),
            between(0.15, 1.35, i, 2),
        ];
        let [along, aside] = axes(i, 3);
        let first = leaves.points.len();
        for [x, y] in [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]] {
            leaves
                .points
                .push(place(centre, along, x * length, aside, y * width));
        }
        leaves
            .triangles
            .extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    Made {
        scene: Scene {
            name: "hedge",
            comment: "Leaves in a box, in the light of a lamp and of the sky.",
            max_depth: 3,
            fov: 32.0,
            origin: "0.6, -5, 1.9",
            target: "0, 0, 0.65",
            body: ply("leaves", "leaves", "true", "", "0.2, 0.4, 0.12")
                + &floor(6.0)
                + &lamp(
                    "lamp",
                    r#"<scale value="0.5"/><rotate y="1" angle="25"/>
      <translate x="-1.6" y="-1" z="3.6"/>"#,
                    "45, 42, 37",
                )
                + &constant("0.35, 0.42, 0.55"),
        },
        meshes: vec![("leaves", leaves)],
        bent: "leaves",
        bands: false,
    }
}

/// Bent blades on the ground, narrower and lower the more there are, of the same area altogether:
/// 0.9, 0.16 and 0.03 pixels wide at their feet.
pub fn grass(density: Density) -> Made {
    const HALF_SIDE: f64 = 1.5;
    let count = density.of([1_000, 10_000, 100_000]);
    let share = count as f64 / 1_000.0;
    let (width, height) = (0.02 * share.powf(-0.75), 0.5 * share.powf(-0.25));
    let mut blades = Mesh::default();
    for i in 0..count {
        let foot = [
            between(-HALF_SIDE, HALF_SIDE, i, 0),
            between(-HALF_SIDE, HALF_SIDE, i, 1),
        ];
        let height = height * between(0.6, 1.2, i, 2);
        let (sin, cos) = (TAU * chance(i, 3)).sin_cos();
        let bend = between(0.1, 0.7, i, 4) * height;
        let row = |part: f64, share: f64| {
            let out = bend * part * part;
            (
                [foot[0] + out * cos, foot[1] + out * sin, height * part],
                [-sin * share * width, cos * share * width, 0.0],
            )
        };
        strip(&mut blades, &[row(0.0, 1.0), row(0.5, 0.8), row(1.0, 0.0)]);
    }
    Made {
        scene: Scene {
            name: "grass",
            comment: "Blades of grass under a lamp that moves.",
            max_depth: 3,
            fov: 34.0,
            origin: "0.3, -4.2, 2.2",
            target: "0, 0, 0.1",
            body: ply("blades", "blades", "true", "", "0.2, 0.45, 0.1")
                + &floor(6.0).replace("0.65, 0.63, 0.6", "0.5, 0.4, 0.3")
                + &lamp(
                    "lamp",
                    r#"<scale value="0.4"/><rotate y="1" angle="30"/>
      <translate x="-1.4" y="0.3" z="2.6"/>"#,
                    "50, 47, 42",
                )
                + &constant("0.2, 0.24, 0.3"),
        },
        meshes: vec![("blades", blades)],
        bent: "blades",
        bands: false,
    }
}
