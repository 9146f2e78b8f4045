//! What a study leaves: tables, charts, pictures, a page.

pub mod gradients;
mod grid;
mod page;
pub mod table;
pub mod values;

use super::cell::Row;
use super::chart::{self, error_time, summary};
use super::config::Plan;
use super::peers::{Peer, of_row};
use crate::jobs::failure::Failure;
use crate::output::atomic;
use std::io::Write;
use std::path::Path;

/// Writes everything but the journal; the names of the files.
pub fn write(
    directory: &Path,
    plan: &Plan,
    rows: &[Row],
    peers: &[Peer],
) -> Result<Vec<String>, Failure> {
    let mut files = Vec::new();
    let mut put = |name: String, bytes: &[u8]| -> Result<(), Failure> {
        atomic::write(&directory.join(&name), |file| file.write_all(bytes))?;
        files.push(name);
        Ok(())
    };
    put("study.json".into(), values::json(plan, rows)?.as_bytes())?;
    put("study.csv".into(), values::csv(rows).as_bytes())?;
    let label = plan.peers.as_ref().map_or("", |peers| &peers.label);
    let mut panels = Vec::new();
    for row in rows {
        let name = format!("{}-{}", row.scene, row.direction);
        let svg = error_time::svg(row, &of_row(peers, row), label);
        put(format!("{name}.svg"), svg.as_bytes())?;
        put(format!("{name}.png"), &chart::png(&svg)?)?;
        let grid = grid::png(directory, row)?;
        put(format!("{name}-gradients.png"), &grid)?;
        panels.push(page::Panel { row, svg, grid });
    }
    let summary = summary::svg(rows);
    put("summary.svg".into(), summary.as_bytes())?;
    put("summary.png".into(), &chart::png(&summary)?)?;
    put(
        "study.html".into(),
        page::html(plan, &summary, &panels).as_bytes(),
    )?;
    Ok(files)
}
