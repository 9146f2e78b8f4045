//! A job: one line of JSON, and what is wrong with it.

use super::failure::Failure;
use super::id::check_id;
use super::numbers::Numbers;
use super::pairs::{Keys, Pairs};
use super::settings::{self, MOST_SAMPLES, Wishes};
use crate::methods::Method;
use crate::output::results;
use crate::trace::Backend;
use schemars::{JsonSchema, Schema, SchemaGenerator};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;
use std::path::PathBuf;

/// One image or gradient to compute. What is left out comes from the scene.
#[derive(Clone, Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "A line of a warpath batch")]
pub struct Job {
    /// Names the job and its folder, once in a batch: letters, digits, '-', '_' and '.', not first a '.'
    #[schemars(
        length(min = 1, max = 128),
        regex(pattern = r"^[A-Za-z0-9_-][A-Za-z0-9._-]*$")
    )]
    pub id: String,
    pub mode: Mode,
    /// Scene file (Mitsuba 3 XML), from the working directory
    pub scene: PathBuf,
    /// Values for the $names of the scene
    #[serde(default)]
    pub defines: Pairs<Define>,
    /// Parameter values in place of the scene's, applied in the order in which they are written
    #[serde(default)]
    pub set: Pairs<Numbers>,
    /// forward: tangents by key, which together make one direction; backward: a list of keys
    #[serde(default)]
    pub params: Option<Keys>,
    /// backward: the derivative of the loss by the image (any picture file, .npy)
    #[serde(default)]
    pub adjoint: Option<PathBuf>,
    /// backward: the picture to compare the image with
    #[serde(default)]
    pub target: Option<PathBuf>,
    /// backward, with a target: how the image is compared [default: l2]
    #[serde(default)]
    pub loss: Option<Loss>,
    /// Which of the scene's sensors renders, counted from 0
    #[serde(default)]
    pub sensor: usize,
    /// Camera paths per pixel
    #[serde(default)]
    #[schemars(range(min = 1, max = 1048576))]
    pub spp: Option<u32>,
    /// Seed of the random numbers
    #[serde(default)]
    pub seed: Option<u64>,
    /// forward, backward: how visibility is differentiated [default: reparam]
    #[serde(default)]
    pub method: Option<MethodName>,
    /// Longest path in segments, -1 for no limit
    #[serde(default)]
    #[schemars(range(min = -1))]
    pub max_depth: Option<i64>,
    /// Width and height of the image in pixels: [640, 480] or "640x480"
    #[serde(default)]
    pub resolution: Option<Resolution>,
    /// forward, backward: whether to write standard errors [default: true]
    #[serde(default)]
    pub stderr: Option<bool>,
    /// Independent groups of samples; divides spp [default: the least divisor of spp from 4]
    #[serde(default)]
    #[schemars(range(min = 1))]
    pub groups: Option<u32>,
    /// Names of the files to write [default: all that the command of this name writes]
    #[serde(default)]
    pub outputs: Option<Vec<String>>,
}

/// What to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Mode {
    /// The image.
    Render,
    /// The gradient image along one direction.
    Forward,
    /// The gradient of one number by every parameter listed.
    Backward,
}

/// An estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum MethodName {
    Reparam,
    Interior,
    Fd,
}

/// How an image is compared with its target.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Loss {
    /// The mean over pixels and channels of |difference|.
    L1,
    /// The mean of its square.
    #[default]
    L2,
}

/// Width and height in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(try_from = "Sides")]
pub struct Resolution(pub [u32; 2]);

#[derive(Deserialize, JsonSchema)]
#[serde(untagged, expecting = "write [width, height] or \"WIDTHxHEIGHT\"")]
enum Sides {
    Pair(#[schemars(inner(range(min = 1, max = 65536)))] [u32; 2]),
    Text(#[schemars(regex(pattern = r"^[0-9]+[xX][0-9]+$"))] String),
}

impl TryFrom<Sides> for Resolution {
    type Error = String;

    fn try_from(sides: Sides) -> Result<Self, String> {
        match sides {
            Sides::Pair(sides) => settings::check_resolution(sides),
            Sides::Text(text) => settings::resolution(&text),
        }
        .map(Resolution)
    }
}

impl JsonSchema for Resolution {
    fn schema_name() -> Cow<'static, str> {
        "Resolution".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        Sides::json_schema(generator)
    }
}

/// The value of a `$name`.
#[derive(Clone, Debug, PartialEq, Deserialize, JsonSchema)]
#[serde(untagged, expecting = "a text, a number, true or false")]
pub enum Define {
    Text(String),
    Number(serde_json::Number),
    Truth(bool),
}

impl Define {
    /// As it would be typed after `-D name=`.
    pub fn text(&self) -> String {
        match self {
            Define::Text(text) => text.clone(),
            Define::Number(number) => number.to_string(),
            Define::Truth(truth) => truth.to_string(),
        }
    }
}

impl Job {
    /// Reads a line. What is wrong is said with the field.
    pub fn parse(line: &str) -> Result<Self, Failure> {
        // An array of all fields in their order would do for serde.
        if line.trim_start().starts_with('[') {
            return Err(Failure::Input(
                "a job is a JSON object, {…}, not an array".into(),
            ));
        }
        let mut reader = serde_json::Deserializer::from_str(line);
        let job: Job = serde_path_to_error::deserialize(&mut reader).map_err(|error| {
            let path = error.path().to_string();
            let field = match path.as_str() {
                "." => String::new(),
                path => format!("{path}: "),
            };
            Failure::Input(format!("{field}{}", without_line(error.inner())))
        })?;
        reader
            .end()
            .map_err(|error| Failure::Input(without_line(&error)))?;
        job.check()?;
        Ok(job)
    }

    fn check(&self) -> Result<(), Failure> {
        let refuse = |what: String| Err(Failure::Input(what));
        check_id(&self.id)?;
        if self.spp.is_some_and(|n| !(1..=MOST_SAMPLES).contains(&n)) {
            return refuse(format!(
                "spp: write a whole number from 1 to {MOST_SAMPLES}"
            ));
        }
        if self.max_depth.is_some_and(|depth| depth == 0 || depth < -1) {
            return refuse(
                "max_depth: write a number of segments from 1, or -1 for no limit".into(),
            );
        }
        let takes =
            |field: &str, given: bool, modes: &[Mode]| match given && !modes.contains(&self.mode) {
                true => Err(Failure::Input(format!(
                    "{field}: {} takes none",
                    self.mode.name()
                ))),
                false => Ok(()),
            };
        let gradients = [Mode::Forward, Mode::Backward];
        takes("params", self.params.is_some(), &gradients)?;
        takes("method", self.method.is_some(), &gradients)?;
        takes("stderr", self.stderr.is_some(), &gradients)?;
        takes("adjoint", self.adjoint.is_some(), &[Mode::Backward])?;
        takes("target", self.target.is_some(), &[Mode::Backward])?;
        takes("loss", self.loss.is_some(), &[Mode::Backward])?;
        match (self.mode, &self.params) {
            (Mode::Render, _) => {}
            (Mode::Forward, Some(Keys::Tangents(tangents))) if !tangents.0.is_empty() => {}
            (Mode::Forward, _) => {
                return refuse(
                    "params: forward needs tangents, as in {\"ball.translation\": [1, 0, 0]}"
                        .into(),
                );
            }
            (Mode::Backward, Some(Keys::Names(names))) if !names.is_empty() => {}
            (Mode::Backward, _) => {
                return refuse(
                    "params: backward needs a list of keys, as in [\"ball.translation\"]".into(),
                );
            }
        }
        if self.mode == Mode::Backward {
            match (&self.adjoint, &self.target, self.loss) {
                (Some(_), None, None) | (None, Some(_), _) => {}
                (Some(_), None, Some(_)) => {
                    return refuse("loss: it belongs to a target, not to an adjoint".into());
                }
                (Some(_), Some(_), _) => {
                    return refuse("give either an adjoint or a target".into());
                }
                (None, None, _) => return refuse("backward needs an adjoint or a target".into()),
            }
            if self.method == Some(MethodName::Fd) {
                return refuse("method: fd has no reverse mode; use forward".into());
            }
        }
        let known = self.mode.files();
        match self
            .outputs
            .iter()
            .flatten()
            .find(|name| !known.contains(&name.as_str()))
        {
            Some(name) => refuse(format!(
                "outputs: {} writes no \"{name}\"; it writes {}",
                self.mode.name(),
                known.join(", ")
            )),
            None => Ok(()),
        }
    }

    /// What it asks of the engine; `threads` is for the engine's own reports.
    pub fn wishes(&self, threads: usize, backend: Backend) -> Wishes {
        Wishes {
            sensor: self.sensor,
            spp: self.spp,
            seed: self.seed,
            max_depth: self
                .max_depth
                .map(|depth| u32::try_from(depth).unwrap_or(u32::MAX)),
            resolution: self.resolution.map(|resolution| resolution.0),
            method: match self.method {
                Some(MethodName::Interior) => Method::Interior,
                Some(MethodName::Fd) => Method::Fd,
                Some(MethodName::Reparam) | None => Method::Reparam,
            },
            backend,
            standard_error: self.mode != Mode::Render && self.stderr.unwrap_or(true),
            groups: self.groups,
            threads,
        }
    }

    /// The `-D name=value` of its scene.
    pub fn definitions(&self) -> Vec<(String, String)> {
        let pairs = self.defines.0.iter();
        pairs
            .map(|(name, value)| (name.clone(), value.text()))
            .collect()
    }

    /// Whether it is by finite differences.
    pub fn is_fd(&self) -> bool {
        self.method == Some(MethodName::Fd)
    }

    /// Whether a file of this name is to be written.
    pub fn writes(&self, name: &str) -> bool {
        self.outputs
            .as_ref()
            .is_none_or(|names| names.iter().any(|n| n == name))
    }
}

impl Mode {
    /// As in a job, and the command that does the same.
    pub fn name(self) -> &'static str {
        match self {
            Mode::Render => "render",
            Mode::Forward => "forward",
            Mode::Backward => "backward",
        }
    }

    /// The files it writes.
    fn files(self) -> &'static [&'static str] {
        match self {
            Mode::Render => &results::RENDER,
            Mode::Forward => &results::FORWARD,
            Mode::Backward => &results::BACKWARD,
        }
    }
}

/// The error without "at line 1 column 7": the line is told by its own number.
pub fn without_line(error: &serde_json::Error) -> String {
    let text = error.to_string();
    match text.rfind(" at line 1 column ") {
        Some(at) => {
            let column = &text[at + " at line 1 column ".len()..];
            format!("{} (column {column})", &text[..at])
        }
        None => text,
    }
}
