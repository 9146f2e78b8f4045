//! Scene × method as Markdown.

use crate::study::cell::{Cell, Row};
use crate::study::chart::axis::label;
use crate::study::config::Plan;
use crate::study::verdict::{Kind, percent};
use std::fmt::Write;

/// What stands where there is no number, and why.
const NONE: &str = "–";

/// A table with a line for each direction, number of samples and method.
pub fn markdown(plan: &Plan, rows: &[Row]) -> String {
    let mut text = format!("# {}\n\n", plan.title);
    if !plan.about.is_empty() {
        text += &format!("{}\n\n", plan.about.trim());
    }
    text += &counts(rows);
    text += "\n## What the columns say\n\n";
    text += COLUMNS;
    text += "\n## Scene by scene\n";
    for row in rows {
        // Writing into a string does not fail.
        let _ = write!(text, "\n### {} · {}\n\n", row.scene, row.direction);
        if !row.symptom.is_empty() {
            text += &format!("Expected: {}.\n", row.symptom.trim_end_matches('.'));
        }
        text += &reference(row);
        text += HEAD;
        for cell in &row.cells {
            text += &line(cell);
        }
    }
    text
}

const HEAD: &str = "\n| method | samples | verdict | rms bias | sigmas | noise | kurtosis | top 0.1 % \
| rejected | coverage |\n|---|---|---|---|---|---|---|---|---|---|\n";

const COLUMNS: &str = "\
- *Verdict*: right, biased (four sigmas from the reference or more), unstable (numbers that are not
  finite, or one repeat that has half of the variance of all), refused with the method's sentence, or
  unknown, where noise hides what is asked. *Size* is that of the gradient along the reference.
- *Rms bias*: what averaging over the repeats would leave, freed of their noise and of the
  reference's, relative to the gradient's root mean square (rms), ± its standard error if there is
  no bias. *Sigmas*: how rare such repeats are without a bias, as images or in their size.
- *Efficiency*: 1/(error² · processor time) over that of `fd` with as many samples, over all rows
  that have one, right or not.
- *Noise*: standard deviation in equal processor time over that of `fd` with as many samples;
  measured in turns, medians. Below one is better than `fd`.
- *Kurtosis* of the deviations of all numbers of all repeats: three for equal normal noise in all
  pixels. *Top 0.1 %*: their share in the variance.
- *Rejected*: samples left out, of all camera paths.
- *Coverage*: share of numbers of all repeats whose 95 % interval (Student's, of the stated
  standard error) holds the reference.
- A dash stands where a method refused, or where there is no gradient to be relative to.
";

/// Of each method, how many verdicts of each kind, and what it is worth beside finite differences.
fn counts(rows: &[Row]) -> String {
    let cells = || rows.iter().flat_map(|row| &row.cells);
    let mut methods: Vec<&str> = Vec::new();
    for cell in cells() {
        if !methods.contains(&cell.method.as_str()) {
            methods.push(&cell.method);
        }
    }
    let names = Kind::ALL.map(|(name, _)| name).join(" | ");
    let mut text = format!(
        "| method | {names} | efficiency: least | geometric mean | most |\n|{}\n",
        "---|".repeat(Kind::ALL.len() + 4)
    );
    for method in methods {
        let of = || cells().filter(|cell| cell.method == method);
        let count = |kind: Kind| of().filter(|c| c.verdict.kind == kind).count().to_string();
        let numbers = Kind::ALL.map(|(_, kind)| count(kind)).join(" | ");
        let worth = of().filter_map(|cell| cell.times.as_ref()?.relative_efficiency);
        let worth = least_mean_and_most(worth.collect()).join(" | ");
        text += &format!("| `{method}` | {numbers} | {worth} |\n");
    }
    text
}

/// The mean is the geometric one.
fn least_mean_and_most(worth: Vec<f64>) -> [String; 3] {
    let text = |x: f64| match worth.is_empty() {
        true => NONE.into(),
        false => label(x),
    };
    let logarithms: f64 = worth.iter().map(|x| x.ln()).sum();
    [
        text(worth.iter().copied().fold(f64::INFINITY, f64::min)),
        text((logarithms / worth.len() as f64).exp()),
        text(worth.iter().copied().fold(0.0, f64::max)),
    ]
}

fn reference(row: &Row) -> String {
    let [width, height] = row.size;
    let ladder = &row.reference.ladder;
    let agree = match ladder.agrees {
        true => "agree",
        false => "disagree",
    };
    let sigmas: Vec<String> = ladder.sigmas.iter().map(|s| format!("{s:.1}")).collect();
    let noise = match row.reference.rms {
        Some(rms) => format!(
            "rms {rms:.3e}, its standard error {}",
            percent(row.reference.noise)
        ),
        None => "no gradient stands out of its noise".into(),
    };
    let [runs, spp] = [row.reference.runs, row.reference.spp as usize];
    format!(
        "Reference, {runs} runs of {width}×{height} pixels × {spp} samples: {noise}; its steps \
         {agree} ({} sigmas).\n",
        sigmas.join(", ")
    )
}

fn line(cell: &Cell) -> String {
    let figures = cell.figures.as_ref();
    let number = |value: Option<f64>, digits: usize| match value {
        Some(x) => format!("{x:.digits$}"),
        None => NONE.into(),
    };
    let share = |value: Option<f64>| value.map_or(NONE.into(), percent);
    let bias = figures.map_or(NONE.into(), |f| {
        let root = |square: f64| percent(square.max(0.0).sqrt());
        format!("{} ± {}", root(f.bias_squared), root(f.bias_squared_se))
    });
    let kind = cell.verdict.kind.name();
    let kind = match cell.verdict.kind {
        Kind::Right => kind.to_string(),
        _ => format!("**{kind}**"),
    };
    let rejected = figures.map_or(NONE.into(), |f| match f.rejected_share {
        0.0 => "0".into(),
        share => {
            let causes: Vec<&str> = f.rejected.keys().map(String::as_str).collect();
            format!("{share:.0e} ({})", causes.join(", ").replace('_', " "))
        }
    });
    let way = cell.way.as_ref().map(|way| format!(" ({way})"));
    format!(
        "| `{}`{} | {} × {} | {kind}: {} | {bias} | {} | {} | {} | {} | {rejected} | {} |\n",
        cell.method,
        way.unwrap_or_default(),
        cell.repeats,
        cell.spp,
        // A sentence may hold what would end a cell.
        cell.verdict.text.replace('|', "\\|").replace('\n', " "),
        number(figures.map(|f| f.bias_sigmas), 1),
        number(cell.times.as_ref().and_then(|t| t.relative_noise), 2),
        number(figures.and_then(|f| f.kurtosis), 0),
        share(figures.and_then(|f| f.top_variance_share)),
        share(figures.and_then(|f| f.coverage)),
    )
}
