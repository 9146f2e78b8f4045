//! A tile's part of a gradient where samples move: what each path of a packet brings.

use crate::gradient::path::backward::BackwardSweep;
use crate::gradient::path::forward::ForwardSweep;
use crate::gradient::scene::backward::TileSums;
use crate::lanes::{LANES, Lane, V3};
use crate::paths::film::tile::TracedTile;
use crate::paths::rays::{from_lanes, to_rgb};
use crate::scene::Rgb;
use glam::Vec3;

/// What the samples of a packet bring: their own derivatives, and their radiances times the
/// velocity of the filter along each axis, if that moves with them. Means over twins.
pub struct Brought {
    pub derivative: [Rgb; LANES],
    pub carried: [[Rgb; LANES]; 2],
}

/// Of packet `number` of a tile.
pub fn forward(
    sweep: &ForwardSweep,
    traced: &TracedTile,
    number: usize,
    filter_follows: bool,
) -> Brought {
    let store = &traced.store;
    let mut derivative = V3::splat(0.0);
    let mut carried = [V3::splat(0.0); 2];
    for path in number * store.twins..(number + 1) * store.twins {
        let moved = sweep.moving_film(store, path);
        derivative = derivative + moved.derivative;
        if filter_follows {
            let radiance = sweep.view.radiance(store, store.path(path));
            for (sum, velocity) in carried.iter_mut().zip(moved.velocity) {
                *sum = *sum + radiance * velocity;
            }
        }
    }
    let share = Lane::splat(1.0 / store.twins as f32);
    Brought {
        derivative: to_rgb(derivative * share),
        carried: carried.map(|c| to_rgb(c * share)),
    }
}

/// From the cotangents of what packet `number` brings.
pub fn backward(
    sweep: &BackwardSweep,
    traced: &TracedTile,
    number: usize,
    (radiance_bars, carried_bars): (&[Vec3; LANES], Option<[[Vec3; LANES]; 2]>),
    sums: &mut TileSums,
) {
    let store = &traced.store;
    let share = Lane::splat(1.0 / store.twins as f32);
    let radiance_bar = from_lanes(radiance_bars) * share;
    for path in number * store.twins..(number + 1) * store.twins {
        let mut at_bars = [Lane::splat(0.0); 2];
        if let Some(carried) = &carried_bars {
            let radiance = sweep.view.radiance(store, store.path(path));
            at_bars = [0, 1].map(|i| radiance.dot(from_lanes(&carried[i])) * share);
        }
        sweep.add_moving_film(store, path, (radiance_bar, at_bars), sums);
    }
}
