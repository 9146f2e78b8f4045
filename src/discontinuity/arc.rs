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

    /// The direction at parameter `s`.
    pub fn direction(&self, s: f64) -> DVec3 {
        self.a * (1.0 - s) + self.b * s
    }
}
