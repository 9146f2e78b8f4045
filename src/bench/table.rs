//! Results as Markdown tables: for terminals and for documents.

use super::{Column, Record, Results};
use crate::trace::Backend;
use std::fmt::Write;

/// The whole run.
pub fn markdown(results: &Results) -> String {
    let mut text = heading(results);
    let mut counts = vec![1, results.threads];
    counts.dedup();
    for (case, triangles) in results.cases() {
        for &threads in &counts {
            let _ = writeln!(
                text,
                "\n### {case}: {triangles} triangles, {}\n",
                count(threads)
            );
            text += &backends(results, &case, threads);
        }
        text += &presets(results, &case);
    }
    text
}

fn heading(results: &Results) -> String {
    let machine = &results.machine;
    let library = |(name, version): (&String, &String)| {
        let width = machine.widths.get(name).copied().unwrap_or(1);
        format!("{name} {version} ({width} rays together)")
    };
    let libraries: Vec<String> = machine.libraries.iter().map(library).collect();
    format!(
        "warpath {} on {}, {} cores, {}; compiled for {}; {}. Packets of {}, {} rays a pass, {} s a number and at \
         least 3 passes unless one takes too long. Medians; ± half of what lies between the least and the most; single \
         passes have none.\n",
        results.version,
        machine.cpu,
        machine.cores,
        machine.system,
        machine.instructions.join(" "),
        libraries.join(", "),
        results.packet_width,
        results.rays_per_pass,
        results.seconds,
    )
}

fn count(threads: usize) -> String {
    format!("{threads} thread{}", if threads == 1 { "" } else { "s" })
}

/// One row a number, one column a backend.
fn backends(results: &Results, case: &str, threads: usize) -> String {
    let columns = results.columns();
    let titles: Vec<String> = columns.iter().map(Column::title).collect();
    let mut rows = vec![header("", &titles)];
    let mut whats: Vec<(&str, &str)> = Vec::new();
    for r in results
        .records
        .iter()
        .filter(|r| r.case == case && r.threads == threads)
    {
        if !whats.iter().any(|w| w.0 == r.what) {
            whats.push((&r.what, r.unit));
        }
    }
    for (what, unit) in whats {
        let cells = columns
            .iter()
            .map(|c| cell(results.find(case, what, c, threads)));
        rows.push(row(&format!("{what}, {unit}"), cells));
    }
    rows.concat()
}

/// One row a preset.
fn presets(results: &Results, case: &str) -> String {
    let most = results.threads;
    let titles = [
        "build on 1 thread, ms",
        "on all, ms",
        "memory, MiB",
        "diffuse bounce, Mrays/s",
    ];
    let mut rows = vec![format!("\n"), header("preset", &titles.map(String::from))];
    for usual in Backend::built_in() {
        for backend in usual.presets() {
            let column = Column {
                backend: backend.to_string(),
                robust: true,
            };
            let of = |what: &str, threads: usize| results.find(case, what, &column, threads);
            if of("build", most).is_none() {
                continue;
            }
            let name = format!("{}:{}", backend.library(), backend.preset());
            let found = [
                of("build", 1),
                of("build", most),
                of("memory", most),
                of("diffuse bounce", most),
            ];
            rows.push(row(&name, found.into_iter().map(cell)));
        }
    }
    rows.concat()
}

fn header(first: &str, titles: &[String]) -> String {
    let rule = vec!["---:".to_string(); titles.len()];
    row(first, titles.iter().cloned()) + &row("---", rule.into_iter())
}

fn row(first: &str, cells: impl Iterator<Item = String>) -> String {
    let cells: Vec<String> = cells.collect();
    format!("| {first} | {} |\n", cells.join(" | "))
}

fn cell(record: Option<&Record>) -> String {
    let Some(r) = record else {
        return String::new();
    };
    let spread = 50.0 * (r.high - r.low) / r.median;
    if r.passes > 1 {
        format!("{} ± {spread:.0} %", digits(r.median))
    } else {
        digits(r.median)
    }
}

/// Three digits.
fn digits(x: f64) -> String {
    match x.abs() {
        a if a >= 100.0 => format!("{x:.0}"),
        a if a >= 10.0 => format!("{x:.1}"),
        _ => format!("{x:.2}"),
    }
}
