//! The image itself.

use super::clock::StageClock;
use super::error::EngineError;
use super::prepared::Prepared;
use super::progress::Progress;
use super::results::Rendering;
use super::settings::Settings;
use super::spare::Spare;
use super::stage::Stage;
use super::statistics::Statistics;
use crate::paths::estimator::Interior;
use crate::paths::film::drift::DriftVelocity;
use crate::paths::film::filter::Block;
use crate::paths::film::tile::{TracedTile, trace_carried};
use crate::paths::integrator::Integrator;
use crate::paths::store::TileStore;
use crate::room;
use crate::scene::Rgb;
use std::time::Instant;

/// Renders the image.
pub fn render(
    prepared: &Prepared,
    settings: &Settings,
    progress: &dyn Progress,
) -> Result<Rendering, EngineError> {
    let mut statistics = Statistics::default();
    let settings = Settings {
        standard_error: false,
        noise: None,
        ..settings.clone()
    };
    let stage = Stage::new(prepared, &settings, None, &mut statistics)?;
    let mut images = stage.group_images()?;
    trace(&stage, None, progress, &mut statistics, |group, block| {
        images.add(group, block)
    })?;
    let image = stage.image(images.finish()?.0);
    Ok(Rendering { image, statistics })
}

/// How the images of a difference are traced.
#[derive(Clone, Copy, Default)]
pub struct Along<'a> {
    /// What samples are carried along with, and for how long.
    pub carried: Option<(&'a DriftVelocity, f64)>,
    /// Paths go on from black surfaces, which on the other side of zero take light away.
    pub black_goes_on: bool,
}

/// Images of each group of samples that is done here.
pub fn group_images(
    prepared: &Prepared,
    settings: &Settings,
    Along {
        carried,
        black_goes_on,
    }: Along,
    progress: &dyn Progress,
    statistics: &mut Statistics,
) -> Result<(Vec<Vec<Rgb>>, [usize; 2]), EngineError> {
    let mut stage = Stage::new(prepared, settings, None, statistics)?;
    stage.limits.black_goes_on = black_goes_on;
    let pixels = stage.size[0] * stage.size[1];
    let own = stage.own_groups();
    let images = own.clone().map(|_| room::filled([0.0; 3], pixels));
    let mut images = images.collect::<Result<Vec<_>, _>>()?;
    let width = stage.size[0];
    trace(&stage, carried, progress, statistics, |group, block| {
        block.add_to(&mut images[(group - own.start) as usize], width);
    })?;
    Ok((images, stage.size))
}

fn trace(
    stage: &Stage,
    carried: Option<(&DriftVelocity, f64)>,
    progress: &dyn Progress,
    statistics: &mut Statistics,
    mut merge: impl FnMut(u32, &Block),
) -> Result<(), EngineError> {
    let clock = StageClock::start();
    let view = stage.view();
    let integrator = Integrator {
        view: &view,
        estimator: &Interior,
        drift: None,
        edge_on: None,
        twin: 0,
    };
    let stores = Spare::new();
    stage.for_each_tile(
        progress,
        statistics,
        |group, index| {
            let start = Instant::now();
            let tile = stage.tile(group, index);
            let mut store = stores.take(TileStore::default);
            let carried = carried.filter(|(velocity, _)| !velocity.rests_over(&tile));
            let (mut block, counts) = if let Some(carried) = carried {
                trace_carried(&integrator, &stage.filter, &tile, carried, &mut store)
            } else {
                let traced = TracedTile::trace(&integrator, &stage.filter, tile, false, store);
                let mut block = Block::new(&stage.filter, &traced.tile);
                traced.splat(&traced.image.radiance, &mut block);
                store = traced.store;
                (block, traced.counts)
            };
            stage.tiling.keep_own(index, &mut block);
            clock.add_tracing(start);
            stores.give_back(store);
            (block, counts)
        },
        |group, block| merge(group, &block),
    )?;
    clock.stop_tracing(statistics);
    Ok(())
}
