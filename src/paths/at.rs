//! Here on the path: what is known where a packet of paths has arrived.

use crate::lanes::{LANES, Lane};
use crate::paths::random::Stream;
use crate::paths::scene_view::SceneView;
use crate::paths::store::Vertices;
use crate::paths::surface::vertex::Surface;

/// Pairs of random numbers that a vertex consumes.
pub const PAIRS_PER_VERTEX: u32 = 5;

/// The random numbers of a packet's vertex.
#[derive(Clone, Copy)]
pub struct Numbers<'a> {
    pub stream: &'a Stream,
    /// Of each lane in the stream's point sets.
    pub index: &'a [u32; LANES],
    /// Number of the vertex: the camera sees number 0.
    pub depth: u32,
}

impl Numbers<'_> {
    /// Pair `number` of the vertex.
    pub fn pair(&self, number: u32) -> (Lane, Lane) {
        self.stream
            .pair(self.index, self.depth * PAIRS_PER_VERTEX + number)
    }
}

/// A packet's vertex, with what scatters there.
#[derive(Clone, Copy)]
pub struct At<'a> {
    pub view: &'a SceneView<'a>,
    pub vertices: &'a Vertices,
    pub surface: &'a Surface,
    pub numbers: Numbers<'a>,
}
