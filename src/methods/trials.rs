//! What a pilot finds out by trial: how much noise a way has, and how much work it is.

use super::carried;
use super::contender::Contender;
use super::differences::{self, carried_step};
use super::error::EngineError;
use super::estimators::{Constants, Method};
use super::prepared::Prepared;
use super::progress::Progress;
use super::results::ForwardGradient;
use super::settings::Settings;
use super::stage::Stage;
use super::statistics::{Pilot, Statistics, Trial};
use crate::boundary::mixture::{Mixture, OnFilm, OverLobes};
use crate::scene::SceneDifferential;
use crate::scene::parameters::{self, Parameter};
use std::collections::BTreeMap;

/// What promises less than this over what is usual is not worth the risk of being misled.
const WORTHWHILE: f64 = 1.2;
/// Differences may promise less than the best of all else. Few paths hold much of the variance of
/// that, and most pilots do not meet them: on the battery they see 0.71 of it in the median.
const WORTHWHILE_DIFFERENCES: f64 = 0.7;
/// Where differences are so many times better than what is usual, other mixtures are not tried.
const CLEARLY: f64 = 4.0;
/// To make the two displaced scenes of a difference, in microseconds for each vertex that moves: of
/// four it was 0.6 and 2.3 in meshes of 150,000 and 360,000 vertices.
const DISPLACED_VERTEX_US: f64 = 0.75;

/// Edges over lobes are tried if no greater part of the vertices moves, as a lamp over a forest. On
/// 147 directions by cameras and large meshes they were never better by a fifth.
const FEW: f64 = 0.25;

/// Parameters and their tangents.
type Direction<'a> = &'a [(Parameter, Vec<f32>)];

/// What trials are for.
#[derive(Clone, Copy)]
pub struct Job {
    /// Samples a pixel.
    pub spp: u32,
    /// The paths of a trial over its own.
    pub share: f64,
}

/// Trials of one length.
pub struct Trials<'a> {
    prepared: &'a Prepared<'a>,
    settings: Settings,
    direction: Direction<'a>,
    job: Job,
    /// Differences that would answer, one for each number.
    differences: usize,
    progress: &'a dyn Progress,
    done: Vec<Tried>,
}

/// A way that has been tried.
struct Tried {
    way: Contender,
    variance: f64,
    work: f64,
    rays: BTreeMap<&'static str, u64>,
}

impl Tried {
    fn cost(&self) -> f64 {
        self.variance * self.work
    }
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
            differences: 1,
            progress,
            done: Vec::new(),
        }
    }

    pub fn run(&mut self, way: Contender) -> Result<(), EngineError> {
        let quiet = Quietly(self.progress);
        let (prepared, direction) = (self.prepared, self.direction);
        let mut settings = self.settings.clone();
        let found = match way {
            Contender::Mixture(mixture) => {
                settings.constants = Constants {
                    mixture: Some(mixture),
                    ..settings.constants
                };
                let boundary = Method::Auto.boundary();
                prepared.forward_by(&settings, direction, boundary, &quiet)?
            }
            Contender::Differences => {
                differences::forward(prepared, &way.settle(&settings), direction, &quiet)?
            }
        };
        let environment = prepared.scene.environment.as_ref();
        let has_map = environment.is_some_and(|e| e.map.is_some());
        let mut variance = variance(&found);
        let mut work = work(way, &found.statistics.rays, has_map);
        if way.is_difference() {
            if carried::is_possible(prepared.scene, &settings, &self.tangent()?) {
                // Of what jumps it goes with one over the step.
                variance *= carried_step(settings.spp) / carried_step(self.job.spp);
            }
            work += self.job.share * DISPLACED_VERTEX_US * self.moved_vertices()?;
            work *= self.differences as f64;
        }
        self.done.push(Tried {
            way,
            variance,
            work,
            rays: found.statistics.rays,
        });
        Ok(())
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

    /// Tries other mixtures than the usual.
    pub fn run_mixtures(&mut self) -> Result<(), EngineError> {
        let Possible {
            drifts,
            edges,
            edges_from_rest,
        } = possible(self.prepared, &self.settings, self.direction)?;
        let usual = Mixture::default();
        let looks_over_lobes = self.done[0].rays.contains_key("bounce_cell");
        let on_film = [
            (OnFilm::Resting, drifts),
            (OnFilm::Edges, edges || edges_from_rest),
        ];
        for (film, is_possible) in on_film {
            if is_possible {
                self.run(Contender::Mixture(Mixture { film, ..usual }))?;
            }
        }
        let film = match self.best_mixture().way {
            Contender::Mixture(best) => best.film,
            Contender::Differences => usual.film,
        };
        if looks_over_lobes && edges_from_rest && self.few_move()? {
            let lobes = OverLobes::EdgesFromRest;
            self.run(Contender::Mixture(Mixture { film, lobes }))?;
        }
        Ok(())
    }

    /// Tries all that may be best; the usual has been. `differences`: how many of these it would take.
    pub fn run_all(&mut self, differences: usize) -> Result<(), EngineError> {
        self.differences = differences;
        self.run(Contender::Differences)?;
        match self.done[0].cost() < CLEARLY * self.done[1].cost() {
            true => self.run_mixtures(),
            false => Ok(()),
        }
    }

    /// What has the least noise for its work.
    pub fn best(&self) -> Contender {
        let ours = self.best_mixture();
        match self.least(true) {
            Some(it) if it.cost() * WORTHWHILE_DIFFERENCES < ours.cost() => it.way,
            _ => ours.way,
        }
    }

    /// The same without differences; the usual if that is nearly as good.
    fn best_mixture(&self) -> &Tried {
        let usual = &self.done[0];
        match self.least(false) {
            Some(best) if best.cost() * WORTHWHILE < usual.cost() => best,
            _ => usual,
        }
    }

    /// The least of what has been tried, among differences or all else.
    fn least(&self, is_difference: bool) -> Option<&Tried> {
        let done = self.done.iter();
        let of_kind = done.filter(|t| t.way.is_difference() == is_difference);
        of_kind.min_by(|a, b| a.cost().total_cmp(&b.cost()))
    }

    pub fn into_pilot(self) -> Pilot {
        let usual = self.done[0].cost();
        let trials = self.done.iter().map(|tried| Trial {
            way: tried.way.name(),
            variance: tried.variance,
            work: tried.work,
            efficiency: Some(usual / tried.cost()).filter(|by| by.is_finite()),
        });
        Pilot {
            trials: trials.collect(),
            ..Pilot::default()
        }
    }
}

/// Which mixtures are worth a try.
struct Possible {
    /// Whether the film would drift.
    drifts: bool,
    /// Whether drawn edges would find all that moves.
    edges: bool,
    /// Whether they would from points that rest, if the camera is one.
    edges_from_rest: bool,
}

fn possible(
    prepared: &Prepared,
    settings: &Settings,
    direction: &[(Parameter, Vec<f32>)],
) -> Result<Possible, EngineError> {
    let tangent = parameters::tangent(prepared.scene, direction, settings.sensor)?;
    let boundary = Method::Auto.boundary();
    let mut stage = Stage::new(prepared, settings, boundary, &mut Statistics::default())?;
    stage.ask_about(&tangent);
    let sensor = &prepared.scene.sensors[settings.sensor];
    let is_allowed =
        super::refusals::check(prepared.scene, &tangent, sensor, Method::Edges).is_ok();
    let view = stage.view();
    Ok(Possible {
        drifts: stage.drift(&view, &*stage.estimator()).is_some(),
        edges: is_allowed && stage.check_geometry(Method::Edges).is_ok(),
        edges_from_rest: is_allowed
            && stage.camera_rests()
            && stage.check_geometry_from_rest(Method::Edges).is_ok(),
    })
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

/// About the microseconds that rays take with all that is done about them, fitted to the failure
/// battery (`docs/method.md`, 14); that of drawn edges is a guess.
fn work(contender: Contender, rays: &BTreeMap<&'static str, u64>, has_map: bool) -> f64 {
    let cost = |kind: &str| match (contender, kind) {
        (Contender::Differences, "camera") => 0.15,
        (Contender::Differences, _) => 0.07,
        (Contender::Mixture(_), "camera") => 0.08,
        (Contender::Mixture(_), "shadow") => 0.3,
        (Contender::Mixture(_), "bounce" | "sky_cell") => 0.6,
        (Contender::Mixture(_), "light_cell" | "bounce_cell") => 0.03,
        // Edges that are drawn have to be found first.
        (Contender::Mixture(_), "edge") => 0.8,
        (Contender::Mixture(_), _) => 0.3,
    };
    // To draw from an environment map and to look it up.
    let of_map = |kind: &str| match kind {
        "shadow" | "bounce" | "probe" if has_map => 0.5,
        _ => 0.0,
    };
    let rays = rays.iter();
    rays.map(|(kind, n)| (cost(kind) + of_map(kind)) * *n as f64)
        .sum()
}

/// Says nothing of how far it is.
struct Quietly<'a>(&'a dyn Progress);

impl Progress for Quietly<'_> {
    fn advance(&self, _: u64, _: u64) {}
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}
