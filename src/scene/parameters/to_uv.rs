//! The transform of texture coordinates as six numbers.

use glam::Affine2;

/// The two rows of a 2×3 matrix, one after the other.
pub(super) fn rows(to_uv: Affine2) -> [f32; 6] {
    let (x, y, t) = (to_uv.x_axis, to_uv.y_axis, to_uv.translation);
    [x.x, y.x, t.x, x.y, y.y, t.y]
}

/// The transform of [`rows`].
pub(super) fn from_rows([a, b, c, d, e, f]: [f32; 6]) -> Affine2 {
    Affine2::from_cols_array(&[a, d, b, e, c, f])
}
