//! What all commands that trace rays share: loading, settings, the output directory, the report.

use super::arguments::{SceneArguments, TraceArguments};
use super::exit::Failure;
use super::log::Log;
use super::progress::StageProgress;
use super::report::{Report, SceneReport};
use super::signals::Signals;
use crate::jobs::id::REPORT;
use crate::jobs::machine;
use crate::jobs::settings::{self, RequestedSettings};
use crate::methods::{EngineError, Method, Progress, Settings, Statistics};
use crate::output::{FileError, atomic};
use crate::scene::{self, Scene};
use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// More warnings than this about a scene are counted, not printed; the report has them all.
const WARNINGS_PRINTED: usize = 10;

/// One run of a command, from the loaded scene to the written report.
pub struct Session {
    pub scene: Scene,
    pub settings: Settings,
    pub report: Report,
    pub log: Log,
    /// What is expected to come after the next stage, for its progress.
    pub rest_seconds: f64,
    directory: PathBuf,
    directory_is_ready: bool,
    signals: Signals,
    started: Instant,
    json: bool,
}

impl Session {
    /// Loads the scene and settles every setting. Nothing is written yet.
    pub fn open(
        command: &'static str,
        trace: &TraceArguments,
        typed: &[OsString],
        method: Option<Method>,
        standard_error: bool,
    ) -> Result<Self, Failure> {
        trace
            .backend
            .require()
            .map_err(|why| Failure::Usage(why.into()))?;
        let started = Instant::now();
        let log = Log::new(&trace.talk);
        let signals = Signals::watch(log);
        let scene = load(&trace.scene, log)?;
        let requested = RequestedSettings {
            sensor: trace.scene.sensor,
            spp: trace.spp,
            seed: trace.seed,
            max_depth: trace.max_depth,
            resolution: trace.resolution,
            method: method.unwrap_or_default(),
            backend: trace.backend,
            standard_error,
            groups: None,
            threads: threads(trace.threads),
        };
        let settings = requested.settle(&scene)?;
        let resolution = settings::size(&settings, &scene);
        let mut report = Report::new(
            command,
            describe(&trace.scene, &scene),
            &settings,
            resolution,
        );
        report.arguments = typed
            .iter()
            .skip(1)
            .map(|argument| argument.to_string_lossy().into_owned())
            .collect();
        report.method = method.map(Method::name);
        report.warnings = scene.warnings.clone();
        report.spend("load", started.elapsed().as_secs_f64());
        let directory = trace
            .output
            .clone()
            .unwrap_or_else(|| default_directory(command, &trace.scene.scene));
        Ok(Self {
            scene,
            settings,
            report,
            log,
            rest_seconds: 0.0,
            directory,
            directory_is_ready: false,
            signals,
            started,
            json: trace.talk.json,
        })
    }

    /// Width and height of the image.
    pub fn resolution(&self) -> [u32; 2] {
        self.report.resolution
    }

    /// Says something the user should know, now and in the report.
    pub fn warn(&mut self, text: String) {
        self.log.warning(&text);
        self.report.warnings.push(text);
    }

    /// Runs the engine once, showing how far it is.
    pub fn trace<T>(
        &mut self,
        stage: &'static str,
        settings: &Settings,
        work: impl FnOnce(&Scene, &Settings, &dyn Progress) -> Result<T, EngineError>,
        statistics: impl FnOnce(&T) -> &Statistics,
    ) -> Result<T, Failure> {
        // Hours of tracing must not end in a directory that cannot be written.
        self.prepare_directory()?;
        let progress = StageProgress::start(stage, self.log, &self.signals, self.rest_seconds);
        let done = work(&self.scene, settings, &progress);
        progress.finish();
        let done = done.map_err(|error| Failure::from_engine(error, self.signals.received()))?;
        self.report.absorb(statistics(&done));
        Ok(done)
    }

    /// Writes one file of the results.
    pub fn write(
        &mut self,
        name: &str,
        write: impl FnOnce(&Path) -> Result<(), FileError>,
    ) -> Result<(), Failure> {
        let started = Instant::now();
        self.prepare_directory()?;
        write(&self.directory.join(name))?;
        self.report.spend("write", started.elapsed().as_secs_f64());
        self.report.files.push(name.into());
        Ok(())
    }

    /// Standard errors are spreads of groups of samples, and one sample is one group.
    pub fn warn_of_one_group(&mut self) {
        if self.settings.standard_error && self.settings.groups().count < 2 {
            self.warn(
                "with one sample a pixel there are no standard errors: raise --spp, or say --no-stderr"
                    .into(),
            );
        }
    }

    /// A file of an earlier run that would now be taken for a part of this one's results.
    pub fn warn_of_leftover(&mut self, name: &str) {
        let path = self.directory.join(name);
        if path.exists() {
            self.warn(format!("{} is from an earlier run", path.display()));
        }
    }

    /// Says what a pilot has tried.
    pub fn explain(&self) {
        match &self.report.pilot {
            Some(pilot) => {
                let lines = pilot.explanation();
                lines.iter().for_each(|line| self.log.note(line));
            }
            None => self
                .log
                .note("there is nothing to explain: only --method auto, the default, asks a pilot"),
        }
    }

    /// Writes the report, and says what was done.
    pub fn close(mut self) -> Result<(), Failure> {
        for warning in self.report.losses() {
            self.warn(warning);
        }
        for note in &self.report.notes {
            self.log.note(note);
        }
        self.report.files.push(REPORT.into());
        self.report.peak_memory_bytes = machine::peak();
        self.report
            .spend("total", self.started.elapsed().as_secs_f64());
        let text = serde_json::to_string_pretty(&self.report)
            .map_err(|error| Failure::System(error.to_string()))?
            + "\n";
        atomic::write(&self.directory.join(REPORT), |file| {
            file.write_all(text.as_bytes())
        })?;
        let seconds = self.started.elapsed().as_secs_f64();
        self.log.note(&format!(
            "{}: {} ({seconds:.2} s)",
            self.directory.display(),
            self.report.files.join(", ")
        ));
        if self.json {
            let mut stdout = std::io::stdout().lock();
            stdout.write_all(text.as_bytes())?;
            stdout.flush()?;
        }
        Ok(())
    }

    /// Whether the report goes to stdout, which then has room for nothing else.
    pub fn prints_json(&self) -> bool {
        self.json
    }

    /// Takes away what an earlier run has found, before this one finds anything.
    pub fn take_away(&mut self, name: &str) -> Result<(), Failure> {
        self.prepare_directory()?;
        Ok(atomic::take_away(&self.directory.join(name))?)
    }

    /// From here on the folder is this run's. A report in it always tells of the files beside it,
    /// so that of an earlier run goes before the first of them is written over.
    fn prepare_directory(&mut self) -> Result<(), Failure> {
        if !self.directory_is_ready {
            atomic::prepare_directory(&self.directory)?;
            atomic::take_away(&self.directory.join(REPORT))?;
            self.directory_is_ready = true;
        }
        Ok(())
    }
}

/// Loads a scene, passing its warnings on.
pub fn load(arguments: &SceneArguments, log: Log) -> Result<Scene, Failure> {
    refuse_doubled(&arguments.defines)?;
    let scene = scene::load(&arguments.scene, &arguments.defines)?;
    warn(&scene, arguments, log)?;
    Ok(scene)
}

/// Loads what there is to list of a scene, even if it cannot be rendered.
pub fn load_to_list(arguments: &SceneArguments, log: Log) -> Result<Scene, Failure> {
    refuse_doubled(&arguments.defines)?;
    let scene = scene::load_to_list(&arguments.scene, &arguments.defines)?;
    warn(&scene, arguments, log)?;
    Ok(scene)
}

/// Of two values for one name, one would silently count for nothing.
fn refuse_doubled(defines: &[(String, String)]) -> Result<(), Failure> {
    for (at, (name, _)) in defines.iter().enumerate() {
        if defines[..at].iter().any(|(other, _)| other == name) {
            return Err(Failure::Usage(format!("-D {name} is given twice")));
        }
    }
    Ok(())
}

fn warn(scene: &Scene, arguments: &SceneArguments, log: Log) -> Result<(), Failure> {
    for warning in scene.warnings.iter().take(WARNINGS_PRINTED) {
        log.warning(warning);
    }
    if scene.warnings.len() > WARNINGS_PRINTED {
        log.warning(&format!(
            "and {} more about the scene",
            scene.warnings.len() - WARNINGS_PRINTED
        ));
    }
    settings::check_sensor(scene, arguments.sensor)?;
    Ok(())
}

/// The method of this name, which the command line knows.
pub fn method(name: &str) -> Result<Method, Failure> {
    let unknown = || Failure::Usage(format!("--method {name}: there is no such method"));
    Method::named(name).ok_or_else(unknown)
}

/// As many as asked for, or the cores this process may use.
pub fn threads(asked: Option<usize>) -> usize {
    asked.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, |cores| cores.get()))
}

fn describe(arguments: &SceneArguments, scene: &Scene) -> SceneReport {
    SceneReport {
        path: arguments.scene.display().to_string(),
        hash: format!("fnv1a64:{:016x}", scene.hash),
        defines: arguments.defines.iter().cloned().collect(),
    }
}

fn default_directory(command: &str, scene: &Path) -> PathBuf {
    let stem = scene
        .file_stem()
        .map_or("scene".into(), |stem| stem.to_string_lossy());
    Path::new("out").join(format!("{command}-{stem}"))
}
