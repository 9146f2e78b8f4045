//! Here on the path: what is known where a packet of paths has arrived.

use crate::lanes::{LANES, Lane};
use crate::paths::dimensions::Pair;
use crate::paths::random::Stream;
use crate::paths::scene_view::SceneView;
use crate::paths::store::Vertices;
use crate::paths::surface::vertex::Surface;

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
    /// The vertex's own pair for this use.
    pub fn pair(&self, user: Pair) -> (Lane, Lane) {
        self.stream.pair(self.index, user.dimension(self.depth))
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
