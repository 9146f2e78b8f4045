//! The 4×4 matrices of shapes: what moves with them, and how.

use glam::{DAffine3, DMat3, DMat4, DVec3};

/// The 16 numbers of a matrix, row by row.
pub(super) fn matrix_rows(matrix: DAffine3) -> [f64; 16] {
    DMat4::from(matrix).transpose().to_cols_array()
}

/// The first three rows of 16 numbers, as what they do to a point (x, y, z, 1).
pub(super) fn from_matrix_rows(rows: &[f64]) -> DAffine3 {
    let column = |column: usize| {
        let number = |row: usize| rows.get(4 * row + column).copied().unwrap_or_default();
        DVec3::new(number(0), number(1), number(2))
    };
    DAffine3 {
        matrix3: DMat3::from_cols(column(0), column(1), column(2)),
        translation: column(3),
    }
}

/// The velocity field over the world that a change of the matrix makes: x ↦ Ṁ M⁻¹ x.
pub(super) fn velocity(change: DAffine3, present: DAffine3) -> DAffine3 {
    let inverse = present.inverse();
    DAffine3 {
        matrix3: change.matrix3 * inverse.matrix3,
        translation: change.matrix3 * inverse.translation + change.translation,
    }
}

/// How a unit normal changes where the world's velocity has this gradient: it goes with the inverse
/// transpose, and stays a unit vector.
pub(super) fn normal_change(gradient: DMat3, n: DVec3) -> DVec3 {
    let change = -(gradient.transpose() * n);
    change - n * n.dot(change)
}

/// The cotangent of the 16 numbers, summed over points and normals with theirs.
pub(super) struct MatrixBar {
    linear: DMat3,
    translation: DVec3,
}

impl MatrixBar {
    pub fn zero() -> Self {
        Self {
            linear: DMat3::ZERO,
            translation: DVec3::ZERO,
        }
    }

    /// Of a point in the world.
    pub fn add_point(&mut self, present: DAffine3, x: DVec3, bar: DVec3) {
        let own = present.inverse().transform_point3(x);
        self.linear += outer(bar, own);
        self.translation += bar;
    }

    /// Of a unit normal.
    pub fn add_normal(&mut self, present: DAffine3, n: DVec3, bar: DVec3) {
        let across = bar - n * n.dot(bar);
        self.linear -= outer(n, present.matrix3.inverse() * across);
    }

    /// Row by row; the last row does not count.
    pub fn rows(&self) -> [f64; 16] {
        let mut rows = [0.0; 16];
        for row in 0..3 {
            for column in 0..3 {
                rows[4 * row + column] = self.linear.col(column)[row];
            }
            rows[4 * row + 3] = self.translation[row];
        }
        rows
    }
}

/// a·bᵀ
fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}
