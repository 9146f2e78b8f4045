//! `warpath check`: forward, backward and finite differences against each other.

use super::arguments::CheckArguments;
use super::check_results::{conclude, write_images};
use super::exit::Failure;
use super::pace::{Kind, Pace};
use super::session::{self, Session};
use super::verdict::{Circumstances, Outcome, SIGNIFICANT, Transposition, judge};
use crate::jobs::direction::{self, Direction};
use crate::methods::{self, ForwardGradient, Image, Method, Objective, Settings};
use crate::scene::Filter;
use crate::scene::parameters::{self, Parameter};
use crate::statistics::comparison::Comparison;
use crate::statistics::replicates::Replicates;
use std::ffi::OsString;
use std::time::Instant;

/// Independent runs of either side: a few groups of samples in one run are too few to trust error
/// bars from.
const LEAST_RUNS: usize = 8;
/// As long as a bias as large as the tolerance could not be told from noise, the noisier side's
/// runs are doubled, up to this many.
const MOST_RUNS: usize = 32;
/// Of the brightest pixel: what rounding leaves in the difference of two images.
const PICTURE_ROUNDING: f64 = 1e-6;
/// Parts the seeds of the runs; finite differences with the random numbers under test would share
/// their noise.
const SEED_STEP: u64 = 0x9e37_79b9_7f4a_7c15;
const FIRST_REFERENCE_SEED: usize = 1 << 20;

/// Runs the three and compares them.
pub fn run(arguments: &CheckArguments, typed: &[OsString]) -> Result<(), Failure> {
    let method = session::method(&arguments.method)?;
    if method.is_reference() {
        return Err(Failure::Usage(format!(
            "--method {} is what the others are checked against",
            method.name()
        )));
    }
    let session = Session::open("check", &arguments.trace, typed, Some(method), true)?;
    let settings = session.settings.clone();
    let direction = direction::resolve(&session.scene, &arguments.parameters, settings.sensor)?;
    if settings.spp < 2 {
        return Err(Failure::Input(
            "with one sample a pixel there are no standard errors to check against: raise --spp"
                .into(),
        ));
    }
    let mut check = Check {
        session,
        settings,
        direction,
        tested: Replicates::default(),
        reference: Replicates::default(),
        pace: Pace::default(),
    };
    check.announce();
    let first = check.run_tested()?;
    check.tell_time();
    let rounding = check.rounding(&first.image)?;
    let transposition = check.transpose(&first.gradient, rounding / PICTURE_ROUNDING)?;
    let moves = check
        .direction
        .iter()
        .any(|(parameter, _)| parameter.moves_visibility);
    let filter = check.session.scene.sensors[check.settings.sensor]
        .film
        .filter;
    let circumstances = Circumstances {
        ignores_visibility: moves && method.ignores_visibility(),
        box_filter: matches!(filter, Filter::Box { .. }),
    };
    let (comparison, verdict) = loop {
        check.run_all()?;
        let comparison = Comparison::of(&check.tested, &check.reference, rounding);
        let verdict = judge(
            method.name(),
            circumstances,
            &transposition,
            &comparison,
            arguments.tolerance,
        );
        let goes_on = arguments.until_sure && verdict.outcome == Outcome::CannotTell;
        let most = if goes_on { usize::MAX } else { MOST_RUNS };
        let is_sharp = comparison.can_tell(arguments.tolerance / SIGNIFICANT);
        if is_sharp || !check.plan_more(&comparison, most) {
            break (comparison, verdict);
        }
    };
    write_images(&mut check.session, &check.tested, &check.reference)?;
    conclude(
        check.session,
        &verdict,
        &transposition,
        &comparison,
        arguments.tolerance,
    )
}

/// The runs of a check, done and to come.
struct Check {
    session: Session,
    settings: Settings,
    direction: Direction,
    tested: Replicates,
    reference: Replicates,
    pace: Pace,
}

impl Check {
    /// Says how much there is to do.
    fn announce(&mut self) {
        self.pace.plan(Kind::Forward, LEAST_RUNS);
        self.pace.plan(Kind::Backward, 1);
        self.pace.plan(Kind::Differences, LEAST_RUNS);
        let [width, height] = self.session.resolution();
        let spp = self.settings.spp;
        let images = LEAST_RUNS + 1 + methods::DIFFERENCE_IMAGES * LEAST_RUNS;
        let paths = images as f64 * f64::from(width) * f64::from(height) * f64::from(spp);
        self.session.log.note(&format!(
            "{} runs of {width}x{height} pixels with {spp} samples: {LEAST_RUNS} forward, 1 backward, {LEAST_RUNS} of finite \
             differences ({} images each), {paths:.1e} camera paths; up to {MOST_RUNS} of either where they are noisy",
            2 * LEAST_RUNS + 1,
            methods::DIFFERENCE_IMAGES,
        ));
    }

    fn tell_time(&self) {
        if let Some(time) = self.pace.time_left() {
            self.session
                .log
                .note(&format!("{time} left, without more runs for noise"));
        }
    }

    /// Does what is planned.
    fn run_all(&mut self) -> Result<(), Failure> {
        while self.pace.left(Kind::Differences) > 0 {
            self.run_reference()?;
            if self.reference.runs() == 1 {
                self.tell_time();
            }
        }
        while self.pace.left(Kind::Forward) > 0 {
            self.run_tested()?;
        }
        Ok(())
    }

    /// Plans as many runs again of the noisier side; whether it may have more than it had.
    fn plan_more(&mut self, comparison: &Comparison, most: usize) -> bool {
        let (kind, runs, name) = match comparison.reference_noise_share > 0.5 {
            true => (
                Kind::Differences,
                self.reference.runs(),
                "finite differences",
            ),
            false => (Kind::Forward, self.tested.runs(), "forward mode"),
        };
        if runs >= most {
            return false;
        }
        self.pace.plan(kind, runs);
        let noise = match comparison.reference_is_significant {
            true => format!("± {:.1} %", 100.0 * comparison.relative_bias_se),
            false => "nothing but noise".into(),
        };
        let time = self.pace.time_left().unwrap_or_default();
        self.session.log.note(&format!(
            "{noise} after {} and {} runs: {runs} more of {name}, {time}",
            comparison.tested_runs, comparison.reference_runs
        ));
        true
    }

    /// What finite differences of this image may be wrong by in any pixel.
    fn rounding(&self, image: &Image) -> Result<f64, Failure> {
        let step = methods::difference_step(&self.session.scene, &self.settings, &self.direction)
            .map_err(|error| Failure::from_engine(error, None))?;
        let numbers = image.pixels.iter().flatten();
        let brightest = numbers.fold(0.0_f32, |most, v| most.max(v.abs()));
        Ok(PICTURE_ROUNDING * f64::from(brightest) / step)
    }

    fn run_tested(&mut self) -> Result<ForwardGradient, Failure> {
        let settings = Settings {
            seed: nth_seed(self.settings.seed, self.tested.runs()),
            ..self.settings.clone()
        };
        let forward = self.run_forward("forward", Kind::Forward, &settings)?;
        self.tested.add(&forward.gradient, stderr(&forward)?);
        Ok(forward)
    }

    fn run_reference(&mut self) -> Result<(), Failure> {
        let settings = Settings {
            method: Method::REFERENCE,
            seed: nth_seed(
                self.settings.seed,
                FIRST_REFERENCE_SEED + self.reference.runs(),
            ),
            ..self.settings.clone()
        };
        let forward = self.run_forward("fd", Kind::Differences, &settings)?;
        self.reference.add(&forward.gradient, stderr(&forward)?);
        Ok(())
    }

    fn run_forward(
        &mut self,
        stage: &'static str,
        kind: Kind,
        settings: &Settings,
    ) -> Result<ForwardGradient, Failure> {
        self.timed(kind, |session, direction| {
            session.trace(
                stage,
                settings,
                |scene, settings, progress| methods::forward(scene, settings, direction, progress),
                |forward| &forward.statistics,
            )
        })
    }

    fn timed<T>(
        &mut self,
        kind: Kind,
        run: impl FnOnce(&mut Session, &Direction) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        self.pace.begin(kind);
        self.session.rest_seconds = self.pace.seconds_left().unwrap_or(0.0);
        let started = Instant::now();
        let done = run(&mut self.session, &self.direction)?;
        self.pace.end(kind, started.elapsed().as_secs_f64());
        Ok(done)
    }

    /// Runs reverse mode on a fixed adjoint image and compares the two ways to the same number.
    /// `conceivable` is what a pixel's derivative would be if all of it came and went in a step of
    /// finite differences.
    fn transpose(&mut self, gradient: &Image, conceivable: f64) -> Result<Transposition, Failure> {
        let settings = self.settings.clone();
        let adjoint = smooth_image(gradient.width, gradient.height, settings.seed);
        let keys: Vec<Parameter> = self.direction.iter().map(|(p, _)| p.clone()).collect();
        let objective = Objective::Adjoint(&adjoint);
        let done = self.timed(Kind::Backward, |session, _| {
            session.trace(
                "backward",
                &settings,
                |scene, settings, progress| {
                    methods::backward(scene, settings, &keys, &objective, progress)
                },
                |backward| &backward.statistics,
            )
        })?;
        let weights = adjoint.pixels.as_flattened();
        let forward = inner(gradient.pixels.as_flattened(), weights);
        let scene = &self.session.scene;
        let mut backward = 0.0;
        for (parameter, tangent) in &self.direction {
            let reduced = parameters::reduce(scene, parameter, &done.gradient);
            backward += inner(&reduced, tangent).0;
        }
        let named: Vec<(&str, &[f32])> = self
            .direction
            .iter()
            .map(|(p, v)| (p.key.as_str(), v.as_slice()))
            .collect();
        // What moves as one cancels over its vertices.
        let tangent = parameters::tangent(scene, &named, settings.sensor)?;
        let size = done.gradient.inner_magnitude(&tangent);
        let weight: f64 = weights.iter().map(|w| f64::from(w.abs())).sum();
        Ok(Transposition::new(
            forward,
            (backward, size),
            conceivable * weight,
        ))
    }
}

fn stderr(forward: &ForwardGradient) -> Result<&Image, Failure> {
    forward.stderr.as_ref().ok_or_else(|| {
        Failure::Input(
            "with so few samples there are no standard errors to check against: raise --spp".into(),
        )
    })
}

/// The first is the user's own.
fn nth_seed(seed: u64, n: usize) -> u64 {
    seed.wrapping_add((n as u64).wrapping_mul(SEED_STEP))
}

/// The sum of the products, and of their absolute values.
fn inner(a: &[f32], b: &[f32]) -> (f64, f64) {
    let products = || a.iter().zip(b).map(|(a, b)| *a as f64 * *b as f64);
    (products().sum(), products().map(f64::abs).sum())
}

/// An adjoint image with no symmetry by which mistakes could cancel: a few slow waves per channel.
fn smooth_image(width: usize, height: usize, seed: u64) -> Image {
    let phase = |n: u64| {
        let mixed = (seed ^ (n + 1).wrapping_mul(SEED_STEP)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        (mixed >> 40) as f64 / (1u64 << 24) as f64 * std::f64::consts::TAU
    };
    let wave = |u: f64, v: f64, channel: u64| {
        let terms = (0..4u64).map(|k| {
            let (across, down) = (1.0 + k as f64, 0.7 + (3 - k) as f64);
            (across * u * 3.0 + down * v * 3.0 + phase(4 * channel + k)).cos()
        });
        (1.0 + 0.5 * terms.sum::<f64>()) as f32
    };
    let pixels = (0..width * height)
        .map(|at| {
            let (u, v) = (
                (at % width) as f64 / width as f64,
                (at / width) as f64 / height as f64,
            );
            std::array::from_fn(|channel| wave(u, v, channel as u64))
        })
        .collect();
    Image {
        width,
        height,
        pixels,
    }
}
