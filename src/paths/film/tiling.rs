//! The tiles of a film: of one lattice, or of one for each density.

use crate::paths::film::density::DensityMap;
use crate::paths::film::filter::{Block, FilmFilter};
use crate::paths::film::lattice::{Lattice, Pixels, Tile};
use crate::paths::random::Stream;
use crate::scene::Rgb;
use std::borrow::Cow;

/// How a film is cut into tiles.
pub enum Tiling {
    Even(Lattice),
    Uneven {
        density: DensityMap,
        regions: Vec<Region>,
    },
}

/// What has one density.
pub struct Region {
    samples: u32,
    lattice: Lattice,
    /// The pixels of each.
    tiles: Vec<Pixels>,
}

impl Tiling {
    /// That of a film with densities; `make` makes a lattice with so many points a pixel.
    pub fn uneven(density: DensityMap, filter: &FilmFilter, make: impl Fn(u32) -> Lattice) -> Self {
        let regions = density.all().into_iter().map(|samples| {
            let lattice = make(samples);
            let film = [lattice.start, lattice.end];
            let needed = density.needed(samples, film, filter.reach());
            let tiles = needed.into_iter().flat_map(|pixels| lattice.cut(pixels));
            Region {
                samples,
                tiles: tiles.collect(),
                lattice,
            }
        });
        let regions = regions.collect();
        Tiling::Uneven { density, regions }
    }

    pub fn tile_count(&self) -> usize {
        match self {
            Tiling::Even(lattice) => lattice.tile_count(),
            Tiling::Uneven { regions, .. } => regions.iter().map(|r| r.tiles.len()).sum(),
        }
    }

    /// Tile `index` of group `group`.
    pub fn tile(&self, index: usize, group: u32, seed: u64) -> Tile {
        match self {
            Tiling::Even(lattice) => lattice.tile(index, group, seed),
            Tiling::Uneven { regions, .. } => {
                let (number, within) = place(regions, index);
                let Region { lattice, tiles, .. } = &regions[number];
                let own = Stream::new(seed, [group, index as u32]);
                let whole = Stream::new(seed, [group, u32::MAX - number as u32]);
                lattice.tile_over(tiles[within], own, whole)
            }
        }
    }

    /// The region of tile `index`.
    pub fn region_of(&self, index: usize) -> usize {
        match self {
            Tiling::Even(_) => 0,
            Tiling::Uneven { regions, .. } => place(regions, index).0,
        }
    }

    /// Blackens what tile `index` brings to pixels that take nothing from it.
    pub fn keep_own(&self, index: usize, block: &mut Block) {
        if let Tiling::Uneven { density, regions } = self {
            density.keep_only(regions[place(regions, index).0].samples, block);
        }
    }

    /// An image parted among the regions, black where others have pixels.
    pub fn part<'a>(&self, pixels: &'a [Rgb]) -> Vec<Cow<'a, [Rgb]>> {
        match self {
            Tiling::Even(_) => vec![pixels.into()],
            Tiling::Uneven { density, regions } => {
                let own = |region: &Region| density.only(region.samples, pixels).into();
                regions.iter().map(own).collect()
            }
        }
    }
}

/// The region of tile `index`, and which of its tiles it is.
fn place(regions: &[Region], index: usize) -> (usize, usize) {
    let mut within = index;
    for (number, region) in regions.iter().enumerate() {
        match within.checked_sub(region.tiles.len()) {
            Some(beyond) => within = beyond,
            None => return (number, within),
        }
    }
    unreachable!("tile {index} is beyond the last")
}
