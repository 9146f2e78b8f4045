//! `--assert FILE`: what figures must not fall below, or rise above.

use super::cell::{Cell, Row};
use super::config::{Plan, ScenePlan};
use super::verdict::Kind;
use crate::jobs::config::document;
use crate::jobs::config::table::Table;
use crate::jobs::failure::Failure;
use crate::output::FileError;
use std::path::Path;

/// One `[[bound]]`: which cells, and what holds for them.
#[derive(Clone, Debug)]
pub struct Bound {
    scene: Option<String>,
    direction: Option<String>,
    method: Option<String>,
    spp: Option<u32>,
    verdicts: Option<Vec<Kind>>,
    least: Vec<(&'static str, f64)>,
    most: Vec<(&'static str, f64)>,
    place: String,
}

/// A figure of a cell; none if it has none.
type Get = fn(&Cell) -> Option<f64>;

/// What can be bounded.
const FIGURES: [(&str, Get); 17] = [
    ("rmse", |c| c.figures.as_ref().map(|f| f.rmse)),
    ("sd", |c| c.figures.as_ref().map(|f| f.sd)),
    ("bias_squared", |c| {
        c.figures.as_ref().map(|f| f.bias_squared)
    }),
    ("size_bias", |c| c.figures.as_ref()?.size_bias.map(f64::abs)),
    ("size_bias_se", |c| c.figures.as_ref()?.size_bias_se),
    ("bias_sigmas", |c| c.figures.as_ref().map(|f| f.bias_sigmas)),
    ("kurtosis", |c| c.figures.as_ref()?.kurtosis),
    ("top_variance_share", |c| {
        c.figures.as_ref()?.top_variance_share
    }),
    ("worst_repeat_share", |c| {
        c.figures.as_ref()?.worst_repeat_share
    }),
    ("coverage", |c| c.figures.as_ref()?.coverage),
    ("not_finite", |c| {
        c.figures.as_ref().map(|f| f.not_finite as f64)
    }),
    ("rejected_share", |c| {
        c.figures.as_ref().map(|f| f.rejected_share)
    }),
    ("rays", |c| c.figures.as_ref().map(|f| f.rays)),
    ("seconds", |c| c.times.as_ref().map(|t| t.seconds)),
    ("processor_seconds", |c| {
        c.times.as_ref().map(|t| t.processor_seconds)
    }),
    ("relative_efficiency", |c| {
        c.times.as_ref()?.relative_efficiency
    }),
    ("relative_noise", |c| c.times.as_ref()?.relative_noise),
];

/// Reads a file of bounds.
pub fn read(file: &Path) -> Result<Vec<Bound>, Failure> {
    let bytes = crate::files::read(file).map_err(|error| FileError::unread(file, &error))?;
    let name = file.display().to_string();
    let text = String::from_utf8(bytes)
        .map_err(|_| Failure::Input(format!("{name}: not TOML: it is no text in UTF-8")))?;
    let root = document::parse(&text, &name)?;
    let table = Table::root(&root)?;
    let tables = table.tables("bound")?;
    if tables.is_empty() {
        return Err(table.error("bound", "there is none; write a table [[bound]]"));
    }
    table.finish()?;
    tables.into_iter().map(bound).collect()
}

fn bound(table: Table) -> Result<Bound, Failure> {
    let names = Kind::ALL.map(|(name, _)| name);
    let verdicts = match table.texts("verdict")? {
        None => None,
        Some(texts) => {
            let mut kinds = Vec::new();
            for text in texts {
                let name = table.one_of("verdict", &text, &names)?;
                kinds.extend(
                    Kind::ALL
                        .iter()
                        .filter(|(n, _)| *n == name)
                        .map(|(_, kind)| *kind),
                );
            }
            Some(kinds)
        }
    };
    let bound = Bound {
        scene: table.text("scene")?,
        direction: table.text("direction")?,
        method: table.text("method")?,
        spp: table
            .count("spp", 1, u64::from(u32::MAX))?
            .map(|spp| spp as u32),
        verdicts,
        least: limits(&table, "at_least")?,
        most: limits(&table, "at_most")?,
        place: table.place().into(),
    };
    if bound.verdicts.is_none() && bound.least.is_empty() && bound.most.is_empty() {
        let what = "nothing is bound; write verdict, at_least or at_most";
        return Err(Failure::Input(format!("{}: {what}", bound.place)));
    }
    table.finish()?;
    Ok(bound)
}

fn limits(table: &Table, key: &str) -> Result<Vec<(&'static str, f64)>, Failure> {
    let Some(inner) = table.table(key)? else {
        return Ok(Vec::new());
    };
    let mut limits = Vec::new();
    for (name, _) in FIGURES {
        limits.extend(inner.number(name)?.map(|limit| (name, limit)));
    }
    inner.finish()?;
    Ok(limits)
}

/// Refuses a bound that is of no cell of the study, before the cells are measured.
pub fn check(bounds: &[Bound], plan: &Plan) -> Result<(), Failure> {
    let is_of = |bound: &Bound, scene: &ScenePlan| {
        let effort = &scene.effort;
        let mut directions = scene.directions.iter();
        let mut methods = effort.methods.iter();
        directions.any(|direction| bound.is_of_row(&scene.name, &direction.name))
            && methods.any(|one| {
                effort
                    .spp
                    .iter()
                    .any(|spp| bound.is_of_cell(&one.name, *spp))
            })
    };
    let of_none = |bound: &&Bound| !plan.scenes.iter().any(|scene| is_of(bound, scene));
    match bounds.iter().find(of_none) {
        None => Ok(()),
        Some(bound) => Err(Failure::Input(format!(
            "{}: the study has nothing of this scene, direction, method and spp",
            bound.place
        ))),
    }
}

/// What does not hold, each in a sentence.
pub fn broken(bounds: &[Bound], rows: &[Row]) -> Vec<String> {
    let mut sentences = Vec::new();
    for bound in bounds {
        let is_of_row = |row: &&Row| bound.is_of_row(&row.scene, &row.direction);
        let is_of_cell = |cell: &&Cell| bound.is_of_cell(&cell.method, cell.spp);
        for row in rows.iter().filter(is_of_row) {
            for cell in row.cells.iter().filter(is_of_cell) {
                let whose = format!(
                    "{}: {} {}, {} with {} samples",
                    bound.place, row.scene, row.direction, cell.method, cell.spp
                );
                sentences.extend(
                    bound
                        .complaints(cell)
                        .into_iter()
                        .map(|c| format!("{whose}: {c}")),
                );
            }
        }
    }
    sentences
}

impl Bound {
    fn is_of_row(&self, scene: &str, direction: &str) -> bool {
        let same = |wanted: &Option<String>, is: &str| wanted.as_deref().is_none_or(|w| w == is);
        same(&self.scene, scene) && same(&self.direction, direction)
    }

    fn is_of_cell(&self, method: &str, spp: u32) -> bool {
        let wanted = self.method.as_deref();
        wanted.is_none_or(|name| name == method) && self.spp.is_none_or(|wanted| wanted == spp)
    }

    fn complaints(&self, cell: &Cell) -> Vec<String> {
        let mut complaints = Vec::new();
        if let Some(wanted) = &self.verdicts
            && !wanted.contains(&cell.verdict.kind)
        {
            let names: Vec<&str> = wanted.iter().map(|kind| kind.name()).collect();
            let (is, text) = (cell.verdict.kind.name(), &cell.verdict.text);
            complaints.push(format!("{is}, not {} ({text})", names.join(" or ")));
        }
        let sides = [("below", &self.least), ("above", &self.most)];
        for (side, limits) in sides {
            for (name, limit) in limits {
                let get = FIGURES.iter().find(|(n, _)| n == name).map(|(_, get)| get);
                match get.and_then(|get| get(cell)) {
                    None => complaints.push(format!("it has no {name}")),
                    Some(is) if (side == "below") == (is < *limit) && is != *limit => {
                        complaints.push(format!("{name} is {is:.4}, {side} {limit}"));
                    }
                    Some(_) => {}
                }
            }
        }
        complaints
    }
}
