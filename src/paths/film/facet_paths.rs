//! Paths through facets that are seen edge-on ([`super::edge_on`]).

use crate::lanes::{LANES, Lane};
use crate::paths::dimensions::Branch;
use crate::paths::film::edge_on::{EdgeOnFacets, FacetPoint};
use crate::paths::film::lattice::Tile;
use crate::paths::integrator::Integrator;
use crate::paths::store::TileStore;
use std::array::from_fn;

/// A packet of them.
pub struct FacetPacket {
    /// Lanes that hold a point.
    pub active: u32,
    /// The film points.
    pub at: [Lane; 2],
    /// One over their density, in pixels; zero where their facets are hidden.
    pub area: [f32; LANES],
}

/// Traces paths through points of the facets in a tile, and appends them.
pub fn trace(
    facets: &EdgeOnFacets,
    integrator: &Integrator,
    tile: &Tile,
    store: &mut TileStore,
) -> Vec<FacetPacket> {
    let stream = tile.stream.branch(Branch::EdgeOn, [0; 3]);
    let camera = &integrator.view.camera;
    let trace_packet = |(number, points): (usize, &[FacetPoint])| {
        let of = |lane: usize| &points[lane.min(points.len() - 1)];
        let at = [0, 1].map(|i| Lane::new(from_fn(|lane| of(lane).at[i] as f32)));
        let active = ((1u64 << points.len()) - 1) as u32;
        let index = from_fn(|lane| (number * LANES + lane) as u32);
        let [u, v] = at;
        let rays = camera.rays(camera.direction(u, v), active);
        let drifts = integrator.drift.map_or(0, |d| d.lanes(u, v));
        let path = store.depths.len() - 1;
        integrator.trace_from_camera(rays, drifts, &stream, &index, store);
        let seen = store.path(path)[0].triangle;
        let area = from_fn(|lane| match of(lane) {
            point if seen[lane] == point.triangle => point.area as f32,
            _ => 0.0,
        });
        FacetPacket { active, at, area }
    };
    let points: Vec<FacetPoint> = facets.points(tile).collect();
    let packets = points.chunks(LANES).enumerate();
    packets.map(trace_packet).collect()
}
