//! Error against time, for scenes with reference gradients: Markdown tables on stdout, progress on
//! stderr.
//!
//! `scripts/benchmark [--peers DIR] [--scenes a,b] [--filters gauss,box] [--spp 16,64,256] [--runs
//! 16]`
//!
//! Seconds are those of whole processes of the release binary: start, load, build, trace, write.

mod cases;
mod process;
mod references;
#[path = "../shared/mod.rs"]
mod shared;

use cases::{Case, Options};
use shared::accuracy::Accuracy;
use shared::program::{Program, median};

type Result<T> = std::result::Result<T, Box<dyn std::error::Error>>;

fn main() -> Result<()> {
    let options = Options::parse(std::env::args().skip(1))?;
    let program = Program::find()?;
    println!("{}\n", program.machine());
    let mut tables = Tables::default();
    for case in cases::all(&options)? {
        if let Err(why) = tables.measure(&program, &case, &options) {
            eprintln!("{} ({}): left out: {why}", case.name, case.filter);
            tables
                .left_out
                .push(format!("{} ({}): {why}", case.name, case.filter));
        }
    }
    tables.print(&options);
    Ok(())
}

#[derive(Default)]
struct Tables {
    forward: Vec<String>,
    agreement: Vec<String>,
    interior: Vec<String>,
    backward: Vec<String>,
    rivals: Vec<String>,
    left_out: Vec<String>,
}

impl Tables {
    fn measure(&mut self, program: &Program, case: &Case, options: &Options) -> Result<()> {
        let reference = references::read(program, case, options)?;
        let label = format!("{} | {}", case.name, case.filter);
        for &spp in &options.spp {
            let runs = process::forward(program, case, "reparam", spp, options.runs)?;
            let accuracy = Accuracy::new(&runs, &reference)?;
            let seconds = median(runs.iter().map(|r| r.seconds));
            let efficiency = 1.0 / (accuracy.error.powi(2) * seconds);
            let rays = runs[0].rays as f64;
            self.forward.push(format!(
                "{label} | {spp} | {seconds:.3} | {:.4} | {:.4} | {:+.4} ± {:.4} | {:.4} | {efficiency:.3e} | {:.2} | {:.2} | {:.0}",
                accuracy.error, accuracy.spread, accuracy.bias, reference.error, accuracy.projection,
                rays / 1e6, rays / runs[0].traced_seconds / 1e6, runs[0].peak_megabytes,
            ));
            self.agreement
                .push(format!("{label} | {spp} | {}", accuracy.z_cells()));
            if let Some((name, rival)) = case.rival(options) {
                self.rivals.push(format!(
                    "{label} | {spp} | {efficiency:.3e} | {name} | {rival:.3e} | {:.0}",
                    efficiency / rival
                ));
            }
        }
        let spp = options.spp[options.spp.len() / 2];
        let runs = process::forward(program, case, "interior", spp, options.runs)?;
        let wrong = Accuracy::new(&runs, &reference)?;
        self.interior.push(format!(
            "{label} | {spp} | {:.3} | {:+.3} | {:.4} | {}",
            wrong.error,
            wrong.bias,
            wrong.projection,
            wrong.z_cells()
        ));
        for &spp in &options.spp {
            let runs = process::backward(program, case, spp, options.runs, &reference)?;
            let seconds = median(runs.iter().map(|r| r.seconds));
            self.backward.push(format!(
                "{label} | {} | {spp} | {seconds:.3} | {} | {:.3} | {:.3}",
                case.tensor,
                runs[0].numbers,
                runs[0].relative_error,
                process::spread_over_error(&runs)
            ));
        }
        Ok(())
    }

    fn print(&self, options: &Options) {
        let table = |title: &str, columns: &str, rows: &[String]| {
            if rows.is_empty() {
                return;
            }
            println!(
                "### {title}\n\n| {columns} |\n|{}",
                "---|".repeat(columns.split(" | ").count())
            );
            rows.iter().for_each(|row| println!("| {row} |"));
            println!();
        };
        println!(
            "{} runs a row; error, spread and bias relative to the RMS of the reference.\n",
            options.runs
        );
        let forward = "scene | filter | spp | s | error | spread | bias ± reference's | projection | 1/(error²·s) | Mrays | Mrays/s | MB";
        table("Forward: the gradient image", forward, &self.forward);
        let z = "χ²/N | expected | \\|z\\| > 4 | expected | compared | RMS difference of the quiet rest | stated se / spread";
        table(
            "Agreement, number by number",
            &format!("scene | filter | spp | {z}"),
            &self.agreement,
        );
        let interior = format!("scene | filter | spp | error | bias | projection | {z}");
        table(
            "What ignoring visibility gives (`--method interior`)",
            &interior,
            &self.interior,
        );
        let backward = "scene | filter | parameter | spp | s | numbers | se/norm | spread/se";
        table("Backward: a linear loss", backward, &self.backward);
        let rivals = "scene | filter | spp | 1/(error²·s) | best reparameterisation of Mitsuba | its 1/(error²·s) | ratio";
        table("Against Mitsuba", rivals, &self.rivals);
        self.left_out
            .iter()
            .for_each(|case| println!("Left out: {case}"));
    }
}
