//! What is seen beside boundaries: the radiance on both sides, whose difference is the jump.

use crate::boundary::search_scene::SearchScene;
use crate::lanes::{LANES, Lane, V3};
use crate::paths::counts::Counts;
use crate::paths::estimator::Interior;
use crate::paths::integrator::{Integrator, Start};
use crate::paths::random::Stream;
use crate::paths::rays::RayPacket;
use crate::paths::store::TileStore;
use crate::trace::Coherence;
use crate::trace::geometry::NO_TRIANGLE;

/// What is asked of the lanes of a packet, two of which look on either side of one boundary.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sides {
    /// Lanes that look.
    pub active: u32,
    /// Of these, those of which the radiance is wanted; of others only what they see.
    pub wanted: u32,
    /// Lanes beside edges at which only the plane bends (`discontinuity::crossing`).
    pub facet_edges: u32,
}

impl Sides {
    /// The sides of the boundary with this number.
    pub fn add(&mut self, number: usize, is_wanted: bool, is_facet_edge: bool) {
        let sides = 0b11 << (2 * number);
        self.active |= sides;
        self.wanted |= sides * is_wanted as u32;
        self.facet_edges |= sides * is_facet_edge as u32;
    }
}

/// The radiance and the triangle that each lane sees.
pub type Probed = (V3<Lane>, [u32; LANES]);

impl SearchScene<'_> {
    /// Radiance along those rays of which it is wanted, and the triangles that all that look meet.
    /// No boundaries are sought along these paths.
    pub fn probe(
        &self,
        start: Start,
        sides: Sides,
        stream: &Stream,
        index: &[u32; LANES],
        counts: &mut Counts,
    ) -> Probed {
        let rays = |active: u32| RayPacket {
            active,
            ..start.rays
        };
        let others = rays(sides.active & !sides.wanted);
        counts.probe += others.active.count_ones() as u64;
        let seen = match others.active {
            0 => [NO_TRIANGLE; LANES],
            _ => self.view.intersect(&others, Coherence::Incoherent),
        };
        if sides.wanted == 0 {
            return (V3::splat(0.0), seen);
        }
        let start = Start {
            rays: rays(sides.wanted),
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
            std::array::from_fn(|l| match (sides.wanted >> l & 1, first) {
                (1, Some(v)) => v.triangle[l],
                _ => seen[l],
            }),
        )
    }
}
