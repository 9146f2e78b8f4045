//! Which scenes, in which directions.

use crate::Result;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// What to measure.
pub struct Options {
    /// A folder with NAME.xml, ref/NAME.FILTER.npy and scenes.json.
    pub peers: Option<PathBuf>,
    pub scenes: Option<Vec<String>>,
    pub filters: Vec<String>,
    pub spp: Vec<u32>,
    pub runs: usize,
    /// Samples a pixel of each of the runs behind an own reference, and how many runs.
    pub reference_spp: u32,
    pub reference_runs: usize,
}

impl Options {
    pub fn parse(mut arguments: impl Iterator<Item = String>) -> Result<Self> {
        let mut options = Self {
            peers: None,
            scenes: None,
            filters: vec!["gauss".into(), "box".into()],
            spp: vec![16, 64, 256],
            runs: 16,
            reference_spp: 4096,
            reference_runs: 8,
        };
        while let Some(name) = arguments.next() {
            let value = arguments.next().ok_or(format!("{name} needs a value"))?;
            let list = || value.split(',').map(String::from).collect::<Vec<_>>();
            match name.as_str() {
                "--peers" => options.peers = Some(value.into()),
                "--scenes" => options.scenes = Some(list()),
                "--filters" => options.filters = list(),
                "--spp" => {
                    options.spp = list()
                        .iter()
                        .map(|s| s.parse())
                        .collect::<std::result::Result<_, _>>()?
                }
                "--runs" => options.runs = value.parse::<usize>()?.max(5),
                "--reference-spp" => options.reference_spp = value.parse()?,
                "--reference-runs" => options.reference_runs = value.parse::<usize>()?.max(2),
                _ => return Err(format!("unknown option {name}").into()),
            }
        }
        Ok(options)
    }
}

/// One scene with one film filter.
pub struct Case {
    pub name: String,
    pub filter: String,
    pub scene: PathBuf,
    /// KEY=TANGENT of the forward runs.
    pub directions: Vec<String>,
    /// The key of the backward runs.
    pub tensor: String,
    /// Folder with the references, if they are given.
    pub given: Option<PathBuf>,
}

impl Case {
    /// What `-D` takes.
    pub fn filter_define(&self) -> String {
        let plugin = if self.filter == "gauss" {
            "gaussian"
        } else {
            &self.filter
        };
        format!("rfilter={plugin}")
    }

    /// The best reparameterisation that the peers' figures have for this scene, and its efficiency.
    pub fn rival(&self, options: &Options) -> Option<(String, f64)> {
        let text = std::fs::read_to_string(options.peers.as_ref()?.join("mitsuba.json")).ok()?;
        // Written by Python, whose JSON knows NaN.
        let figures: Vec<Value> = serde_json::from_str(&text.replace("NaN", "null")).ok()?;
        figures
            .iter()
            .filter(|f| f["scene"] == self.name.as_str())
            .filter_map(|f| {
                Some((
                    f["integrator"].as_str()?,
                    f["spp"].as_u64()?,
                    f["eff_rel"].as_f64()?,
                ))
            })
            .filter(|(name, ..)| name.contains("reparam"))
            .max_by(|a, b| a.2.total_cmp(&b.2))
            .map(|(name, spp, efficiency)| (format!("{name}, {spp} spp"), efficiency))
    }
}

/// Scene, direction and tensor of this repository's own scenes.
const OWN: [(&str, &str, &str); 6] = [
    (
        "demo",
        "occluder.translation=1,0,0",
        "occluder.vertex_positions",
    ),
    (
        "sharp_shadow",
        "occluder.translation=1,0,0",
        "occluder.vertex_positions",
    ),
    (
        "silhouette",
        "ball.translation=1,0,0.3",
        "ball.vertex_positions",
    ),
    ("camera", "cam.translation=1,0,0", "ball.vertex_positions"),
    (
        "indirect",
        "ball.translation=1,0,0",
        "ball.vertex_positions",
    ),
    (
        "environment",
        "ring.translation=1,0,0",
        "ring.vertex_positions",
    ),
];

/// All cases that the options ask for.
pub fn all(options: &Options) -> Result<Vec<Case>> {
    let scenes = match &options.peers {
        Some(folder) => peers(folder)?,
        None => OWN
            .map(|(name, direction, tensor)| own(name, direction, tensor))
            .into(),
    };
    let wanted = |name: &str| {
        options
            .scenes
            .as_ref()
            .is_none_or(|s| s.iter().any(|s| s == name))
    };
    let mut cases = Vec::new();
    for (name, scene, directions, tensor) in scenes.into_iter().filter(|s| wanted(&s.0)) {
        for filter in &options.filters {
            cases.push(Case {
                name: name.clone(),
                filter: filter.clone(),
                scene: scene.clone(),
                directions: directions.clone(),
                tensor: tensor.clone(),
                given: options.peers.as_ref().map(|p| p.join("ref")),
            });
        }
    }
    Ok(cases)
}

type Scene = (String, PathBuf, Vec<String>, String);

fn own(name: &str, direction: &str, tensor: &str) -> Scene {
    (
        name.into(),
        Path::new("scenes").join(format!("{name}.xml")),
        vec![direction.into()],
        tensor.into(),
    )
}

fn peers(folder: &Path) -> Result<Vec<Scene>> {
    let list: Vec<Value> =
        serde_json::from_str(&std::fs::read_to_string(folder.join("scenes.json"))?)?;
    list.iter()
        .map(|entry| peer(folder, entry).ok_or_else(|| format!("scenes.json: {entry}").into()))
        .collect()
}

fn peer(folder: &Path, entry: &Value) -> Option<Scene> {
    let mut directions = Vec::new();
    let mut tensor = "obj.vertex_positions".to_string();
    for motion in entry["motions"].as_array()? {
        let id = ["shape", "sensor", "id"]
            .iter()
            .find_map(|k| motion[k].as_str())
            .unwrap_or("cam");
        let numbers: Option<Vec<String>> = motion["dir"]
            .as_array()?
            .iter()
            .map(|x| Some(x.as_f64()?.to_string()))
            .collect();
        directions.push(format!("{id}.translation={}", numbers?.join(",")));
        if id != "cam" && directions.len() == 1 {
            tensor = format!("{id}.vertex_positions");
        }
    }
    Some((
        entry["name"].as_str()?.into(),
        folder.join(entry["xml"].as_str()?),
        directions,
        tensor,
    ))
}
