//! Forward mode by `reparam` and `interior`: the gradient image along one direction.

use super::clock::StageClock;
use super::error::EngineError;
use super::estimators::MakeBoundary;
use super::foretold;
use super::group_images::GroupImages;
use super::moved_packet::Moved;
use super::moving_samples;
use super::prepared::Prepared;
use super::progress::Progress;
use super::refusals;
use super::results::ForwardGradient;
use super::settings::Settings;
use super::spare::Spare;
use super::stage::Stage;
use super::statistics::Statistics;
use super::steps::Steps;
use super::tails::share_of_worst_pixels;
use crate::gradient::path::forward::ForwardSweep;
use crate::gradient::scene::forward::Motion;
use crate::lanes::{LANES, Lane};
use crate::paths::boundary_sample::{BoundarySample, Coordinate};
use crate::paths::film::drift::DriftVelocity;
use crate::paths::film::filter::{Block, Taps};
use crate::paths::film::tile::TracedTile;
use crate::paths::integral::{Borders, ByIntegral};
use crate::paths::integrator::Integrator;
use crate::paths::rays::to_rgb;
use crate::paths::store::TileStore;
use crate::paths::warp::seam::Warp;
use crate::scene::{Rgb, SceneDifferential};
use std::time::Instant;

/// dI/dθ along `tangent`, with its standard error; `boundary` makes what finds the boundary terms.
pub fn forward(
    prepared: &Prepared,
    settings: &Settings,
    tangent: &SceneDifferential,
    boundary: Option<MakeBoundary>,
    progress: &dyn Progress,
) -> Result<ForwardGradient, EngineError> {
    let done = forward_and_foretell(prepared, settings, tangent, boundary, None, progress)?;
    Ok(done.0)
}

/// The same, and the variance that differences would have from what jumps, if that is asked for.
pub fn forward_and_foretell(
    prepared: &Prepared,
    settings: &Settings,
    tangent: &SceneDifferential,
    boundary: Option<MakeBoundary>,
    differences: Option<&Steps>,
    progress: &dyn Progress,
) -> Result<(ForwardGradient, f64), EngineError> {
    let mut statistics = Statistics::default();
    let scene = prepared.scene;
    let sensor = &scene.sensors[settings.sensor];
    refusals::check(scene, tangent, sensor, settings.method)?;
    let boundary = boundary.filter(|_| tangent.moves_edges(scene));
    let settings = &settings.through_lens(sensor, tangent.moves_edges(scene));
    let mut stage = Stage::new(prepared, settings, boundary, &mut statistics)?;
    stage.ask_about(tangent);
    stage.check_geometry(settings.method)?;
    let motion = Motion::new(scene, &stage.parts.geometry, tangent);
    let view = stage.view();
    let estimator = stage.estimator();
    let drift = stage.drift(&view, &*estimator);
    let edge_on = stage.edge_on(&*estimator);
    let integrator = Integrator {
        view: &view,
        estimator: &*estimator,
        drift: drift.as_ref(),
        edge_on: edge_on.as_ref(),
        twin: 0,
    };
    let sweep = ForwardSweep::new(&view, &motion, estimator.lobe_drift(&view));
    let filter_follows = estimator.warp().is_some_and(Warp::filter_follows);
    let velocity = drift
        .as_ref()
        .map(|d| d.velocity(|f| sweep.film_velocity(f)));

    let clock = StageClock::start();
    let stores = Spare::new();
    let mut images = stage.group_images()?;
    let mut gradients = stage.group_images()?;
    let mut foretold = 0.0;
    stage.for_each_tile(
        progress,
        &mut statistics,
        |group, index| {
            let tile = stage.tile(group, index);
            let start = Instant::now();
            let store = stores.take(TileStore::default);
            let view = stage.view_of_tile(group, index);
            let integrator = Integrator {
                view: &view,
                ..integrator
            };
            let sweep = ForwardSweep::new(&view, &motion, estimator.lobe_drift(&view));
            let mut traced = TracedTile::trace(&integrator, &stage.filter, tile, true, store);
            let start = clock.add_tracing(start);
            let mut image = Block::new(&stage.filter, &traced.tile);
            traced.splat(&traced.image.radiance, &mut image);
            let film = (velocity.as_ref(), filter_follows);
            let mut gradient = differentiate(&stage, &sweep, film, &mut traced);
            let foretell = |s| foretold::variance_of_tile(s, &stage, &sweep, &traced);
            let told = differences.map_or(0.0, foretell);
            for block in [&mut image, &mut gradient] {
                stage.tiling.keep_own(index, block);
            }
            clock.add_differentiating(start);
            stores.give_back(traced.store);
            ((image, gradient, told), traced.counts)
        },
        |group, (image, gradient, told)| {
            foretold += told;
            images.add(group, &image);
            gradients.add(group, &gradient);
        },
    )?;
    clock.stop(&mut statistics);

    let groups = f64::from(stage.groups);
    let done = finish(&stage, images, gradients, statistics)?;
    Ok((done, foretold / (groups * groups)))
}

/// The means of the groups, and how far these are apart.
fn finish(
    stage: &Stage,
    images: GroupImages,
    gradients: GroupImages,
    mut statistics: Statistics,
) -> Result<ForwardGradient, EngineError> {
    let image = stage.image(images.finish()?.0);
    let (gradient, stderr) = gradients.finish()?;
    let worst = stderr.as_deref();
    let worst = worst.and_then(|stderr| share_of_worst_pixels(stderr, 1000));
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
fn differentiate(
    stage: &Stage,
    sweep: &ForwardSweep,
    (drift, filter_follows): (Option<&DriftVelocity>, bool),
    traced: &mut TracedTile,
) -> Block {
    let columns = traced.tile.points[0];
    let samples = traced.image.radiance.len();
    let mut tangents = vec![[0.0; 3]; samples];
    // Radiances times the velocity of the film along each axis.
    let carries = drift.is_some() || filter_follows;
    let mut carried = [(); 2].map(|_| vec![[0.0; 3]; if carries { samples } else { 0 }]);
    let packets: Vec<_> = traced.packets().collect();
    for (number, packet) in packets.into_iter().enumerate() {
        let moved = Moved::new([packet.u, packet.v], packet.active, drift);
        let moving = traced
            .store
            .samples_move()
            .then(|| moving_samples::forward(sweep, traced, number, filter_follows));
        let values = match &moving {
            Some(moving) => moving.derivative,
            None => {
                let at = moved.film_point();
                let [x, y] = &traced.taps;
                let borders = &mut traced.counts.borders;
                let mut each = |sample: &BoundarySample, brings| {
                    let [x, y] = [&x[packet.column + sample.lane as usize], &y[packet.row]];
                    add_size(borders, sample, [x, y], brings);
                };
                to_rgb(sweep.path_derivative(&traced.store, number, at, &[], &mut each))
            }
        };
        for lane in (0..LANES).filter(|&l| packet.active >> l & 1 == 1) {
            let at = packet.row * columns + packet.column + lane;
            if !values[lane].iter().all(|c| c.is_finite()) {
                traced.counts.gradient_not_finite += 1;
                continue;
            }
            if !traced.leaves_out(at) {
                tangents[at] = values[lane];
            }
            if let (Some(moving), true) = (&moving, filter_follows) {
                carried[0][at] = moving.carried[0][lane];
                carried[1][at] = moving.carried[1][lane];
            }
            if drift.is_some() {
                let radiance = traced.image.radiance[at];
                for c in 0..3 {
                    tangents[at][c] += radiance[c] * moved.divergence[lane];
                    carried[0][at][c] = radiance[c] * moved.velocity[0][lane];
                    carried[1][at][c] = radiance[c] * moved.velocity[1][lane];
                }
            }
        }
    }
    let mut block = Block::new(&stage.filter, &traced.tile);
    traced.splat(&tangents, &mut block);
    if carries {
        let slopes = [0, 1].map(|i| stage.filter.tile_slopes(&traced.tile, i));
        let [x, y] = &traced.taps;
        traced.splat_by([&slopes[0], y], &carried[0], &mut block);
        traced.splat_by([x, &slopes[1]], &carried[1], &mut block);
    }
    add_facets(stage, sweep, drift, traced, &mut block);
    add_film_borders(stage, sweep, drift, traced, &mut block);
    block
}

/// Adds what borders on the film bring.
fn add_film_borders(
    stage: &Stage,
    sweep: &ForwardSweep,
    drift: Option<&DriftVelocity>,
    traced: &mut TracedTile,
    block: &mut Block,
) {
    for sample in traced.store.film_boundary() {
        let Coordinate::Film { at, piece } = sample.at else {
            continue;
        };
        let mut is_finite = true;
        let borders = &mut traced.counts.borders;
        stage.filter.along(at, &piece, |share, at, [x, y]| {
            let (velocity, _) = drift.map_or(([0.0; 2], 0.0), |d| d.at(at));
            let value = sweep.film_boundary(&traced.store.found, sample, at, velocity);
            if value.iter().all(|c| c.is_finite()) {
                let value = value.map(|c| c * share);
                block.add_point(x, y, value);
                add_size(borders, sample, [x, y], value);
            } else {
                is_finite = false;
            }
        });
        traced.counts.gradient_not_finite += u64::from(!is_finite);
    }
}

/// Notes how much a border brings to the image.
fn add_size(
    borders: &mut ByIntegral<Borders>,
    sample: &BoundarySample,
    [x, y]: [&Taps; 2],
    brings: Rgb,
) {
    let size = brings.map(|c| f64::from(c).powi(2)).iter().sum::<f64>();
    if size.is_finite() {
        borders[sample.at.integral()].brought += x.sum() * y.sum() * size.sqrt();
    }
}

/// Adds what the paths through facets that are seen edge-on bring.
fn add_facets(
    stage: &Stage,
    sweep: &ForwardSweep,
    drift: Option<&DriftVelocity>,
    traced: &mut TracedTile,
    block: &mut Block,
) {
    let mut not_finite = 0;
    for (number, packet) in traced.facet_packets() {
        let moved = Moved::new(packet.at, packet.active, drift);
        let values = to_rgb(sweep.radiance_derivative(&traced.store, number, moved.film_point()));
        let [u, v] = packet.at.map(Lane::to_array);
        for lane in (0..LANES).filter(|&l| packet.active >> l & 1 == 1 && packet.area[l] > 0.0) {
            let value = values[lane].map(|c| c * packet.area[lane]);
            if value.iter().all(|c| c.is_finite()) {
                let [x, y] = [(0, u), (1, v)].map(|(i, at)| stage.filter.taps(i, at[lane].into()));
                block.add_point(&x, &y, value);
            } else {
                not_finite += 1;
            }
        }
    }
    traced.counts.gradient_not_finite += not_finite;
}
