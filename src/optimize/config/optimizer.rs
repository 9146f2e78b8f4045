//! `[optimizer]`.

use super::schedule::Schedule;
use crate::jobs::config::table::Table;
use crate::jobs::failure::Failure;

/// Which recurrence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Gradient descent, with momentum.
    Sgd,
    /// \[Kingma2015\]
    Adam,
    /// \[Loshchilov2019\]
    AdamW,
    /// Adam with one scale for all numbers of a parameter \[Nicolet2021\].
    Uniform,
}

pub const KINDS: [(&str, Kind); 4] = [
    ("sgd", Kind::Sgd),
    ("adam", Kind::Adam),
    ("adamw", Kind::AdamW),
    ("uniform", Kind::Uniform),
];

/// An optimiser and its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct OptimizerSettings {
    pub kind: Kind,
    pub lr: Schedule,
    pub momentum: f64,
    pub betas: [f64; 2],
    pub epsilon: f64,
    pub weight_decay: f64,
    /// No number goes farther than this in one step.
    pub max_step: Option<f64>,
}

pub fn read(table: &Table) -> Result<OptimizerSettings, Failure> {
    let mut settings = OptimizerSettings {
        kind: Kind::Adam,
        lr: Schedule::Constant(0.01),
        momentum: 0.0,
        betas: [0.9, 0.999],
        epsilon: 1e-8,
        weight_decay: 0.0,
        max_step: None,
    };
    let Some(inner) = table.table("optimizer")? else {
        return Ok(settings);
    };
    if let Some(kind) = kind(&inner, "name")? {
        settings.kind = kind;
    }
    let below_one = |v: f64| (0.0..1.0).contains(&v);
    if let Some(lr) = rate(&inner)? {
        settings.lr = lr;
    }
    let has = |key: &str| inner.keys().contains(&key);
    let belongs = [
        ("momentum", &[Kind::Sgd][..], "sgd"),
        (
            "beta1",
            &[Kind::Adam, Kind::AdamW, Kind::Uniform],
            "adam, adamw and uniform",
        ),
        (
            "beta2",
            &[Kind::Adam, Kind::AdamW, Kind::Uniform],
            "adam, adamw and uniform",
        ),
        (
            "epsilon",
            &[Kind::Adam, Kind::AdamW, Kind::Uniform],
            "adam, adamw and uniform",
        ),
        ("weight_decay", &[Kind::AdamW], "adamw"),
    ];
    for (key, kinds, names) in belongs {
        if has(key) && !kinds.contains(&settings.kind) {
            return Err(inner.error(key, format!("it belongs to {names}; take it out")));
        }
    }
    let wanted = "a number from 0 up to 1";
    settings.momentum = inner.number_if("momentum", 0.0, wanted, below_one)?;
    settings.betas = [
        inner.number_if("beta1", 0.9, wanted, below_one)?,
        inner.number_if("beta2", 0.999, wanted, below_one)?,
    ];
    let positive = |v: f64| v > 0.0;
    settings.epsilon = inner.number_if("epsilon", 1e-8, "a number above zero", positive)?;
    let default = if settings.kind == Kind::AdamW {
        0.01
    } else {
        0.0
    };
    settings.weight_decay =
        inner.number_if("weight_decay", default, "a number from zero", |v| v >= 0.0)?;
    settings.max_step = max_step(&inner)?;
    inner.finish()?;
    Ok(settings)
}

pub fn kind(table: &Table, key: &str) -> Result<Option<Kind>, Failure> {
    let names = KINDS.map(|(name, _)| name);
    let name = table.choice(key, &names)?;
    let found = name.and_then(|name| KINDS.iter().find(|(known, _)| *known == name));
    Ok(found.map(|(_, kind)| *kind))
}

pub fn rate(table: &Table) -> Result<Option<Schedule>, Failure> {
    Schedule::read(table, "lr", "learning rates above zero", |v| v > 0.0)
}

pub fn max_step(table: &Table) -> Result<Option<f64>, Failure> {
    match table.number("max_step")? {
        Some(v) if v <= 0.0 => {
            let what = format!("write a length above zero, not {v}");
            Err(table.error("max_step", what))
        }
        other => Ok(other),
    }
}
