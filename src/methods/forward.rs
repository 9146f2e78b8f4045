//! Forward mode by `reparam` and `interior`: the gradient image along one direction.

use super::clock::StageClock;
use super::error::EngineError;
use super::estimators::MakeBoundary;
use super::prepared::Prepared;
use super::progress::Progress;
use super::refusals;
use super::results::ForwardGradient;
use super::settings::Settings;
use super::spare::Spare;
use super::stage::Stage;
use super::statistics::Statistics;
use super::tails::share_of_worst_pixels;
use crate::gradient::path::forward::ForwardSweep;
use crate::gradient::scene::forward::Motion;
use crate::lanes::LANES;
use crate::paths::boundary_sample::Coordinate;
use crate::paths::counts::Counts;
use crate::paths::film::filter::Block;
use crate::paths::film::tile::TracedTile;
use crate::paths::integrator::Integrator;
use crate::paths::rays::to_rgb;
use crate::paths::store::TileStore;
use crate::scene::SceneDifferential;
use std::time::Instant;

/// dI/dθ along `tangent`, with its standard error; `boundary` makes what finds the boundary terms.
pub fn forward(
    prepared: &Prepared,
    settings: &Settings,
    tangent: &SceneDifferential,
    boundary: Option<MakeBoundary>,
    progress: &dyn Progress,
) -> Result<ForwardGradient, EngineError> {
    let mut statistics = Statistics::default();
    let scene = prepared.scene;
    refusals::check(scene, tangent, settings.method)?;
    let boundary = boundary.filter(|_| tangent.moves_edges(scene));
    let mut stage = Stage::new(prepared, settings, boundary, &mut statistics)?;
    stage.ask_about(tangent);
    let motion = Motion::new(scene, &stage.parts.geometry, tangent);
    let view = stage.view();
    let estimator = stage.estimator();
    let integrator = Integrator {
        view: &view,
        estimator: &*estimator,
    };
    let sweep = ForwardSweep::new(&view, &motion);

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
            let mut traced = TracedTile::trace(&integrator, &stage.filter, tile, true, store);
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
    let packets: Vec<_> = traced.packets().collect();
    for (number, packet) in packets.into_iter().enumerate() {
        let values = to_rgb(sweep.radiance_derivative(&traced.store, number, packet.u, packet.v));
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
    for sample in traced.store.film_boundary() {
        let Coordinate::Film(at) = sample.at else {
            continue;
        };
        let value = sweep.film_boundary(sample);
        if value.iter().all(|c| c.is_finite()) {
            let [x, y] = [0, 1].map(|i| stage.filter.taps(i, at[i]));
            block.add_point(&x, &y, value);
        } else {
            traced.counts.gradient_not_finite += 1;
        }
    }
    block
}
