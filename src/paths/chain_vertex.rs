//! The smooth surfaces of a chain (`paths::chain`), as they are stored.

use crate::lanes::Real;

/// What a smooth surface does with a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bend {
    Reflected,
    Refracted,
    Straight,
}

/// What becomes of a ray at a surface: which of the materials that this is made of it meets, and
/// what that does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turn {
    /// Its number among them; 0 where there is one.
    pub part: u16,
    pub bend: Bend,
}

/// A smooth surface that a chain meets.
#[derive(Clone, Copy, Debug)]
pub struct ChainVertex {
    pub triangle: u32,
    pub turn: Turn,
    /// Whether the ray comes from the side to which the shading normal points.
    pub from_front: bool,
}

impl ChainVertex {
    pub fn facing(&self) -> f64 {
        if self.from_front { 1.0 } else { -1.0 }
    }

    /// Index beyond the surface over that on the ray's side, from inside over outside.
    pub fn ratio<F: Real>(&self, eta: F) -> F {
        if self.from_front {
            eta
        } else {
            F::splat(1.0) / eta
        }
    }

    pub fn is_reflected(&self) -> bool {
        self.turn.bend == Bend::Reflected
    }

    pub fn is_refracted(&self) -> bool {
        self.turn.bend == Bend::Refracted
    }
}
