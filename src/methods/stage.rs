//! What every method sets up for one image: camera, film, groups of samples, and the way through
//! their tiles.

use super::error::EngineError;
use super::estimators::{Constants, MakeBoundary, Method};
use super::group_images::GroupImages;
use super::parts::Parts;
use super::prepared::Prepared;
use super::progress::Progress;
use super::reach;
use super::refusals;
use super::settings::{Groups, Settings};
use super::statistics::Statistics;
use super::workers::Workers;
use crate::boundary::mixture::Mixture;
use crate::discontinuity::adjacency::Adjacency;
use crate::paths::counts::Counts;
use crate::paths::dimensions::Single;
use crate::paths::estimator::{BoundaryEstimator, Interior, WholeFilm};
use crate::paths::film::camera::Camera;
use crate::paths::film::drift::Drift;
use crate::paths::film::edge_on::EdgeOnFacets;
use crate::paths::film::filter::FilmFilter;
use crate::paths::film::lattice::{Lattice, Tile};
use crate::paths::film::tiling::Tiling;
use crate::paths::light::patches::Lights;
use crate::paths::moving::Moving;
use crate::paths::random::Stream;
use crate::paths::scene_view::{PathLimits, SceneView};
use crate::picture::Image;
use crate::room::NoRoom;
use crate::scene::{DeltaLight, DeltaLightKind, Film, Rgb, Scene, SceneDifferential, Sensor};
use glam::{Vec3, Vec3A};
use rayon::prelude::*;
use std::sync::Arc;
use std::time::Instant;

/// Tiles handed to the threads at once, a thread: their results wait in memory until they are added
/// in order.
const TILES_PER_THREAD: usize = 8;

/// Everything that does not depend on a direction in parameter space.
pub struct Stage<'a> {
    pub scene: &'a Scene,
    pub parts: Parts,
    boundary: Option<MakeBoundary>,
    moving: Moving,
    /// Whether each tile looks through one point of the lens.
    has_tile_lenses: bool,
    constants: Constants,
    pub camera: Camera,
    /// About the origin of what is traced.
    delta_lights: Vec<DeltaLight>,
    /// That of the film where it is sampled evenly.
    pub lattice: Lattice,
    pub tiling: Tiling,
    pub filter: FilmFilter,
    pub limits: PathLimits,
    pub size: [usize; 2],
    /// Independent groups of `spp / groups` samples.
    pub groups: u32,
    pub seed: u64,
    only: Option<u32>,
    part_of_film: Option<f64>,
    counts_tiles: bool,
    workers: Workers,
}

impl<'a> Stage<'a> {
    /// `boundary` makes what finds the boundary terms, if they are asked for.
    pub fn new(
        prepared: &Prepared<'a>,
        settings: &Settings,
        boundary: Option<MakeBoundary>,
        statistics: &mut Statistics,
    ) -> Result<Self, EngineError> {
        let start = Instant::now();
        let (scene, parts) = (prepared.scene, prepared.parts.clone());
        if settings.spp == 0 {
            return Err(EngineError::Refused(
                "at least one sample a pixel is needed: --spp 1 or more".into(),
            ));
        }
        let mut sensor = sensor(scene, settings)?;
        let origin = parts.origin();
        sensor.to_world.translation -= Vec3A::from(origin);
        if let (Some(_), Some(film)) = (boundary, settings.method.estimator().film) {
            sensor.film =
                film(&settings.constants.warp, sensor.film).map_err(EngineError::Refused)?;
        }
        let film = &sensor.film;
        if boundary.is_some() {
            let pool = &prepared.workers.pool;
            let make = || pool.install(|| Adjacency::new(&parts.geometry));
            parts.adjacency.get_or_init(make);
        }
        let Groups {
            count: groups,
            only,
        } = settings.groups();
        let border = if film.sample_border {
            FilmFilter::border(film.filter)
        } else {
            0
        };
        let of_group = settings.spp / groups;
        let make_lattice = |samples| match settings.part_of_film {
            None => Lattice::new(samples, film.crop_size, border),
            Some(_) => Lattice::in_small_tiles(samples, film.crop_size, border),
        };
        let lattice = make_lattice(of_group);
        let filter = FilmFilter::new(film.filter, film.crop_size, &lattice);
        let size = film.crop_size.map(|s| s as usize);
        let noise = settings.noise.as_ref();
        let plan = noise.and_then(|noise| noise.plan(size, of_group, filter.reach()));
        let tiling = match plan {
            None => Tiling::Even(lattice.clone()),
            Some(plan) => Tiling::uneven(plan.density, &filter, make_lattice),
        };
        statistics.add_seconds("build", start);
        Ok(Self {
            scene,
            parts,
            boundary,
            moving: Moving::default(),
            has_tile_lenses: false,
            constants: settings.constants,
            camera: Camera::new(&sensor),
            delta_lights: placed(&scene.delta_lights, origin),
            lattice,
            tiling,
            filter,
            limits: PathLimits {
                max_depth: settings.max_depth,
                rr_depth: settings.rr_depth,
                hide_emitters: settings.hide_emitters,
                black_goes_on: false,
            },
            size,
            groups,
            seed: settings.seed,
            only,
            part_of_film: settings.part_of_film,
            counts_tiles: settings.counts_tiles,
            workers: prepared.workers.clone(),
        })
    }

    /// Sees to it that what is asked about is looked for where it moves, and sampled where it is
    /// black now.
    pub fn ask_about(&mut self, request: &SceneDifferential) {
        self.has_tile_lenses = request.moves_edges(self.scene);
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

    /// Whether what the camera sees moves only if it does so itself.
    pub fn camera_rests(&self) -> bool {
        self.moving.camera_lanes() == 0
    }

    /// Refuses what the method would not find in the geometry, where boundary terms are asked for.
    pub fn check_geometry(&self, method: Method) -> Result<(), EngineError> {
        self.check_meshes(method, &|_| true)
    }

    /// The same of what is seen from points that rest.
    pub fn check_geometry_from_rest(&self, method: Method) -> Result<(), EngineError> {
        self.check_meshes(method, &|mesh| self.moving.moves_mesh(mesh))
    }

    fn check_meshes(
        &self,
        method: Method,
        moves: &(dyn Fn(usize) -> bool + Sync),
    ) -> Result<(), EngineError> {
        match (self.boundary, self.parts.adjacency.get()) {
            (Some(_), Some(adjacency)) => {
                let view = self.view();
                let check = || refusals::check_geometry(&view, adjacency, method, moves);
                self.workers.pool.install(check)
            }
            _ => Ok(()),
        }
    }

    /// The scene as this stage's paths see it.
    pub fn view(&self) -> SceneView<'_> {
        SceneView {
            scene: self.scene,
            delta_lights: &self.delta_lights,
            geometry: &self.parts.geometry,
            accel: &self.parts.accel,
            lights: &self.parts.lights,
            materials: &self.parts.materials,
            map_distribution: self.parts.map_distribution.as_deref(),
            camera: self.camera,
            limits: self.limits,
        }
    }

    /// The same as the paths of a tile see it: if something moves, through one point of the lens.
    /// So what is found between neighbours is found as with a pinhole.
    pub fn view_of_tile(&self, group: u32, tile: usize) -> SceneView<'_> {
        let mut view = self.view();
        if self.has_tile_lenses {
            let stream = Stream::new(self.seed, [group, tile as u32]);
            let number = |axis| stream.single(Single::TileLensPoint, [axis, 0, 0]);
            view.camera = view.camera.through([number(0), number(1)]);
        }
        view
    }

    /// What finds the boundary terms that are asked for.
    pub fn estimator(&self) -> Box<dyn BoundaryEstimator + '_> {
        match (self.boundary, self.parts.adjacency.get()) {
            (Some(make), Some(adjacency)) => make(adjacency, &self.moving, &self.constants),
            _ => Box::new(Interior),
        }
    }

    /// What would carry the film's samples with a mixture.
    pub fn drift_by(&self, mixture: Mixture) -> Option<Drift> {
        let (make, adjacency) = (self.boundary?, self.parts.adjacency.get()?);
        let constants = Constants {
            mixture: Some(mixture),
            ..self.constants
        };
        self.drift(&self.view(), &*make(adjacency, &self.moving, &constants))
    }

    /// What has samples of its own on the film, for an estimator of boundary terms.
    pub fn edge_on(&self, estimator: &dyn BoundaryEstimator) -> Option<EdgeOnFacets> {
        let samples_rest = self.boundary.is_some() && estimator.warp().is_none();
        let moves = |mesh| self.moving.moves_mesh(mesh);
        let find = || EdgeOnFacets::new(&self.parts.geometry, &self.camera, moves);
        samples_rest.then(|| self.workers.pool.install(find))?
    }

    /// What carries the film's samples.
    pub fn drift(&self, view: &SceneView, estimator: &dyn BoundaryEstimator) -> Option<Drift> {
        let film = WholeFilm {
            view,
            lattice: &self.lattice,
            filter: &self.filter,
            seed: self.seed,
        };
        self.workers.pool.install(|| estimator.drift(&film))
    }

    /// Tile `index` of group `group`.
    pub fn tile(&self, group: u32, index: usize) -> Tile {
        self.tiling.tile(index, group, self.seed)
    }

    /// Does `work(group, tile)` for all tiles of all groups on the threads, and gives the results
    /// to `merge` in order: sums do not depend on the number of threads. Adds up what tiles count.
    pub fn for_each_tile<T: Send>(
        &self,
        progress: &dyn Progress,
        statistics: &mut Statistics,
        work: impl Fn(u32, usize) -> (T, Counts) + Sync,
        mut merge: impl FnMut(u32, T),
    ) -> Result<(), EngineError> {
        let tiles = self.own_tiles();
        let groups = self.own_groups();
        let total = tiles.len() * groups.len();
        let of_group = |group: u32| tiles.iter().map(move |&tile| (group, tile));
        let jobs: Vec<(u32, usize)> = groups.flat_map(of_group).collect();
        let mut done = 0;
        let mut counts = Counts::default();
        for chunk in jobs.chunks(TILES_PER_THREAD * self.workers.threads) {
            if progress.cancelled() {
                return Err(EngineError::Interrupted);
            }
            let results: Vec<(T, Counts)> = self.workers.pool.install(|| {
                let jobs = chunk.par_iter().with_max_len(1);
                jobs.map(|&(group, tile)| work(group, tile)).collect()
            });
            for (&(group, tile), (result, of_tile)) in chunk.iter().zip(results) {
                merge(group, result);
                counts += of_tile;
                if self.counts_tiles {
                    let pixels = self.lattice.pixels_of(tile);
                    statistics.tiles.push((pixels, of_tile));
                }
            }
            done += chunk.len();
            progress.advance(done as u64, total as u64);
        }
        statistics.add_counts(&counts);
        Ok(())
    }

    /// The tiles that are done here.
    fn own_tiles(&self) -> Vec<usize> {
        match self.part_of_film {
            None => (0..self.tiling.tile_count()).collect(),
            Some(part) => self.lattice.some_tiles(part),
        }
    }

    /// Their share in all.
    pub fn part_of_tiles(&self) -> f64 {
        self.own_tiles().len() as f64 / self.lattice.tile_count() as f64
    }

    /// The groups that are done here.
    pub fn own_groups(&self) -> std::ops::Range<u32> {
        match self.only {
            Some(group) => group..group + 1,
            None => 0..self.groups,
        }
    }

    /// That work through tiles.
    pub fn threads(&self) -> usize {
        self.workers.threads
    }

    /// For the mean of the images of the groups that are done here.
    pub fn group_images(&self) -> Result<GroupImages, NoRoom> {
        GroupImages::new(self.size, self.own_groups().len() as u32)
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

/// Lights about another origin.
fn placed(lights: &[DeltaLight], origin: Vec3) -> Vec<DeltaLight> {
    let mut placed = lights.to_vec();
    for light in &mut placed {
        if let DeltaLightKind::Point { position } = &mut light.kind {
            *position -= origin;
        }
    }
    placed
}

/// The sensor with the film that is asked for. What is beyond single precision, or beyond the
/// sampling of films, is refused.
fn sensor(scene: &Scene, settings: &Settings) -> Result<Sensor, EngineError> {
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
    reach::check_view(scene, &sensor)?;
    let radius = sensor.film.filter.radius();
    if radius > 4.0 {
        return Err(EngineError::Refused(format!(
            "the film's filter reaches {radius} pixels; at most 4 are supported",
        )));
    }
    Ok(sensor)
}
