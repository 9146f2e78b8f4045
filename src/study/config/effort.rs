//! How much is measured of each direction.

use super::contestant::Contestant;
use crate::jobs::config::table::Table;
use crate::jobs::failure::Failure;
use crate::jobs::resolution::resolution;
use crate::jobs::settings::MOST_SAMPLES;

/// Runs of one cell; more are a typing error.
const MOST_RUNS: u64 = 4096;

/// What is measured of each direction; scenes may have it otherwise than the rest.
#[derive(Clone, Debug, PartialEq)]
pub struct Effort {
    pub methods: Vec<Contestant>,
    pub spp: Vec<u32>,
    pub repeats: usize,
    /// Width and height in pixels; the film's if not said.
    pub resolution: Option<[u32; 2]>,
    /// Segments; the scene's if not said.
    pub max_depth: Option<u32>,
    pub reference: ReferencePlan,
}

/// The finite differences that all are compared with.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferencePlan {
    /// Samples a pixel of one image of a run.
    pub spp: u32,
    /// Independent runs at each step.
    pub runs: usize,
    /// Steps in parts of the usual one, the widest first, each half of the one before.
    pub steps: Vec<f64>,
}

impl Default for ReferencePlan {
    fn default() -> Self {
        Self {
            spp: 1024,
            runs: 16,
            steps: steps(1.0, 2),
        }
    }
}

/// What a table says of the effort, in place of what is usual.
pub fn effort(table: &Table, usual: Effort, known: &[Contestant]) -> Result<Effort, Failure> {
    let size = |text: String| resolution(&text).map_err(|what| table.error("resolution", what));
    Ok(Effort {
        methods: methods(table, known)?.unwrap_or(usual.methods),
        spp: sample_counts(table)?.unwrap_or(usual.spp),
        // The scatter of one run is unknown.
        repeats: runs(table, "repeats")?.unwrap_or(usual.repeats),
        resolution: match table.text("resolution")? {
            Some(text) => Some(size(text)?),
            None => usual.resolution,
        },
        max_depth: match table.count("max_depth", 1, u64::from(u32::MAX))? {
            Some(depth) => Some(depth as u32),
            None => usual.max_depth,
        },
        reference: reference(table, usual.reference)?,
    })
}

/// How many runs a key asks for.
pub fn runs(table: &Table, key: &str) -> Result<Option<usize>, Failure> {
    Ok(table.count(key, 2, MOST_RUNS)?.map(|runs| runs as usize))
}

fn reference(table: &Table, mut plan: ReferencePlan) -> Result<ReferencePlan, Failure> {
    let Some(inner) = table.table("reference")? else {
        return Ok(plan);
    };
    if let Some(spp) = inner.count("spp", 2, u64::from(MOST_SAMPLES))? {
        plan.spp = spp as u32;
    }
    if let Some(number) = runs(&inner, "runs")? {
        plan.runs = number;
    }
    // One step agrees with nothing; below a thousandth of a pixel is rounding.
    let count = inner.count("steps", 2, 6)?;
    let count = count.map_or(plan.steps.len(), |count| count as usize);
    let is_width = |x: f64| (0.05..=20.0).contains(&x);
    let what = "a number from 0.05 to 20";
    let widest = inner.number_if("widest_step", plan.steps[0], what, is_width)?;
    plan.steps = steps(widest, count);
    inner.finish()?;
    Ok(plan)
}

fn steps(widest: f64, count: usize) -> Vec<f64> {
    (0..count).map(|i| widest * 0.5f64.powi(i as i32)).collect()
}

fn methods(table: &Table, known: &[Contestant]) -> Result<Option<Vec<Contestant>>, Failure> {
    let Some(names) = table.texts("methods")? else {
        return Ok(None);
    };
    let known_names: Vec<&str> = known.iter().map(|one| one.name.as_str()).collect();
    let mut methods: Vec<Contestant> = Vec::new();
    for name in names {
        let name = table.one_of("methods", &name, &known_names)?;
        if methods.iter().any(|other| other.name == name) {
            return Err(table.error("methods", format!("{name} is there twice")));
        }
        methods.extend(known.iter().find(|one| one.name == name).cloned());
    }
    match methods.is_empty() {
        true => Err(table.error("methods", "none is named")),
        false => Ok(Some(methods)),
    }
}

fn sample_counts(table: &Table) -> Result<Option<Vec<u32>>, Failure> {
    let Some(numbers) = table.numbers("spp")? else {
        return Ok(None);
    };
    let mut counts = Vec::new();
    for number in numbers {
        if number.fract() != 0.0 || !(2.0..=f64::from(MOST_SAMPLES)).contains(&number) {
            let what = format!("write whole numbers from 2 to {MOST_SAMPLES}, not {number}");
            return Err(table.error("spp", what));
        }
        counts.push(number as u32);
    }
    if counts.is_empty() || !counts.is_sorted_by(|a, b| a < b) {
        return Err(table.error("spp", "write ascending numbers, as in [16, 64, 256]"));
    }
    Ok(Some(counts))
}
