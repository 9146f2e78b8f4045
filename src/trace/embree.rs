//! The safe side of `ffi/embree_shim.h`.

use super::{
    ffi,
    packet::{Coherence, Hits, Rays},
};
use glam::Vec3;
use std::{ffi::CStr, ptr::NonNull};

/// A triangle mesh to be traced; copied when an [`Accel`] is built or refitted.
#[derive(Clone, Copy, Debug)]
pub struct MeshView<'a> {
    pub positions: &'a [Vec3],
    pub triangles: &'a [[u32; 3]],
}

/// How to build an [`Accel`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AccelOptions {
    /// No ray slips through an edge that two triangles share. It costs speed: see `docs/embree.md`.
    pub robust: bool,
    /// Threads that build; 1 starts none, 0 leaves the number to Embree.
    pub threads: usize,
    /// Widest packet handed to Embree, 0 for the widest native one: lets tests go each way on any CPU.
    pub(super) width: u32,
    /// Bytes Embree may take, 0 for no limit: lets tests run out of memory.
    pub(super) memory_limit: u64,
}

impl Default for AccelOptions {
    fn default() -> Self {
        Self {
            robust: true,
            threads: 1,
            width: 0,
            memory_limit: 0,
        }
    }
}

impl AccelOptions {
    /// Options for `threads` build threads, robust or not.
    pub fn new(robust: bool, threads: usize) -> Self {
        Self {
            robust,
            threads,
            ..Self::default()
        }
    }
}

/// Why there is no [`Accel`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TraceError {
    #[error("Embree ran out of memory: {0}")]
    OutOfMemory(String),
    #[error("this CPU is too old for Embree: {0}")]
    UnsupportedCpu(String),
    #[error("Embree failed with code {code}: {message}")]
    Embree { code: i32, message: String },
    #[error("mesh {mesh}: triangle {triangle} names vertex {vertex}, but there are {vertices}")]
    Index {
        mesh: usize,
        triangle: usize,
        vertex: u32,
        vertices: usize,
    },
    #[error("mesh {mesh}: vertex {vertex} is not finite")]
    NonFinite { mesh: usize, vertex: usize },
    #[error("mesh {mesh}: {count} vertices or triangles are more than 32 bits count")]
    TooLarge { mesh: usize, count: usize },
    #[error("a refit must keep the number of meshes, vertices and triangles: {0}")]
    Topology(String),
}

/// Triangles in an order that rays find fast. Built by Embree, which keeps copies of the meshes.
pub struct Accel {
    pub(super) raw: NonNull<ffi::WarpathAccel>,
    /// Vertices and triangles of each mesh: what a refit must match.
    counts: Vec<(usize, usize)>,
}

// SAFETY: an Embree scene has no tie to the thread that made it.
unsafe impl Send for Accel {}
// SAFETY: `&Accel` only allows queries, which Embree lets any number of threads run on a committed scene;
// what changes the scene (`refit`, `drop`) takes `&mut`.
unsafe impl Sync for Accel {}

impl std::fmt::Debug for Accel {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "Accel({} meshes)", self.counts.len())
    }
}

impl Accel {
    /// Builds over `meshes`; hits name them by their index here.
    pub fn build(meshes: &[MeshView], options: AccelOptions) -> Result<Accel, TraceError> {
        let raw_meshes = raw_meshes(meshes)?;
        let raw_options = ffi::WarpathOptions {
            robust: options.robust.into(),
            threads: options.threads.try_into().unwrap_or(0),
            width: options.width,
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
        // SAFETY: the pointers in `raw_meshes` come from live slices of the lengths beside them, whose
        // triangle indices `raw_meshes` has checked; all are only read during the call.
        let raw = unsafe {
            ffi::warpath_accel_new(raw_meshes.as_ptr(), mesh_count, &raw_options, &mut error)
        };
        Ok(Accel {
            raw: NonNull::new(raw).ok_or_else(|| trace_error(&error))?,
            counts: meshes.iter().map(counts).collect(),
        })
    }

    /// Follows moved vertices; `meshes` must be those of [`Accel::build`] but for their positions.
    ///
    /// The first refit builds the meshes anew, later ones only move boxes: some fifteen times faster than
    /// building, and slower to trace the farther vertices went. After an error the accel holds no useful
    /// scene: drop it or refit it again.
    pub fn refit(&mut self, meshes: &[MeshView]) -> Result<(), TraceError> {
        if meshes.len() != self.counts.len() {
            let (old, new) = (self.counts.len(), meshes.len());
            return Err(TraceError::Topology(format!("{old} meshes became {new}")));
        }
        for (i, (mesh, &old)) in meshes.iter().zip(&self.counts).enumerate() {
            let new = counts(mesh);
            if new != old {
                return Err(TraceError::Topology(format!(
                    "mesh {i} had {} vertices and {} triangles and now has {} and {}",
                    old.0, old.1, new.0, new.1
                )));
            }
        }
        let raw_meshes = raw_meshes(meshes)?;
        let mut error = no_error();
        // SAFETY: `raw` is alive until drop and `&mut self` keeps queries away; `raw_meshes` holds as many
        // meshes, of as many vertices, as the scene was built with.
        let code =
            unsafe { ffi::warpath_accel_refit(self.raw.as_ptr(), raw_meshes.as_ptr(), &mut error) };
        if code == 0 {
            Ok(())
        } else {
            Err(trace_error(&error))
        }
    }

    /// Finds where each active ray first meets a triangle. `N` is 1, 4, 8 or 16; bit `i` of `active` is
    /// lane `i`. Inactive lanes of `hits` stay as they are.
    #[inline]
    pub fn intersect<const N: usize>(
        &self,
        rays: &Rays<N>,
        active: u32,
        hits: &mut Hits<N>,
        coherence: Coherence,
    ) {
        const {
            assert!(
                matches!(N, 1 | 4 | 8 | 16),
                "Embree has packets of 1, 4, 8 and 16"
            )
        };
        let call = match N {
            1 => ffi::warpath_intersect1,
            4 => ffi::warpath_intersect4,
            8 => ffi::warpath_intersect8,
            _ => ffi::warpath_intersect16,
        };
        let coherent = i32::from(coherence == Coherence::Coherent);
        let rays = std::ptr::from_ref(rays).cast::<f32>();
        let tuv = std::ptr::from_mut(hits).cast::<f32>();
        // SAFETY: `raw` is alive until drop. `Rays<N>` and `Hits<N>` are `repr(C)` arrays of N 4-byte
        // numbers in the order the shim documents, so the ids begin after 3N floats of the same object;
        // `hits` is borrowed exclusively, and the shim writes nothing but those 5N numbers.
        unsafe {
            let ids = tuv.add(3 * N).cast::<u32>();
            call(self.raw.as_ptr(), rays, active, coherent, tuv, ids);
        }
    }

    /// Whether each active ray meets any triangle, as one bit a lane. `N` is 1, 4, 8 or 16.
    #[inline]
    pub fn occluded<const N: usize>(
        &self,
        rays: &Rays<N>,
        active: u32,
        coherence: Coherence,
    ) -> u32 {
        const {
            assert!(
                matches!(N, 1 | 4 | 8 | 16),
                "Embree has packets of 1, 4, 8 and 16"
            )
        };
        let call = match N {
            1 => ffi::warpath_occluded1,
            4 => ffi::warpath_occluded4,
            8 => ffi::warpath_occluded8,
            _ => ffi::warpath_occluded16,
        };
        let coherent = i32::from(coherence == Coherence::Coherent);
        let rays = std::ptr::from_ref(rays).cast::<f32>();
        // SAFETY: `raw` is alive until drop, and `Rays<N>` is the eight arrays of N floats the shim reads.
        unsafe { call(self.raw.as_ptr(), rays, active, coherent) }
    }

    /// The widest packet this CPU traces without being split: 1, 4, 8 or 16.
    pub fn native_width(&self) -> usize {
        // SAFETY: `raw` is alive until drop.
        unsafe { ffi::warpath_accel_native_width(self.raw.as_ptr()) as usize }
    }

    /// Major, minor and patch version of the Embree library that is loaded.
    pub fn embree_version(&self) -> [u32; 3] {
        // SAFETY: `raw` is alive until drop.
        let v = unsafe { ffi::warpath_accel_version(self.raw.as_ptr()) };
        [v / 10_000, v / 100 % 100, v % 100]
    }
}

impl Drop for Accel {
    fn drop(&mut self) {
        // SAFETY: `raw` came from `warpath_accel_new` and is freed here only.
        unsafe { ffi::warpath_accel_free(self.raw.as_ptr()) }
    }
}

fn counts(mesh: &MeshView) -> (usize, usize) {
    (mesh.positions.len(), mesh.triangles.len())
}

/// The meshes as the shim takes them, once Embree can be trusted with them.
fn raw_meshes(meshes: &[MeshView]) -> Result<Vec<ffi::WarpathMesh>, TraceError> {
    let raw = |(mesh, view): (usize, &MeshView)| {
        let small =
            |count: usize| u32::try_from(count).map_err(|_| TraceError::TooLarge { mesh, count });
        let vertex_count = small(view.positions.len())?;
        let triangle_count = small(view.triangles.len())?;
        if let Some(vertex) = view.positions.iter().position(|p| !p.is_finite()) {
            return Err(TraceError::NonFinite { mesh, vertex });
        }
        for (triangle, corners) in view.triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&v| v >= vertex_count) {
                let vertices = view.positions.len();
                return Err(TraceError::Index {
                    mesh,
                    triangle,
                    vertex,
                    vertices,
                });
            }
        }
        Ok(ffi::WarpathMesh {
            positions: view.positions.as_ptr().cast(),
            triangles: view.triangles.as_ptr().cast(),
            vertex_count,
            triangle_count,
        })
    };
    meshes.iter().enumerate().map(raw).collect()
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
