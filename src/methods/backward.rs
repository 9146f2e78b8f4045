//! Reverse mode by `reparam` and `interior`: the gradient of one number for everything that was asked for.

use super::groups::GroupImages;
use super::spare::Spare;
use super::stage::{Stage, StageClock};
use super::{
    BackwardGradient, EngineError, Evaluation, Image, Method, Objective, Prepared, Progress,
    Settings, Statistics, refusals,
};
use crate::gradient::accumulator::{FilmSums, TileGradient, TileSums, Wanted};
use crate::gradient::reverse::ReverseSweep;
use crate::gradient::terms::Terms;
use crate::lanes::LANES;
use crate::paths::film::{Block, gather_point, gather_row};
use crate::paths::rays::from_lanes;
use crate::paths::store::TileStore;
use crate::paths::tile::TracedTile;
use crate::paths::tracer::Counts;
use crate::room;
use crate::scene::{Rgb, SceneDifferential};
use glam::Vec3;
use std::time::Instant;

/// The image that an objective is measured on gets its own random numbers: a loss and its derivative from the same
/// samples would be correlated, and the gradient biased (METHODS §6).
const OBJECTIVE_SEED: u64 = 0x9e37_79b9_7f4a_7c15;

/// The sweep takes derivatives by the image between this and its inverse as they are.
const LEAST_MAGNITUDE: f32 = 1e-6;

/// d objective/d(everything in `request`).
pub fn backward(
    prepared: &Prepared,
    settings: &Settings,
    request: &SceneDifferential,
    objective: &Objective,
    progress: &dyn Progress,
) -> Result<BackwardGradient, EngineError> {
    let scene = prepared.scene;
    refusals::check(scene, request, settings.method)?;
    let Evaluation {
        loss,
        mut adjoint,
        image,
        mut statistics,
    } = evaluate(prepared, settings, objective, progress)?;
    let magnitude = to_unit_magnitude(&mut adjoint);
    let visibility = settings.method == Method::Reparam && request.moves_edges(scene);
    let mut stage = Stage::new(prepared, settings, visibility, &mut statistics)?;
    stage.ask_about(request);
    check_size(&adjoint, stage.size)?;

    let clock = StageClock::start();
    let wanted = Wanted::new(scene, request);
    let tracer = stage.tracer();
    let sweep = ReverseSweep {
        tracer: &tracer,
        wanted: &wanted,
        visibility,
    };
    let (stores, scratch) = (Spare::new(), Spare::new());
    let mut images = GroupImages::new(&stage)?;
    let mut sums = (0..stage.own_groups().len())
        .map(|_| FilmSums::new(scene, &stage.parts.geometry, &wanted))
        .collect::<Result<Vec<_>, _>>()?;
    let scratch_bytes = TileSums::bytes_needed(scene, &stage.parts.geometry, &wanted);
    room::look_for(settings.threads as u64 * scratch_bytes)?;
    let mut terms = Terms::new(scene.meshes.len(), scene.textures.len());
    let mut counts = Counts::default();
    stage.for_each_tile(
        progress,
        |group, index| {
            let tile = stage.lattice.tile(index, group, stage.seed);
            let start = Instant::now();
            let store = stores.take(TileStore::default);
            let traced = TracedTile::trace(&tracer, &stage.filter, tile, true, store);
            let start = clock.add_primal(start);
            let mut block = Block::new(&stage.filter, &traced.tile);
            traced.splat(&traced.image.radiance, &mut block);
            let mut tile_sums =
                scratch.take(|| TileSums::new(scene, &stage.parts.geometry, &wanted));
            let gradient = differentiate(&stage, &sweep, &traced, &adjoint.pixels, &mut tile_sums);
            clock.add_adjoint(start);
            scratch.give_back(tile_sums);
            stores.give_back(traced.store);
            let mut counts = traced.counts;
            counts.gradient_not_finite += gradient.not_finite;
            (block, gradient, counts)
        },
        |group, (block, gradient, tile_counts)| {
            let own = (group - stage.own_groups().start) as usize;
            images.add(group, &block);
            sums[own].add(&gradient);
            terms.absorb(&gradient.terms);
            counts += tile_counts;
        },
    )?;
    statistics.add_counts(&counts);
    clock.stop(&mut statistics);

    let groups: Vec<SceneDifferential> = sums
        .into_iter()
        .map(|mut sums| {
            sums.scale(magnitude);
            sums.finish(scene, &stage.parts.geometry, &stage.camera, request)
        })
        .collect();
    let gradient = SceneDifferential::mean(&groups);
    let own = stage.image(images.finish()?.0);
    let (loss, image) = match objective {
        Objective::Adjoint(adjoint) => (inner_product(&own, adjoint), own),
        _ => (loss, image.unwrap_or(own)),
    };
    Ok(BackwardGradient {
        image,
        gradient,
        groups,
        loss,
        terms,
        statistics,
    })
}

/// The objective's value and derivative by the image, and the image they were taken at.
pub fn evaluate(
    prepared: &Prepared,
    settings: &Settings,
    objective: &Objective,
    progress: &dyn Progress,
) -> Result<Evaluation, EngineError> {
    let (target, is_l1) = match objective {
        Objective::Adjoint(adjoint) => {
            return Ok(Evaluation {
                loss: 0.0,
                adjoint: Image {
                    pixels: room::copy(&adjoint.pixels)?,
                    ..**adjoint
                },
                image: None,
                statistics: Statistics::default(),
            });
        }
        Objective::L1(target) => (target, true),
        Objective::L2(target) => (target, false),
    };
    let settings = Settings {
        seed: settings.seed ^ OBJECTIVE_SEED,
        // Whoever does a part of the samples needs the same whole image.
        groups: None,
        ..settings.clone()
    };
    let rendering = super::render::render(prepared, &settings, progress)?;
    let mut statistics = Statistics::default();
    statistics.absorb(&rendering.statistics);
    let image = rendering.image;
    check_size(target, [image.width, image.height])?;
    let scale = 1.0 / (3 * image.pixels.len()) as f64;
    let mut loss = 0.0;
    let derivative = |value: f32, target: f32, loss: &mut f64| {
        let difference = f64::from(value) - f64::from(target);
        let slope = if is_l1 {
            *loss += difference.abs() * scale;
            if difference == 0.0 {
                0.0
            } else {
                difference.signum()
            }
        } else {
            *loss += difference * difference * scale;
            2.0 * difference
        };
        (slope * scale) as f32
    };
    let pixels = image
        .pixels
        .iter()
        .zip(&target.pixels)
        .map(|(value, target)| std::array::from_fn(|c| derivative(value[c], target[c], &mut loss)))
        .collect();
    let adjoint = Image {
        width: image.width,
        height: image.height,
        pixels,
    };
    Ok(Evaluation {
        loss,
        adjoint,
        image: Some(image),
        statistics,
    })
}

/// Takes a power of two out of an objective's derivative by the image, and returns it. The sweep multiplies the derivative
/// with radiances in single precision, where the square of a large radiance would overflow.
fn to_unit_magnitude(adjoint: &mut Image) -> f64 {
    let values = || adjoint.pixels.iter().flatten();
    let largest = values().fold(0.0f32, |most, v| most.max(v.abs()));
    // Everything else is as exact as it is.
    if largest == 0.0 || (LEAST_MAGNITUDE..1.0 / LEAST_MAGNITUDE).contains(&largest) {
        return 1.0;
    }
    let exponent = f64::from(largest).log2().floor();
    let magnitude = exponent.exp2();
    for v in adjoint.pixels.iter_mut().flatten() {
        *v = (f64::from(*v) / magnitude) as f32;
    }
    magnitude
}

fn check_size(image: &Image, [width, height]: [usize; 2]) -> Result<(), EngineError> {
    if [image.width, image.height] == [width, height] {
        return Ok(());
    }
    Err(EngineError::Refused(format!(
        "the image given has {}×{} pixels, the rendering has {width}×{height}",
        image.width, image.height
    )))
}

/// The sum over pixels and channels of the products: the value of [`Objective::Adjoint`].
pub fn inner_product(a: &Image, b: &Image) -> f64 {
    a.pixels
        .iter()
        .flatten()
        .zip(b.pixels.iter().flatten())
        .map(|(x, y)| *x as f64 * *y as f64)
        .sum()
}

/// A tile's part of the gradient.
fn differentiate(
    stage: &Stage,
    sweep: &ReverseSweep,
    traced: &TracedTile,
    adjoint: &[Rgb],
    sums: &mut TileSums,
) -> TileGradient {
    let [columns, rows] = traced.tile.points;
    let width = stage.size[0];
    let mut bars = vec![[0.0; 3]; columns * rows];
    let mut row_bars = Vec::new();
    for (row, y_taps) in traced.taps[1].iter().enumerate() {
        gather_row(adjoint, width, &traced.taps[0], y_taps, &mut row_bars);
        bars[row * columns..(row + 1) * columns].copy_from_slice(&row_bars);
    }
    for (number, packet) in traced.packets(sweep.tracer.adjacency.is_some()).enumerate() {
        let mut lanes = [Vec3::ZERO; LANES];
        for lane in (0..LANES).filter(|&l| packet.active >> l & 1 == 1) {
            lanes[lane] = Vec3::from(bars[packet.row * columns + packet.column + lane]);
        }
        if lanes.iter().any(|b| *b != Vec3::ZERO) {
            sweep.add_path(
                &traced.store,
                number,
                [packet.u, packet.v],
                from_lanes(&lanes),
                sums,
            );
            sums.end_term();
        }
    }
    for crossing in &traced.store.film_crossings {
        let line = traced.tile.step[1 - crossing.axis as usize] as f32;
        let [x, y] = [0, 1].map(|i| stage.filter.taps(i, crossing.at[i]));
        let bar = gather_point(adjoint, width, &x, &y).map(|c| c * line);
        if bar != [0.0; 3] {
            sweep.add_film_crossing(crossing, bar, sums);
            sums.end_term();
        }
    }
    sums.take()
}
