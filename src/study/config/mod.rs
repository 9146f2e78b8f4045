//! `CONFIG.toml` of a study: which scenes, directions, methods and sample counts.

mod contestant;
mod effort;
mod scene;

pub use contestant::Contestant;
pub use effort::{Effort, ReferencePlan};
pub use scene::{DirectionPlan, ScenePlan};

use crate::jobs::config::document;
use crate::jobs::config::table::Table;
use crate::jobs::failure::Failure;
use crate::output::FileError;
use crate::scene::nearest::nearest_hint;
use effort::effort;
use std::path::{Path, PathBuf};

/// What a study is asked to do.
#[derive(Clone, Debug)]
pub struct Plan {
    pub title: String,
    /// A sentence or two for the page and the table.
    pub about: String,
    pub seed: u64,
    pub peers: Option<PeersPlan>,
    pub scenes: Vec<ScenePlan>,
}

/// What other programs took.
#[derive(Clone, Debug, PartialEq)]
pub struct PeersPlan {
    pub file: PathBuf,
    /// What the charts say of it, as "Mitsuba 3.9.1, on another machine".
    pub label: String,
}

impl Plan {
    /// Leaves out all scenes but these, if any are named.
    pub fn keep(&mut self, names: &[String]) -> Result<(), Failure> {
        for name in names {
            let known = || self.scenes.iter().map(|scene| scene.name.as_str());
            if !known().any(|known| known == name) {
                let hint = nearest_hint(name, known());
                return Err(Failure::Input(format!(
                    "--only {name}: there is no such scene{hint}"
                )));
            }
        }
        let is_kept = |scene: &ScenePlan| names.is_empty() || names.contains(&scene.name);
        self.scenes.retain(is_kept);
        Ok(())
    }
}

/// Reads the file, puts the overrides (`repeats=8`) into it and checks it.
pub fn read(file: &Path, overrides: &[String]) -> Result<Plan, Failure> {
    let bytes = crate::files::read(file).map_err(|error| FileError::unread(file, &error))?;
    let name = file.display().to_string();
    let text = String::from_utf8(bytes)
        .map_err(|_| Failure::Input(format!("{name}: not TOML: it is no text in UTF-8")))?;
    let mut root = document::parse(&text, &name)?;
    for typed in overrides {
        document::set(&mut root, typed)?;
    }
    let folder = file.parent().unwrap_or(Path::new(""));
    let table = Table::root(&root)?;
    let known = contestant::all(&table)?;
    let usual = Effort {
        methods: known.clone(),
        spp: vec![16, 64, 256],
        repeats: 16,
        resolution: None,
        max_depth: None,
        reference: ReferencePlan::default(),
    };
    let usual = effort(&table, usual, &known)?;
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let plan = Plan {
        title: table.text("title")?.unwrap_or(stem.into()),
        about: table.text("about")?.unwrap_or_default(),
        seed: table.count("seed", 0, u64::MAX >> 1)?.unwrap_or(0),
        peers: peers(&table, folder)?,
        scenes: scene::all(&table, folder, (&usual, &known))?,
    };
    table.finish()?;
    Ok(plan)
}

fn peers(table: &Table, folder: &Path) -> Result<Option<PeersPlan>, Failure> {
    let Some(inner) = table.table("peers")? else {
        return Ok(None);
    };
    let missing = |key, as_in: &str| inner.error(key, format!("it is missing; write {as_in}"));
    let file = inner.text("file")?;
    let label = inner.text("label")?;
    let plan = PeersPlan {
        file: folder.join(file.ok_or_else(|| missing("file", "file = \"peers.json\""))?),
        label: label.ok_or_else(|| missing("label", "label = \"NAME, on another machine\""))?,
    };
    inner.finish()?;
    Ok(Some(plan))
}
