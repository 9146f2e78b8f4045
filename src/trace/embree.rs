//! The safe side of `ffi/embree_shim.h`.

use super::{
    AccelOptions, Coherence, EmbreeIsa, EmbreeQuality, Hits, MeshView, Rays, TraceError, ffi,
};
use std::{ffi::CStr, ptr::NonNull};

/// A scene of Embree's, which keeps copies of the meshes.
pub struct EmbreeScene {
    pub(super) raw: NonNull<ffi::WarpathAccel>,
}

// SAFETY: an Embree scene has no tie to the thread that made it.
unsafe impl Send for EmbreeScene {}
// SAFETY: `&EmbreeScene` only allows queries, which Embree lets any number of threads run on a
// committed scene; what changes the scene (`refit`, `drop`) takes `&mut`.
unsafe impl Sync for EmbreeScene {}

impl std::fmt::Debug for EmbreeScene {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "EmbreeScene({:?})", self.raw)
    }
}

impl EmbreeScene {
    /// Builds over meshes that [`super::Accel`] has checked.
    pub fn build(
        meshes: &[MeshView],
        options: AccelOptions,
        isa: EmbreeIsa,
        quality: EmbreeQuality,
    ) -> Result<Self, TraceError> {
        let raw_meshes = raw_meshes(meshes);
        let raw_options = ffi::WarpathOptions {
            robust: options.robust.into(),
            quality: match quality {
                EmbreeQuality::Low => 0,
                EmbreeQuality::Medium => 1,
                EmbreeQuality::High => 2,
            },
            threads: options.threads.try_into().unwrap_or(0),
            width: options.width,
            isa: isa_name(isa),
            memory_limit: options.memory_limit,
        };
        let mesh_count = raw_meshes
            .len()
            .try_into()
            .map_err(|_| TraceError::TooLarge {
                mesh: meshes.len(),
                count: meshes.len(),
            })?;
        let mut error = no_error();
        // SAFETY: the pointers in `raw_meshes` come from live slices of the lengths beside them,
        // whose triangle indices `Accel` has checked; all are only read during the call.
        let raw = unsafe {
            ffi::warpath_accel_new(raw_meshes.as_ptr(), mesh_count, &raw_options, &mut error)
        };
        Ok(Self {
            raw: NonNull::new(raw).ok_or_else(|| trace_error(&error))?,
        })
    }

    /// Follows moved vertices of the meshes it was built with.
    pub fn refit(&mut self, meshes: &[MeshView]) -> Result<(), TraceError> {
        let raw_meshes = raw_meshes(meshes);
        let mut error = no_error();
        // SAFETY: `raw` is alive until drop and `&mut self` keeps queries away; `raw_meshes` holds
        // as many meshes, of as many vertices, as the scene was built with: `Accel` has compared
        // them.
        let code =
            unsafe { ffi::warpath_accel_refit(self.raw.as_ptr(), raw_meshes.as_ptr(), &mut error) };
        if code == 0 {
            Ok(())
        } else {
            Err(trace_error(&error))
        }
    }

    /// First hits, as [`super::Accel::intersect`] promises them.
    #[inline]
    pub fn intersect<const N: usize>(
        &self,
        rays: &Rays<N>,
        active: u32,
        hits: &mut Hits<N>,
        coherence: Coherence,
    ) {
        let call = match N {
            1 => ffi::warpath_intersect1,
            4 => ffi::warpath_intersect4,
            8 => ffi::warpath_intersect8,
            _ => ffi::warpath_intersect16,
        };
        let coherent = i32::from(coherence == Coherence::Coherent);
        let rays = std::ptr::from_ref(rays).cast::<f32>();
        let tuv = std::ptr::from_mut(hits).cast::<f32>();
        // SAFETY: `raw` is alive until drop. `Rays<N>` and `Hits<N>` are `repr(C)` arrays of N
        // 4-byte numbers in the order the shim documents, so the ids begin after 3N floats of the
        // same object; `hits` is borrowed exclusively, and the shim writes nothing but those 5N
        // numbers.
        unsafe {
            let ids = tuv.add(3 * N).cast::<u32>();
            call(self.raw.as_ptr(), rays, active, coherent, tuv, ids);
        }
    }

    /// Occlusion, one bit a lane.
    #[inline]
    pub fn occluded<const N: usize>(
        &self,
        rays: &Rays<N>,
        active: u32,
        coherence: Coherence,
    ) -> u32 {
        let call = match N {
            1 => ffi::warpath_occluded1,
            4 => ffi::warpath_occluded4,
            8 => ffi::warpath_occluded8,
            _ => ffi::warpath_occluded16,
        };
        let coherent = i32::from(coherence == Coherence::Coherent);
        let rays = std::ptr::from_ref(rays).cast::<f32>();
        // SAFETY: `raw` is alive until drop, and `Rays<N>` is the eight arrays of N floats the shim
        // reads.
        unsafe { call(self.raw.as_ptr(), rays, active, coherent) }
    }

    /// The widest packet this CPU traces without being split: 1, 4, 8 or 16.
    pub fn native_width(&self) -> usize {
        // SAFETY: `raw` is alive until drop.
        unsafe { ffi::warpath_accel_native_width(self.raw.as_ptr()) as usize }
    }

    /// The version of the library that is loaded.
    pub fn version(&self) -> String {
        // SAFETY: `raw` is alive until drop.
        let v = unsafe { ffi::warpath_accel_version(self.raw.as_ptr()) };
        format!("{}.{}.{}", v / 10_000, v / 100 % 100, v % 100)
    }

    /// Bytes Embree has taken and not given back.
    pub fn memory_bytes(&self) -> u64 {
        // SAFETY: `raw` is alive until drop.
        unsafe { ffi::warpath_accel_memory(self.raw.as_ptr()) }
    }
}

impl Drop for EmbreeScene {
    fn drop(&mut self) {
        // SAFETY: `raw` came from `warpath_accel_new` and is freed here only.
        unsafe { ffi::warpath_accel_free(self.raw.as_ptr()) }
    }
}

/// The meshes as the shim takes them.
fn raw_meshes(meshes: &[MeshView]) -> Vec<ffi::WarpathMesh> {
    let raw = |view: &MeshView| ffi::WarpathMesh {
        positions: view.positions.as_ptr().cast(),
        triangles: view.triangles.as_ptr().cast(),
        vertex_count: view.positions.len() as u32,
        triangle_count: view.triangles.len() as u32,
    };
    meshes.iter().map(raw).collect()
}

/// Embree's name of an instruction set, ended by a zero; empty for the best.
fn isa_name(isa: EmbreeIsa) -> [std::ffi::c_char; 16] {
    let mut name = [0; 16];
    let text: &[u8] = match isa {
        EmbreeIsa::Best => b"",
        EmbreeIsa::Sse42 => b"sse4.2",
    };
    for (to, from) in name.iter_mut().zip(text) {
        *to = *from as std::ffi::c_char;
    }
    name
}

fn no_error() -> ffi::WarpathError {
    ffi::WarpathError {
        code: 0,
        message: [0; 252],
    }
}

fn trace_error(error: &ffi::WarpathError) -> TraceError {
    // SAFETY: the shim ends the message with a zero, within its 252 bytes.
    let message = unsafe { CStr::from_ptr(error.message.as_ptr()) };
    let message = message.to_string_lossy().into_owned();
    match error.code {
        4 => TraceError::OutOfMemory(message),
        5 => TraceError::UnsupportedCpu(message),
        code => TraceError::Embree { code, message },
    }
}
