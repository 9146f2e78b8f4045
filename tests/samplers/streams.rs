//! Random numbers, and the direction of diffuse light.

use super::*;
use warpath::lanes::Lane;
use warpath::paths::dimensions::Single;
use warpath::paths::rays::lane_of;
use warpath::paths::surface::lobe_sample::cosine_direction;

#[test]
fn pairs_fill_the_square() {
    for (dimension, index) in [(0, 0), (1, 5), (6, 77), (3, 4095)] {
        let mut counts = vec![0; 32 * 32];
        for [x, y] in pairs(11, dimension, index) {
            counts[bin(x, 32) * 32 + bin(y, 32)] += 1;
        }
        uniform(&format!("pair {dimension} at {index}"), &counts);
    }
}

/// Dimensions, neighbours and seeds know nothing of each other.
#[test]
fn streams_are_independent() {
    let joint = |what: &str,
                 a: &mut dyn Iterator<Item = [f32; 2]>,
                 b: &mut dyn Iterator<Item = [f32; 2]>| {
        let mut counts = vec![0; 8 * 8 * 8 * 8];
        for ([x, y], [z, w]) in a.zip(b) {
            counts[((bin(x, 8) * 8 + bin(y, 8)) * 8 + bin(z, 8)) * 8 + bin(w, 8)] += 1;
        }
        uniform(what, &counts);
    };
    joint("two dimensions", &mut pairs(3, 0, 9), &mut pairs(3, 1, 9));
    joint("two vertices", &mut pairs(3, 2, 9), &mut pairs(3, 6, 9));
    joint("two seeds", &mut pairs(3, 0, 9), &mut pairs(4, 0, 9));
    joint(
        "seeds that differ in their upper half",
        &mut pairs(3, 0, 9),
        &mut pairs(3 + (1 << 32), 0, 9),
    );
    joint(
        "neighbouring streams",
        &mut pairs(3, 0, 9),
        &mut pairs(3, 0, 9).skip(1),
    );
    let mut counts = vec![0; 16 * 16];
    for i in 0..SAMPLES as u32 {
        let stream = Stream::new(7, [i, 1]);
        counts[bin(stream.single(Single::FilmEdge, [0; 3]), 16) * 16
            + bin(stream.single(Single::FilmEdge, [1, 0, 0]), 16)] += 1;
    }
    uniform("a tile's shift", &counts);
}

/// cos θ/π over the hemisphere: sin²θ and φ are uniform.
#[test]
fn bounces_follow_the_cosine() {
    let mut counts = vec![0; 24 * 24];
    for [u, v] in pairs(5, 2, 3) {
        let [x, y, z] = lane_of(cosine_direction(Lane::splat(u), Lane::splat(v)), 0).to_array();
        assert!((x * x + y * y + z * z - 1.0).abs() < 1e-5 && z >= 0.0);
        let turn = y.atan2(x) / std::f32::consts::TAU;
        let turn = if turn < 0.0 { turn + 1.0 } else { turn };
        let sin_squared = (x * x + y * y).min(1.0 - 1e-7);
        counts[bin(sin_squared, 24) * 24 + bin(turn.min(1.0 - 1e-7), 24)] += 1;
    }
    uniform("bounces", &counts);
}
