//! What every method sets up for one image: camera, film, groups of samples, and the way through their tiles.

use super::groups::group_count;
use super::{
    EngineError, Groups, Image, Parts, Prepared, Progress, Settings, Statistics, Workers, refusals,
};
use crate::boundary::cells::Cells;
use crate::discontinuity::adjacency::Adjacency;
use crate::paths::counts::Counts;
use crate::paths::estimator::{BoundaryEstimator, Interior};
use crate::paths::film::camera::Camera;
use crate::paths::film::filter::FilmFilter;
use crate::paths::film::lattice::Lattice;
use crate::paths::light::patches::Lights;
use crate::paths::moving::Moving;
use crate::paths::scene_view::{PathLimits, SceneView};
use crate::scene::{Film, Rgb, Scene, SceneDifferential};
use rayon::prelude::*;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Tiles handed to the threads at once, a thread: their results wait in memory until they are added in order.
const TILES_PER_THREAD: usize = 8;

/// Everything that does not depend on a direction in parameter space.
pub struct Stage<'a> {
    pub scene: &'a Scene,
    pub parts: Parts,
    /// Whether silhouettes are asked for.
    visibility: bool,
    moving: Moving,
    pub camera: Camera,
    pub lattice: Lattice,
    pub filter: FilmFilter,
    pub limits: PathLimits,
    pub size: [usize; 2],
    /// Independent groups of `spp / groups` samples.
    pub groups: u32,
    pub seed: u64,
    only: Option<u32>,
    workers: Workers,
}

impl<'a> Stage<'a> {
    /// `visibility`: silhouettes will be asked for.
    pub fn new(
        prepared: &Prepared<'a>,
        settings: &Settings,
        visibility: bool,
        statistics: &mut Statistics,
    ) -> Result<Self, EngineError> {
        let start = Instant::now();
        let (scene, parts) = (prepared.scene, prepared.parts.clone());
        if settings.spp == 0 {
            return Err(EngineError::Refused(
                "at least one sample a pixel is needed: --spp 1 or more".into(),
            ));
        }
        let mut sensor = scene.sensors[settings.sensor].clone();
        if let Some([width, height]) = settings.resolution {
            sensor.film = Film {
                width,
                height,
                crop_offset: [0; 2],
                crop_size: [width, height],
                ..sensor.film
            };
        }
        refusals::check_view(scene, &sensor)?;
        let film = &sensor.film;
        if film.filter.radius() > 4.0 {
            return Err(EngineError::Refused(format!(
                "the film's filter reaches {} pixels; at most 4 are supported",
                film.filter.radius()
            )));
        }
        if visibility {
            let pool = &prepared.workers.pool;
            let make = || pool.install(|| Adjacency::new(&parts.geometry));
            parts.adjacency.get_or_init(make);
        }
        let Groups {
            count: groups,
            only,
        } = settings.groups.unwrap_or(Groups {
            count: match settings.standard_error {
                true => group_count(settings.spp),
                false => 1,
            },
            only: None,
        });
        let border = if film.sample_border {
            FilmFilter::border(film.filter)
        } else {
            0
        };
        let lattice = Lattice::new(settings.spp / groups, film.crop_size, border);
        let filter = FilmFilter::new(film.filter, film.crop_size, &lattice);
        statistics.add_seconds("build", start);
        Ok(Self {
            scene,
            parts,
            visibility,
            moving: Moving::default(),
            camera: Camera::new(&sensor),
            lattice,
            filter,
            limits: PathLimits {
                max_depth: settings.max_depth,
                rr_depth: settings.rr_depth,
                hide_emitters: settings.hide_emitters,
                black_goes_on: false,
            },
            size: film.crop_size.map(|s| s as usize),
            groups,
            seed: settings.seed,
            only,
            workers: prepared.workers.clone(),
        })
    }

    /// Sees to it that what is asked about is looked for where it moves, and sampled where it is black now.
    pub fn ask_about(&mut self, request: &SceneDifferential) {
        self.moving = Moving::new(self.scene, &self.parts.geometry, request);
        self.limits.black_goes_on = refusals::asks_about_black(self.scene, request);
        if self
            .scene
            .area_lights
            .iter()
            .any(|l| request.texels[l.radiance].is_some())
        {
            let new = || Lights::new(self.scene, &self.parts.geometry, true);
            self.parts.lights = Arc::new(self.workers.pool.install(new));
        }
    }

    /// The scene as this stage's paths see it.
    pub fn view(&self) -> SceneView<'_> {
        SceneView {
            scene: self.scene,
            geometry: &self.parts.geometry,
            accel: &self.parts.accel,
            lights: &self.parts.lights,
            materials: &self.parts.materials,
            sky: self.parts.sky.as_deref(),
            camera: self.camera,
            limits: self.limits,
        }
    }

    /// What finds the boundary terms that are asked for.
    pub fn estimator(&self) -> Box<dyn BoundaryEstimator + '_> {
        match self.parts.adjacency.get() {
            Some(adjacency) if self.visibility => Box::new(Cells {
                adjacency,
                moving: &self.moving,
            }),
            _ => Box::new(Interior),
        }
    }

    /// Does `work(group, tile)` for all tiles of all groups on the threads, and gives the results to `merge` in
    /// order: sums do not depend on the number of threads.
    pub fn for_each_tile<T: Send>(
        &self,
        progress: &dyn Progress,
        work: impl Fn(u32, usize) -> T + Sync,
        mut merge: impl FnMut(u32, T),
    ) -> Result<(), EngineError> {
        let tiles = self.lattice.tile_count();
        let groups = self.own_groups();
        let (first, total) = (tiles * groups.start as usize, tiles * groups.len());
        let jobs: Vec<usize> = (first..first + total).collect();
        for chunk in jobs.chunks(TILES_PER_THREAD * self.workers.threads) {
            if progress.cancelled() {
                return Err(EngineError::Interrupted);
            }
            let results: Vec<(u32, T)> = self.workers.pool.install(|| {
                chunk
                    .par_iter()
                    .with_max_len(1)
                    .map(|&job| {
                        (
                            (job / tiles) as u32,
                            work((job / tiles) as u32, job % tiles),
                        )
                    })
                    .collect()
            });
            for (group, result) in results {
                merge(group, result);
            }
            progress.advance((chunk[chunk.len() - 1] + 1 - first) as u64, total as u64);
        }
        Ok(())
    }

    /// The groups that are done here.
    pub fn own_groups(&self) -> std::ops::Range<u32> {
        match self.only {
            Some(group) => group..group + 1,
            None => 0..self.groups,
        }
    }

    /// An image of this stage's size.
    pub fn image(&self, pixels: Vec<Rgb>) -> Image {
        Image {
            width: self.size[0],
            height: self.size[1],
            pixels,
        }
    }
}

/// Parts the time of a sweep over tiles into tracing and differentiating, by what the threads spent on each.
pub struct StageClock {
    started: Instant,
    primal_ns: AtomicU64,
    adjoint_ns: AtomicU64,
}

impl StageClock {
    pub fn start() -> Self {
        Self {
            started: Instant::now(),
            primal_ns: AtomicU64::new(0),
            adjoint_ns: AtomicU64::new(0),
        }
    }

    /// A thread has traced since `start`; now.
    pub fn add_primal(&self, start: Instant) -> Instant {
        self.primal_ns
            .fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
        Instant::now()
    }

    /// A thread has differentiated since `start`.
    pub fn add_adjoint(&self, start: Instant) {
        self.adjoint_ns
            .fetch_add(start.elapsed().as_nanos() as u64, Ordering::Relaxed);
    }

    /// As [`StageClock::stop`], of a sweep that only traced.
    pub fn stop_primal(self, statistics: &mut Statistics) {
        statistics.add_seconds("primal", self.started);
        statistics.tile_seconds += self.primal_ns.into_inner() as f64 * 1e-9;
    }

    /// Hands the time since the start to the stages.
    pub fn stop(self, statistics: &mut Statistics) {
        let seconds = self.started.elapsed().as_secs_f64();
        let (primal, adjoint) = (
            self.primal_ns.into_inner() as f64,
            self.adjoint_ns.into_inner() as f64,
        );
        let share = primal / (primal + adjoint).max(1.0);
        statistics.spend("primal", seconds * share);
        statistics.spend("adjoint", seconds * (1.0 - share));
        statistics.tile_seconds += (primal + adjoint) * 1e-9;
    }
}

impl Statistics {
    /// Adds to a stage's time.
    pub fn spend(&mut self, stage: &'static str, seconds: f64) {
        *self.seconds.entry(stage).or_default() += seconds;
    }

    /// Adds the time since `start` to a stage.
    pub fn add_seconds(&mut self, stage: &'static str, start: Instant) {
        self.spend(stage, start.elapsed().as_secs_f64());
    }

    /// Adds what another run did, but for its remarks.
    pub fn absorb(&mut self, other: &Statistics) {
        for (&stage, &seconds) in &other.seconds {
            self.spend(stage, seconds);
        }
        for (&kind, &count) in &other.rays {
            *self.rays.entry(kind).or_default() += count;
        }
        self.silhouettes += other.silhouettes;
        for (&cause, &count) in &other.rejected {
            *self.rejected.entry(cause).or_default() += count;
        }
        self.tile_seconds += other.tile_seconds;
    }

    /// Adds what tiles counted.
    pub fn add_counts(&mut self, counts: &Counts) {
        let rays = [
            ("camera", counts.camera),
            ("shadow", counts.shadow),
            ("bounce", counts.bounce),
            ("light_cell", counts.light_cell),
            ("bounce_cell", counts.bounce_cell),
            ("sky_cell", counts.sky_cell),
            ("probe", counts.probe),
        ];
        for (kind, count) in rays.into_iter().filter(|r| r.1 > 0) {
            *self.rays.entry(kind).or_default() += count;
        }
        self.silhouettes += counts.resolved;
        let rejected = [
            ("not_finite", counts.not_finite),
            ("boundary_not_finite", counts.boundary_not_finite),
            ("gradient_not_finite", counts.gradient_not_finite),
            ("silhouette_not_found", counts.unresolved),
        ];
        for (cause, count) in rejected.into_iter().filter(|r| r.1 > 0) {
            *self.rejected.entry(cause).or_default() += count;
        }
    }
}
