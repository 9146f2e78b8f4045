//! What `auto` does: a pilot tries what may be best, and the rest is done by what has the least
//! noise for its work.
//!
//! The pilot renders some tiles of the film with random numbers of its own, so what it comes to does
//! not depend on the samples that it is used for: whichever it is, their mean is the gradient.
//! Noise is the variance of the gradient image, from independent groups of samples. Work is counted
//! in rays and not in seconds, so all processes and all runs come to the same.

use super::carried;
use super::contender::Contender;
use super::decisions::Asked;
use super::difference_step::step;
use super::differences;
use super::error::EngineError;
use super::estimators::{Constants, Method};
use super::prepared::Prepared;
use super::progress::Progress;
use super::results::ForwardGradient;
use super::settings::{Groups, Settings};
use super::stage::Stage;
use super::statistics::{Pilot, Statistics, Trial};
use crate::boundary::mixture::{Mixture, OnFilm, OverLobes};
use crate::scene::parameters::{self, Parameter};
use std::collections::BTreeMap;
use std::time::Instant;

/// Parameters and their tangents.
type Direction = Vec<(Parameter, Vec<f32>)>;

/// The pilot's own random numbers.
const SEED: u64 = 0x7069_6c6f_7400_0001;
const GROUPS: u32 = 4;
/// Samples a pixel of a group, as far as the job's groups have as many.
const SAMPLES: [u32; 2] = [2, 16];
/// Paths of one trial, at least, and the share that they have in the whole job's at least.
const LEAST_PATHS: f64 = 16384.0;
const LEAST_SHARE: f64 = 1.0 / 64.0;
/// What promises less than this over what is usual is not worth the risk of being misled.
const WORTHWHILE: f64 = 1.2;
/// And differences, whose work is compared worse, over the best of all else.
const WORTHWHILE_DIFFERENCES: f64 = 1.4;
/// If differences are so many times better or worse than what is usual, others of the better kind
/// need no trial to tell which kind is best.
const CLEARLY: f64 = 4.0;

/// What one may ask for.
pub enum Question<'a> {
    /// The gradient image along a direction.
    Forward(&'a [(Parameter, Vec<f32>)]),
    /// The derivative of a number by these.
    Backward(&'a [Parameter]),
}

impl Prepared<'_> {
    /// The settings with which `auto` answers a question, and how it came to them.
    ///
    /// Errors are those of the answer itself.
    pub fn decide(
        &self,
        settings: &Settings,
        question: &Question,
        progress: &dyn Progress,
    ) -> Result<(Settings, Pilot), EngineError> {
        let start = Instant::now();
        let Some(direction) = moving_direction(self, settings, question)? else {
            let mut pilot = Pilot::without_trials("nothing that moves has edges".into());
            let way = Contender::Mixture(Mixture::default());
            pilot.chosen = way.name();
            return Ok((way.settle(settings), pilot));
        };
        let forward = matches!(question, Question::Forward(_));
        let named = direction.iter().map(|(p, v)| (p.key.clone(), v.clone()));
        let asked = Asked::new(settings, forward, named.collect());
        if let Some((way, pilot)) = self.parts.decisions.find(&asked) {
            return Ok((way.settle(settings), pilot));
        }
        let (way, mut pilot) = self.try_ways(settings, forward, &direction, progress)?;
        pilot.chosen = way.name();
        let known = pilot.clone();
        pilot.seconds = start.elapsed().as_secs_f64();
        self.parts.decisions.keep(asked, (way, known));
        Ok((way.settle(settings), pilot))
    }

    fn try_ways(
        &self,
        settings: &Settings,
        forward: bool,
        direction: &[(Parameter, Vec<f32>)],
        progress: &dyn Progress,
    ) -> Result<(Contender, Pilot), EngineError> {
        // Whole images are compared by one process.
        let has_differences = forward && settings.groups().only.is_none();
        let sensor = &self.scene.sensors[settings.sensor];
        let settings = of_pilot(self, &settings.through_lens(sensor, true))?;
        let mut trials = Trials {
            prepared: self,
            settings: &settings,
            direction,
            progress,
            done: Vec::new(),
        };
        let usual = Mixture::default();
        match trials.run(Contender::Mixture(usual)) {
            Err(EngineError::Refused(sentence)) if has_differences => {
                let way = match carries(self, &settings, direction)? {
                    true => Contender::CarriedDifferences,
                    false => Contender::Differences,
                };
                return Ok((way, Pilot::without_trials(sentence)));
            }
            tried => tried?,
        }
        if !has_differences {
            trials.run_mixtures()?;
            return Ok((trials.best(), trials.into_pilot()));
        }
        if carries(self, &settings, direction)? {
            trials.run(Contender::CarriedDifferences)?;
        }
        // How much better differences are than what is usual, if some have been tried.
        let lead = match trials.done[..] {
            [ref usual, ref carried] => usual.cost() / carried.cost(),
            _ => 1.0,
        };
        if lead < CLEARLY {
            trials.run_mixtures()?;
        }
        if lead * CLEARLY > 1.0 {
            trials.run(Contender::Differences)?;
        }
        let best = trials.best();
        Ok((best, trials.into_pilot()))
    }
}

/// The direction along which a pilot looks; `None` if it would not find any edge that moves.
fn moving_direction(
    prepared: &Prepared,
    settings: &Settings,
    question: &Question,
) -> Result<Option<Direction>, EngineError> {
    let scene = prepared.scene;
    let moves = |direction: &[(Parameter, Vec<f32>)]| {
        let tangent = parameters::tangent(scene, direction, settings.sensor)?;
        Ok::<_, EngineError>(tangent.moves_edges(scene))
    };
    let direction = match question {
        Question::Forward(direction) => direction.to_vec(),
        Question::Backward(wanted) => {
            // All of them at once, each as fast on the film as the others.
            let mut together = Vec::new();
            for parameter in *wanted {
                let one = vec![(parameter.clone(), vec![1.0; parameter.len()])];
                if moves(&one)? {
                    let speed = step(scene, settings, &one)? as f32;
                    together.push((parameter.clone(), vec![speed; parameter.len()]));
                }
            }
            together
        }
    };
    let is_worth_it = !direction.is_empty() && moves(&direction)?;
    Ok(is_worth_it.then_some(direction))
}

/// Fewer samples on the whole film, or on tiles of it where even the least would be too many. What has
/// most of the noise, as a lamp that is seen, may lie in one place.
fn of_pilot(prepared: &Prepared, settings: &Settings) -> Result<Settings, EngineError> {
    let [least, most] = SAMPLES.map(|n| n.min(settings.spp / settings.groups().count).max(1));
    let mut own = Settings {
        seed: SEED,
        spp: most * GROUPS,
        standard_error: true,
        groups: Some(Groups {
            count: GROUPS,
            only: None,
        }),
        tiles: None,
        ..settings.clone()
    };
    let stage = Stage::new(prepared, &own, None, &mut Statistics::default())?;
    let pixels = stage.size.iter().product::<usize>() as f64;
    let paths = LEAST_PATHS.max(LEAST_SHARE * pixels * f64::from(settings.spp));
    let samples = ((paths / pixels) as u32 / GROUPS).clamp(least, most);
    own.spp = samples * GROUPS;
    let stage = Stage::new(prepared, &own, None, &mut Statistics::default())?;
    let share = (paths / (pixels * f64::from(own.spp))).min(1.0);
    own.tiles = Some((share * stage.lattice.tile_count() as f64).ceil() as usize);
    Ok(own)
}

/// Whether the samples of differences could be carried along.
fn carries(
    prepared: &Prepared,
    settings: &Settings,
    direction: &[(Parameter, Vec<f32>)],
) -> Result<bool, EngineError> {
    let tangent = parameters::tangent(prepared.scene, direction, settings.sensor)?;
    Ok(carried::is_possible(prepared.scene, settings, &tangent))
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

/// What has been tried.
struct Trials<'a> {
    prepared: &'a Prepared<'a>,
    settings: &'a Settings,
    direction: &'a [(Parameter, Vec<f32>)],
    progress: &'a dyn Progress,
    done: Vec<Tried>,
}

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

impl Trials<'_> {
    fn run(&mut self, way: Contender) -> Result<(), EngineError> {
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
            Contender::Differences | Contender::CarriedDifferences => {
                differences::forward(prepared, &way.settle(&settings), direction, &quiet)?
            }
        };
        let environment = prepared.scene.environment.as_ref();
        let has_map = environment.is_some_and(|e| e.map.is_some());
        self.done.push(Tried {
            way,
            variance: variance(&found),
            work: work(way, &found.statistics.rays, has_map),
            rays: found.statistics.rays,
        });
        Ok(())
    }

    /// Tries other mixtures than the usual.
    fn run_mixtures(&mut self) -> Result<(), EngineError> {
        let Possible {
            drifts,
            edges,
            edges_from_rest,
        } = possible(self.prepared, self.settings, self.direction)?;
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
            Contender::Differences | Contender::CarriedDifferences => usual.film,
        };
        let over_lobes = [
            (OverLobes::EdgesFromRest, edges_from_rest),
            (OverLobes::Edges, edges),
        ];
        for (lobes, is_possible) in over_lobes {
            if is_possible && looks_over_lobes {
                self.run(Contender::Mixture(Mixture { film, lobes }))?;
            }
        }
        Ok(())
    }

    /// What has the least noise for its work.
    fn best(&self) -> Contender {
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

    fn into_pilot(self) -> Pilot {
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
        (Contender::Differences, "camera") => 0.036,
        (Contender::CarriedDifferences, "camera") => 0.15,
        (Contender::Differences | Contender::CarriedDifferences, _) => 0.07,
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
