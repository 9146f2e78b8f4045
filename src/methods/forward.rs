//! Forward mode by `reparam` and `interior`: the gradient image along one direction.

use super::clock::StageClock;
use super::error::EngineError;
use super::prepared::Prepared;
use super::progress::Progress;
use super::refusals;
use super::results::ForwardGradient;
use super::settings::Settings;
use super::spare::Spare;
use super::stage::Stage;
use super::statistics::Statistics;
use super::tails::share_of_worst_pixels;
use crate::gradient::forward::ForwardSweep;
use crate::gradient::motion::Motion;
use crate::lanes::LANES;
use crate::paths::film::Block;
use crate::paths::store::TileStore;
use crate::paths::tile::{TracedTile, to_rgb};
use crate::paths::tracer::Counts;
use crate::scene::SceneDifferential;
use std::time::Instant;

/// dI/dθ along `tangent`, with its standard error.
pub fn forward(
    prepared: &Prepared,
    settings: &Settings,
    tangent: &SceneDifferential,
    progress: &dyn Progress,
) -> Result<ForwardGradient, EngineError> {
    let mut statistics = Statistics::default();
    let scene = prepared.scene;
    refusals::check(scene, tangent, settings.method)?;
    let visibility = settings.method.looks_for_discontinuities() && tangent.moves_edges(scene);
    let mut stage = Stage::new(prepared, settings, visibility, &mut statistics)?;
    stage.ask_about(tangent);
    let motion = Motion::new(scene, &stage.parts.geometry, tangent);
    let tracer = stage.tracer();
    let sweep = ForwardSweep::new(&tracer, &motion, visibility);

    let clock = StageClock::start();
    let stores = Spare::new();
    let mut images = stage.group_images()?;
    let mut gradients = stage.group_images()?;
    let mut counts = Counts::default();
    stage.for_each_tile(
        progress,
        |group, index| {
            let tile = stage.lattice.tile(index, group, stage.seed);
            let start = Instant::now();
            let store = stores.take(TileStore::default);
            let mut traced = TracedTile::trace(&tracer, &stage.filter, tile, true, store);
            let start = clock.add_tracing(start);
            let mut image = Block::new(&stage.filter, &traced.tile);
            traced.splat(&traced.image.radiance, &mut image);
            let gradient = differentiate(&stage, &sweep, &mut traced);
            clock.add_differentiating(start);
            stores.give_back(traced.store);
            (image, gradient, traced.counts)
        },
        |group, (image, gradient, tile_counts)| {
            images.add(group, &image);
            gradients.add(group, &gradient);
            counts += tile_counts;
        },
    )?;
    statistics.add_counts(&counts);
    clock.stop(&mut statistics);

    let image = stage.image(images.finish()?.0);
    let (gradient, stderr) = gradients.finish()?;
    let worst = stderr.as_deref().and_then(share_of_worst_pixels);
    let worst = worst.map(|share| ("gradient".into(), share));
    statistics.largest_parts.extend(worst);
    Ok(ForwardGradient {
        image,
        gradient: stage.image(gradient),
        stderr: stderr.map(|e| stage.image(e)),
        statistics,
    })
}

/// A tile's part of the gradient image.
fn differentiate(stage: &Stage, sweep: &ForwardSweep, traced: &mut TracedTile) -> Block {
    let columns = traced.tile.points[0];
    let mut tangents = vec![[0.0; 3]; traced.image.radiance.len()];
    let outer = sweep.tracer.adjacency.is_some();
    let packets: Vec<_> = traced.packets(outer).collect();
    for (number, packet) in packets.into_iter().enumerate() {
        let values = to_rgb(sweep.radiance_tangent(&traced.store, number, packet.u, packet.v));
        for lane in (0..LANES).filter(|&l| packet.active >> l & 1 == 1) {
            let at = packet.row * columns + packet.column + lane;
            if values[lane].iter().all(|c| c.is_finite()) {
                tangents[at] = values[lane];
            } else {
                traced.counts.gradient_not_finite += 1;
            }
        }
    }
    let mut block = Block::new(&stage.filter, &traced.tile);
    traced.splat(&tangents, &mut block);
    for crossing in &traced.store.film_crossings {
        let line = traced.tile.step[1 - crossing.axis as usize] as f32;
        let value = sweep.film_crossing(crossing).map(|c| c * line);
        if value.iter().all(|c| c.is_finite()) {
            let [x, y] = [0, 1].map(|i| stage.filter.taps(i, crossing.at[i]));
            block.add_point(&x, &y, value);
        } else {
            traced.counts.gradient_not_finite += 1;
        }
    }
    block
}
