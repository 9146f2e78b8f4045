//! Tracing all samples of a tile.

use super::film::{Block, FilmFilter, Taps};
use super::film_cells::{self, LatticeImage};
use super::lattice::Tile;
use super::random::morton;
use super::rays::RayPacket;
use super::store::TileStore;
use super::tracer::{Counts, Tracer};
use crate::lanes::{LANES, Lane, V3};
use crate::paths::camera::splat;
use crate::scene::Rgb;
use crate::trace::geometry::NO_TRIANGLE;

/// A tile whose paths are traced and, if they were to be kept, stored.
pub struct TracedTile {
    pub tile: Tile,
    pub store: TileStore,
    pub image: LatticeImage,
    pub counts: Counts,
    pub taps: [Vec<Taps>; 2],
}

/// A packet of film samples: a part of one lattice row.
#[derive(Clone, Copy)]
pub struct FilmPacket {
    pub row: usize,
    pub column: usize,
    /// Lanes that hold a lattice point.
    pub active: u32,
    pub u: Lane,
    pub v: Lane,
}

impl TracedTile {
    /// Traces the tile. If the tracer looks for silhouettes the paths are stored, and the film's cells are searched. What `store` holds is thrown away.
    pub fn trace(
        tracer: &Tracer,
        filter: &FilmFilter,
        tile: Tile,
        keep: bool,
        mut store: TileStore,
    ) -> Self {
        let [columns, rows] = tile.points;
        store.clear();
        let mut counts = Counts::default();
        let mut image = LatticeImage {
            triangle: vec![NO_TRIANGLE; columns * rows],
            radiance: vec![[0.0; 3]; columns * rows],
        };
        for packet in packets(&tile, tracer.adjacency.is_some()) {
            if !keep {
                store.clear();
            }
            let direction = tracer.camera.direction(packet.u, packet.v);
            let rays = RayPacket {
                active: packet.active,
                origin: splat(tracer.camera.origin),
                direction,
                near: tracer.camera.near_clip,
                far: tracer.camera.far_clip,
            };
            let index =
                std::array::from_fn(|l| morton((packet.column + l) as u32, packet.row as u32));
            tracer.trace(rays, &tile.stream, &index, &mut counts, &mut store);
            let path = store.path(store.depths.len() - 2);
            let radiance = to_rgb(tracer.radiance(&store, path));
            for lane in (0..LANES).filter(|&l| packet.active >> l & 1 == 1) {
                let at = packet.row * columns + packet.column + lane;
                image.triangle[at] = path[0].triangle[lane];
                if radiance[lane].iter().all(|c| c.is_finite()) {
                    image.radiance[at] = radiance[lane];
                } else {
                    counts.not_finite += 1;
                }
            }
        }
        if let Some(adjacency) = tracer.adjacency {
            store.film_crossings = film_cells::find(tracer, adjacency, &tile, &image, &mut counts);
            let found = [
                store.film_crossings.len(),
                store.light_crossings.len(),
                store.bounce_crossings.len(),
            ];
            counts.resolved += found.iter().sum::<usize>() as u64;
        }
        let taps = [filter.tile_taps(&tile, 0), filter.tile_taps(&tile, 1)];
        Self {
            tile,
            store,
            image,
            counts,
            taps,
        }
    }

    /// The tile's packets, in the order of the store.
    pub fn packets(&self, with_outer: bool) -> impl Iterator<Item = FilmPacket> {
        packets(&self.tile, with_outer)
    }

    /// Adds one value a lattice point to a block.
    pub fn splat(&self, values: &[Rgb], block: &mut Block) {
        let columns = self.tile.points[0];
        for (row, y_taps) in self.taps[1].iter().enumerate() {
            block.add_row(
                &self.taps[0],
                y_taps,
                &values[row * columns..(row + 1) * columns],
            );
        }
    }
}

/// All packets of a tile, row by row; the outer rows and columns only if asked for.
fn packets(tile: &Tile, with_outer: bool) -> impl Iterator<Item = FilmPacket> + use<> {
    let tile = tile.clone();
    let [columns, rows] = tile.points;
    let skip = if with_outer { 0 } else { 1 };
    (skip..rows - skip).flat_map(move |row| {
        let tile = tile.clone();
        (skip..columns - skip).step_by(LANES).map(move |column| {
            let lanes = (columns - skip - column).min(LANES);
            let u = std::array::from_fn(|l| tile.position(0, column + l) as f32);
            FilmPacket {
                row,
                column,
                active: ((1u64 << lanes) - 1) as u32,
                u: Lane::new(u),
                v: Lane::splat(tile.position(1, row) as f32),
            }
        })
    })
}

/// One colour a lane.
pub fn to_rgb(v: V3<Lane>) -> [Rgb; LANES] {
    let (x, y, z) = (v.x.to_array(), v.y.to_array(), v.z.to_array());
    std::array::from_fn(|l| [x[l], y[l], z[l]])
}
