//! All that is measured on one case.

use super::cases::Case;
use super::contestant::{Contestant, is_first_of_library};
use super::measure::{Budget, Record, timed};
use super::number::Number;
use super::rays::{RAYS, Workload, workloads};
use crate::methods::{self, Constants, EngineError, Method, Progress, Settings};
use crate::trace::{Accel, AccelOptions, Backend, MeshView, TraceError};

use glam::Vec3;
use rayon::prelude::*;

/// Packets that a thread takes at a time.
const PACKETS_AT_ONCE: usize = 64;

/// Film and samples of the gradients.
const GRADIENT_SIZE: [u32; 2] = [96, 96];
const GRADIENT_SPP: u32 = 4;

/// How to measure.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    pub budget: Budget,
    /// Beside one thread.
    pub threads: usize,
}

/// Measures everything on `case`, handing each number to `put` as it comes.
pub fn measure(
    case: &Case,
    plan: Plan,
    progress: &dyn Progress,
    put: &mut dyn FnMut(Record),
) -> Result<(), EngineError> {
    let mut bench = Bench {
        case,
        plan,
        progress,
        put,
        views: case.views(),
    };
    let counts = if plan.threads > 1 {
        vec![1, plan.threads]
    } else {
        vec![1]
    };
    let loads = workloads(
        case,
        &bench.build(Contestant::all()[0].options(plan.threads))?,
    );
    let loads = loads
        .ok_or_else(|| EngineError::Refused(format!("{}: the camera sees nothing", case.name)))?;
    for contestant in Contestant::all() {
        bench.builds(contestant, &counts)?;
        let mut accel = bench.build(contestant.options(plan.threads))?;
        bench.memory(contestant, &accel);
        for &threads in &counts {
            for load in &loads {
                bench.rays(contestant, &accel, load, threads)?;
            }
        }
        if contestant.robust {
            bench.refits(contestant, &mut accel)?;
        }
    }
    for backend in Backend::built_in()
        .into_iter()
        .filter(|b| is_first_of_library(*b))
    {
        bench.presets(backend, &counts, &loads)?;
    }
    for &threads in &counts {
        for backend in Backend::built_in() {
            bench.gradient(backend, threads)?;
        }
    }
    Ok(())
}

/// How many numbers [`measure`] will hand out, if every gradient can be taken.
pub fn steps(case: &Case, plan: Plan) -> u64 {
    const KINDS_OF_RAYS: usize = 7;
    let counts = if plan.threads > 1 { 2 } else { 1 };
    let built_in = Backend::built_in();
    let presets: usize = built_in
        .iter()
        .filter(|b| is_first_of_library(**b))
        .map(|b| b.presets().len() - 1)
        .sum();
    let contestants = Contestant::all().len() * (counts + 1 + KINDS_OF_RAYS * counts);
    let gradients = if case.direction().is_some() {
        built_in.len() * counts
    } else {
        0
    };
    (contestants + built_in.len() + presets * (counts + 2) + gradients) as u64
}

struct Bench<'a> {
    case: &'a Case,
    plan: Plan,
    progress: &'a dyn Progress,
    put: &'a mut dyn FnMut(Record),
    views: Vec<MeshView<'a>>,
}

impl Bench<'_> {
    fn check(&self) -> Result<(), EngineError> {
        if self.progress.cancelled() {
            return Err(EngineError::Interrupted);
        }
        Ok(())
    }

    fn build(&self, options: AccelOptions) -> Result<Accel, EngineError> {
        Accel::build(&self.views, options).map_err(failed)
    }

    fn record(&mut self, contestant: Contestant, what: &str, threads: usize, number: Number) {
        (self.put)(Record {
            case: self.case.name.clone(),
            triangles: self.case.triangle_count(),
            what: what.into(),
            backend: contestant.backend.to_string(),
            robust: contestant.robust,
            threads,
            unit: number.unit,
            median: number.summary[0],
            low: number.summary[1],
            high: number.summary[2],
            passes: number.passes,
            rays: number.rays,
        });
    }

    fn builds(&mut self, contestant: Contestant, counts: &[usize]) -> Result<(), EngineError> {
        for &threads in counts {
            self.check()?;
            let options = contestant.options(threads);
            let passes = self.plan.budget.repeat(|| {
                let (seconds, accel) = timed(|| Accel::build(&self.views, options));
                accel.map(|_| seconds)
            });
            let passes = passes.map_err(failed)?;
            self.record(contestant, "build", threads, Number::milliseconds(&passes));
        }
        Ok(())
    }

    fn memory(&mut self, contestant: Contestant, accel: &Accel) {
        let mebibytes = accel.memory_bytes() as f64 / f64::from(1 << 20);
        let number = Number {
            unit: "MiB",
            summary: [mebibytes; 3],
            passes: 1,
            rays: None,
        };
        self.record(contestant, "memory", self.plan.threads, number);
    }

    fn rays(
        &mut self,
        contestant: Contestant,
        accel: &Accel,
        load: &Workload,
        threads: usize,
    ) -> Result<(), EngineError> {
        self.check()?;
        let number = trace(accel, load, threads, self.plan.budget)?;
        self.record(contestant, load.name, threads, number);
        Ok(())
    }

    fn refits(&mut self, contestant: Contestant, accel: &mut Accel) -> Result<(), EngineError> {
        self.check()?;
        let swollen = [1.001, 0.999].map(|factor| -> Vec<Vec<Vec3>> {
            let grown = |m: &MeshView| m.positions.iter().map(|p| *p * factor).collect();
            self.views.iter().map(grown).collect()
        });
        let moved = swollen.each_ref().map(|meshes| -> Vec<MeshView> {
            let meshes = self.views.iter().zip(meshes);
            meshes
                .map(|(m, positions)| MeshView { positions, ..*m })
                .collect()
        });
        // Embree builds another kind of tree at the first refit.
        accel.refit(&moved[0]).map_err(failed)?;
        let mut count = 0;
        let passes = self.plan.budget.repeat(|| {
            count += 1;
            let (seconds, done) = timed(|| accel.refit(&moved[count % 2]));
            done.map(|()| seconds)
        });
        let number = Number::milliseconds(&passes.map_err(failed)?);
        self.record(contestant, "refit", self.plan.threads, number);
        Ok(())
    }

    /// Time to build at each preset, and what that is worth to rays that go everywhere.
    fn presets(
        &mut self,
        usual: Backend,
        counts: &[usize],
        loads: &[Workload],
    ) -> Result<(), EngineError> {
        let most = self.plan.threads;
        for backend in usual.presets().into_iter().filter(|b| *b != usual) {
            let contestant = Contestant {
                backend,
                robust: true,
            };
            self.builds(contestant, counts)?;
            let accel = self.build(contestant.options(most))?;
            self.memory(contestant, &accel);
            for load in loads.iter().filter(|load| load.name == "diffuse bounce") {
                self.rays(contestant, &accel, load, most)?;
            }
        }
        Ok(())
    }

    fn gradient(&mut self, backend: Backend, threads: usize) -> Result<(), EngineError> {
        let Some(direction) = self.case.direction() else {
            return Ok(());
        };
        let scene = &self.case.scene;
        let settings = Settings {
            constants: Constants::default(),
            part_of_film: None,
            counts_tiles: false,
            noise: None,
            spp: GRADIENT_SPP,
            seed: 1,
            threads,
            max_depth: scene.integrator.max_depth,
            rr_depth: scene.integrator.rr_depth,
            hide_emitters: scene.integrator.hide_emitters,
            sensor: 0,
            resolution: Some(GRADIENT_SIZE),
            method: Method::Reparam,
            backend,
            standard_error: true,
            groups: None,
        };
        let mut rays: u64 = 0;
        let passes = self.plan.budget.repeat(|| {
            let (seconds, done) =
                timed(|| methods::forward(scene, &settings, &direction, self.progress));
            rays = done?.statistics.rays.values().sum();
            Ok(seconds)
        });
        let passes = match passes {
            // What cannot be differentiated is no failure of a bench.
            Err(EngineError::Refused(_)) => return Ok(()),
            passes => passes?,
        };
        let contestant = Contestant {
            backend,
            robust: true,
        };
        let number = Number {
            rays: Some(rays),
            ..Number::milliseconds(&passes)
        };
        self.record(contestant, "gradient", threads, number);
        Ok(())
    }
}

/// Rays a second, on some threads.
fn trace(
    accel: &Accel,
    load: &Workload,
    threads: usize,
    budget: Budget,
) -> Result<Number, EngineError> {
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()
        .map_err(|e| EngineError::Failed(e.to_string()))?;
    let chunks = || load.packets.par_chunks(PACKETS_AT_ONCE);
    let mut hits = 0;
    let passes = budget.repeat(|| {
        let (seconds, met) =
            timed(|| pool.install(|| chunks().map(|packets| load.trace(accel, packets)).sum()));
        hits = met;
        Ok::<f64, EngineError>(seconds)
    })?;
    Ok(Number {
        unit: "Mrays/s",
        summary: passes.summary(|seconds| RAYS as f64 / 1e6 / seconds),
        passes: passes.count(),
        rays: Some(hits),
    })
}

fn failed(error: TraceError) -> EngineError {
    EngineError::Failed(error.to_string())
}
