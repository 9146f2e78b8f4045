//! Reverse mode by `reparam` and `interior`: the gradient of one number for everything that was
//! asked for.

use super::clock::StageClock;
use super::error::EngineError;
use super::group_images::GroupImages;
use super::moving_samples;
use super::objective::{Evaluation, Objective, check_size, evaluate, inner_product};
use super::prepared::Prepared;
use super::progress::Progress;
use super::refusals;
use super::results::BackwardGradient;
use super::settings::Settings;
use super::spare::Spare;
use super::stage::Stage;
use super::statistics::Statistics;
use crate::gradient::path::backward::BackwardSweep;
use crate::gradient::scene::backward::{FilmSums, TileGradient, TileSums};
use crate::gradient::scene::wanted::Wanted;
use crate::gradient::terms::Terms;
use crate::lanes::{LANES, Lane};
use crate::paths::boundary_sample::Coordinate;
use crate::paths::counts::Counts;
use crate::paths::film::filter::{Block, Taps, gather_point, gather_row};
use crate::paths::film::tile::TracedTile;
use crate::paths::integrator::Integrator;
use crate::paths::rays::from_lanes;
use crate::paths::store::TileStore;
use crate::paths::warp::seam::Warp;
use crate::picture::Image;
use crate::room;
use crate::scene::parameters::Gradient;
use crate::scene::{Rgb, SceneDifferential};
use glam::Vec3;
use std::time::Instant;

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
    let sensor = &scene.sensors[settings.sensor];
    refusals::check(scene, request, sensor, settings.method)?;
    let Evaluation {
        loss,
        mut adjoint,
        image,
        mut statistics,
    } = evaluate(prepared, settings, objective, progress)?;
    let magnitude = to_unit_magnitude(&mut adjoint);
    let boundary = settings
        .method
        .boundary()
        .filter(|_| request.moves_edges(scene));
    let settings = settings.weighted_by(&adjoint);
    let settings = &settings.through_lens(sensor, request.moves_edges(scene));
    let mut stage = Stage::new(prepared, settings, boundary, &mut statistics)?;
    stage.ask_about(request);
    stage.check_geometry(settings.method)?;
    check_size(&adjoint, stage.size)?;
    let wanted = Wanted::new(scene, request);
    let asked = Asked {
        request,
        wanted: &wanted,
        adjoint: &adjoint.pixels,
        magnitude,
    };
    let swept = sweep_tiles(&stage, &asked, progress, &mut statistics)?;
    let groups = swept.groups;
    let gradient = SceneDifferential::mean(&groups);
    let own = stage.image(swept.images.finish()?.0);
    let (loss, image) = match objective {
        Objective::Adjoint(adjoint) => (inner_product(&own, adjoint), own),
        _ => (loss, image.unwrap_or(own)),
    };
    Ok(BackwardGradient {
        image,
        gradient: gradient.into(),
        groups: groups.into_iter().map(Gradient::from).collect(),
        loss,
        terms: swept.terms,
        statistics,
    })
}

/// What the gradient is of, and by.
struct Asked<'a> {
    request: &'a SceneDifferential,
    wanted: &'a Wanted,
    /// The derivative by the image, over `magnitude`.
    adjoint: &'a [Rgb],
    magnitude: f64,
}

/// What all tiles add up to.
struct Swept {
    images: GroupImages,
    /// Each group's gradient.
    groups: Vec<SceneDifferential>,
    terms: Terms,
}

/// Traces every tile and differentiates it, given the derivative by the image.
fn sweep_tiles(
    stage: &Stage,
    asked: &Asked,
    progress: &dyn Progress,
    statistics: &mut Statistics,
) -> Result<Swept, EngineError> {
    let clock = StageClock::start();
    let (scene, geometry, wanted) = (stage.scene, &stage.parts.geometry, asked.wanted);
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
    let sweep = BackwardSweep {
        view: &view,
        wanted,
        drift: drift.as_ref(),
        lobe_drift: estimator.lobe_drift(&view),
        filter_follows: estimator.warp().is_some_and(Warp::filter_follows),
    };
    let tools = Tools {
        stage,
        integrator,
        sweep,
        stores: Spare::new(),
        scratch: Spare::new(),
        clock,
    };
    let mut swept = Swept {
        images: stage.group_images()?,
        groups: Vec::new(),
        terms: Terms::new(scene.meshes.len(), scene.textures.len()),
    };
    // Groups come one after another, and large scenes have no room for the sums of all.
    let mut sums = FilmSums::new(scene, geometry, wanted)?;
    let mut not_finite = 0;
    let mut finish = |sums: &mut FilmSums| {
        let mut own = tools.take_scratch();
        not_finite += add_followed(&tools.sweep, sums, &mut own);
        tools.scratch.give_back(own);
        sums.scale(asked.magnitude);
        sums.take(scene, geometry, &stage.camera, asked.request)
    };
    let first = stage.own_groups().start;
    let scratch_bytes = TileSums::bytes_needed(scene, geometry, wanted);
    room::look_for(stage.threads() as u64 * scratch_bytes)?;
    let adjoints = stage.tiling.part(asked.adjoint);
    stage.for_each_tile(
        progress,
        statistics,
        |group, index| {
            let adjoint = &adjoints[stage.tiling.region_of(index)];
            tools.sweep_tile((group, index), adjoint)
        },
        |group, (block, gradient)| {
            if (group - first) as usize > swept.groups.len() {
                swept.groups.push(finish(&mut sums));
            }
            swept.images.add(group, &block);
            sums.add(&gradient);
            swept.terms.absorb(&gradient.terms);
        },
    )?;
    swept.groups.push(finish(&mut sums));
    statistics.add_counts(&Counts {
        gradient_not_finite: not_finite,
        ..Counts::default()
    });
    tools.clock.stop(statistics);
    Ok(swept)
}

/// What tiles are swept with.
struct Tools<'a> {
    stage: &'a Stage<'a>,
    integrator: Integrator<'a>,
    sweep: BackwardSweep<'a>,
    stores: Spare<TileStore>,
    scratch: Spare<TileSums>,
    clock: StageClock,
}

impl Tools<'_> {
    fn take_scratch(&self) -> TileSums {
        let (scene, geometry) = (self.stage.scene, &self.stage.parts.geometry);
        self.scratch
            .take(|| TileSums::new(scene, geometry, self.sweep.wanted))
    }

    /// Traces one tile of a group and differentiates it.
    fn sweep_tile(
        &self,
        (group, index): (u32, usize),
        adjoint: &[Rgb],
    ) -> ((Block, TileGradient), Counts) {
        let stage = self.stage;
        let tile = stage.tile(group, index);
        let start = Instant::now();
        let store = self.stores.take(TileStore::default);
        let view = stage.view_of_tile(group, index);
        let integrator = Integrator {
            view: &view,
            ..self.integrator
        };
        let sweep = BackwardSweep {
            view: &view,
            ..self.sweep
        };
        let traced = TracedTile::trace(&integrator, &stage.filter, tile, true, store);
        let start = self.clock.add_tracing(start);
        let mut block = Block::new(&stage.filter, &traced.tile);
        traced.splat(&traced.image.radiance, &mut block);
        let mut sums = self.take_scratch();
        stage.tiling.keep_own(index, &mut block);
        let gradient = differentiate(stage, &sweep, &traced, adjoint, &mut sums);
        self.clock.add_differentiating(start);
        self.scratch.give_back(sums);
        self.stores.give_back(traced.store);
        let mut counts = traced.counts;
        counts.gradient_not_finite += gradient.not_finite;
        counts.borders.add_brought(&gradient.brought);
        ((block, gradient), counts)
    }
}

/// Hands what a group has collected at the drift's nodes and for bodies to the points that these
/// follow. Returns how much of it was not finite.
fn add_followed(sweep: &BackwardSweep, sums: &mut FilmSums, scratch: &mut TileSums) -> u64 {
    for (body, bar) in std::mem::take(&mut sums.bodies) {
        sweep.add_body(body, bar, scratch);
    }
    for (node, bar) in std::mem::take(&mut sums.drift) {
        for followed in sweep.drift.iter().flat_map(|drift| &drift.followed[node]) {
            let bar = bar.map(|b| b * followed.share);
            sweep.add_followed(followed, bar, scratch);
        }
    }
    let gradient = scratch.take();
    sums.add(&gradient);
    gradient.not_finite
}

/// Takes a power of two out of an objective's derivative by the image, and returns it. The sweep
/// multiplies the derivative with radiances in single precision, where the square of a large
/// radiance would overflow.
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

/// A tile's part of the gradient.
fn differentiate(
    stage: &Stage,
    sweep: &BackwardSweep,
    traced: &TracedTile,
    adjoint: &[Rgb],
    sums: &mut TileSums,
) -> TileGradient {
    let columns = traced.tile.points[0];
    let width = stage.size[0];
    let [x, y] = &traced.taps;
    let bars = sample_bars(traced, [x, y], adjoint, width);
    // Of the velocities of samples, each times its radiance.
    let carries = sweep.drift.is_some() || sweep.filter_follows;
    let carried = carries.then(|| {
        let slopes = [0, 1].map(|i| stage.filter.tile_slopes(&traced.tile, i));
        [[&slopes[0], y], [x, &slopes[1]]].map(|taps| sample_bars(traced, taps, adjoint, width))
    });
    for (number, packet) in traced.packets().enumerate() {
        let mut lanes = [Vec3::ZERO; LANES];
        let place = |lane: usize| packet.row * columns + packet.column + lane;
        for lane in (0..LANES).filter(|&l| packet.active >> l & 1 == 1) {
            lanes[lane] = Vec3::from(bars[place(lane)]);
        }
        if lanes.iter().any(|b| *b != Vec3::ZERO) {
            if traced.store.samples_move() {
                let at = |lane: usize, bars: &[Rgb]| match packet.active >> lane & 1 {
                    1 => Vec3::from(bars[place(lane)]),
                    _ => Vec3::ZERO,
                };
                let carried = carried.as_ref().map(|carried| {
                    [0, 1].map(|i| std::array::from_fn(|lane| at(lane, &carried[i])))
                });
                moving_samples::backward(sweep, traced, number, (&lanes, carried), sums);
                sums.end_term();
                continue;
            }
            let mut path_bars = lanes;
            for lane in (0..LANES).filter(|&l| packet.active >> l & 1 == 1) {
                if traced.leaves_out(place(lane)) {
                    path_bars[lane] = Vec3::ZERO;
                }
            }
            let at = [packet.u, packet.v];
            let path_bars = from_lanes(&path_bars);
            let film_bars = sweep.add_path(&traced.store, number, at, path_bars, sums);
            if let (Some(drift), Some(carried)) = (sweep.drift, &carried) {
                let film_bars = film_bars.map(Lane::to_array);
                let [u, v] = [packet.u, packet.v].map(Lane::to_array);
                for lane in (0..LANES).filter(|&l| packet.active >> l & 1 == 1) {
                    let radiance = Vec3::from(traced.image.radiance[place(lane)]).as_dvec3();
                    let velocity = [0, 1].map(|i| {
                        let bar = Vec3::from(carried[i][place(lane)]).as_dvec3();
                        f64::from(film_bars[i][lane]) + radiance.dot(bar)
                    });
                    let divergence = radiance.dot(lanes[lane].as_dvec3());
                    let at = [u[lane], v[lane]].map(f64::from);
                    sums.add_drift(drift, at, velocity, divergence);
                }
            }
            sums.end_term();
        }
    }
    add_facets(stage, sweep, traced, adjoint, sums);
    add_film_boundary(stage, sweep, traced, adjoint, sums);
    sums.take()
}

/// Adds what jumps on the film.
fn add_film_boundary(
    stage: &Stage,
    sweep: &BackwardSweep,
    traced: &TracedTile,
    adjoint: &[Rgb],
    sums: &mut TileSums,
) {
    for sample in traced.store.film_boundary() {
        let Coordinate::Film { at, piece } = sample.at else {
            continue;
        };
        let mut is_done = false;
        stage.filter.along(at, &piece, |share, at, [x, y]| {
            let bar = gather_point(adjoint, stage.size[0], x, y).map(|c| c * share);
            if bar != [0.0; 3] {
                sweep.add_film_boundary(&traced.store.found, (sample, at), bar, sums);
                is_done = true;
            }
        });
        if is_done {
            sums.end_term();
        }
    }
}

/// Adds what the paths through facets that are seen edge-on bring.
fn add_facets(
    stage: &Stage,
    sweep: &BackwardSweep,
    traced: &TracedTile,
    adjoint: &[Rgb],
    sums: &mut TileSums,
) {
    for (number, packet) in traced.facet_packets() {
        let [u, v] = packet.at.map(Lane::to_array);
        let at = |lane: usize| [u[lane], v[lane]].map(f64::from);
        let bar = |lane: usize| {
            let place = at(lane);
            let [x, y] = [0, 1].map(|i| stage.filter.taps(i, place[i]));
            Vec3::from(gather_point(adjoint, stage.size[0], &x, &y)) * packet.area[lane]
        };
        let counts = |lane: usize| packet.active >> lane & 1 == 1 && packet.area[lane] > 0.0;
        let bars: [Vec3; LANES] = std::array::from_fn(|lane| match counts(lane) {
            true => bar(lane),
            false => Vec3::ZERO,
        });
        if bars.iter().all(|bar| *bar == Vec3::ZERO) {
            continue;
        }
        let film_bars = sweep.add_path(&traced.store, number, packet.at, from_lanes(&bars), sums);
        if let Some(drift) = sweep.drift {
            let film_bars = film_bars.map(Lane::to_array);
            for lane in (0..LANES).filter(|&l| counts(l)) {
                let velocity = film_bars.map(|bars| f64::from(bars[lane]));
                sums.add_drift(drift, at(lane), velocity, 0.0);
            }
        }
        sums.end_term();
    }
}

/// The cotangent of what each sample of a tile brings, if its weights along the axes are these.
fn sample_bars(
    traced: &TracedTile,
    [x, y]: [&Vec<Taps>; 2],
    adjoint: &[Rgb],
    width: usize,
) -> Vec<Rgb> {
    let columns = traced.tile.points[0];
    let mut bars = vec![[0.0; 3]; columns * traced.tile.points[1]];
    let mut row_bars = Vec::new();
    for (row, y_taps) in y.iter().enumerate() {
        gather_row(adjoint, width, x, y_taps, &mut row_bars);
        bars[row * columns..(row + 1) * columns].copy_from_slice(&row_bars);
    }
    bars
}
