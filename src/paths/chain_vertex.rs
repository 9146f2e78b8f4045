//! The smooth surfaces of a chain (`paths::chain`), as they are stored.

use crate::lanes::Real;

/// What a smooth surface does with a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bend {
    Reflected,
    Refracted,
    Straight,
}

/// A smooth surface that a chain meets.
#[derive(Clone, Copy, Debug)]
pub struct ChainVertex {
    pub triangle: u32,
    pub bend: Bend,
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
        self.bend == Bend::Reflected
    }

    pub fn is_refracted(&self) -> bool {
        self.bend == Bend::Refracted
    }
}
