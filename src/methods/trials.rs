//! What a pilot finds out by trial: how much noise a way has, and how much work it is.

use super::contender::Contender;
use super::decisions::Answer;
use super::differences;
use super::error::EngineError;
use super::estimators::Method;
use super::looks::{self, Job, Look};
use super::noise_map::{NoiseMap, Plan, Survey};
use super::prepared::Prepared;
use super::progress::{Progress, Quietly};
use super::results::ForwardGradient;
use super::settings::Settings;
use super::stage::Stage;
use super::statistics::{Pilot, Statistics};
use super::steps::Steps;
use super::tails::share_of_worst_seen;
use super::tried::{AllTried, Tried, WORST_IN};
use super::work::{BORDER_US, DISPLACED_VERTEX_US, work};
use crate::boundary::mixture::{Mixture, OnFilm, OverLobes};
use crate::paths::film::drift::Drift;
use crate::paths::integral::Integral;
use crate::picture::Image;
use crate::scene::SceneDifferential;
use crate::scene::parameters::{self, Parameter};
use std::collections::BTreeMap;
use std::sync::Arc;

/// What is tried first.
const USUAL: Mixture = Mixture {
    film: OnFilm::Drifting,
    lobes: OverLobes::Cells,
};

/// Where differences are so many times better than what is usual, other mixtures are not tried.
const CLEARLY: f64 = 4.0;

/// Looks are dense that have one sample of a pixel for this many of the job.
const DENSE: u32 = 4;

/// Fewer lines over lobes are tried if more than this of the work is beside borders.
const MOSTLY: f64 = 0.6;

/// Edges over lobes are tried if no greater part of the vertices moves, as a lamp over a forest. On
/// 147 directions by cameras and large meshes they were never better by a fifth.
const FEW: f64 = 0.25;

/// Parameters and their tangents.
type Direction<'a> = &'a [(Parameter, Vec<f32>)];

/// Trials for one job.
pub struct Trials<'a> {
    prepared: &'a Prepared<'a>,
    settings: Settings,
    direction: Direction<'a>,
    job: Job,
    progress: &'a dyn Progress,
    /// What differences would step by, if they may answer.
    steps: Option<Steps>,
    done: AllTried,
}

impl<'a> Trials<'a> {
    pub fn new(
        prepared: &'a Prepared<'a>,
        settings: Settings,
        (direction, job): (Direction<'a>, Job),
        progress: &'a dyn Progress,
    ) -> Self {
        Self {
            prepared,
            settings,
            direction,
            job,
            progress,
            steps: None,
            done: AllTried::new(job.whole_look()),
        }
    }

    /// Differences may answer, too: looks at the usual way foretell their noise.
    pub fn allow_differences(&mut self) -> Result<(), EngineError> {
        let settings = Settings {
            method: Method::CarriedFd,
            seed: looks::SEED,
            ..self.settings.clone()
        };
        self.steps = Some(Steps::usual(self.prepared, &settings, self.direction)?);
        Ok(())
    }

    /// Looks at a mixture with so many paths; a longer look replaces one before.
    fn run(&mut self, mixture: Mixture, paths: f64) -> Result<(), EngineError> {
        let mut look = Look::new(self.prepared, &self.settings, self.job, paths)?;
        look.settings.constants.mixture = Some(mixture);
        let (found, foretold) = super::forward::forward_and_foretell(
            self.prepared,
            &look.settings,
            &self.tangent()?,
            Method::Auto.boundary(),
            self.steps.as_ref().filter(|_| mixture == USUAL),
            &Quietly(self.progress),
        )?;
        if mixture == USUAL {
            self.done.foretold_of_differences = self.of_job(foretold, &look);
        }
        let way = Contender::Mixture(mixture);
        let work = self.work(way, &found, &look);
        let variance = self.variance(&found, &look);
        self.add(way, paths, [variance, work], &found);
        Ok(())
    }

    /// The same with differences.
    fn run_differences(&mut self, paths: f64) -> Result<(), EngineError> {
        let look = Look::new(self.prepared, &self.settings, self.job, paths)?;
        let steps = self.steps();
        let found = self.look_by_differences(&look.settings)?;
        let way = Contender::Differences {
            carried: steps.carried().is_some(),
        };
        let variance = self.variance(&found, &look);
        let mut work = self.work(way, &found, &look);
        if steps.carried().is_some() {
            work *= steps.work_over_first(&self.settings);
        }
        work += DISPLACED_VERTEX_US * steps.scenes() as f64 * self.moved_vertices()?;
        work *= self.job.differences as f64;
        self.add(way, paths, [variance, work], &found);
        Ok(())
    }

    fn steps(&self) -> &Steps {
        let steps = self.steps.as_ref();
        steps.expect("steps, where differences may answer")
    }

    fn look_by_differences(&self, settings: &Settings) -> Result<ForwardGradient, EngineError> {
        let quiet = Quietly(self.progress);
        differences::look(
            self.prepared,
            &by_differences(settings),
            self.direction,
            self.steps(),
            &quiet,
        )
    }

    /// Of the job's gradient image.
    fn variance(&self, found: &ForwardGradient, look: &Look) -> f64 {
        self.of_job(variance(found), look)
    }

    /// The variance of the job's gradient image from that of a look.
    fn of_job(&self, variance: f64, look: &Look) -> f64 {
        let samples = f64::from(look.settings.spp) / f64::from(self.job.spp);
        variance * samples / look.film
    }

    /// Of the job.
    fn work(&self, way: Contender, found: &ForwardGradient, look: &Look) -> f64 {
        self.work_of(way, &found.statistics.rays) / look.share
    }

    fn work_of(&self, way: Contender, rays: &BTreeMap<&'static str, u64>) -> f64 {
        let environment = self.prepared.scene.environment.as_ref();
        let has_map = environment.is_some_and(|e| e.map.is_some());
        work(way, rays, has_map)
    }

    fn add(
        &mut self,
        way: Contender,
        paths: f64,
        [variance, work]: [f64; 2],
        found: &ForwardGradient,
    ) {
        let (rays, borders) = (&found.statistics.rays, &found.statistics.borders);
        let probes = [("probe", rays.get("probe").copied().unwrap_or(0))].into();
        self.done.add(Tried {
            way,
            paths,
            variance,
            work,
            looks_over_lobes: rays.contains_key("bounce_cell"),
            probes_share: self.work_of(way, &probes) / self.work_of(way, rays),
            film_borders: borders[Integral::Film].found as f64 / rays["camera"] as f64,
            lights_share: borders.lights_share(),
            worst_pixels: share_of_worst_seen(found, WORST_IN),
            noise: self.noise(way, found),
        });
    }

    fn tangent(&self) -> Result<SceneDifferential, EngineError> {
        let scene = self.prepared.scene;
        let tangent = parameters::tangent(scene, self.direction, self.settings.sensor)?;
        Ok(tangent)
    }

    fn moved_vertices(&self) -> Result<f64, EngineError> {
        let tangent = self.tangent()?;
        let moved = tangent.positions.iter().flatten();
        Ok(moved.map(|velocities| velocities.len() as f64).sum())
    }

    /// Whether most of the scene rests, so that edges over lobes may be few enough to be drawn.
    fn few_move(&self) -> Result<bool, EngineError> {
        let meshes = self.prepared.scene.meshes.iter();
        let all: usize = meshes.map(|mesh| mesh.positions.len()).sum();
        Ok(self.moved_vertices()? < FEW * all as f64)
    }

    /// Tries what is usual.
    pub fn run_usual(&mut self) -> Result<(), EngineError> {
        self.run(USUAL, self.job.first_look())
    }

    /// Tries other mixtures than the usual, if the job is worth it.
    pub fn run_mixtures(&mut self) -> Result<(), EngineError> {
        let Some(paths) = self.job.later_look() else {
            return Ok(());
        };
        if self.done.usual().paths < paths {
            self.run(USUAL, paths)?;
        }
        let Possible {
            on_film,
            edges_from_rest,
        } = self.possible(paths)?;
        let usual = self.done.usual();
        let (looks_over_lobes, probes_share) = (usual.looks_over_lobes, usual.probes_share);
        for film in on_film {
            self.run(Mixture { film, ..USUAL }, paths)?;
        }
        let film = match self.done.best_mixture().way {
            Contender::Mixture(best) => best.film,
            Contender::Differences { .. } => USUAL.film,
        };
        if looks_over_lobes && probes_share > MOSTLY && !self.has_even_sky() {
            let lobes = OverLobes::SeldomCells;
            self.run(Mixture { film, lobes }, paths)?;
        }
        if looks_over_lobes && edges_from_rest && self.few_move()? {
            let lobes = OverLobes::EdgesFromRest;
            self.run(Mixture { film, lobes }, paths)?;
        }
        Ok(())
    }

    /// Under which no line over a lobe is left out.
    fn has_even_sky(&self) -> bool {
        let environment = self.prepared.scene.environment.as_ref();
        environment.is_some_and(|e| e.map.is_none())
    }

    /// Tries all that may be best; the usual has been. Differences are cheap, and what they see is
    /// rarer: no step of theirs may carry an edge past any of few samples.
    pub fn run_all(&mut self) -> Result<(), EngineError> {
        let later = self.job.later_look();
        let paths = later.unwrap_or(self.job.first_look());
        self.run_differences(paths)?;
        let is_whole = self.done.usual().paths == self.job.whole_look();
        // What a first look of few paths says by less than that is worth another.
        let bound = match is_whole || self.job.later_tells_more() {
            true => CLEARLY,
            false => 1.0,
        };
        if later.is_none() || self.done.differences_promise(bound) {
            return Ok(());
        }
        if !is_whole {
            self.run(USUAL, paths)?;
            if self.done.best().is_difference() {
                return Ok(());
            }
        }
        self.run_mixtures()
    }

    /// What has the least noise for its work, and how that was found. Differences over steps that
    /// do not agree are left to who asks for them: their standard errors do not tell.
    pub fn best(&self) -> Result<(Contender, Pilot), EngineError> {
        let (best, mut pilot) = (self.done.best(), self.done.pilot());
        let Some(tried) = self.done.of(best).filter(|_| best.is_difference()) else {
            return Ok((best, pilot));
        };
        let look = Look::new(self.prepared, &self.settings, self.job, tried.paths)?;
        let settings = by_differences(&look.settings);
        let (steps, quiet) = (self.steps(), Quietly(self.progress));
        let apart = differences::apart(self.prepared, &settings, self.direction, steps, &quiet)?;
        let Some(apart) = apart else {
            return Ok((best, pilot));
        };
        pilot.no_differences = Some(format!(
            "no differences: over two steps they are {} % of the gradient apart",
            (100.0 * apart).round()
        ));
        Ok((self.done.best_mixture().way, pilot))
    }

    /// The answer, with a survey of the film if that is asked for.
    pub fn answer(
        &self,
        way: Contender,
        mut pilot: Pilot,
        asked: Survey,
    ) -> Result<Answer, EngineError> {
        let mut noise = None;
        if asked != Survey::None {
            noise = self.survey(way, asked == Survey::Always)?;
        }
        if asked == Survey::IfItPays {
            let plan = noise.as_ref().map(|noise| self.plan(noise));
            pilot.uneven = plan.transpose()?.flatten().map(|plan| plan.gain);
            noise = noise.filter(|_| pilot.uneven.is_some());
        }
        let noise = noise.map(Arc::new);
        Ok(Answer { way, noise, pilot })
    }

    /// Where a way has its noise; nothing if what has been seen of it promises nothing, unless it
    /// `must` be known, or if the job is too short to find out.
    fn survey(&self, way: Contender, must: bool) -> Result<Option<NoiseMap>, EngineError> {
        let Some(look) = self.job.survey(&self.settings) else {
            return Ok(None);
        };
        if let Some(known) = self.done.of(way).filter(|_| !must)
            && self.plan(&known.noise)?.is_none()
        {
            return Ok(None);
        }
        let settings = way.settle(&look);
        let quiet = Quietly(self.progress);
        let found = match way {
            Contender::Mixture(_) => {
                let boundary = Method::Auto.boundary();
                self.prepared
                    .forward_by(&settings, self.direction, boundary, &quiet)?
            }
            Contender::Differences { .. } => self.look_by_differences(&settings)?,
        };
        Ok(Some(self.noise(way, &found)))
    }

    /// How the job's film is best sampled.
    fn plan(&self, noise: &NoiseMap) -> Result<Option<Plan>, EngineError> {
        let stage = Stage::new(self.prepared, &self.settings, None, &mut Default::default())?;
        let of_group = self.settings.spp / stage.groups;
        Ok(noise.plan(stage.size, of_group, stage.filter.reach()))
    }

    fn noise(&self, way: Contender, found: &ForwardGradient) -> NoiseMap {
        let none = Image::default();
        let stderr = found.stderr.as_ref().unwrap_or(&none);
        NoiseMap::new(stderr, &found.statistics.tiles, |counts| {
            let mut statistics = Statistics::default();
            statistics.add_counts(counts);
            self.work_of(way, &statistics.rays) + BORDER_US * counts.borders.all().found as f64
        })
    }
}

/// Which mixtures are worth a try.
struct Possible {
    /// Beside the usual.
    on_film: Vec<OnFilm>,
    /// Whether drawn edges would find all that moves, as seen from points that rest.
    edges_from_rest: bool,
}

impl Trials<'_> {
    /// What a look of so many paths can tell of.
    fn possible(&self, paths: f64) -> Result<Possible, EngineError> {
        let (prepared, settings) = (self.prepared, &self.settings);
        let tangent = self.tangent()?;
        let boundary = Method::Auto.boundary();
        let mut stage = Stage::new(prepared, settings, boundary, &mut Statistics::default())?;
        stage.ask_about(&tangent);
        let sensor = &prepared.scene.sensors[settings.sensor];
        let few_edges = (self.moved_triangles(&tangent) as f64) < paths;
        let is_allowed = few_edges
            && super::refusals::check(prepared.scene, &tangent, sensor, Method::Edges).is_ok();
        let edges = is_allowed && stage.check_geometry(Method::Edges).is_ok();
        let edges_from_rest = is_allowed
            && stage.camera_rests()
            && stage.check_geometry_from_rest(Method::Edges).is_ok();
        let look = Look::new(prepared, settings, self.job, paths)?;
        let is_dense = DENSE * look.settings.spp >= self.job.spp;
        let usual = stage.drift_by(USUAL);
        // A look does not meet what is rare on a film at rest.
        let holds_sheets = usual.as_ref().is_some_and(|drift| drift.holds_sheets);
        let mut on_film = drifts(&stage, usual, is_dense);
        if edges || edges_from_rest {
            on_film.push(OnFilm::Edges);
        }
        if holds_sheets {
            on_film.clear();
        }
        Ok(Possible {
            on_film,
            edges_from_rest,
        })
    }

    /// Triangles whose edges move over the film.
    fn moved_triangles(&self, tangent: &SceneDifferential) -> usize {
        let meshes = self.prepared.scene.meshes.iter().zip(&tangent.positions);
        let moved = meshes.filter(|(_, motion)| tangent.camera.is_some() || motion.is_some());
        moved.map(|(mesh, _)| mesh.triangles.len()).sum()
    }
}

/// Films that drift otherwise than the usual one does, among them that at rest. Looks with far
/// fewer samples a pixel than the job has do not show what following brings: what it costs falls
/// soon, and what it avoids is seldom met.
fn drifts(stage: &Stage, usual: Option<Drift>, is_dense: bool) -> Vec<OnFilm> {
    let mut films = Vec::new();
    let mut known = vec![usual];
    let others: &[OnFilm] = match is_dense {
        true => &[OnFilm::Resting, OnFilm::WithAll],
        false => &[OnFilm::Resting],
    };
    for &film in others {
        let drift = stage.drift_by(Mixture { film, ..USUAL });
        if !known.contains(&drift) {
            films.push(film);
            known.push(drift);
        }
    }
    films
}

fn by_differences(settings: &Settings) -> Settings {
    Settings {
        method: Method::CarriedFd,
        ..settings.clone()
    }
}

/// Of all numbers of a gradient image, from its standard errors.
fn variance(found: &ForwardGradient) -> f64 {
    let errors = found
        .stderr
        .iter()
        .flat_map(|image| &image.pixels)
        .flatten();
    errors.map(|e| f64::from(*e).powi(2)).sum()
}
