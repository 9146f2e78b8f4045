//! The figures of the paper: gradient images beside finite differences, and a table on stdout.
//!
//! `scripts/figures [--only NAME,…] [--runs 6] [--quick] [--fresh]`
//!
//! Writes `out/figures/NAME/` and `out/figures/figures.md`. Exits with 1 if a figure could not be
//! made.

mod agreement;
mod figures;
mod picture;
mod plot;
mod runs;
#[path = "../shared/mod.rs"]
mod shared;

use agreement::Agreement;
use figures::{Figure, Options};
use shared::accuracy::{Accuracy, Reference};
use shared::program::{ForwardRun, Program, median};
use std::process::ExitCode;

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

const COLUMNS: &str = "figure | direction | method | spp | seconds | amplitude | error of one run | bias of the mean | \
                       reference's noise | χ²/N (expected)";

/// Runs at few samples are cheap and noisy: there may be this many times more of them.
const MOST_MORE_RUNS: u32 = 8;

fn main() -> Result<ExitCode> {
    let options = Options::parse(std::env::args().skip(1))?;
    let figures = figures::read(&options)?;
    let program = Program::find()?;
    let mut table = format!(
        "{}\n\n| {COLUMNS} |\n|{}\n",
        program.machine(),
        "---|".repeat(COLUMNS.split(" | ").count())
    );
    print!("{table}");
    let mut is_complete = true;
    for figure in &figures {
        let rows = make(&program, figure, &options).unwrap_or_else(|why| {
            is_complete = false;
            vec![format!(
                "{} | not made: {} | | | | | | | |",
                label(figure),
                why.to_string()
                    .trim_start_matches("error: ")
                    .replace('|', "\\|")
            )]
        });
        for row in rows {
            println!("| {row} |");
            table += &format!("| {row} |\n");
        }
    }
    std::fs::create_dir_all(runs::out())?;
    std::fs::write(runs::out().join("figures.md"), table)?;
    Ok(if is_complete {
        ExitCode::SUCCESS
    } else {
        ExitCode::from(1)
    })
}

/// Everything of one figure; the rows of its table.
fn make(program: &Program, figure: &Figure, options: &Options) -> Result<Vec<String>> {
    eprintln!("{}", figure.name);
    let folder = runs::out().join(&figure.name);
    let judged = runs::judged(program, figure, options, figure.spp, options.runs)?;
    let reference = runs::reference(program, figure, options, &judged[0].scene_hash)?;
    let mean = Reference::mean_of(&reference);
    picture::write(
        &folder.join("gradient.png"),
        mean.size,
        &judged[0].gradient,
        &mean.values,
    )?;
    let mut rows = vec![row(figure, figure.spp, &judged, &reference, &mean)?.0];
    let mut points = Vec::new();
    for &spp in &figure.chart {
        let more = (figure.spp / spp).clamp(1, MOST_MORE_RUNS) as usize;
        let runs = runs::judged(program, figure, options, spp, options.runs * more)?;
        let (text, agreement) = row(figure, spp, &runs, &reference, &mean)?;
        if spp != figure.spp {
            rows.push(text);
        }
        points.push(plot::Point {
            spp,
            error: agreement.error,
            bias: agreement.bias_square.value.max(0.0).sqrt(),
            limits: agreement.bias_limits(),
        });
    }
    if !points.is_empty() {
        std::fs::write(folder.join("bias.svg"), plot::svg(&figure.name, &points))?;
    }
    Ok(rows)
}

fn row(
    figure: &Figure,
    spp: u32,
    judged: &[ForwardRun],
    reference: &[ForwardRun],
    mean: &Reference,
) -> Result<(String, Agreement)> {
    let [chi_square, expected] = Accuracy::new(judged, mean)?.chi_square();
    let agreement = Agreement::of(judged, reference);
    let text = format!(
        "{} | {} | {spp} | {:.2} | {:.4} ± {:.4} | {:.4} | {} | {:.4} | {chi_square:.2} ({expected:.2})",
        label(figure),
        figure.method,
        median(judged.iter().map(|r| r.seconds)),
        agreement.amplitude.value,
        agreement.amplitude.error,
        agreement.error,
        agreement.bias(),
        mean.error,
    );
    Ok((text, agreement))
}

fn label(figure: &Figure) -> String {
    format!("{} | `{}`", figure.name, figure.direction.join(" "))
}
