//! An optimisation ready to begin: scene, views and variables.

pub mod base;
mod pictures;
pub mod pose;
mod remeshing;
pub mod seeds;
pub mod silhouette;
pub mod variable;
pub mod view;

use crate::jobs::failure::Failure;
use crate::jobs::settings::{MOST_SAMPLES, RequestedSettings};
use crate::methods::{EngineError, Pilot, Prepared, Progress, Question, Settings, Workers};
use crate::optimize::cameras;
use crate::optimize::config::{Config, Truth};
use crate::optimize::loss::Comparison;
use crate::picture::Image;
use crate::scene::parameters::{self, Parameter, Target};
use crate::scene::{self, Normals, Scene, vertex_normals};
use crate::trace::Backend;
use base::SceneBase;
use std::path::Path;
use std::time::Instant;
use variable::Variable;
use view::View;

/// What a mask has where shapes cover all of a pixel, up to rounding.
const WHOLE: f32 = 0.999;

/// What the machine gives.
#[derive(Clone)]
pub struct Machine {
    pub workers: Workers,
    pub threads: usize,
    pub backend: Backend,
}

/// Everything that does not change from step to step.
pub struct Problem {
    pub config: Config,
    pub machine: Machine,
    pub settings: Settings,
    pub base: SceneBase,
    /// That of the mask term.
    pub silhouette: Option<SceneBase>,
    pub variables: Vec<Variable>,
    pub views: Vec<View>,
    pub held_out: Vec<View>,
    /// The scene with its first values.
    pub start: Scene,
    /// The scene that is to be found, if it is known.
    pub truth: Option<Scene>,
    pub warnings: Vec<String>,
    /// How `auto` has come to what all steps are done with.
    pub pilot: Option<Pilot>,
    /// Spent on loading and building, on rendering the targets.
    pub seconds: [f64; 2],
}

impl Problem {
    /// Loads the scene and the views, and renders the targets of a known scene.
    pub fn load(
        config: Config,
        machine: Machine,
        progress: &dyn Progress,
    ) -> Result<Self, Failure> {
        let begun = Instant::now();
        let mut scene = load_scene(&config, "scene", &config.scene)?;
        let wanted = match &config.views.cameras {
            Some(found) => cameras::add(
                found,
                &mut scene,
                Truth::makes_targets(config.truth.as_ref()),
            )?,
            None => view::wanted(&config, &scene)?,
        };
        let truth = truth(&config, &scene)?;
        let mut warnings = std::mem::take(&mut scene.warnings);
        let settings = settings(&config, &scene, &machine)?;
        let mut variables: Vec<Variable> = Vec::new();
        for parameter in &config.parameters {
            variables.push(Variable::new(&scene, parameter, &config)?);
        }
        // Vertices first, then what turns, scales and moves them together: the pose's pivot is that
        // of the mesh as it stands.
        variables.sort_by_key(|v| rank(v.parameter.target));
        check_together(&variables)?;
        free_normals(&mut scene, &variables, &mut warnings);
        let links = variables.iter().any(|v| v.parameter.moves_visibility);
        let silhouette = match &config.loss.silhouette {
            None => None,
            Some(of) => {
                let scene = silhouette::scene(&scene, of)
                    .map_err(|what| config.places.wrong("loss.silhouette.shapes", what))?;
                Some(SceneBase::new(
                    scene,
                    &machine.workers,
                    machine.backend,
                    links,
                )?)
            }
        };
        let start = at_start(&scene, &variables)?;
        let base = SceneBase::new(scene, &machine.workers, machine.backend, links)?;
        let loaded = begun.elapsed().as_secs_f64();
        let begun = Instant::now();
        let mut problem = Self {
            config,
            machine,
            settings,
            base,
            silhouette,
            variables,
            views: Vec::new(),
            held_out: Vec::new(),
            start,
            truth,
            warnings,
            pilot: None,
            seconds: [loaded, 0.0],
        };
        problem.read_views(&wanted, progress)?;
        problem.ask_pilot(progress)?;
        problem.seconds[1] = begun.elapsed().as_secs_f64();
        Ok(problem)
    }

    fn read_views(
        &mut self,
        wanted: &[view::Wanted],
        progress: &dyn Progress,
    ) -> Result<(), Failure> {
        let mut all = Vec::new();
        {
            let is_rendered = Truth::makes_targets(self.config.truth.as_ref());
            let prepared = match self.truth.as_ref().filter(|_| is_rendered) {
                Some(truth) => Some(
                    Prepared::with_workers(
                        truth,
                        &self.machine.workers,
                        self.machine.backend,
                        &|| progress.cancelled(),
                    )
                    .map_err(failed)?,
                ),
                None => None,
            };
            for (number, wanted) in wanted.iter().enumerate() {
                let render = |resolution| {
                    let (Some(prepared), Some(truth)) = (&prepared, &self.config.truth) else {
                        return Err(Failure::Input(format!(
                            "{}: it has no target",
                            wanted.place
                        )));
                    };
                    let settings = Settings {
                        spp: truth.spp,
                        seed: seeds::of(self.config.seed, [seeds::TRUTH, number as u64, 0]),
                        sensor: wanted.sensor,
                        resolution,
                        ..self.settings.clone()
                    };
                    Ok(prepared.render(&settings, progress).map_err(failed)?.image)
                };
                let resolution = self.config.render.resolution;
                all.push(view::read(
                    number,
                    wanted,
                    &self.base.scene,
                    resolution,
                    render,
                )?);
            }
        }
        self.hold_out(all)?;
        if self.views.is_empty() {
            return Err(Failure::Input(format!(
                "{}: there is no view to fit; give [[view]], or cameras",
                self.config.file.display()
            )));
        }
        if self.silhouette.is_some()
            && let Some(view) = self.views.iter().find(|view| view.mask.is_none())
        {
            let what = format!(
                "it compares with masks, and {} has none; give each view a mask, or take it out",
                view.name
            );
            return Err(self.config.places.wrong("loss.silhouette", what));
        }
        for step in 0..self.config.steps {
            for view in &self.views {
                view::check_factor(view, &self.base.scene, self.downscale(step) as u64)
                    .map_err(|what| self.config.places.wrong("render.downscale", what))?;
            }
        }
        Ok(())
    }

    /// Parts the views that are fitted from those that are not.
    fn hold_out(&mut self, all: Vec<View>) -> Result<(), Failure> {
        let out = self.config.views.hold_out;
        if let Some(n) = out.filter(|n| *n > all.len() as u64) {
            let what = format!(
                "every {n} views one is left out, and there are {}; write a smaller number",
                all.len()
            );
            return Err(self.config.places.wrong("views.hold_out", what));
        }
        for (i, view) in all.into_iter().enumerate() {
            match out.is_some_and(|n| (i as u64 + 1).is_multiple_of(n)) {
                true => self.held_out.push(view),
                false => self.views.push(view),
            }
        }
        Ok(())
    }

    /// Settles what `auto` does in all steps: what is best for the first view that depends on what
    /// is sought, of the scene as it starts, which is the same however often a run is taken up
    /// again.
    fn ask_pilot(&mut self, progress: &dyn Progress) -> Result<(), Failure> {
        if !self.settings.needs_pilot() {
            return Ok(());
        }
        let Machine {
            workers, backend, ..
        } = &self.machine;
        let cancelled = || progress.cancelled();
        let prepared = Prepared::with_workers(&self.start, workers, *backend, &cancelled);
        let of_view = |view: &View| -> Vec<Parameter> {
            let all = self.variables.iter().map(|v| v.parameter.clone());
            all.filter(|p| p.check_sensor(&self.start, view.sensor).is_ok())
                .collect()
        };
        let mut views = self.views.iter().map(|view| (view, of_view(view)));
        let Some((view, parameters)) = views.find(|(_, of_view)| !of_view.is_empty()) else {
            return Ok(());
        };
        let settings = Settings {
            spp: self.even(self.config.render.spp.at(0, self.config.steps) as u32),
            ..self.settings_of(view, 0)
        };
        let needed = pose::needed(&self.start, &parameters);
        let jobs = self.config.steps * self.views.len() as u64;
        let decided = prepared
            .and_then(|p| p.decide_for(jobs, &settings, &Question::Backward(&needed), progress))
            .map_err(failed)?;
        let (settled, pilot) = decided;
        self.settings.method = settled.method;
        self.settings.constants = settled.constants;
        self.pilot = Some(pilot);
        Ok(())
    }

    /// By how much views are smaller at a step.
    pub fn downscale(&self, step: u64) -> usize {
        self.config.render.downscale.at(step, self.config.steps) as usize
    }

    /// The image of one view compared with its target, at a step.
    pub fn comparison(&self, view: &View, step: u64) -> Comparison {
        let (target, weights) = self.counted(view, self.downscale(step));
        let loss = &self.config.loss;
        Comparison::new(loss.kind, target, weights, loss.pyramid)
    }

    /// A view's target, smaller by a factor, and how much the colours of its pixels count: as its
    /// mask says. Where that is what shapes cover, a pixel that they cover in part has mixed in
    /// what is behind them, and does not count.
    pub fn counted(&self, view: &View, factor: usize) -> (Image, Option<Vec<f32>>) {
        let (target, mut weights) = view::shrunk(view, factor);
        if self.silhouette.is_some() {
            for weight in weights.iter_mut().flatten() {
                *weight = f32::from(*weight >= WHOLE);
            }
        }
        (target, weights)
    }

    /// What the shapes cover compared with a view's mask, at a step.
    pub fn coverage(&self, view: &View, step: u64) -> Comparison {
        let mask = view.mask.clone().unwrap_or_default();
        let view = View {
            target: Image {
                pixels: mask.iter().map(|&v| [v; 3]).collect(),
                ..view.target.clone()
            },
            mask: None,
            ..view.clone()
        };
        let (target, _) = view::shrunk(&view, self.downscale(step));
        let levels = self.config.loss.pyramid;
        Comparison::new(crate::optimize::config::Pointwise::L2, target, None, levels)
    }

    /// Settings for one view at a step.
    pub fn settings_of(&self, view: &View, step: u64) -> Settings {
        let factor = self.downscale(step) as u32;
        let [width, height] = view.size().map(|n| n as u32);
        let resolution = match factor {
            1 => view.resolution,
            factor => Some([width / factor, height / factor]),
        };
        Settings {
            sensor: view.sensor,
            resolution,
            ..self.settings.clone()
        }
    }

    /// Samples that shares can part evenly.
    pub fn even(&self, spp: u32) -> u32 {
        spp.max(1)
            .next_multiple_of(self.config.render.shares)
            .min(MOST_SAMPLES)
    }
}

/// A scene that a key names. What is wrong with the file itself has its place there.
fn load_scene(config: &Config, key: &str, file: &Path) -> Result<Scene, Failure> {
    if !file.exists() {
        let what = format!("{}: there is no such file", file.display());
        return Err(config.places.wrong(key, what));
    }
    scene::load(file, &config.defines).map_err(|error| {
        let text = error.to_string();
        // As the command line would have given it.
        let define = text.strip_prefix("-D ").and_then(|t| t.split_once(": "));
        match define {
            Some((name, what)) => config.places.wrong(&format!("defines.{name}"), what),
            None => error.into(),
        }
    })
}

fn settings(config: &Config, scene: &Scene, machine: &Machine) -> Result<Settings, Failure> {
    let requested = RequestedSettings {
        sensor: 0,
        spp: Some(1),
        seed: Some(config.seed),
        max_depth: config.render.max_depth,
        resolution: config.render.resolution,
        method: config.render.method,
        backend: machine.backend,
        standard_error: true,
        groups: None,
        threads: machine.threads,
    };
    requested.settle(scene)
}

/// The scene to be found, with the cameras of the one that is optimised.
fn truth(config: &Config, scene: &Scene) -> Result<Option<Scene>, Failure> {
    let Some(truth) = &config.truth else {
        return Ok(None);
    };
    let mut found = match &truth.scene {
        None => scene.clone(),
        Some(file) => load_scene(config, "truth.scene", file)?,
    };
    let own = std::mem::replace(&mut found.sensors, scene.sensors.clone());
    if config.views.cameras.is_none() {
        for sensor in &mut found.sensors {
            if let Some(same) = own.iter().find(|other| other.id == sensor.id) {
                *sensor = same.clone();
            }
        }
    }
    Ok(Some(found))
}

fn at_start(scene: &Scene, variables: &[Variable]) -> Result<Scene, Failure> {
    let mut scene = scene.clone();
    for variable in variables {
        let values = variable.start(&scene)?;
        let values: Vec<f32> = values.iter().map(|&v| v as f32).collect();
        parameters::apply(&mut scene, &variable.parameter, &values)?;
    }
    Ok(scene)
}

/// In which order values are set.
fn rank(target: Option<Target>) -> u32 {
    match target {
        Some(Target::VertexPositions(_)) => 0,
        Some(Target::ShapeScale(_)) => 1,
        Some(Target::ShapeRotation(_)) => 2,
        Some(Target::ShapeTranslation(_) | Target::DeltaLightTranslation(_)) => 3,
        _ => 0,
    }
}

/// Refuses two names of one parameter, and vertices that move while their pose's pivot depends on
/// them.
fn check_together(variables: &[Variable]) -> Result<(), Failure> {
    for (i, variable) in variables.iter().enumerate() {
        let place = &variable.settings.place;
        let (target, key) = (variable.parameter.target, &variable.parameter.key);
        if variables[..i].iter().any(|v| v.parameter.target == target) {
            return Err(Failure::Input(format!(
                "{place}: {key} is named twice, by two of its names"
            )));
        }
        let Some(Target::ShapeRotation(body) | Target::ShapeScale(body)) = target else {
            continue;
        };
        let moves = |v: &Variable| v.mesh().is_some_and(|m| body.meshes().contains(&m));
        if variables.iter().any(moves) {
            return Err(Failure::Input(format!(
                "{place}: {key} and the vertex_positions of the same shape say one thing twice; take one out"
            )));
        }
    }
    Ok(())
}

/// Normals that a file gives stay behind when vertices move one by one: they are computed instead.
fn free_normals(scene: &mut Scene, variables: &[Variable], warnings: &mut Vec<String>) {
    for m in variables.iter().filter_map(Variable::mesh) {
        let mesh = &mut scene.meshes[m];
        if let Normals::Given(_) = mesh.normals {
            mesh.normals = Normals::Computed(vertex_normals(&mesh.positions, &mesh.triangles));
            warnings.push(format!(
                "{}: the normals of its file would stay as they are while its vertices move; they are computed from \
                 the vertices instead",
                mesh.id
            ));
        }
    }
}

fn failed(error: EngineError) -> Failure {
    Failure::from_engine(error, None)
}
