//! The number types kernels are written over: one number or many side by side, with or without a
//! tangent.

mod dual;
mod packets;
mod real;
mod scalar;
mod vec3;

pub use dual::Dual;
pub use packets::{F32x8, F32x16, LANES, Lane, PacketMask};
pub use real::{Mask, Number, Real};
pub use vec3::V3;
