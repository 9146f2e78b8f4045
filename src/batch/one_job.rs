//! One job of a batch: from its line to its files and its result line.

use super::options::Options;
use super::queue::register::Line;
use super::results::folder;
use super::results::line::ResultLine;
use super::samples::partial::{self, Partial};
use super::samples::share::PARTIAL;
use super::scenes::estimate;
use super::scenes::key::SceneKey;
use super::scenes::loaded::Loaded;
use super::scenes::store::{Admission, Store};
use crate::jobs::attachments;
use crate::jobs::direction;
use crate::jobs::failure::Failure;
use crate::jobs::job::Job;
use crate::jobs::mode::Mode;
use crate::jobs::read;
use crate::jobs::request::Request;
use crate::jobs::results::Done;
use crate::jobs::settings::RequestedSettings;
use crate::methods::{EditedScene, EngineError, Pilot, Prepared, Progress, Settings, Workers};
use crate::output::gradients::STANDARD_ERROR;
use crate::output::results::{self, ResultFile, STDERR};
use crate::scene::parameters;
use std::time::Instant;

/// What the jobs of a batch share.
pub struct Shared<'a> {
    pub options: &'a Options,
    pub workers: Workers,
    pub store: Store,
}

impl Shared<'_> {
    /// Runs the job of a line.
    pub fn run(&self, line: &Line, progress: &dyn Progress) -> Result<ResultLine, Failure> {
        if let Some(refusal) = &line.refusal {
            return Err(refusal.clone());
        }
        let job = read::job(&line.text)?;
        // Before hours are spent on what could not be written.
        folder::refuse_taken(&self.options.directory, &job.id)?;
        let requested = job.settings(self.options.threads, self.options.backend);
        let waited = Instant::now();
        let admission = self.admit(&job, &requested, progress)?;
        let admitted = Instant::now();
        let mut result = ResultLine::begun(&job.id, line.number, &line.hash);
        let loaded = &*admission.loaded;
        result.spend("wait", (admitted - waited).as_secs_f64());
        if admission.was_loaded {
            result.spend("load", loaded.load_seconds);
            result.spend("build", loaded.build_seconds);
        }
        let scene = self.edited(&job, loaded)?;
        let settings = requested.settle(scene.scene())?;
        let request = Request::new(&job, scene.scene(), &settings)?;
        let prepared = scene
            .prepare(&self.workers, &|| progress.cancelled())
            .map_err(failed)?;
        result.spend("prepare", admitted.elapsed().as_secs_f64());
        result.scene_hash = Some(format!("fnv1a64:{:016x}", loaded.scene.hash));
        if line.scene_before.is_some() && line.scene_before != result.scene_hash {
            result.warnings.push(format!(
                "{} has changed since an earlier run did jobs of it: results of both are in {}; choose another -o to \
                 have all of one",
                job.scene.display(),
                self.options.directory.display()
            ));
        }
        result.rebuilt = scene.is_rebuilt();
        let scenes = (loaded, &prepared);
        let computed = self.compute(&job, &request, scenes, &settings, progress)?;
        drop(prepared);
        if let Some(lease) = scene.finish() {
            loaded.give_back(lease);
        }
        self.write(&job, computed, &mut result)?;
        let total = admitted.elapsed().as_secs_f64();
        result.seconds.insert("total".into(), total);
        Ok(result)
    }

    /// Waits for the scene, and for the memory that the job takes beside it.
    fn admit(
        &self,
        job: &Job,
        requested: &RequestedSettings,
        progress: &dyn Progress,
    ) -> Result<Admission, Failure> {
        let key = SceneKey {
            path: job.scene.clone(),
            defines: job.definitions(),
        };
        let shard = self.options.shard_of_samples();
        let bytes = |loaded: &Loaded| {
            let settings = requested.settle(&loaded.scene)?;
            let kept = shard.map_or(0, |shard| partial::own_groups(&settings, shard).len());
            let files = attachments::bytes_needed(job, &loaded.scene, &settings)?;
            Ok(files + estimate::of_job(&loaded.scene, &settings, job, kept as u64))
        };
        self.store.admit(&key, bytes, &|| progress.cancelled())
    }

    /// The scene with the job's values.
    fn edited<'a>(&self, job: &Job, loaded: &'a Loaded) -> Result<EditedScene<'a>, Failure> {
        let mut scene = EditedScene::new(loaded.base());
        let all = job.set.0.iter();
        let found = direction::distinct(all.map(|(key, _)| parameters::find(scene.scene(), key)))?;
        for ((key, numbers), parameter) in job.set.0.iter().zip(found) {
            let values = numbers.exactly(&parameter, key)?;
            scene.set(&parameter, &values)?;
        }
        scene.follow(self.options.threads).map_err(failed)?;
        Ok(scene)
    }

    fn compute(
        &self,
        job: &Job,
        request: &Request,
        (loaded, prepared): (&Loaded, &Prepared),
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Computed, Failure> {
        let Some(shard) = self.options.shard_of_samples() else {
            let pilot = self.ask_pilot(request, loaded, settings, progress);
            let settled = pilot.as_ref().map_or(settings, |(settled, _)| settled);
            let mut done = request.answer(prepared, settled, progress)?;
            if let Some((_, pilot)) = pilot {
                done.statistics.add_pilot(pilot);
            }
            return Ok(Computed::Whole(done));
        };
        let part = partial::answer(job, request, shard, prepared, settings, progress)?;
        Ok(Computed::Part(part))
    }

    /// What a pilot comes to, if one is to be asked: of the scene without the job's values, so that
    /// all jobs with the same question share the answer. A scene that refuses it leaves it to the
    /// job's.
    fn ask_pilot(
        &self,
        request: &Request,
        loaded: &Loaded,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Option<(Settings, Pilot)> {
        let question = request.question().filter(|_| settings.needs_pilot())?;
        let scene = EditedScene::new(loaded.base());
        let prepared = scene.prepare(&self.workers, &|| progress.cancelled());
        prepared.ok()?.decide(settings, &question, progress).ok()
    }

    /// Writes the files, and what there is to say of them.
    fn write(&self, job: &Job, computed: Computed, result: &mut ResultLine) -> Result<(), Failure> {
        match computed {
            Computed::Whole(done) => {
                result.absorb(&done.statistics);
                result.loss = done.loss;
                result.norms = done.results.norms().into_iter().collect();
                if lacks_errors(job, result) {
                    result.warnings.push(NO_ERRORS.into());
                }
                let mut files = done.results.files()?;
                files.retain(|file| job.writes(file.name));
                self.write_files(job, &files, result)
            }
            Computed::Part(part) => {
                result.absorb(&part.statistics);
                result.loss = part.loss;
                if !part.tensors.is_empty() {
                    let file = results::partial(PARTIAL, &part.tensors)?;
                    self.write_files(job, &[file], result)?;
                }
                result.share = Some(part.share);
                Ok(())
            }
        }
    }

    fn write_files(
        &self,
        job: &Job,
        files: &[ResultFile],
        result: &mut ResultLine,
    ) -> Result<(), Failure> {
        let start = Instant::now();
        result.files = folder::write(&self.options.directory, &job.id, files)?;
        let seconds = start.elapsed().as_secs_f64();
        result.seconds.insert("write".into(), seconds);
        Ok(())
    }
}

const NO_ERRORS: &str =
    "a single sample, or group of samples, tells no standard error: none is written";

/// Whether standard errors are expected, and there are none.
fn lacks_errors(job: &Job, result: &ResultLine) -> bool {
    let expected = match job.mode {
        Mode::Render => false,
        Mode::Forward => job.writes(STDERR),
        Mode::Backward => true,
    };
    let is_error = |name: &String| name.ends_with(STANDARD_ERROR);
    expected && job.stderr != Some(false) && !result.norms.keys().any(is_error)
}

/// What a job gives.
enum Computed {
    Whole(Done),
    /// Some groups of its samples.
    Part(Partial),
}

fn failed(error: EngineError) -> Failure {
    Failure::from_engine(error, None)
}
