//! `CONFIG.toml`: what an optimisation is asked to do, read and checked before a scene is loaded.

mod loss;
mod optimizer;
mod parameter;
mod places;
mod render;
mod schedule;
mod views;

pub use loss::{LossSettings, Pointwise, Silhouette};
pub use optimizer::{Kind, OptimizerSettings};
pub use parameter::{ParameterSettings, Remeshing, Reparameterisation, Start};
pub use places::Places;
pub use render::{Adaptive, RenderSettings};
pub use schedule::{How, Schedule};
pub use views::{Cameras, CamerasFrom, MaskFrom, Order, Truth, ViewSettings, ViewsSettings};

use crate::jobs::config::document::{self, Node};
use crate::jobs::config::table::Table;
use crate::jobs::failure::Failure;
use crate::output::FileError;
use crate::scene::source::Fnv1a;
use std::path::{Path, PathBuf};

/// Steps of one run; more are a typing error.
const MOST_STEPS: u64 = 10_000_000;

/// What an optimisation is asked to do.
#[derive(Clone, Debug)]
pub struct Config {
    /// The file, as it was named.
    pub file: PathBuf,
    /// FNV-1a of the file and of what overrides it.
    pub hash: u64,
    pub scene: PathBuf,
    pub defines: Vec<(String, String)>,
    pub steps: u64,
    pub seed: u64,
    pub render: RenderSettings,
    pub optimizer: OptimizerSettings,
    pub loss: LossSettings,
    pub parameters: Vec<ParameterSettings>,
    pub views: ViewsSettings,
    pub truth: Option<Truth>,
    pub stop: Stop,
    pub output: Output,
    pub places: Places,
}

/// When to end before the last step.
#[derive(Clone, Debug, PartialEq)]
pub struct Stop {
    /// Ends when the mean loss of so many steps is not below that of as many before by at least
    /// twice its standard error.
    pub patience: Option<u64>,
    /// Ends when the loss is below this.
    pub below: Option<f64>,
    /// Ends when the loss is what noise alone would make of a perfect fit.
    pub at_noise: bool,
}

/// What is written, and how often.
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Steps between checkpoints.
    pub checkpoint_every: u64,
    /// Steps between the pictures of views and the page; 0 for those of the end alone.
    pub pictures_every: u64,
    /// Samples a pixel of the pictures.
    pub spp: u32,
    /// Pictures of a turntable; 0 for none.
    pub turntable: u64,
}

/// Reads the file, puts the overrides (`optimizer.lr=0.02`) into it and checks it.
pub fn read(file: &Path, overrides: &[String]) -> Result<Config, Failure> {
    let bytes = crate::files::read(file).map_err(|error| FileError::unread(file, &error))?;
    let name = file.display().to_string();
    let text = String::from_utf8(bytes)
        .map_err(|_| Failure::Input(format!("{name}: not TOML: it is no text in UTF-8")))?;
    let mut root = document::parse(&text, &name)?;
    let mut hash = Fnv1a::default();
    hash.write(text.as_bytes());
    for typed in overrides {
        document::set(&mut root, typed)?;
        hash.write(typed.as_bytes());
        hash.write(b"\n");
    }
    of_document(&root, file, hash.0)
}

fn of_document(root: &Node, file: &Path, hash: u64) -> Result<Config, Failure> {
    let table = Table::root(root)?;
    let folder = file.parent().unwrap_or(Path::new(""));
    let scene = table
        .text("scene")?
        .ok_or_else(|| table.error("scene", "it is missing; write scene = \"scene.xml\""))?;
    let steps = table.count("steps", 1, MOST_STEPS)?;
    let truth = views::truth(&table, folder)?;
    let config = Config {
        file: file.into(),
        hash,
        scene: folder.join(scene),
        defines: table.defines("defines")?,
        steps: steps.ok_or_else(|| table.error("steps", "it is missing; write steps = 100"))?,
        seed: table.count("seed", 0, u64::MAX >> 1)?.unwrap_or(0),
        render: render::read(&table)?,
        optimizer: optimizer::read(&table)?,
        loss: loss::read(&table)?,
        parameters: parameter::read(&table, folder)?,
        views: views::read(&table, folder, Truth::makes_targets(truth.as_ref()))?,
        truth,
        stop: stop(&table)?,
        output: output(&table)?,
        places: Places::of(root, file.display().to_string()),
    };
    table.finish()?;
    Ok(config)
}

fn stop(table: &Table) -> Result<Stop, Failure> {
    let Some(inner) = table.table("stop")? else {
        return Ok(Stop {
            patience: None,
            below: None,
            at_noise: false,
        });
    };
    let stop = Stop {
        patience: inner.count("patience", 2, MOST_STEPS)?,
        below: inner.number("below")?,
        at_noise: inner.truth("at_noise", false)?,
    };
    inner.finish()?;
    Ok(stop)
}

fn output(table: &Table) -> Result<Output, Failure> {
    let mut output = Output {
        checkpoint_every: 10,
        pictures_every: 0,
        spp: 64,
        turntable: 0,
    };
    if let Some(inner) = table.table("output")? {
        if let Some(every) = inner.count("checkpoint_every", 1, MOST_STEPS)? {
            output.checkpoint_every = every;
        }
        if let Some(every) = inner.count("pictures_every", 0, MOST_STEPS)? {
            output.pictures_every = every;
        }
        if let Some(spp) = inner.count("spp", 1, 1 << 20)? {
            output.spp = spp as u32;
        }
        if let Some(pictures) = inner.count("turntable", 0, 360)? {
            output.turntable = pictures;
        }
        inner.finish()?;
    }
    Ok(output)
}
