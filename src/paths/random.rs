//! Random numbers from counters: Owen-scrambled Sobol points in Morton order over a tile's lattice.
//!
//! Every number is a pure function of (seed, stream, lattice point, dimension). Neighbouring
//! lattice points get neighbouring indices of a (0,2)-sequence, so that any aligned block of 2^k ×
//! 2^k film samples has well spread light and bounce samples (Ahmed & Wonka 2020, "Screen-Space
//! Blue-Noise Diffusion of Monte Carlo Sampling Error via Hierarchical Ordering of Pixels"). The
//! scrambling is Burley's hash ("Practical Hash-based Owen Scrambling", 2020) and every pair of
//! dimensions shuffles the index anew.

use crate::lanes::{LANES, Lane};

type U = [u32; LANES];

/// A stream of point sets: one a tile and group.
#[derive(Clone, Copy, Debug)]
pub struct Stream(u32);

impl Stream {
    /// `parts` name the stream; different parts give independent streams.
    pub fn new(seed: u64, parts: [u32; 2]) -> Self {
        let mut h = mix(seed as u32 ^ 0x9e37_79b9);
        h = mix(h ^ (seed >> 32) as u32);
        h = mix(h.wrapping_add(parts[0].wrapping_mul(0x85eb_ca6b)));
        Self(mix(h ^ parts[1].wrapping_mul(0xc2b2_ae35)))
    }

    /// A stream of its own for what `words` name (`paths::dimensions`).
    pub(super) fn child(&self, words: [u32; 5]) -> Self {
        let mix_in =
            |h: u32, word: u32| mix(h ^ mix(word.wrapping_mul(0x9e37_79b1).wrapping_add(1)));
        Self(words.into_iter().fold(mix(self.0), mix_in))
    }

    /// A uniform number in [0, 1) for what `words` name.
    pub(super) fn keyed(&self, words: [u32; 5]) -> f32 {
        to_unit(self.child(words).0)
    }

    /// Two-dimensional points of the pair `dimension` at the given indices, in [0, 1)².
    pub fn pair(&self, index: &U, dimension: u32) -> (Lane, Lane) {
        let key = mix(self.0
            ^ mix(dimension
                .wrapping_mul(0x9e37_79b1)
                .wrapping_add(0x7f4a_7c15)));
        let (k0, k1, k2) = (mix(key), mix(key ^ 0x68bc_21eb), mix(key ^ 0x02e5_be93));
        let (mut x, mut y) = ([0.0; LANES], [0.0; LANES]);
        for lane in 0..LANES {
            let i = owen(index[lane].reverse_bits(), k0).reverse_bits();
            x[lane] = to_unit(owen(i, k1).reverse_bits());
            y[lane] = to_unit(owen(pascal(i), k2).reverse_bits());
        }
        (Lane::new(x), Lane::new(y))
    }
}

/// Interleaves the bits of a lattice point: the Morton index.
pub fn morton(column: u32, row: u32) -> u32 {
    spread(column) | spread(row) << 1
}

fn spread(x: u32) -> u32 {
    let mut x = x & 0xffff;
    x = (x | x << 8) & 0x00ff_00ff;
    x = (x | x << 4) & 0x0f0f_0f0f;
    x = (x | x << 2) & 0x3333_3333;
    (x | x << 1) & 0x5555_5555
}

/// Owen scrambling of a number whose bits are already reversed (Laine–Karras, constants by
/// Vegdahl).
#[inline(always)]
fn owen(mut x: u32, seed: u32) -> u32 {
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul((seed >> 16) | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x
}

/// The generator matrix of Sobol's second dimension, bit order reversed on output: Pascal's
/// triangle modulo 2, which is a tensor power of [[1, 1], [0, 1]] and so takes five steps.
#[inline(always)]
fn pascal(mut i: u32) -> u32 {
    i ^= (i & 0xaaaa_aaaa) >> 1;
    i ^= (i & 0xcccc_cccc) >> 2;
    i ^= (i & 0xf0f0_f0f0) >> 4;
    i ^= (i & 0xff00_ff00) >> 8;
    i ^ (i & 0xffff_0000) >> 16
}

/// A 32-bit mixer (lowbias32, found by Wellons' hash prospector).
#[inline(always)]
fn mix(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7feb_352d);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846c_a68b);
    x ^ x >> 16
}

#[inline(always)]
fn to_unit(x: u32) -> f32 {
    (x >> 8) as f32 * (1.0 / 16_777_216.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Any 2^k consecutive aligned points hit every elementary interval once: the (0, k, 2)-net
    /// property.
    #[test]
    fn pairs_are_nets() {
        let stream = Stream::new(7, [3, 5]);
        for dimension in 0..4 {
            for k in 1..=8u32 {
                let n = 1usize << k;
                let mut points = Vec::new();
                for block in 0..n.div_ceil(LANES) {
                    let index = std::array::from_fn(|l| (n + block * LANES + l) as u32);
                    let (x, y) = stream.pair(&index, dimension);
                    points.extend(x.to_array().into_iter().zip(y.to_array()));
                }
                points.truncate(n);
                for a in 0..=k {
                    let (nx, ny) = (1usize << a, n >> a);
                    let mut hit = vec![0; n];
                    for &(x, y) in &points {
                        hit[(x * nx as f32) as usize * ny + (y * ny as f32) as usize] += 1;
                    }
                    assert!(
                        hit.iter().all(|&h| h == 1),
                        "k={k} a={a} dimension={dimension}"
                    );
                }
            }
        }
    }
}
