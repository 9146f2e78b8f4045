//! Tracing all samples of a tile.

use crate::lanes::{LANES, Lane, V3};
use crate::paths::counts::Counts;
use crate::paths::dimensions::Single;
use crate::paths::estimator::FilmTile;
use crate::paths::film::drift::DriftVelocity;
use crate::paths::film::facet_paths::{self, FacetPacket};
use crate::paths::film::filter::{Block, FilmFilter, Taps};
use crate::paths::film::lattice::{LatticeImage, Tile};
use crate::paths::integrator::Integrator;
use crate::paths::random::morton;
use crate::paths::rays::to_rgb;
use crate::paths::store::{MovingFilmPath, TileStore};
use crate::paths::warp::seam::{FilmPoints, Warp};
use crate::scene::Rgb;
use crate::trace::geometry::NO_TRIANGLE;
use std::array::from_fn;

/// A tile whose paths are traced and, if they were to be kept, stored.
pub struct TracedTile {
    pub tile: Tile,
    pub store: TileStore,
    pub image: LatticeImage,
    pub counts: Counts,
    pub taps: [Vec<Taps>; 2],
    /// Whose paths come after those of the lattice, if paths are kept.
    facets: Vec<FacetPacket>,
    /// Lattice points that see what has paths of its own.
    left_out: Option<Vec<bool>>,
    /// Whether the outer rows and columns were traced.
    with_outer: bool,
}

/// Renders a tile whose samples are carried along with the film's drift for a time: each keeps its
/// random numbers.
pub fn trace_carried(
    integrator: &Integrator,
    filter: &FilmFilter,
    tile: &Tile,
    (velocity, time): (&DriftVelocity, f64),
    store: &mut TileStore,
) -> (Block, Counts) {
    store.clear();
    let mut block = Block::new(filter, tile);
    let mut not_finite = 0;
    let area = tile.step[0] * tile.step[1];
    for packet in packets(tile, false) {
        store.forget_paths();
        let carried: [_; LANES] = from_fn(|lane| {
            let at = [(0, packet.column + lane), (1, packet.row)];
            velocity.carry(at.map(|(axis, point)| tile.position(axis, point)), time)
        });
        let [u, v] = [0, 1].map(|axis| from_fn(|lane| carried[lane].0[axis] as f32).into());
        let packet = FilmPacket { u, v, ..packet };
        let radiance = to_rgb(trace_packet(integrator, tile, &packet, store));
        for lane in (0..LANES).filter(|&l| packet.active >> l & 1 == 1) {
            let ([x, y], growth) = carried[lane];
            let value = radiance[lane].map(|c| c * (growth * area) as f32);
            if value.iter().all(|c| c.is_finite()) {
                block.add_point(&filter.taps(0, x), &filter.taps(1, y), value);
            } else {
                not_finite += 1;
            }
        }
    }
    store.counts.not_finite = not_finite;
    (block, store.counts)
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
    /// Traces the tile, and has the estimator find what jumps on the film. Paths are kept for the
    /// sweeps if `keep` says so. What `store` holds is thrown away.
    pub fn trace(
        integrator: &Integrator,
        filter: &FilmFilter,
        tile: Tile,
        keep: bool,
        mut store: TileStore,
    ) -> Self {
        let [columns, rows] = tile.points;
        let Integrator {
            view,
            estimator,
            drift,
            edge_on,
            ..
        } = *integrator;
        store.clear();
        let mut not_finite = 0;
        let mut image = LatticeImage {
            triangle: vec![NO_TRIANGLE; columns * rows],
            radiance: vec![[0.0; 3]; columns * rows],
            hidden: Vec::new(),
        };
        if estimator.closes_lattice() {
            let lights = view.delta_lights.len();
            image.hidden = vec![vec![false; columns * rows]; lights];
        }
        for packet in packets(&tile, estimator.closes_lattice()) {
            if !keep {
                store.forget_paths();
            }
            let first = store.depths.len() - 1;
            let radiance = to_rgb(trace_packet(integrator, &tile, &packet, &mut store));
            let path = store.path(first);
            for lane in (0..LANES).filter(|&l| packet.active >> l & 1 == 1) {
                let at = packet.row * columns + packet.column + lane;
                image.triangle[at] = path[0].triangle[lane];
                let sights = store.delta_visible(&path[0]);
                for (hidden, sight) in image.hidden.iter_mut().zip(sights) {
                    hidden[at] = sight.hidden >> lane & 1 == 1;
                }
                if radiance[lane].iter().all(|c| c.is_finite()) {
                    image.radiance[at] = radiance[lane];
                } else {
                    not_finite += 1;
                }
            }
        }
        let facets = match edge_on {
            Some(facets) if keep => facet_paths::trace(facets, integrator, &tile, &mut store),
            _ => Vec::new(),
        };
        let left_out = edge_on.map(|facets| {
            let triangles = image.triangle.iter();
            triangles.map(|&t| facets.contains(t)).collect()
        });
        store.vertex_samples = store.found.samples.len();
        let film = FilmTile {
            view,
            tile: &tile,
            image: &image,
            filter: filter.filter,
            drift,
        };
        estimator.search_film(&film, &mut store.found);
        store.counts.not_finite = not_finite;
        let mut counts = store.counts;
        counts += store.found.counts;
        let taps = [filter.tile_taps(&tile, 0), filter.tile_taps(&tile, 1)];
        Self {
            tile,
            store,
            image,
            counts,
            taps,
            facets,
            left_out,
            with_outer: estimator.closes_lattice(),
        }
    }

    /// The tile's packets, in the order of the store.
    pub fn packets(&self) -> impl Iterator<Item = FilmPacket> {
        packets(&self.tile, self.with_outer)
    }

    /// Whether the derivative of a lattice point's radiance is left to other paths.
    pub fn leaves_out(&self, point: usize) -> bool {
        self.left_out.as_ref().is_some_and(|points| points[point])
    }

    /// The packets through facets that are seen edge-on, with their numbers in the store.
    pub fn facet_packets(&self) -> impl Iterator<Item = (usize, &FacetPacket)> {
        let first = self.packets().count();
        self.facets
            .iter()
            .enumerate()
            .map(move |(i, p)| (first + i, p))
    }

    /// Adds one value a lattice point to a block.
    pub fn splat(&self, values: &[Rgb], block: &mut Block) {
        self.splat_by([&self.taps[0], &self.taps[1]], values, block);
    }

    /// Likewise, with other weights along the axes.
    pub fn splat_by(&self, [x, y]: [&Vec<Taps>; 2], values: &[Rgb], block: &mut Block) {
        let columns = self.tile.points[0];
        for (row, y_taps) in y.iter().enumerate() {
            block.add_row(x, y_taps, &values[row * columns..(row + 1) * columns]);
        }
    }
}

/// Traces the paths of a packet; returns their radiance, the mean of twins.
fn trace_packet(
    integrator: &Integrator,
    tile: &Tile,
    packet: &FilmPacket,
    store: &mut TileStore,
) -> V3<Lane> {
    let Integrator { view, drift, .. } = *integrator;
    let index: [u32; LANES] =
        std::array::from_fn(|l| morton((packet.column + l) as u32, packet.row as u32));
    let lens_point = |lane: usize| {
        let number = |axis| {
            tile.stream
                .single(Single::LensPoint, [index[lane], axis, 0])
        };
        [number(0), number(1)]
    };
    let first = store.depths.len() - 1;
    if let Some(warp) = integrator.estimator.warp() {
        let points = FilmPoints {
            view,
            u: packet.u,
            v: packet.v,
            active: packet.active,
            stream: &tile.stream,
            index: &index,
        };
        trace_moving(integrator, warp, &points, store);
    } else {
        let camera = &view.camera;
        let rays = camera.rays_through(packet.u, packet.v, packet.active, lens_point);
        let drifts = drift.map_or(0, |d| d.lanes(packet.u, packet.v));
        integrator.trace_from_camera(rays, drifts, &tile.stream, &index, store);
    }
    let mut radiance = view.radiance(store, store.path(first));
    for twin in 1..store.twins {
        radiance = radiance + view.radiance(store, store.path(first + twin));
    }
    radiance * Lane::splat(1.0 / store.twins as f32)
}

/// Traces the paths of a packet whose samples move.
fn trace_moving(
    integrator: &Integrator,
    warp: &dyn Warp,
    points: &FilmPoints,
    store: &mut TileStore,
) {
    let paths = warp.film(points, &mut store.counts);
    store.twins = paths.len();
    for (twin, path) in paths.into_iter().enumerate() {
        let first = store.follows.len() as u32;
        store.follows.extend_from_slice(&path.follows);
        store.film_paths.push(MovingFilmPath {
            at: path.at,
            follows: [first, store.follows.len() as u32],
        });
        let [u, v] = path.at;
        // Through a pinhole: other cameras are refused where anything moves.
        let camera = &points.view.camera;
        let rays = camera.rays(camera.direction(u, v), points.active);
        let twin = Integrator {
            twin: twin as u32,
            ..*integrator
        };
        twin.trace_from_camera(rays, 0, points.stream, points.index, store);
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
