//! Directions of an environment map, and its meridians.

use super::*;
use glam::{Affine2, DVec3, EulerRot, Mat3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use warpath::paths::environment::distribution::MapDistribution;
use warpath::scene::{EnvironmentMap, Layout, Texture, Wrap};

const WIDTH: usize = 24;
const HEIGHT: usize = 13;

/// A gradient with a small sun, a dark half, and the like: by name.
fn maps() -> [(&'static str, Texture); 3] {
    let with = |of: &dyn Fn(usize, usize) -> f32| Texture {
        texels: (0..WIDTH * HEIGHT)
            .map(|t| [of(t % WIDTH, t / WIDTH); 3])
            .collect(),
        layout: Layout::Bitmap {
            width: WIDTH as u32,
            height: HEIGHT as u32,
            wrap: Wrap::Repeat,
            bilinear: true,
            to_uv: Affine2::IDENTITY,
        },
        ..Texture::constant("sky".into(), [0.0; 3])
    };
    let sun = |x: usize, y: usize| if (x, y) == (7, 3) { 300.0 } else { 0.0 };
    [
        ("sun", with(&|x, y| 0.1 + 0.05 * y as f32 + sun(x, y))),
        ("half", with(&|x, _| if x < WIDTH / 2 { 1.0 } else { 0.0 })),
        ("black", with(&|_, _| 0.0)),
    ]
}

fn turned() -> EnvironmentMap {
    EnvironmentMap {
        to_world: Mat3::from_euler(EulerRot::XYZ, 0.3, 0.5, -0.8),
        scale: 2.0,
    }
}

/// u = atan2(x, −z)/2π and v = acos(y)/π of the map, as fractions.
fn place(map: &EnvironmentMap, d: DVec3) -> [f64; 2] {
    let d = map.to_world.as_dmat3().transpose() * d;
    let turn = (d.x.atan2(-d.z) / TAU).rem_euclid(1.0);
    [turn, d.y.clamp(-1.0, 1.0).acos() / PI]
}

fn at(map: &EnvironmentMap, [u, v]: [f64; 2]) -> DVec3 {
    let (sin_u, cos_u) = (TAU * u).sin_cos();
    let (sin_v, cos_v) = (PI * v).sin_cos();
    map.to_world.as_dmat3() * DVec3::new(sin_u * sin_v, cos_v, -cos_u * sin_v)
}

/// Bins are halves of texels' cells: in them the density over u and v is the same everywhere.
#[test]
fn directions_have_their_density() {
    let map = turned();
    let [columns, rows] = [2 * WIDTH, 2 * (HEIGHT - 1)];
    for (name, texture) in maps() {
        let sky = MapDistribution::new(&texture, &map, &|| false).unwrap();
        let mut counts = vec![0; columns * rows];
        for [u, v] in pairs(41, 3, 8) {
            let (d, density) = sky.sample(u.into(), v.into());
            let at = place(&map, d.as_dvec3());
            let [x, y] = at.map(|x| x.min(1.0 - 1e-7) as f32);
            counts[bin(x, columns) * rows + bin(y, rows)] += 1;
            // Single precision may take the direction to the next cell, and knows no distance from
            // the poles near them.
            let is_inside = [at[0] * columns as f64, at[1] * rows as f64]
                .iter()
                .all(|x| (x - x.round()).abs() > 1e-3)
                && (PI * at[1]).sin() > 0.02;
            let told = sky.pdf(d);
            assert!(
                !is_inside || (told - density).abs() < 1e-3 * density,
                "{name}: {told} against {density}"
            );
        }
        let cell = 2.0 * PI * PI / (columns * rows) as f64;
        let shares: Vec<f64> = (0..columns * rows)
            .map(|bin| {
                let middle = |k: usize, n: usize| (k as f64 + 0.5) / n as f64;
                let v = middle(bin % rows, rows);
                let d = at(&map, [middle(bin / rows, columns), v]);
                f64::from(sky.pdf(d.as_vec3())) * (PI * v).sin() * cell
            })
            .collect();
        expect_shares(&format!("the {name}'s directions"), &counts, &shares);
    }
}

/// Longitudes of meridians follow 1/`inverse_density`, and points on them the power below them.
#[test]
fn meridians_have_their_density() {
    let map = turned();
    for (name, texture) in maps() {
        let sky = MapDistribution::new(&texture, &map, &|| false).unwrap();
        for axis in 0..2 {
            // The pole and the longitude's zero in the map, as `paths::environment::distribution`
            // has them.
            let [pole, zero, quarter] = [
                [DVec3::Y, DVec3::NEG_Z, DVec3::X],
                [DVec3::X, DVec3::Y, DVec3::Z],
            ][axis]
                .map(|d| map.to_world.as_dmat3() * d);
            // Halves of the tables' columns, so that where in a column a line lies shows.
            let columns = 2 * WIDTH;
            let mut counts = vec![0; columns];
            let mut width = vec![0.0; columns];
            for [u, v] in pairs(43, 5, 2) {
                let line = sky.line(axis, u.into());
                assert!(line.pole.distance(pole) < 1e-6 && line.middle.dot(pole).abs() < 1e-6);
                let turn = line.middle.dot(quarter).atan2(line.middle.dot(zero)) / TAU;
                let column = bin(turn.rem_euclid(1.0).min(1.0 - 1e-7) as f32, columns);
                counts[column] += 1;
                width[column] = 1.0 / line.inverse_density;
                let psi = sky.quantile(&line, v.into());
                assert!(psi.abs() <= FRAC_PI_2);
                let below = sky.power_below(&line, psi);
                assert!((below - f64::from(v)).abs() < 1e-6, "{below} against {v}");
            }
            let shares: Vec<f64> = width.iter().map(|p| p * TAU / columns as f64).collect();
            let what = format!("the {name}'s meridians about axis {axis}");
            expect_shares(&what, &counts, &shares);
        }
    }
}
