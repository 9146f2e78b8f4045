//! The diverging colour map of gradient pictures.

/// ColorBrewer's RdBu, blue first: told apart by colour-blind readers, white at zero.
const ANCHORS: [[u8; 3]; 11] = [
    [5, 48, 97],
    [33, 102, 172],
    [67, 147, 195],
    [146, 197, 222],
    [209, 229, 240],
    [247, 247, 247],
    [253, 219, 199],
    [244, 165, 130],
    [214, 96, 77],
    [178, 24, 43],
    [103, 0, 31],
];

/// The colour of `t` in −1…1: blue below zero, near-white at it, red above.
pub fn diverging(t: f32) -> [u8; 3] {
    let last = ANCHORS.len() - 1;
    let at = (t.clamp(-1.0, 1.0) * 0.5 + 0.5) * last as f32;
    // A NaN casts to 0.
    let low = (at as usize).min(last - 1);
    let part = at - low as f32;
    std::array::from_fn(|c| {
        let (a, b) = (ANCHORS[low][c] as f32, ANCHORS[low + 1][c] as f32);
        (a + (b - a) * part).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ends_and_middle() {
        assert_eq!(diverging(-2.0), ANCHORS[0]);
        assert_eq!(diverging(0.0), ANCHORS[5]);
        assert_eq!(diverging(1.0), ANCHORS[10]);
    }
}
