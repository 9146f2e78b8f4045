//! How rays are traced.

use super::Backend;

/// How to build an [`super::Accel`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AccelOptions {
    /// What builds it and traces.
    pub backend: Backend,
    /// No ray slips through an edge that two triangles share. It costs speed: see `docs/embree.md`
    /// and `docs/backends.md`.
    pub robust: bool,
    /// Threads that build; 1 starts none, 0 leaves the number to the library.
    pub threads: usize,
    /// Widest packet handed to Embree, 0 for the widest native one: lets tests go each way on any
    /// CPU.
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
