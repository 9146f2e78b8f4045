//! What `scenes/paper/figures.json` lists.

use crate::Result;
use serde::Deserialize;
use std::path::PathBuf;

/// Fewer runs tell nothing of their noise once one is left out.
pub const LEAST_RUNS: usize = 3;

/// One gradient image and its reference.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Figure {
    pub name: String,
    pub scene: PathBuf,
    /// NAME=VALUE
    #[serde(default)]
    pub defines: Vec<String>,
    /// KEY=TANGENT; together they are one direction.
    pub direction: Vec<String>,
    #[serde(default = "reparam")]
    pub method: String,
    #[serde(default = "spp")]
    pub spp: u32,
    #[serde(default)]
    pub reference: Repeats,
    /// Samples a pixel for a chart of what is left by averaging, if there is to be one.
    #[serde(default)]
    pub chart: Vec<u32>,
}

/// Finite differences, averaged.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Repeats {
    pub spp: u32,
    pub runs: usize,
}

impl Default for Repeats {
    fn default() -> Self {
        Self { spp: 1024, runs: 8 }
    }
}

fn reparam() -> String {
    "reparam".into()
}

fn spp() -> u32 {
    64
}

/// The figures.
const LIST: &str = "scenes/paper/figures.json";

/// What was asked for on the command line.
pub struct Options {
    pub only: Vec<String>,
    /// Runs of which the mean is judged.
    pub runs: usize,
    /// Small images and few samples, to see whether everything runs.
    pub quick: bool,
    /// References are made again.
    pub fresh: bool,
}

impl Options {
    pub fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self> {
        let mut options = Self {
            only: Vec::new(),
            runs: 6,
            quick: false,
            fresh: false,
        };
        while let Some(name) = arguments.next() {
            let mut value = || arguments.next().ok_or(format!("{name} needs a value"));
            match name.as_str() {
                "--only" => options.only.extend(value()?.split(',').map(String::from)),
                "--runs" => options.runs = value()?.parse::<usize>()?.max(LEAST_RUNS),
                "--quick" => options.quick = true,
                "--fresh" => options.fresh = true,
                _ => return Err(format!("unknown option {name}").into()),
            }
        }
        Ok(options)
    }

    /// WxH, if not the scene's.
    pub fn resolution(&self) -> Option<&'static str> {
        self.quick.then_some("32x32")
    }
}

/// Those that are asked for, as they are to be run.
pub fn read(options: &Options) -> Result<Vec<Figure>> {
    let mut figures = parse()?;
    if let Some(name) = options
        .only
        .iter()
        .find(|name| figures.iter().all(|f| f.name != **name))
    {
        let known: Vec<_> = figures.iter().map(|f| f.name.as_str()).collect();
        return Err(format!("no figure {name}; there are {}", known.join(", ")).into());
    }
    figures.retain(|f| options.only.is_empty() || options.only.contains(&f.name));
    if options.quick {
        for figure in &mut figures {
            figure.spp = figure.spp.min(16);
            figure.reference = Repeats { spp: 64, runs: 4 };
            figure.chart.retain(|spp| *spp <= 16);
        }
    }
    Ok(figures)
}

fn parse() -> Result<Vec<Figure>> {
    let at = |e: &dyn std::fmt::Display| format!("{LIST}: {e}");
    let text = std::fs::read_to_string(LIST).map_err(|e| at(&e))?;
    Ok(serde_json::from_str(&text).map_err(|e| at(&e))?)
}
