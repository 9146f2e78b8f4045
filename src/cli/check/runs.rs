//! The runs of a check.

use super::verdict::{SIGNIFICANT, Transposition};
use super::waves::smooth_image;
use crate::cli::exit::Failure;
use crate::cli::pace::{Kind, Pace};
use crate::cli::session::Session;
use crate::jobs::direction::Direction;
use crate::jobs::seeds::{FIRST_REFERENCE_SEED, nth_seed};
use crate::methods::{
    self, ForwardGradient, Image, Method, Objective, Question, Settings, Statistics,
};
use crate::scene::parameters::{self, Parameter};
use crate::statistics::comparison::{Comparison, PICTURE_ROUNDING};
use crate::statistics::replicates::Replicates;
use std::time::Instant;

/// Independent runs of either side: a few groups of samples in one run are too few to trust error
/// bars from.
const LEAST_RUNS: usize = 8;
/// As long as a bias as large as the tolerance could not be told from noise, the noisier side's
/// runs are doubled, up to this many.
pub const MOST_RUNS: usize = 32;
/// Where the usual steps are doubted, so many times shorter ones are asked.
pub const SHORTER: f64 = 16.0;

/// The runs of a check, done and to come.
pub struct Check {
    pub session: Session,
    pub settings: Settings,
    pub direction: Direction,
    pub tested: Replicates,
    pub reference: Replicates,
    pace: Pace,
    /// How long it was last said to take.
    told: Option<String>,
}

impl Check {
    /// Before the first run.
    pub fn new(session: Session, settings: Settings, direction: Direction) -> Self {
        Self {
            session,
            settings,
            direction,
            tested: Replicates::default(),
            reference: Replicates::default(),
            pace: Pace::default(),
            told: None,
        }
    }

    /// Says how much there is to do.
    pub fn announce(&mut self) {
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

    /// Settles what `auto` does in all runs, forward and backward.
    pub fn ask_pilot(&mut self) -> Result<(), Failure> {
        if !self.settings.needs_pilot() {
            return Ok(());
        }
        let keys: Vec<Parameter> = self.direction.iter().map(|(p, _)| p.clone()).collect();
        let settings = self.settings.clone();
        let (settled, _) = self.session.trace(
            "pilot",
            &settings,
            |scene, settings, progress| {
                let question = Question::ForwardAndBackward(&keys);
                let (settled, pilot) = methods::decide(scene, settings, &question, progress)?;
                let mut statistics = Statistics::default();
                statistics.add_pilot(pilot);
                Ok((settled, statistics))
            },
            |(_, statistics)| statistics,
        )?;
        self.settings = settled;
        Ok(())
    }

    /// Says how long the rest takes, if that is known and no news.
    pub fn tell_time(&mut self) {
        let time = self.pace.time_left();
        if let Some(time) = time.as_ref().filter(|_| time != self.told) {
            self.session
                .log
                .note(&format!("{time} left, without more runs for noise"));
        }
        self.told = time;
    }

    /// Does what is planned.
    pub fn run_all(&mut self) -> Result<(), Failure> {
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
    pub fn plan_more(&mut self, comparison: &Comparison, most: usize) -> bool {
        let (kind, runs, name) = match comparison.reference_noise_share > 0.5 {
            true => (
                Kind::Differences,
                self.reference.runs(),
                "finite differences",
            ),
            false => (Kind::Forward, self.tested.runs(), "forward"),
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
    pub fn rounding(&self, image: &Image) -> Result<f64, Failure> {
        let step = self.step()?;
        let numbers = image.pixels.iter().flatten();
        let brightest = numbers.fold(0.0_f32, |most, v| most.max(v.abs()));
        Ok(PICTURE_ROUNDING * f64::from(brightest) / step)
    }

    /// The step of finite differences.
    pub fn step(&self) -> Result<f64, Failure> {
        methods::difference_step(&self.session.scene, &self.settings, &self.direction)
            .map_err(|error| Failure::from_engine(error, None))
    }

    /// One run of the method that is checked.
    pub fn run_tested(&mut self) -> Result<ForwardGradient, Failure> {
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

    /// Whether differences by much shorter steps are others, which are taken then: what moves may
    /// pass something within a step, as a lamp that hangs a little below a ceiling.
    pub fn takes_shorter_steps(&mut self, rounding: f64, tolerance: f64) -> Result<bool, Failure> {
        self.pace.plan(Kind::Differences, LEAST_RUNS);
        let step = self.step()?;
        let mut shorter = Replicates::default();
        for run in 0..LEAST_RUNS {
            let settings = Settings {
                method: Method::REFERENCE,
                seed: nth_seed(self.settings.seed, FIRST_REFERENCE_SEED + run),
                ..self.settings.clone()
            };
            let done = self.timed(Kind::Differences, |session, direction| {
                session.trace(
                    "fd",
                    &settings,
                    |scene, settings, progress| {
                        let step = step / SHORTER;
                        methods::difference(scene, settings, direction, step, progress)
                    },
                    |forward| &forward.statistics,
                )
            })?;
            shorter.add(&done.gradient, stderr(&done)?);
        }
        let steps = Comparison::of(&shorter, &self.reference, SHORTER * rounding);
        if steps.agrees(SIGNIFICANT, tolerance) {
            return Ok(false);
        }
        self.session.warn(format!(
            "finite differences with steps of {step:.2e} are others than with a sixteenth of that, which are taken: what \
             moves passes something within a step"
        ));
        self.reference = shorter;
        Ok(true)
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

    /// Runs backward from a fixed adjoint image and compares the two ways to the same number.
    /// `conceivable` is what a pixel's derivative would be if all of it came and went in a step of
    /// finite differences.
    pub fn transpose(
        &mut self,
        gradient: &Image,
        conceivable: f64,
    ) -> Result<Transposition, Failure> {
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
            let reduced = done.gradient.by(scene, parameter);
            backward += inner(&reduced, tangent).0;
        }
        // What moves as one cancels over its vertices.
        let tangent = parameters::tangent(scene, &self.direction, settings.sensor)?;
        let size = done.gradient.cotangent.inner_magnitude(&tangent);
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

/// The sum of the products, and of their absolute values.
fn inner(a: &[f32], b: &[f32]) -> (f64, f64) {
    let products = || a.iter().zip(b).map(|(a, b)| *a as f64 * *b as f64);
    (products().sum(), products().map(f64::abs).sum())
}
