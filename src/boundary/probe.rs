//! What is seen beside boundaries: the radiance on both sides, whose difference is the jump.

use crate::boundary::search_scene::SearchScene;
use crate::lanes::{LANES, Lane, V3};
use crate::paths::counts::Counts;
use crate::paths::estimator::Interior;
use crate::paths::integrator::Integrator;
use crate::paths::random::Stream;
use crate::paths::start::Start;
use crate::paths::store::TileStore;
use crate::trace::geometry::NO_TRIANGLE;

/// What is asked of the lanes of a packet, two of which look on either side of one boundary.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sides {
    /// Lanes that look.
    pub active: u32,
    /// Lanes beside edges at which only the plane bends (`discontinuity::crossing`).
    pub facet_edges: u32,
}

impl Sides {
    /// The sides of the boundary with this number.
    pub fn add(&mut self, number: usize, is_facet_edge: bool) {
        let sides = 0b11 << (2 * number);
        self.active |= sides;
        self.facet_edges |= sides * is_facet_edge as u32;
    }
}

/// The radiance and the triangle that each lane sees.
pub type Probed = (V3<Lane>, [u32; LANES]);

impl SearchScene<'_> {
    /// Radiance along rays, and the triangles that they meet. No boundaries are sought along these
    /// paths.
    pub fn probe(
        &self,
        start: Start,
        sides: Sides,
        stream: &Stream,
        index: &[u32; LANES],
        counts: &mut Counts,
    ) -> Probed {
        let start = Start {
            between_planes: sides.facet_edges,
            ..start
        };
        let integrator = Integrator {
            view: self.view,
            estimator: &Interior,
            drift: None,
            edge_on: None,
            twin: 0,
        };
        let mut store = TileStore::default();
        integrator.trace(&start, stream, index, &mut store);
        counts.probe += store.counts.rays();
        let first = store.vertices.first();
        (
            self.view.radiance(&store, &store.vertices),
            first.map_or([NO_TRIANGLE; LANES], |v| v.triangle),
        )
    }
}
