//! `[loss]`.

use crate::jobs::config::table::Table;
use crate::jobs::failure::Failure;

/// How a number of the image is compared with that of the target.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pointwise {
    L1,
    L2,
    RelativeL2,
    Log,
}

pub const POINTWISE: [(&str, Pointwise); 4] = [
    ("l1", Pointwise::L1),
    ("l2", Pointwise::L2),
    ("relative_l2", Pointwise::RelativeL2),
    ("log", Pointwise::Log),
];

/// What is made small.
#[derive(Clone, Debug, PartialEq)]
pub struct LossSettings {
    pub kind: Pointwise,
    /// Levels: the image itself, and so many less one that are each half as large.
    pub pyramid: u32,
    pub silhouette: Option<Silhouette>,
}

/// The mask term: what the objects cover against the views' masks.
#[derive(Clone, Debug, PartialEq)]
pub struct Silhouette {
    /// Ids of shapes.
    pub shapes: Vec<String>,
    pub weight: f64,
}

pub fn read(table: &Table) -> Result<LossSettings, Failure> {
    let mut loss = LossSettings {
        kind: Pointwise::L2,
        pyramid: 1,
        silhouette: None,
    };
    let Some(inner) = table.table("loss")? else {
        return Ok(loss);
    };
    let names = POINTWISE.map(|(name, _)| name);
    if let Some(name) = inner.choice("kind", &names)? {
        let found = POINTWISE.iter().find(|(known, _)| *known == name);
        loss.kind = found.map_or(loss.kind, |(_, kind)| *kind);
    }
    if let Some(levels) = inner.count("pyramid", 1, 16)? {
        loss.pyramid = levels as u32;
    }
    if let Some(silhouette) = inner.table("silhouette")? {
        let shapes = silhouette.text("shapes")?.ok_or_else(|| {
            silhouette.error(
                "shapes",
                "it is missing; write shapes = \"id\", or ids with spaces between",
            )
        })?;
        loss.silhouette = Some(Silhouette {
            shapes: shapes.split_whitespace().map(str::to_string).collect(),
            weight: silhouette.number_if("weight", 1.0, "a number above zero", |v| v > 0.0)?,
        });
        silhouette.finish()?;
    }
    inner.finish()?;
    Ok(loss)
}
