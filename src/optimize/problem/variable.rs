//! What the optimiser moves: a parameter of the scene, or numbers that it is a function of.

use crate::jobs::failure::Failure;
use crate::jobs::number_file::NumberFile;
use crate::optimize::config::{
    Config, Kind, ParameterSettings, Remeshing, Reparameterisation, Schedule, Start,
};
use crate::optimize::optimizer::Rates;
use crate::optimize::shape::large_steps::LargeSteps;
use crate::scene::Scene;
use crate::scene::parameters::{self, Parameter, Target, Value};
use std::sync::Arc;

/// A parameter that is optimised.
pub struct Variable {
    pub parameter: Parameter,
    pub settings: ParameterSettings,
    /// The least and the largest value, infinite where there is none.
    pub bounds: [f64; 2],
    pub map: Map,
    lr: Schedule,
    kind: Kind,
}

/// From what the optimiser moves, the latent numbers, to the value.
#[derive(Clone)]
pub enum Map {
    Identity,
    Log,
    Logistic,
    LargeSteps(Arc<LargeSteps>),
}

impl Variable {
    /// Finds a parameter in the scene, and checks what is asked of it.
    pub fn new(
        scene: &Scene,
        settings: &ParameterSettings,
        config: &Config,
    ) -> Result<Self, Failure> {
        let wrong = |what: String| Failure::Input(format!("{}: {what}", settings.place));
        let parameter =
            parameters::find(scene, &settings.key).map_err(|error| wrong(error.to_string()))?;
        let [low, high] = natural_bounds(scene, &parameter);
        let [min, max] = settings.bounds;
        let bounds = [min.unwrap_or(low).max(low), max.unwrap_or(high).min(high)];
        if bounds[0] >= bounds[1] {
            let what = format!("its bounds leave nothing of {low} to {high}, where its values are");
            return Err(wrong(what));
        }
        let map = map(scene, &parameter, settings)?;
        Ok(Self {
            lr: settings
                .lr
                .clone()
                .unwrap_or_else(|| config.optimizer.lr.clone()),
            kind: settings.kind.unwrap_or(config.optimizer.kind),
            settings: settings.clone(),
            parameter,
            bounds,
            map,
        })
    }

    /// The optimiser's numbers at a step.
    pub fn rates(&self, config: &Config, step: u64) -> Rates {
        let optimizer = &config.optimizer;
        Rates {
            kind: self.kind,
            lr: self.lr.at(step, config.steps),
            momentum: optimizer.momentum,
            betas: optimizer.betas,
            epsilon: optimizer.epsilon,
            weight_decay: optimizer.weight_decay,
            max_step: self.settings.max_step.or(optimizer.max_step),
        }
    }

    /// Which optimiser.
    pub fn kind(&self) -> Kind {
        self.kind
    }

    /// New triangles on the way.
    pub fn remeshing(&self) -> Option<&Remeshing> {
        self.settings.remeshing.as_ref()
    }

    /// The mesh whose vertices it moves one by one.
    pub fn mesh(&self) -> Option<usize> {
        match self.parameter.target {
            Some(Target::VertexPositions(m)) => Some(m),
            _ => None,
        }
    }

    /// Where the optimisation begins.
    pub fn start(&self, scene: &Scene) -> Result<Vec<f64>, Failure> {
        let key = &self.parameter.key;
        let wrong = |what: String| Failure::Input(format!("{}: {what}", self.settings.place));
        let values = match &self.settings.start {
            None => present(scene, &self.parameter),
            Some(Start::Numbers(numbers)) => {
                let numbers: Vec<f32> = numbers.iter().map(|&v| v as f32).collect();
                let all = self.parameter.broadcast(&numbers);
                let all = all.map_err(|error| {
                    Failure::Input(format!("{}: start: {error}", self.settings.place))
                })?;
                all.iter().map(|&v| f64::from(v)).collect()
            }
            Some(Start::File(file)) => {
                let read = NumberFile::open(file, &self.parameter, key)
                    .and_then(|opened| opened.read(&self.parameter, key))
                    .map_err(|error| error.at("start").at(&self.settings.place))?;
                read.iter().map(|&v| f64::from(v)).collect()
            }
        };
        let [low, high] = self.bounds;
        // A bound of the scene itself was rounded to single precision.
        let inside = |v: &f64| *v >= low - 1e-6 * low.abs() && *v <= high + 1e-6 * high.abs();
        match values.iter().find(|v| !v.is_finite() || !inside(v)) {
            None => Ok(values),
            Some(bad) => Err(wrong(format!(
                "it starts at {bad}, which is not between {low} and {high}; write another start, min or max"
            ))),
        }
    }

    /// The latent numbers of a value.
    pub fn latent(&self, values: &[f64]) -> Vec<f64> {
        let [low, high] = self.bounds;
        match &self.map {
            Map::Identity => values.to_vec(),
            Map::Log => values
                .iter()
                .map(|v| v.max(f64::MIN_POSITIVE).ln())
                .collect(),
            Map::Logistic => {
                // At a bound itself nothing would ever move again.
                let share = |v: &f64| ((v - low) / (high - low)).clamp(1e-4, 1.0 - 1e-4);
                values
                    .iter()
                    .map(share)
                    .map(|t| (t / (1.0 - t)).ln())
                    .collect()
            }
            Map::LargeSteps(map) => map.latent(values),
        }
    }

    /// The value of latent numbers.
    pub fn values(&self, latent: &[f64]) -> Vec<f64> {
        let [low, high] = self.bounds;
        match &self.map {
            Map::Identity => latent.to_vec(),
            Map::Log => latent.iter().map(|x| x.exp()).collect(),
            Map::Logistic => latent
                .iter()
                .map(|x| low + (high - low) * logistic(*x))
                .collect(),
            Map::LargeSteps(map) => map.values(latent),
        }
    }

    /// The gradient by the latent numbers, of that by the value.
    pub fn pull_back(&self, latent: &[f64], gradient: &[f64]) -> Vec<f64> {
        let [low, high] = self.bounds;
        let pairs = latent.iter().zip(gradient);
        match &self.map {
            Map::Identity => gradient.to_vec(),
            Map::Log => pairs.map(|(x, g)| g * x.exp()).collect(),
            Map::Logistic => pairs
                .map(|(x, g)| {
                    let t = logistic(*x);
                    g * (high - low) * t * (1.0 - t)
                })
                .collect(),
            Map::LargeSteps(map) => map.pull_back(gradient),
        }
    }

    /// Puts latent numbers back between the bounds; how many were outside.
    pub fn hold(&self, latent: &mut [f64]) -> usize {
        let [low, high] = match self.map {
            Map::Identity => self.bounds,
            Map::Log => self
                .bounds
                .map(|v| if v > 0.0 { v.ln() } else { f64::NEG_INFINITY }),
            Map::Logistic | Map::LargeSteps(_) => return 0,
        };
        let mut held = 0;
        for x in latent {
            let inside = x.clamp(low, high);
            held += usize::from(inside != *x);
            *x = inside;
        }
        held
    }
}

fn logistic(x: f64) -> f64 {
    1.0 / (1.0 + (-x).exp())
}

fn map(scene: &Scene, parameter: &Parameter, settings: &ParameterSettings) -> Result<Map, Failure> {
    let wrong = |what: &str| Err(Failure::Input(format!("{}: {what}", settings.place)));
    let is_motion = ["translation", "rotation"]
        .iter()
        .any(|motion| parameter.key.ends_with(motion));
    match settings.reparameterisation {
        Reparameterisation::None => Ok(Map::Identity),
        Reparameterisation::Log if is_motion || parameter.key.ends_with("positions") => wrong(
            "a logarithm is for numbers above zero, such as colours; take reparameterisation out",
        ),
        Reparameterisation::Log => Ok(Map::Log),
        Reparameterisation::Logistic => Ok(Map::Logistic),
        Reparameterisation::LargeSteps { lambda } => match parameter.target {
            Some(Target::VertexPositions(m)) => {
                let mesh = &scene.meshes[m];
                let map = LargeSteps::new(&mesh.positions, &mesh.triangles, lambda)
                    .map_err(|what| Failure::Input(format!("{}: {what}", settings.place)))?;
                Ok(Map::LargeSteps(Arc::new(map)))
            }
            _ => wrong("large_steps is for vertex_positions"),
        },
    }
}

/// What the parameter's numbers can be at all.
fn natural_bounds(scene: &Scene, parameter: &Parameter) -> [f64; 2] {
    match parameter.target {
        Some(Target::Texels(texture) | Target::Texel { texture, .. }) => {
            scene.textures[texture].limits.map(f64::from)
        }
        Some(Target::ShapeScale(_)) => [1e-6, f64::INFINITY],
        Some(Target::EnvironmentScale) => [0.0, f64::INFINITY],
        Some(Target::SensorXFov(_)) => [1e-3, 179.999],
        _ => [f64::NEG_INFINITY, f64::INFINITY],
    }
}

/// All numbers of a parameter as the scene has them.
pub fn present(scene: &Scene, parameter: &Parameter) -> Vec<f64> {
    let all = |numbers: &mut dyn Iterator<Item = f32>| numbers.map(f64::from).collect();
    match (parameter.target, &parameter.value) {
        (Some(Target::VertexPositions(m)), _) => {
            all(&mut scene.meshes[m].positions.iter().flat_map(|p| p.to_array()))
        }
        (Some(Target::Texels(t)), _) => {
            let texture = &scene.textures[t];
            let texels = texture.texels.iter();
            all(&mut texels.flat_map(|texel| texel[..texture.channels].to_vec()))
        }
        (_, Value::Numbers(numbers)) => numbers.clone(),
        (_, Value::Range { .. }) => Vec::new(),
    }
}
