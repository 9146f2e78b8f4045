//! The one door to ray queries: [`Accel`], over whichever library is asked for.

#[cfg(feature = "embree")]
use super::embree::EmbreeScene;
#[cfg(feature = "obvhs")]
use super::obvhs::ObvhsScene;
use super::{Backend, Coherence, Hits, Rays};
use glam::Vec3;

#[cfg(not(any(feature = "embree", feature = "obvhs")))]
compile_error!("nothing traces rays: build with the feature embree, obvhs or both");

/// A triangle mesh to be traced; copied when an [`Accel`] is built or refitted.
#[derive(Clone, Copy, Debug)]
pub struct MeshView<'a> {
    pub positions: &'a [Vec3],
    pub triangles: &'a [[u32; 3]],
}

/// How to build an [`Accel`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AccelOptions {
    /// What builds it and traces.
    pub backend: Backend,
    /// No ray slips through an edge that two triangles share. It costs speed: see `docs/embree.md` and
    /// `docs/backends.md`.
    pub robust: bool,
    /// Threads that build; 1 starts none, 0 leaves the number to the library.
    pub threads: usize,
    /// Widest packet handed to Embree, 0 for the widest native one: lets tests go each way on any CPU.
    pub(super) width: u32,
    /// Bytes Embree may take, 0 for no limit: lets tests run out of memory.
    pub(super) memory_limit: u64,
}

impl Default for AccelOptions {
    fn default() -> Self {
        Self {
            backend: Backend::default(),
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

    /// The same on another backend.
    pub fn on(self, backend: Backend) -> Self {
        Self { backend, ..self }
    }
}

/// Why there is no [`Accel`].
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum TraceError {
    #[error("{0}")]
    NotBuiltIn(&'static str),
    #[error("Embree ran out of memory: {0}")]
    OutOfMemory(String),
    #[error("this CPU is too old for Embree: {0}")]
    UnsupportedCpu(String),
    #[error("Embree failed with code {code}: {message}")]
    Embree { code: i32, message: String },
    #[error("no threads to build with: {0}")]
    Threads(String),
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

/// Triangles in an order that rays find fast; keeps copies of the meshes.
#[derive(Debug)]
pub struct Accel {
    pub(super) scene: Library,
    backend: Backend,
    /// Vertices and triangles of each mesh: what a refit must match.
    counts: Vec<(usize, usize)>,
}

/// Who traces. One predictable branch a packet, against thousands of cycles of traversal.
#[derive(Debug)]
pub(super) enum Library {
    #[cfg(feature = "embree")]
    Embree(EmbreeScene),
    #[cfg(feature = "obvhs")]
    Obvhs(Box<ObvhsScene>),
}

impl Accel {
    /// Builds over `meshes`; hits name them by their index here.
    pub fn build(meshes: &[MeshView], options: AccelOptions) -> Result<Accel, TraceError> {
        options.backend.require().map_err(TraceError::NotBuiltIn)?;
        check(meshes)?;
        let scene = match options.backend {
            #[cfg(feature = "embree")]
            Backend::Embree(isa, quality) => {
                Library::Embree(EmbreeScene::build(meshes, options, isa, quality)?)
            }
            #[cfg(feature = "obvhs")]
            Backend::Obvhs(tree, preset) => {
                Library::Obvhs(Box::new(ObvhsScene::build(meshes, options, tree, preset)?))
            }
            #[cfg(not(all(feature = "embree", feature = "obvhs")))]
            other => return Err(TraceError::NotBuiltIn(other.library())),
        };
        Ok(Accel {
            scene,
            backend: options.backend,
            counts: meshes.iter().map(counts).collect(),
        })
    }

    /// Follows moved vertices; `meshes` must be those of [`Accel::build`] but for their positions.
    ///
    /// Much faster than building, and slower to trace the farther vertices went. (Embree builds anew at the first
    /// refit.) After an error the accel holds no useful scene: drop it or refit it again.
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
        check(meshes)?;
        match &mut self.scene {
            #[cfg(feature = "embree")]
            Library::Embree(scene) => scene.refit(meshes),
            #[cfg(feature = "obvhs")]
            Library::Obvhs(scene) => scene.refit(meshes),
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
                "packets have 1, 4, 8 or 16 rays"
            )
        };
        match &self.scene {
            #[cfg(feature = "embree")]
            Library::Embree(scene) => scene.intersect(rays, active, hits, coherence),
            #[cfg(feature = "obvhs")]
            Library::Obvhs(scene) => scene.intersect(rays, active, hits, coherence),
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
                "packets have 1, 4, 8 or 16 rays"
            )
        };
        match &self.scene {
            #[cfg(feature = "embree")]
            Library::Embree(scene) => scene.occluded(rays, active, coherence),
            #[cfg(feature = "obvhs")]
            Library::Obvhs(scene) => scene.occluded(rays, active, coherence),
        }
    }

    /// What traces.
    pub fn backend(&self) -> Backend {
        self.backend
    }

    /// Bytes the library holds, copies of the meshes included.
    pub fn memory_bytes(&self) -> u64 {
        match &self.scene {
            #[cfg(feature = "embree")]
            Library::Embree(scene) => scene.memory_bytes(),
            #[cfg(feature = "obvhs")]
            Library::Obvhs(scene) => scene.memory_bytes(),
        }
    }

    /// The widest packet that is traced without being split: 1, 4, 8 or 16.
    pub fn native_width(&self) -> usize {
        match &self.scene {
            #[cfg(feature = "embree")]
            Library::Embree(scene) => scene.native_width(),
            #[cfg(feature = "obvhs")]
            Library::Obvhs(scene) => scene.native_width(),
        }
    }

    /// The version of the library that is loaded: `3.13.5`.
    pub fn library_version(&self) -> String {
        match &self.scene {
            #[cfg(feature = "embree")]
            Library::Embree(scene) => scene.version(),
            #[cfg(feature = "obvhs")]
            Library::Obvhs(_) => super::obvhs::VERSION.into(),
        }
    }
}

fn counts(mesh: &MeshView) -> (usize, usize) {
    (mesh.positions.len(), mesh.triangles.len())
}

/// Refuses what no library can be trusted with.
fn check(meshes: &[MeshView]) -> Result<(), TraceError> {
    for (mesh, view) in meshes.iter().enumerate() {
        for count in [view.positions.len(), view.triangles.len()] {
            if u32::try_from(count).is_err() {
                return Err(TraceError::TooLarge { mesh, count });
            }
        }
        if let Some(vertex) = view.positions.iter().position(|p| !p.is_finite()) {
            return Err(TraceError::NonFinite { mesh, vertex });
        }
        let vertices = view.positions.len();
        for (triangle, corners) in view.triangles.iter().enumerate() {
            if let Some(&vertex) = corners.iter().find(|&&v| v as usize >= vertices) {
                return Err(TraceError::Index {
                    mesh,
                    triangle,
                    vertex,
                    vertices,
                });
            }
        }
    }
    Ok(())
}
