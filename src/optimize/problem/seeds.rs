//! Seeds: every image of a run has random numbers of its own, which depend on nothing but what it
//! is for.

/// Of the targets.
pub const TRUTH: u64 = 1;
/// Of the image in the loss.
pub const LOSS: u64 = 2;
/// Of the derivative.
pub const DERIVATIVE: u64 = 3;
/// Of the pictures that are looked at.
pub const PICTURE: u64 = 4;
/// Of the order of views.
pub const ORDER: u64 = 5;
/// Of what the views see of textures.
pub const SEEN: u64 = 6;

/// A seed for what three numbers name (SplitMix64 over each in turn).
pub fn of(seed: u64, words: [u64; 3]) -> u64 {
    words.iter().fold(mix(seed), |state, &word| {
        mix(state ^ mix(word.wrapping_add(1)))
    })
}

fn mix(seed: u64) -> u64 {
    let mut z = seed.wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}
