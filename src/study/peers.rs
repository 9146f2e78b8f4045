//! What other programs took on the same scenes, from a file of measurements.

use super::cell::Row;
use super::config::PeersPlan;
use crate::jobs::failure::Failure;
use crate::output::FileError;
use serde::Deserialize;

/// One measurement: a JSON object of a list. Other fields are the other program's own.
#[derive(Clone, Debug, Deserialize)]
pub struct Peer {
    pub scene: String,
    #[serde(alias = "method")]
    pub integrator: String,
    pub spp: u32,
    /// The film's filter, if the measurement says it.
    pub rfilter: Option<String>,
    /// Processor seconds of one gradient.
    pub cpu: f64,
    /// Root mean square error over the reference's root mean square.
    pub rel_rmse: f64,
}

/// Reads the file; a measurement without an error or a time is no point and is left out.
pub fn read(plan: &PeersPlan) -> Result<Vec<Peer>, Failure> {
    let file = &plan.file;
    let bytes = crate::files::read(file).map_err(|error| FileError::unread(file, &error))?;
    let wrong = |error: serde_json::Error| {
        let (line, column) = (error.line(), error.column());
        let what = "write a list of objects with scene, integrator, spp, cpu and rel_rmse";
        Failure::Input(format!(
            "{}:{line}:{column}: {error}; {what}",
            file.display()
        ))
    };
    let text = without_nan(&String::from_utf8_lossy(&bytes));
    let all: Vec<serde_json::Value> = serde_json::from_str(&text).map_err(wrong)?;
    let is_point = |value: &serde_json::Value| {
        ["cpu", "rel_rmse"]
            .iter()
            .all(|key| value.get(key).is_some_and(|v| v.is_number()))
    };
    let points = all.into_iter().filter(is_point);
    points
        .map(|value| serde_json::from_value(value).map_err(wrong))
        .collect()
}

/// Python writes numbers that are none as `NaN`, which is no JSON; outside of texts `null` takes
/// its place.
fn without_nan(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for (i, part) in text.split('"').enumerate() {
        if i > 0 {
            out.push('"');
        }
        // A quote within a text, behind a backslash, would turn this round; names hold none.
        match i % 2 {
            0 => {
                out += &part
                    .replace("-Infinity", "null")
                    .replace("Infinity", "null")
                    .replace("NaN", "null")
            }
            _ => out += part,
        }
    }
    out
}

/// Those of a direction's scene with its filter.
pub fn of_row<'a>(peers: &'a [Peer], row: &Row) -> Vec<&'a Peer> {
    let is_of = |peer: &&Peer| {
        let filter = peer.rfilter.as_ref();
        peer.scene == row.peer && filter.is_none_or(|filter| *filter == row.filter)
    };
    peers.iter().filter(is_of).collect()
}
