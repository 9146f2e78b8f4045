//! What every method sets up: geometry, acceleration structure, lights, film, and threads that work through tiles.

use super::{EngineError, Image, Progress, Settings, Statistics, refusals};
use crate::paths::camera::Camera;
use crate::paths::film::{Block, FilmFilter};
use crate::paths::lattice::Lattice;
use crate::paths::lights::Lights;
use crate::paths::materials::MaterialTable;
use crate::paths::sky::Sky;
use crate::paths::tracer::{Counts, PathLimits, Tracer};
use crate::scene::{Film, Rgb, Scene, SceneDifferential};
use crate::trace::geometry::Geometry;
use crate::trace::{Accel, AccelOptions, MeshView};
use crate::warp::adjacency::Adjacency;
use rayon::prelude::*;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Independent groups of samples behind a standard error, at least.
const MIN_GROUPS: u32 = 4;

/// Tiles handed to the threads at once, a thread: their results wait in memory until they are added in order.
const TILES_PER_THREAD: usize = 8;

/// Everything that does not depend on a direction in parameter space.
pub struct Stage<'a> {
    pub scene: &'a Scene,
    pub geometry: Geometry,
    pub accel: Accel,
    pub lights: Lights,
    pub materials: MaterialTable,
    pub sky: Option<Sky>,
    pub adjacency: Option<Adjacency>,
    pub camera: Camera,
    pub lattice: Lattice,
    pub filter: FilmFilter,
    pub limits: PathLimits,
    pub size: [usize; 2],
    /// Independent groups of `spp / groups` samples.
    pub groups: u32,
    pub seed: u64,
    pool: rayon::ThreadPool,
    threads: usize,
}

impl<'a> Stage<'a> {
    /// Builds; `visibility`: silhouettes will be asked for.
    pub fn new(
        scene: &'a Scene,
        settings: &Settings,
        visibility: bool,
        statistics: &mut Statistics,
    ) -> Result<Self, EngineError> {
        let start = Instant::now();
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
        let film = &sensor.film;
        if film.filter.radius() > 4.0 {
            return Err(EngineError::Refused(format!(
                "the film's filter reaches {} pixels; at most 4 are supported",
                film.filter.radius()
            )));
        }
        let threads = settings.threads.max(1);
        let failed = |e: &dyn std::fmt::Display| EngineError::Failed(e.to_string());
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|e| failed(&e))?;
        let geometry = Geometry::new(scene);
        let views: Vec<MeshView> = scene
            .meshes
            .iter()
            .map(|m| MeshView {
                positions: &m.positions,
                triangles: &m.triangles,
            })
            .collect();
        let options = AccelOptions::new(true, threads).on(settings.backend);
        let accel = Accel::build(&views, options).map_err(|e| failed(&e))?;
        let lights = Lights::new(scene, &geometry, false);
        let sky = scene.environment.as_ref().and_then(|e| {
            let map = e.map.as_ref()?;
            Some(Sky::new(&scene.textures[e.radiance], map))
        });
        let adjacency = visibility.then(|| pool.install(|| Adjacency::new(&geometry)));
        let groups = if settings.standard_error {
            group_count(settings.spp)
        } else {
            1
        };
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
            geometry,
            accel,
            lights,
            materials: MaterialTable::new(scene),
            sky,
            adjacency,
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
            pool,
            threads,
        })
    }

    /// Sees to it that what is black now, and asked about, is sampled all the same.
    pub fn ask_about(&mut self, request: &SceneDifferential) {
        self.limits.black_goes_on = refusals::asks_about_black(self.scene, request);
        if self
            .scene
            .area_lights
            .iter()
            .any(|l| request.texels[l.radiance].is_some())
        {
            self.lights = Lights::new(self.scene, &self.geometry, true);
        }
    }

    /// A tracer over this stage.
    pub fn tracer(&self) -> Tracer<'_> {
        Tracer {
            scene: self.scene,
            geometry: &self.geometry,
            accel: &self.accel,
            lights: &self.lights,
            materials: &self.materials,
            sky: self.sky.as_ref(),
            camera: self.camera,
            limits: self.limits,
            adjacency: self.adjacency.as_ref(),
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
        let total = tiles * self.groups as usize;
        let jobs: Vec<usize> = (0..total).collect();
        for chunk in jobs.chunks(TILES_PER_THREAD * self.threads) {
            if progress.cancelled() {
                return Err(EngineError::Interrupted);
            }
            let results: Vec<(u32, T)> = self.pool.install(|| {
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
            progress.advance(chunk[chunk.len() - 1] as u64 + 1, total as u64);
        }
        Ok(())
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

/// The smallest number of equal groups that is at least [`MIN_GROUPS`], or one sample each.
pub fn group_count(spp: u32) -> u32 {
    (MIN_GROUPS..=spp)
        .find(|g| spp.is_multiple_of(*g))
        .unwrap_or(spp)
}

/// The mean of several groups' images, and its standard error.
pub struct GroupImages {
    width: usize,
    group: Option<u32>,
    current: Vec<Rgb>,
    sum: Vec<[f64; 3]>,
    squares: Vec<[f64; 3]>,
    groups: u32,
}

impl GroupImages {
    pub fn new(stage: &Stage) -> Self {
        let pixels = stage.size[0] * stage.size[1];
        Self {
            width: stage.size[0],
            group: None,
            current: vec![[0.0; 3]; pixels],
            sum: vec![[0.0; 3]; pixels],
            squares: vec![[0.0; 3]; if stage.groups > 1 { pixels } else { 0 }],
            groups: stage.groups,
        }
    }

    /// Adds a tile's part to the image of `group`; groups come one after another.
    pub fn add(&mut self, group: u32, block: &Block) {
        if self.group != Some(group) {
            self.close();
            self.group = Some(group);
        }
        block.add_to(&mut self.current, self.width);
    }

    fn close(&mut self) {
        for (i, pixel) in self.current.iter_mut().enumerate() {
            for c in 0..3 {
                let value = pixel[c] as f64;
                self.sum[i][c] += value;
                if let Some(squares) = self.squares.get_mut(i) {
                    squares[c] += value * value;
                }
            }
            *pixel = [0.0; 3];
        }
    }

    /// Mean and standard error (if there are several groups).
    pub fn finish(mut self) -> (Vec<Rgb>, Option<Vec<Rgb>>) {
        self.close();
        let n = self.groups as f64;
        let mean = self.sum.iter().map(|s| s.map(|x| (x / n) as f32)).collect();
        let error = (self.groups > 1).then(|| {
            let se = |s: f64, q: f64| (((q - s * s / n) / (n - 1.0)).max(0.0) / n).sqrt() as f32;
            self.sum
                .iter()
                .zip(&self.squares)
                .map(|(s, q)| std::array::from_fn(|c| se(s[c], q[c])))
                .collect()
        });
        (mean, error)
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

    /// Hands the time since the start to the stages.
    pub fn stop(self, statistics: &mut Statistics) {
        let seconds = self.started.elapsed().as_secs_f64();
        let (primal, adjoint) = (
            self.primal_ns.into_inner() as f64,
            self.adjoint_ns.into_inner() as f64,
        );
        let share = primal / (primal + adjoint).max(1.0);
        *statistics.seconds.entry("primal").or_default() += seconds * share;
        *statistics.seconds.entry("adjoint").or_default() += seconds * (1.0 - share);
    }
}

impl Statistics {
    /// Adds the time since `start` to a stage.
    pub fn add_seconds(&mut self, stage: &'static str, start: Instant) {
        *self.seconds.entry(stage).or_default() += start.elapsed().as_secs_f64();
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
            ("silhouette_not_found", counts.unresolved),
        ];
        for (cause, count) in rejected.into_iter().filter(|r| r.1 > 0) {
            *self.rejected.entry(cause).or_default() += count;
        }
    }
}
