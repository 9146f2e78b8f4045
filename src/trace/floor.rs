//! What Embree alone costs: a bare C loop over packets already in its layout, for benchmarks.

use super::accel::Library;
use super::{Accel, Coherence, Rays, ffi};

/// What the bare loop measured.
#[derive(Clone, Copy, Debug)]
pub struct Floor {
    /// Wall time of one pass over the rays.
    pub seconds: f64,
    /// Rays that met a triangle, so that the work can be compared.
    pub hits: u64,
}

/// Times one pass of the bare loop over `packets`, all lanes active, in the widest native packets.
/// `None` if it is not Embree that traces.
pub fn floor<const N: usize>(
    accel: &Accel,
    packets: &[Rays<N>],
    coherence: Coherence,
) -> Option<Floor> {
    const {
        assert!(
            matches!(N, 1 | 4 | 8 | 16),
            "Embree has packets of 1, 4, 8 and 16"
        )
    };
    // The pattern always fits in a build with Embree alone.
    #[allow(irrefutable_let_patterns)]
    let Library::Embree(scene) = &accel.scene else {
        return None;
    };
    // A packet of one ray is padded to 64 bytes, which the loop steps over as a stride.
    let stride = size_of::<Rays<N>>() / size_of::<f32>();
    let coherent = i32::from(coherence == Coherence::Coherent);
    let mut hits = 0;
    // SAFETY: the accel is alive; `packets` is `packets.len()` times `stride` floats of which the
    // first 8N of each are the rays, only read; the widths asked for are those the shim has.
    let seconds = unsafe {
        ffi::warpath_floor(
            scene.raw.as_ptr(),
            packets.as_ptr().cast(),
            N as u32,
            stride as u32,
            packets.len() as u32,
            coherent,
            &mut hits,
        )
    };
    Some(Floor { seconds, hits })
}
