//! What is said of a job when it has ended: a line of `results.jsonl`.

use crate::jobs::failure::Failure;
use crate::jobs::id::check_id;
use crate::jobs::mode::Mode;
use crate::jobs::read::without_line;
use crate::methods::Statistics;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// One result. Fields without a value are left out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ResultLine {
    /// None if the line had no id that could be read; it is written down all the same.
    #[serde(deserialize_with = "Option::deserialize")]
    pub id: Option<String>,
    /// The line of the job in its file, or how many came before it on standard input, counted from
    /// 1.
    pub line: usize,
    /// A hash of the job's line: `--resume` and `merge` know by it that a job is the same.
    pub job: String,
    /// `ok` or `failed`.
    pub status: String,
    /// 0, or that of the program if the job were run alone; 3 where it would refuse its arguments.
    pub code: u8,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub message: Option<String>,
    /// What is not as one may expect of results that are there.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// A hash of everything that was read of the scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scene_hash: Option<String>,
    /// Of a job that moves vertices: whether the acceleration structure was built anew, and not
    /// refitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rebuilt: Option<bool>,
    /// Wall-clock seconds by stage, while other jobs ran beside this one; `total` from admission to
    /// the files.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub seconds: BTreeMap<String, f64>,
    /// What the threads spent tracing and differentiating, added up over threads.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub thread_seconds: Option<f64>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub rays: BTreeMap<String, u64>,
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub rejected: BTreeMap<String, u64>,
    /// About what part of all that silhouettes bring is missing, if some were not found.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub missing_part: Option<f64>,
    /// The share of a gradient's variance that its largest part carries, by key.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub largest_parts: BTreeMap<String, f64>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub loss: Option<f64>,
    /// The root of the sum of squares of each gradient, and of its standard error under `KEY#se`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub norms: BTreeMap<String, f64>,
    /// Paths from the output directory.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub files: BTreeMap<String, String>,
    /// Of a job whose samples are shared out: which groups of them these are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub share: Option<Share>,
}

/// What a result line says of a share.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Share {
    pub mode: Mode,
    /// Groups of the whole job.
    pub groups: u32,
    /// The groups done here.
    pub done: Vec<u32>,
    /// The parameters of a backward job, in its order.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub keys: Vec<String>,
    /// Whether standard errors are wanted.
    pub stderr: bool,
    /// Files that are wanted, if not all are.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outputs: Option<Vec<String>>,
}

impl ResultLine {
    /// A job that is being run.
    pub fn begun(id: &str, line: usize, job: &str) -> Self {
        Self {
            id: Some(id.into()),
            line,
            job: job.into(),
            status: "ok".into(),
            ..Self::default()
        }
    }

    /// A job that did not get as far as having results.
    pub fn failed(id: Option<String>, line: usize, job: String, failure: &Failure) -> Self {
        Self {
            id,
            line,
            job,
            status: "failed".into(),
            code: failure.code(),
            message: Some(failure.to_string()),
            ..Self::default()
        }
    }

    /// A line of the file, without its end; else what is wrong with it.
    pub fn parse(text: &str) -> Result<Self, String> {
        let result: Self = serde_json::from_str(text).map_err(|error| without_line(&error))?;
        match (result.status.as_str(), result.code, &result.id) {
            ("ok", 0, Some(id)) => check_id(id).map_err(|failure| failure.to_string())?,
            ("ok", 0, None) => return Err("a result without an id".into()),
            ("failed", 1.., _) => {}
            (status, code, _) => return Err(format!("its status is {status:?} with code {code}")),
        }
        Ok(result)
    }

    /// Adds to a stage's time.
    pub fn spend(&mut self, stage: &str, seconds: f64) {
        *self.seconds.entry(stage.into()).or_default() += seconds;
    }

    /// Takes over what the engine counted.
    pub fn absorb(&mut self, statistics: &Statistics) {
        for (&stage, &seconds) in &statistics.seconds {
            self.spend(stage, seconds);
        }
        for (&kind, &count) in &statistics.rays {
            *self.rays.entry(kind.into()).or_default() += count;
        }
        for (&cause, &count) in &statistics.rejected {
            *self.rejected.entry(cause.into()).or_default() += count;
        }
        self.note_missing(statistics.missing_part());
        self.largest_parts.extend(statistics.largest_parts.clone());
        self.warnings.extend(statistics.warnings.clone());
        *self.thread_seconds.get_or_insert_default() += statistics.tile_seconds;
    }

    /// Takes a missing part over, if it is larger than what was known.
    pub fn note_missing(&mut self, part: Option<f64>) {
        let parts = [self.missing_part, part].into_iter().flatten();
        self.missing_part = parts.reduce(f64::max);
    }

    /// Whether the job's results are there.
    pub fn is_ok(&self) -> bool {
        self.status == "ok"
    }

    /// As it stands in the file, without the line's end.
    pub fn text(&self) -> String {
        // Strings, numbers and maps of them: there is nothing that could not be written.
        serde_json::to_string(self).unwrap_or_default()
    }
}
