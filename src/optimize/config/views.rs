//! `[views]`, `[[view]]`, `[cameras]` and `[truth]`: what is seen, from where.

use crate::jobs::config::document::Value;
use crate::jobs::config::table::Table;
use crate::jobs::failure::Failure;
use crate::jobs::settings::MOST_SAMPLES;
use std::path::{Path, PathBuf};

/// Which views each step looks at.
#[derive(Clone, Debug)]
pub struct ViewsSettings {
    /// Views of a step; all if not said.
    pub batch: Option<u64>,
    pub order: Order,
    /// Every so many views one is left out, to be looked at in the end alone.
    pub hold_out: Option<u64>,
    pub list: Vec<ViewSettings>,
    pub cameras: Option<Cameras>,
}

/// In which order views come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Order {
    /// Each once in a round, in an order of its own.
    Shuffled,
    InTurn,
}

/// A target and the sensor that sees it.
#[derive(Clone, Debug)]
pub struct ViewSettings {
    pub place: String,
    /// An id, or a number from 0.
    pub sensor: Option<String>,
    pub target: Option<PathBuf>,
    pub mask: Option<MaskFrom>,
}

/// Where a view's mask comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum MaskFrom {
    /// The target's alpha.
    Alpha,
    File(PathBuf),
}

/// Cameras that other programs have found.
#[derive(Clone, Debug)]
pub struct Cameras {
    pub from: CamerasFrom,
    pub place: String,
    /// Whether the pictures' alpha is their mask.
    pub alpha: bool,
}

/// The files that say where the cameras are.
#[derive(Clone, Debug)]
pub enum CamerasFrom {
    /// NeRF's `transforms.json`, which names its pictures and their masks.
    Transforms(PathBuf),
    /// A folder with COLMAP's `cameras.txt` and `images.txt`, that of the pictures, and that of
    /// their masks.
    Colmap {
        folder: PathBuf,
        images: PathBuf,
        masks: Option<PathBuf>,
    },
}

impl CamerasFrom {
    /// What is read.
    pub fn files(&self) -> Vec<PathBuf> {
        match self {
            Self::Transforms(file) => vec![file.clone()],
            Self::Colmap { folder, .. } => ["cameras.txt", "images.txt"]
                .map(|name| folder.join(name))
                .to_vec(),
        }
    }
}

/// A scene that is known, with which the result is compared.
#[derive(Clone, Debug)]
pub struct Truth {
    /// The optimised scene's file if not said.
    pub scene: Option<PathBuf>,
    pub spp: u32,
    /// Whether it makes the targets; if not, the views have pictures.
    pub renders: bool,
}

impl Truth {
    /// Whether there is a known scene that makes the targets.
    pub fn makes_targets(truth: Option<&Truth>) -> bool {
        truth.is_some_and(|truth| truth.renders)
    }
}

pub fn read(table: &Table, folder: &Path, is_rendered: bool) -> Result<ViewsSettings, Failure> {
    let list = table.tables("view")?;
    let mut views = ViewsSettings {
        batch: None,
        order: Order::Shuffled,
        hold_out: None,
        list: list
            .into_iter()
            .map(|view| one(view, folder))
            .collect::<Result<_, _>>()?,
        cameras: cameras(table, folder)?,
    };
    if let Some(inner) = table.table("views")? {
        views.batch = inner.count("batch", 1, 1 << 20)?;
        views.hold_out = inner.count("hold_out", 2, 1 << 20)?;
        if inner.choice("order", &["shuffled", "in_turn"])? == Some("in_turn") {
            views.order = Order::InTurn;
        }
        inner.finish()?;
    }
    if views.cameras.is_some() && !views.list.is_empty() {
        let what = "give either [[view]] or [cameras], which brings its own views";
        return Err(table.error("view", what));
    }
    if views.list.is_empty() && views.cameras.is_none() && !is_rendered {
        let what = "nothing says what the images should be; write [[view]] with a target, [cameras], or [truth]";
        return Err(table.error("view", what));
    }
    for (i, view) in views.list.iter().enumerate() {
        if view.target.is_some() == is_rendered {
            let what = match is_rendered {
                true => "[truth] renders the targets; take target out, or write truth.targets = \"pictures\"".to_string(),
                false => {
                    format!("view {i} has no target; write target = \"photo.png\", or [truth]")
                }
            };
            return Err(Failure::Input(format!("{}: {what}", view.place)));
        }
    }
    Ok(views)
}

fn one(table: Table, folder: &Path) -> Result<ViewSettings, Failure> {
    let place = match table.error("", "") {
        Failure::Input(text) => text.trim_end_matches(['.', ':', ' ']).to_string(),
        _ => String::new(),
    };
    let sensor = match table.node("sensor").map(|node| &node.value) {
        None => None,
        Some(Value::Whole(n)) if *n >= 0 => Some(n.to_string()),
        Some(Value::Text(id)) => Some(id.clone()),
        Some(_) => {
            let what = "write a sensor's id, or its number counted from 0";
            return Err(table.error("sensor", what));
        }
    };
    let mask = table.text("mask")?.map(|mask| match mask.as_str() {
        "alpha" => MaskFrom::Alpha,
        file => MaskFrom::File(folder.join(file)),
    });
    let view = ViewSettings {
        place,
        sensor,
        target: table.text("target")?.map(|file| folder.join(file)),
        mask,
    };
    if view.mask == Some(MaskFrom::Alpha) && view.target.is_none() {
        return Err(table.error("mask", "alpha is that of a target, and there is none"));
    }
    table.finish()?;
    Ok(view)
}

fn cameras(table: &Table, folder: &Path) -> Result<Option<Cameras>, Failure> {
    let Some(inner) = table.table("cameras")? else {
        return Ok(None);
    };
    let place = match inner.error("", "") {
        Failure::Input(text) => text.trim_end_matches(['.', ':', ' ']).to_string(),
        _ => String::new(),
    };
    let path = |key: &str| Ok::<_, Failure>(inner.text(key)?.map(|file| folder.join(file)));
    let [transforms, colmap, images] = [path("transforms")?, path("colmap")?, path("images")?];
    let masks = path("masks")?;
    let alpha = inner.truth("alpha", false)?;
    if masks.is_some() && (alpha || colmap.is_none()) {
        let what = match alpha {
            true => "masks are either alpha or files; take one out",
            false => "transforms.json names its masks, as mask_path of each frame; take it out",
        };
        return Err(inner.error("masks", what));
    }
    let from = match (transforms, colmap, images) {
        (Some(file), None, None) => CamerasFrom::Transforms(file),
        (None, Some(folder), Some(images)) => CamerasFrom::Colmap {
            folder,
            images,
            masks,
        },
        (None, Some(_), None) => {
            return Err(inner.error(
                "images",
                "it is missing; write the folder of COLMAP's pictures",
            ));
        }
        (Some(_), None, Some(_)) => {
            return Err(inner.error("images", "transforms.json names its pictures; take it out"));
        }
        _ => {
            let what = "write either transforms = \"transforms.json\", or colmap = \"sparse/0\" and images";
            return Err(table.error("cameras", what));
        }
    };
    inner.finish()?;
    Ok(Some(Cameras { from, place, alpha }))
}

pub fn truth(table: &Table, folder: &Path) -> Result<Option<Truth>, Failure> {
    let Some(inner) = table.table("truth")? else {
        return Ok(None);
    };
    let truth = Truth {
        scene: inner.text("scene")?.map(|file| folder.join(file)),
        spp: inner.count("spp", 1, MOST_SAMPLES.into())?.unwrap_or(256) as u32,
        renders: inner.choice("targets", &["rendered", "pictures"])? != Some("pictures"),
    };
    inner.finish()?;
    Ok(Some(truth))
}
