//! Why rays cannot be traced.

/// Why there is no [`super::Accel`].
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
