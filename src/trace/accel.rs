//! The one door to ray queries: [`Accel`], over whichever library is asked for.

#[cfg(feature = "embree")]
use super::embree::EmbreeScene;
use super::error::TraceError;
use super::meshes::{MeshView, check};
#[cfg(feature = "obvhs")]
use super::obvhs::ObvhsScene;
use super::options::AccelOptions;
use super::{Backend, Coherence, Hits, Rays};

#[cfg(not(any(feature = "embree", feature = "obvhs")))]
compile_error!("nothing traces rays: build with the feature embree, obvhs or both");

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
            counts: meshes.iter().map(MeshView::counts).collect(),
        })
    }

    /// Follows moved vertices; `meshes` must be those of [`Accel::build`] but for their positions.
    ///
    /// Much faster than building, and slower to trace the farther vertices went. (Embree builds
    /// anew at the first refit.) After an error the accel holds no useful scene: drop it or refit
    /// it again.
    pub fn refit(&mut self, meshes: &[MeshView]) -> Result<(), TraceError> {
        if meshes.len() != self.counts.len() {
            let (old, new) = (self.counts.len(), meshes.len());
            return Err(TraceError::Topology(format!("{old} meshes became {new}")));
        }
        for (i, (mesh, &old)) in meshes.iter().zip(&self.counts).enumerate() {
            let new = mesh.counts();
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

    /// Finds where each active ray first meets a triangle. `N` is 1, 4, 8 or 16; bit `i` of
    /// `active` is lane `i`. Inactive lanes of `hits` stay as they are.
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
