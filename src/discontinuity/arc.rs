//! The arc of directions between two rays from one origin.

use glam::DVec3;

/// The arc of directions between two rays from one origin.
#[derive(Clone, Copy, Debug)]
pub struct Arc {
    pub origin: DVec3,
    pub a: DVec3,
    pub b: DVec3,
}

impl Arc {
    /// The same arc from its other end.
    pub fn reversed(self) -> Self {
        Self {
            origin: self.origin,
            a: self.b,
            b: self.a,
        }
    }

    /// Across its plane, a × b.
    pub fn normal(&self) -> DVec3 {
        normal_between(self.a, self.b)
    }

    /// The direction at parameter `s`.
    pub fn direction(&self, s: f64) -> DVec3 {
        self.a * (1.0 - s) + self.b * s
    }
}

/// a × b as (a + b)/2 × (b − a): where directions hardly differ their product is all rounding, and
/// their difference is exact. To the last bit it is −(b × a).
pub fn normal_between(a: DVec3, b: DVec3) -> DVec3 {
    (0.5 * (a + b)).cross(b - a)
}
