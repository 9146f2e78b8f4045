//! `[[scene]]`: a file and the directions in which its parameters move.

use super::contestant::Contestant;
use super::effort::{Effort, effort};
use crate::jobs::config::document::{Node, Value};
use crate::jobs::config::table::{Table, number};
use crate::jobs::failure::Failure;
use crate::jobs::numbers::Numbers;
use std::path::{Path, PathBuf};

/// A scene of a study.
#[derive(Clone, Debug)]
pub struct ScenePlan {
    /// Unlike that of all others; a part of file names.
    pub name: String,
    pub file: PathBuf,
    pub defines: Vec<(String, String)>,
    /// What is expected to go wrong on it.
    pub symptom: String,
    /// What the file of other programs' measurements calls it.
    pub peer: String,
    pub effort: Effort,
    pub directions: Vec<DirectionPlan>,
    /// Where the table stands.
    pub place: String,
}

/// What moves.
#[derive(Clone, Debug)]
pub struct DirectionPlan {
    pub name: String,
    pub tangents: Vec<(String, Numbers)>,
    /// Where it is written.
    pub place: String,
}

/// All scenes.
pub fn all(
    root: &Table,
    folder: &Path,
    usual: (&Effort, &[Contestant]),
) -> Result<Vec<ScenePlan>, Failure> {
    let tables = root.tables("scene")?;
    let mut scenes: Vec<ScenePlan> = Vec::with_capacity(tables.len());
    for table in tables {
        let scene = read(&table, folder, usual)?;
        if scenes.iter().any(|other| other.name == scene.name) {
            return Err(table.error("name", format!("{} is there twice", scene.name)));
        }
        table.finish()?;
        scenes.push(scene);
    }
    match scenes.is_empty() {
        true => Err(root.error(
            "scene",
            "there is none; write a table [[scene]] with a file",
        )),
        false => Ok(scenes),
    }
}

fn read(
    table: &Table,
    folder: &Path,
    (usual, known): (&Effort, &[Contestant]),
) -> Result<ScenePlan, Failure> {
    let file = table
        .text("file")?
        .ok_or_else(|| table.error("file", "it is missing; write file = \"scene.xml\""))?;
    let file = folder.join(file);
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let name = table.text("name")?.unwrap_or(stem.into());
    if !is_plain(&name) {
        return Err(table.error("name", NAMES));
    }
    Ok(ScenePlan {
        peer: table.text("peer")?.unwrap_or(name.clone()),
        name,
        file,
        defines: table.defines("defines")?,
        symptom: table.text("symptom")?.unwrap_or_default(),
        effort: effort(table, usual.clone(), known)?,
        directions: directions(table, folder)?,
        place: table.place().into(),
    })
}

const NAMES: &str = "names are parts of file names: use letters, digits, '-' and '_'";

fn is_plain(name: &str) -> bool {
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_');
    !name.is_empty() && name.len() <= 64 && name.chars().all(plain)
}

fn directions(table: &Table, folder: &Path) -> Result<Vec<DirectionPlan>, Failure> {
    let missing = || {
        let what = "it is missing; write [scene.direction.move] and under it \"ball.translation\" = [1, 0, 0]";
        table.error("direction", what)
    };
    let named = table.table("direction")?.ok_or_else(missing)?;
    let mut directions = Vec::new();
    for name in named.keys() {
        if !is_plain(name) {
            return Err(named.error(name, NAMES));
        }
        let Some(inner) = named.table(name)? else {
            continue;
        };
        let tangent = |key: &str| -> Result<(String, Numbers), Failure> {
            let wrong = || {
                inner.error(
                    key,
                    "write a number, a list of numbers, or \"@tangent.npy\"",
                )
            };
            let numbers = inner.node(key).and_then(|node| numbers(node, folder));
            Ok((key.to_string(), numbers.ok_or_else(wrong)?))
        };
        directions.push(DirectionPlan {
            name: name.into(),
            tangents: inner
                .keys()
                .into_iter()
                .map(tangent)
                .collect::<Result<_, _>>()?,
            place: inner.place().into(),
        });
        if directions.last().is_some_and(|d| d.tangents.is_empty()) {
            return Err(named.error(
                name,
                "it has no parameter; write \"ball.translation\" = [1, 0, 0]",
            ));
        }
    }
    if directions.is_empty() {
        return Err(missing());
    }
    Ok(directions)
}

fn numbers(node: &Node, folder: &Path) -> Option<Numbers> {
    let float = |node: &Node| number(node).map(|x| x as f32).filter(|x| x.is_finite());
    match &node.value {
        Value::Text(text) => text
            .strip_prefix('@')
            .map(|f| Numbers::File(folder.join(f))),
        Value::List(list) => list
            .iter()
            .map(float)
            .collect::<Option<_>>()
            .map(Numbers::list),
        _ => float(node).map(|x| Numbers::list(vec![x])),
    }
}
