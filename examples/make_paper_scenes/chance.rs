//! Numbers that look random and are the same everywhere: no state, one number for each pair of
//! keys.

/// In 0…1, from what is numbered and which of its properties is asked for.
pub fn chance(number: u64, property: u64) -> f64 {
    // The finaliser of SplitMix64.
    let mut x = number
        .wrapping_mul(64)
        .wrapping_add(property)
        .wrapping_add(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 11) as f64 / (1u64 << 53) as f64
}

/// In `low`…`high`.
pub fn between(low: f64, high: f64, number: u64, property: u64) -> f64 {
    low + (high - low) * chance(number, property)
}
