//! Triangles smaller than a pixel before a picture that rests.

use crate::bands::{bright_wall, wall};
use crate::made::{Density, Made};
use crate::mesh::Mesh;
use crate::placing::{axes, in_ball, place};
use crate::xml::{Scene, constant, ply};

/// A cloud that covers a quarter of what is behind it. The triangles are 0.8, 0.8 and 0.25 pixels
/// across of an image of 64 pixels: the cloud of fewest is hence the smaller one.
pub fn specks(density: Density) -> Made {
    /// Area of the triangles over that of the cloud's disc. They face any way, so half of it is
    /// seen: 1 − exp(−0.29) is a quarter.
    const COVER: f64 = 0.58;
    let (count, radius) = density.of([(500, 0.37), (5_000, 1.1), (50_000, 1.1)]);
    let area = COVER * std::f64::consts::PI * radius * radius / count as f64;
    // From the middle of an even triangle to its corners.
    let size = (4.0 * area / 27f64.sqrt()).sqrt();
    let mut specks = Mesh::default();
    for i in 0..count {
        let centre = in_ball(i, 0).map(|x| radius * x);
        let [a, b] = axes(i, 3);
        let first = specks.points.len();
        for [x, y] in [
            [1.0, 0.0],
            [-0.5, 0.75f64.sqrt()],
            [-0.5, -(0.75f64.sqrt())],
        ] {
            specks.points.push(place(centre, a, size * x, b, size * y));
        }
        specks.triangles.push([first, first + 1, first + 2]);
    }
    Made {
        scene: Scene {
            name: "specks",
            comment: "Triangles smaller than pixels before a picture, in light from everywhere.",
            max_depth: 3,
            fov: 30.0,
            origin: "0, -5, 0",
            target: "0, 0, 0",
            body: ply("specks", "specks", "true", "", "0.6, 0.45, 0.15")
                + &wall("wall", 2.6, 1.8)
                + &constant("1, 1, 1"),
        },
        meshes: vec![("specks", specks)],
        bent: "specks",
        bands: true,
    }
}

/// The same cloud, dark, before a picture that shines, in paths of one segment.
pub fn specks_film(density: Density) -> Made {
    let made = specks(density);
    Made {
        scene: Scene {
            name: "specks_film",
            comment: "Triangles smaller than pixels before a picture that shines.",
            max_depth: 1,
            body: ply("specks", "specks", "true", "", "0.6, 0.45, 0.15")
                + &bright_wall("wall", 2.6, 1.8),
            ..made.scene
        },
        ..made
    }
}
