//! `[parameters."KEY"]`: what is optimised, and how.

use super::optimizer::{self, Kind};
use super::schedule::Schedule;
use crate::jobs::config::document::Value;
use crate::jobs::config::table::Table;
use crate::jobs::failure::Failure;
use std::path::{Path, PathBuf};

/// One parameter, as it is asked for.
#[derive(Clone, Debug)]
pub struct ParameterSettings {
    pub key: String,
    /// `CONFIG.toml:3:1`, for what only the scene can tell.
    pub place: String,
    pub start: Option<Start>,
    pub lr: Option<Schedule>,
    pub kind: Option<Kind>,
    pub max_step: Option<f64>,
    /// The least and the largest value.
    pub bounds: [Option<f64>; 2],
    pub reparameterisation: Reparameterisation,
    /// Of textures: how much the sum of differences between neighbours counts.
    pub total_variation: f64,
    pub remeshing: Option<Remeshing>,
}

/// Where the optimisation begins, if not at the scene's own value.
#[derive(Clone, Debug)]
pub enum Start {
    Numbers(Vec<f64>),
    /// A `.npy` or `.safetensors`.
    File(PathBuf),
}

/// What the optimiser moves in place of the value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reparameterisation {
    None,
    /// Its logarithm.
    Log,
    /// Its place between the bounds, by the logistic function.
    Logistic,
    /// (I + λL)v of the vertices v \[Nicolet2021\].
    LargeSteps {
        lambda: f64,
    },
}

/// New triangles of even size on the way \[Botsch2004\].
#[derive(Clone, Debug, PartialEq)]
pub struct Remeshing {
    /// Before these steps.
    pub at: Vec<u64>,
    /// The edges aimed at, as a factor on their mean length.
    pub edge: f64,
    /// Whether the optimiser's state is carried over, or begins anew.
    pub carry: bool,
}

const NAMES: [&str; 5] = ["none", "log", "logistic", "rotation_vector", "large_steps"];

pub fn read(table: &Table, folder: &Path) -> Result<Vec<ParameterSettings>, Failure> {
    let all = table.table("parameters")?;
    let none = || {
        let what = "no parameter is named; write [parameters.\"KEY\"], with a key that `warpath params` lists";
        table.error("parameters", what)
    };
    let all = all.ok_or_else(none)?;
    if all.keys().is_empty() {
        return Err(none());
    }
    let keys = all.keys().into_iter();
    let read = keys.map(|key| one(&all, key, folder));
    read.collect()
}

fn one(all: &Table, key: &str, folder: &Path) -> Result<ParameterSettings, Failure> {
    let place = match all.error(key, "") {
        Failure::Input(text) => text.trim_end_matches(": ").to_string(),
        _ => key.to_string(),
    };
    let Some(inner) = all.table(key)? else {
        return Err(all.error(key, "write a table"));
    };
    let bounds = [inner.number("min")?, inner.number("max")?];
    if let [Some(min), Some(max)] = bounds
        && min >= max
    {
        return Err(inner.error("max", format!("it must be above min, {min}")));
    }
    let settings = ParameterSettings {
        key: key.to_string(),
        place,
        start: start(&inner, folder)?,
        lr: optimizer::rate(&inner)?,
        kind: optimizer::kind(&inner, "optimizer")?,
        max_step: optimizer::max_step(&inner)?,
        bounds,
        reparameterisation: reparameterisation(&inner, bounds, key)?,
        total_variation: inner
            .number_if("total_variation", 0.0, "a number from zero", |v| v >= 0.0)?,
        remeshing: remeshing(&inner, key)?,
    };
    if settings.total_variation > 0.0 && !key.ends_with(".data") {
        return Err(inner.error(
            "total_variation",
            "it is for textures alone, whose keys end with .data",
        ));
    }
    inner.finish()?;
    Ok(settings)
}

fn start(table: &Table, folder: &Path) -> Result<Option<Start>, Failure> {
    match table.node("start").map(|node| &node.value) {
        Some(Value::Text(file)) => Ok(Some(Start::File(folder.join(file)))),
        Some(_) => Ok(table.numbers("start")?.map(Start::Numbers)),
        None => Ok(None),
    }
}

fn reparameterisation(
    table: &Table,
    bounds: [Option<f64>; 2],
    key: &str,
) -> Result<Reparameterisation, Failure> {
    const SLOT: &str = "reparameterisation";
    let name = table.choice(SLOT, &NAMES)?.unwrap_or("none");
    let lambda = table.number_if("lambda", 19.0, "a number above zero", |v| v > 0.0)?;
    if name != "large_steps" && table.keys().contains(&"lambda") {
        return Err(table.error("lambda", "it belongs to large_steps; take it out"));
    }
    match name {
        "log" => match bounds[0] {
            Some(min) if min <= 0.0 => Err(table.error(
                "min",
                format!("a logarithm needs a bound above zero, not {min}"),
            )),
            _ => Ok(Reparameterisation::Log),
        },
        "logistic" => match bounds {
            [Some(_), Some(_)] => Ok(Reparameterisation::Logistic),
            _ => Err(table.error(SLOT, "logistic needs both bounds; write min and max")),
        },
        "rotation_vector" if !key.ends_with(".rotation") => {
            let what = "rotation_vector is for keys that end with .rotation, which have it anyway";
            Err(table.error(SLOT, what))
        }
        "large_steps" => {
            if !(key.ends_with(".vertex_positions") || key.ends_with(".positions")) {
                return Err(table.error(
                    SLOT,
                    "large_steps is for keys that end with .vertex_positions",
                ));
            }
            if bounds != [None, None] {
                let which = if bounds[0].is_some() { "min" } else { "max" };
                return Err(table.error(which, "large_steps knows no bounds; take it out"));
            }
            Ok(Reparameterisation::LargeSteps { lambda })
        }
        _ => Ok(Reparameterisation::None),
    }
}

fn remeshing(table: &Table, key: &str) -> Result<Option<Remeshing>, Failure> {
    let Some(inner) = table.table("remesh")? else {
        return Ok(None);
    };
    if !(key.ends_with(".vertex_positions") || key.ends_with(".positions")) {
        return Err(table.error("remesh", "it is for keys that end with .vertex_positions"));
    }
    let wrong = || inner.error("at", "write the steps, as in at = [200, 400]");
    let at = inner.numbers("at")?.ok_or_else(wrong)?;
    let is_step = |v: &f64| v.fract() == 0.0 && *v >= 1.0;
    if at.is_empty() || !at.iter().all(is_step) || !at.windows(2).all(|w| w[0] < w[1]) {
        return Err(wrong());
    }
    let remeshing = Remeshing {
        at: at.into_iter().map(|v| v as u64).collect(),
        edge: inner.number_if("edge", 0.5, "a factor from 0.1 to 4", |v| {
            (0.1..=4.0).contains(&v)
        })?,
        carry: inner.choice("state", &["reset", "carry"])? == Some("carry"),
    };
    inner.finish()?;
    Ok(Some(remeshing))
}
