//! The piece of a border that its crossing with a row or a column stands for.
//!
//! Rows are one step apart. A straight border that goes on is covered once, without gaps, by pieces
//! about its crossings that reach half a step to both sides, across the rows. Before a filter that
//! jumps from pixel to pixel, such as a box, the share of a pixel in a border is then its length there.
//! With points in place of pieces it would be a number of crossings, and off by a good part of one.
//!
//! What is spread so is the place alone, along the tangent and evenly to both sides. In the mean over
//! all shifts of the lattice that is the filter of the film, smoothed along the border by one step h:
//! right where the border and what jumps go on, and off by the second order, h²/24 times a second
//! derivative, where they do not. Weighted as rows and columns are, the pieces lie off a border of
//! curvature κ by h²κ/24 in all.

/// No piece reaches further than this along its row or column, in pixels: those that cross flatly
/// have hardly any weight.
const LONGEST: f64 = 1.0;

/// Half of the piece, in pixels, with ∇F on the film where the border crosses a line along `axis`;
/// `step` is from line to line.
pub fn half(gradient: [f64; 2], axis: usize, step: f64) -> [f64; 2] {
    let across = 0.5 * step;
    let slope = -gradient[1 - axis] / gradient[axis];
    let mut half = [across; 2];
    half[axis] = (slope * across).clamp(-LONGEST, LONGEST);
    half
}
