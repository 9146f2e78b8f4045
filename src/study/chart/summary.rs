//! All directions in one chart: what each method is worth beside finite differences.

use super::axis::{LogAxis, label};
use super::colour;
use super::svg::{Anchor, Svg};
use crate::methods::Method;
use crate::study::cell::{Cell, Row};
use crate::study::verdict::Kind;
use std::collections::BTreeMap;

/// Points that are worth less stand here: one that finds noise where there is nothing would squeeze
/// all others together.
const LEAST_WORTH: f64 = 1e-5;
/// Of a letter of the words at the right.
const LETTER: f64 = 4.7;
const NAMES: f64 = 210.0;
const VERDICTS: f64 = 590.0;
const LINE: f64 = 17.0;
const TOP: f64 = 64.0;

/// Relative efficiency at the most samples, a line a direction; biased points are hollow, and the
/// rest is said in words.
pub fn svg(rows: &[Row]) -> String {
    let methods = methods(rows);
    let points = || rows.iter().flat_map(last_cells).filter_map(worth);
    let x = LogAxis::around(points().chain([1.0]), NAMES + 10.0, VERDICTS - 10.0);
    let bottom = TOP + LINE * rows.len() as f64;
    let words: Vec<String> = rows.iter().map(not_right).collect();
    let longest = words.iter().map(String::len).max().unwrap_or(0);
    let width = VERDICTS + (LETTER * longest as f64).max(130.0);
    let mut svg = Svg::new(width, bottom + 44.0);
    let title = "Efficiency 1/(error² · processor time) over that of finite differences";
    svg.text([12.0, 20.0], Anchor::Start, 14.0, "#111", title);
    let mut at = 12.0;
    for (i, name) in methods.iter().enumerate() {
        svg.dot([at + 5.0, 36.0], 4.0, colour(i), true);
        svg.text([at + 14.0, 40.0], Anchor::Start, 11.5, "#222", name);
        at += 40.0 + 7.0 * name.len() as f64;
    }
    svg.text(
        [at, 40.0],
        Anchor::Start,
        11.5,
        "#666",
        "hollow: not found right",
    );
    for mark in x.marks() {
        svg.line(
            [x.at(mark), TOP - 10.0],
            [x.at(mark), bottom],
            "#e4e4e4",
            "",
        );
        svg.text(
            [x.at(mark), bottom + 14.0],
            Anchor::Middle,
            11.0,
            "#444",
            &label(mark),
        );
    }
    svg.line([x.at(1.0), TOP - 10.0], [x.at(1.0), bottom], "#888", "");
    for (i, (row, words)) in rows.iter().zip(&words).enumerate() {
        let y = TOP + LINE * i as f64;
        let name = format!("{} {}", row.scene, row.direction);
        svg.text([NAMES, y + 4.0], Anchor::End, 11.0, "#222", &name);
        svg.line([NAMES + 8.0, y], [VERDICTS - 8.0, y], "#f0f0f0", "");
        for cell in last_cells(row) {
            let colour = colour(methods.iter().position(|m| *m == cell.method).unwrap_or(0));
            if let Some(worth) = worth(cell) {
                svg.dot(
                    [x.at(worth), y],
                    4.0,
                    colour,
                    cell.verdict.kind == Kind::Right,
                );
            }
        }
        svg.text([VERDICTS, y + 4.0], Anchor::Start, 9.0, "#666", words);
    }
    let scale = format!(
        "1: as good as finite differences of as many samples; to the right, better. What is worth less than {} stands there",
        label(LEAST_WORTH)
    );
    svg.text([12.0, bottom + 32.0], Anchor::Start, 11.0, "#444", &scale);
    svg.finish(title)
}

/// All methods but the one the others are measured by, in the order in which they are met.
fn methods(rows: &[Row]) -> Vec<&str> {
    let mut names: Vec<&str> = Vec::new();
    for cell in rows.iter().flat_map(last_cells) {
        if !names.contains(&cell.method.as_str()) {
            names.push(&cell.method);
        }
    }
    names
}

fn last_cells(row: &Row) -> impl Iterator<Item = &Cell> {
    let most = row.cells.iter().map(|cell| cell.spp).max();
    let others = |cell: &&Cell| cell.method != Method::REFERENCE.name();
    row.cells
        .iter()
        .filter(move |c| Some(c.spp) == most)
        .filter(others)
}

fn worth(cell: &Cell) -> Option<f64> {
    let worth = cell.times.as_ref()?.relative_efficiency?;
    Some(worth.max(LEAST_WORTH))
}

/// Which methods are not right, by verdicts.
fn not_right(row: &Row) -> String {
    let mut by_verdict: BTreeMap<&str, Vec<&str>> = BTreeMap::new();
    for cell in last_cells(row).filter(|cell| cell.verdict.kind != Kind::Right) {
        let methods = by_verdict.entry(cell.verdict.kind.name()).or_default();
        methods.push(&cell.method);
    }
    let words = by_verdict
        .iter()
        .map(|(verdict, methods)| format!("{verdict}: {}", methods.join(", ")));
    words.collect::<Vec<_>>().join("; ")
}
