//! Trees on a meadow: very many small triangles, none of them larger than what moves.

use crate::chance::{between, chance};
use crate::mesh::{Mesh, Point};
use crate::xml::{Scene, constant, floor, lamp, ply};
use std::f64::consts::TAU;
use std::io;
use std::path::Path;

/// What the paper's largest scene has.
pub const TRIANGLES: usize = 1_800_000;

const TREES: u64 = 24;
/// The meadow reaches this far from the object, in the middle.
const RADIUS: f64 = 6.0;
/// Nothing grows where the object stands, nor a tree before it.
const CLEARING: f64 = 0.35;

/// Writes the scene and its meshes, of about so many triangles altogether, and returns how many.
pub fn write(folder: &Path, triangles: usize, star: &Mesh) -> io::Result<usize> {
    let meshes = folder.join("meshes");
    std::fs::create_dir_all(&meshes)?;
    let wood = trunks();
    let left = triangles.saturating_sub(star.triangles.len() + wood.triangles.len() + 4);
    // Five triangles a blade of grass, two a leaf; two thirds are grass.
    let grass = grass(left * 2 / 3 / 5);
    let leaves = leaves((left - grass.triangles.len()) / 2);
    let mut total = 4;
    for (name, mesh) in [
        ("star", star),
        ("wood", &wood),
        ("grass", &grass),
        ("leaves", &leaves),
    ] {
        total += mesh.triangles.len();
        mesh.write_binary(&meshes.join(format!("{name}.ply")))?;
    }
    std::fs::write(folder.join("forest.xml"), scene().text(512))?;
    Ok(total)
}

fn scene() -> Scene {
    let object = r#"  <shape type="ply" id="obj">
    <string name="filename" value="meshes/star.ply"/><boolean name="face_normals" value="$flat"/>
    <transform name="to_world"><scale value="0.4"/><translate z="0.5"/></transform>
    <bsdf type="roughconductor"><string name="material" value="Cu"/><float name="alpha" value="0.1"/></bsdf>
  </shape>
"#;
    let plant = |id, colour| ply(id, id, "true", "", colour);
    Scene {
        name: "forest",
        comment: "A metal star in a meadow between trees, in the light of a lamp and of the sky.",
        max_depth: 3,
        fov: 40.0,
        origin: "0.3, -3.2, 1.1",
        target: "0, 0, 0.6",
        body: object.to_string()
            + &floor(2.0 * RADIUS).replace("0.65, 0.63, 0.6", "0.12, 0.09, 0.06")
            + &plant("grass", "0.12, 0.3, 0.06")
            + &plant("leaves", "0.1, 0.22, 0.05")
            + &plant("wood", "0.25, 0.17, 0.1")
            + &lamp(
                "light",
                r#"<scale value="0.8"/><rotate y="1" angle="30"/><translate x="-3" y="-2" z="5.5"/>"#,
                "60, 55, 45",
            )
            + &constant("0.35, 0.45, 0.6"),
    }
}

/// Even over a disc of `RADIUS`.
fn on_meadow(number: u64) -> [f64; 2] {
    let (r, turn) = (RADIUS * chance(number, 0).sqrt(), TAU * chance(number, 1));
    [r * turn.cos(), r * turn.sin()]
}

fn grass(blades: usize) -> Mesh {
    let mut mesh = Mesh::default();
    let places = (0..).filter(|i| {
        let [x, y] = on_meadow(*i);
        x.hypot(y) > CLEARING
    });
    for i in places.take(blades) {
        let [x, y] = on_meadow(i);
        let (width, height) = (between(0.003, 0.007, i, 2), between(0.06, 0.2, i, 3));
        let (sin, cos) = (TAU * chance(i, 4)).sin_cos();
        let bend = between(0.2, 0.8, i, 5) * height;
        let first = mesh.points.len();
        // Two points a height, less and less wide, and one at the tip.
        for (part, share) in [(0.0, 1.0), (0.4, 0.85), (0.75, 0.5), (1.0, 0.0)] {
            let (out, up) = (bend * part * part, height * part * (1.0 - 0.15 * part));
            for side in if share > 0.0 {
                &[-1.0, 1.0][..]
            } else {
                &[0.0]
            } {
                let across = side * share * width;
                mesh.points.push([
                    x + out * cos - across * sin,
                    y + out * sin + across * cos,
                    up,
                ]);
            }
        }
        for [a, b, c] in [[0, 1, 3], [0, 3, 2], [2, 3, 5], [2, 5, 4], [4, 5, 6]] {
            mesh.triangles.push([first + a, first + b, first + c]);
        }
    }
    mesh
}

/// Foot and height. The nearer trees stand to the sides of the line from the camera.
fn tree(number: u64) -> (Point, f64) {
    let turn = TAU * (0.02 + 0.46 * (number as f64 + chance(number, 10)) / TREES as f64);
    let r = between(1.6, RADIUS - 0.4, number, 11);
    (
        [r * turn.cos() * 1.1, r * turn.sin(), 0.0],
        between(1.6, 3.0, number, 12),
    )
}

/// Trunks of eight sides, a little leaning.
fn trunks() -> Mesh {
    const SIDES: usize = 8;
    const ROWS: usize = 12;
    let mut mesh = Mesh::default();
    for number in 0..TREES {
        let ([x, y, _], height) = tree(number);
        let lean = [
            between(-0.15, 0.15, number, 13),
            between(-0.15, 0.15, number, 14),
        ];
        let first = mesh.points.len();
        for j in 0..=ROWS {
            let t = j as f64 / ROWS as f64;
            let radius = 0.09 * (1.0 - 0.8 * t) * height / 2.0;
            for i in 0..SIDES {
                let (sin, cos) = (TAU * i as f64 / SIDES as f64).sin_cos();
                mesh.points.push([
                    x + lean[0] * height * t * t + radius * cos,
                    y + lean[1] * height * t * t + radius * sin,
                    height * t,
                ]);
            }
        }
        let at = |i: usize, j: usize| first + j * SIDES + i % SIDES;
        for j in 0..ROWS {
            for i in 0..SIDES {
                let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
                mesh.triangles.extend([[a, b, c], [a, c, d]]);
            }
        }
    }
    mesh
}

/// Pairs of triangles, folded along the middle, in a ball about each tree's upper half.
fn leaves(count: usize) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..count as u64 {
        let ([x, y, _], height) = tree(i % TREES);
        // Denser outside, as leaves are: a cube root would make them even.
        let r = 0.36 * height * chance(i, 20).powf(0.25);
        let (z, turn) = (between(-1.0, 1.0, i, 21), TAU * chance(i, 22));
        let across = (1.0 - z * z).sqrt();
        let centre = [
            x + r * across * turn.cos(),
            y + r * across * turn.sin(),
            0.75 * height + r * z,
        ];
        let size = between(0.02, 0.04, i, 23);
        let (sin, cos) = (TAU * chance(i, 24)).sin_cos();
        let droop = between(-0.8, 0.4, i, 25);
        // Along the leaf, across it, and which way its halves fold.
        let place = |along: f64, across: f64, fold: f64| {
            std::array::from_fn(|c| {
                centre[c]
                    + size
                        * [
                            along * cos - across * sin,
                            along * sin + across * cos,
                            droop * along + fold,
                        ][c]
            })
        };
        let first = mesh.points.len();
        mesh.points.extend([
            place(-1.0, 0.0, 0.0),
            place(0.0, -0.45, 0.2),
            place(1.0, 0.0, 0.0),
            place(0.0, 0.45, 0.2),
        ]);
        mesh.triangles
            .extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    mesh
}
