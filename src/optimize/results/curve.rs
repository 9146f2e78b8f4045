//! The loss of every step: `loss.csv`, and drawn with its error in `loss.svg`.

use crate::jobs::failure::Failure;
use crate::optimize::problem::Problem;
use crate::optimize::run::record::Record;
use crate::optimize::run::state::State;
use crate::output::atomic;
use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

pub const CSV: &str = "loss.csv";
pub const SVG: &str = "loss.svg";

/// Writes both.
pub fn write(directory: &Path, problem: &Problem, state: &State) -> Result<(), Failure> {
    let text = csv(problem, &state.history);
    atomic::write(&directory.join(CSV), |file| file.write_all(text.as_bytes()))?;
    let text = svg(&state.history);
    atomic::write(&directory.join(SVG), |file| file.write_all(text.as_bytes()))?;
    Ok(())
}

fn csv(problem: &Problem, history: &[Record]) -> String {
    let mut text = String::from(
        "step,loss,loss_se,noise_floor,penalty,spp,loss_spp,downscale,views,held,shortened,inverted,refused",
    );
    for variable in &problem.variables {
        let key = &variable.parameter.key;
        let _ = write!(
            text,
            ",gradient_squared {key},gradient_variance {key},off_truth {key}"
        );
    }
    text.push('\n');
    let shown = |number: Option<f64>| number.map_or(String::new(), |n| format!("{n:.9e}"));
    for r in history {
        let views: Vec<String> = r.views.iter().map(usize::to_string).collect();
        let _ = write!(
            text,
            "{},{},{},{},{:.9e},{},{},{},{},{},{},{},{}",
            r.step,
            shown(r.loss),
            shown(r.error),
            shown(r.floor),
            r.penalty,
            r.spp,
            r.loss_spp,
            r.downscale,
            views.join(" "),
            r.held,
            r.shortened,
            r.inverted,
            u8::from(r.refused),
        );
        for ((signal, noise), off) in r.signal.iter().zip(&r.noise).zip(&r.off_truth) {
            let _ = write!(text, ",{signal:.9e},{noise:.9e},{}", shown(*off));
        }
        text.push('\n');
    }
    text
}

const SIZE: [f64; 2] = [720.0, 320.0];
/// Left, right, top, bottom of the axes.
const AXES: [f64; 4] = [70.0, 700.0, 16.0, 276.0];

/// From steps and losses to places.
struct Axes {
    last: f64,
    /// Decades.
    low: f64,
    high: f64,
}

impl Axes {
    fn new(points: &[(f64, &Record)]) -> Self {
        let floors = points
            .iter()
            .filter_map(|(_, r)| r.floor.filter(|f| *f > 0.0));
        let all = points.iter().map(|(loss, _)| *loss).chain(floors);
        let (low, high) = all.fold((f64::INFINITY, 0.0f64), |(a, b), v| (a.min(v), b.max(v)));
        let low = low.log10().floor();
        Self {
            last: points.last().map_or(1.0, |(_, r)| r.step.max(1) as f64),
            low,
            high: high.log10().ceil().max(low + 1.0),
        }
    }

    fn x(&self, step: u64) -> f64 {
        AXES[0] + (AXES[1] - AXES[0]) * step as f64 / self.last
    }

    fn y(&self, v: f64) -> f64 {
        let t = (v.max(1e-300).log10() - self.low) / (self.high - self.low);
        AXES[3] - (AXES[3] - AXES[2]) * t.clamp(-0.05, 1.05)
    }

    fn at(&self, step: u64, v: f64) -> String {
        format!("{:.1} {:.1}", self.x(step), self.y(v))
    }

    fn draw(&self, text: &mut String) {
        for decade in self.low as i32..=self.high as i32 {
            let at = self.y(10f64.powi(decade));
            let _ = writeln!(
                text,
                "<path d=\"M{} {at:.1}H{}\" stroke=\"#ddd\"/><text x=\"{}\" y=\"{:.1}\" text-anchor=\"end\">1e{decade}</text>",
                AXES[0],
                AXES[1],
                AXES[0] - 6.0,
                at + 4.0
            );
        }
        for part in 0..=4 {
            let step = (self.last * f64::from(part) / 4.0).round();
            let _ = writeln!(
                text,
                "<text x=\"{:.1}\" y=\"{}\" text-anchor=\"middle\">{step}</text>",
                self.x(step as u64),
                AXES[3] + 18.0
            );
        }
    }
}

/// The loss on a logarithmic axis, a band of twice its standard error around it, and what noise
/// alone would make it.
pub fn svg(history: &[Record]) -> String {
    let points: Vec<(f64, &Record)> = history
        .iter()
        .filter_map(|r| Some((r.loss.filter(|loss| *loss > 0.0)?, r)))
        .collect();
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" font-size=\"12\" \
         role=\"img\"><title>Loss by step</title><rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        SIZE[0], SIZE[1]
    );
    if points.is_empty() {
        text.push_str("<text x=\"90\" y=\"150\">no step yet</text></svg>\n");
        return text;
    }
    let axes = Axes::new(&points);
    axes.draw(&mut text);
    let bound = |sign: f64| {
        let of = |(v, r): &(f64, &Record)| axes.at(r.step, v + sign * 2.0 * r.error.unwrap_or(0.0));
        points.iter().map(of).collect::<Vec<String>>()
    };
    let mut band = bound(1.0);
    band.extend(bound(-1.0).into_iter().rev());
    let floor = points
        .iter()
        .filter_map(|(_, r)| Some(axes.at(r.step, r.floor?)));
    let line = points.iter().map(|(v, r)| axes.at(r.step, *v));
    let paths = [
        (band, "fill=\"#9ecae1\" fill-opacity=\"0.6\""),
        (
            floor.collect(),
            "fill=\"none\" stroke=\"#888\" stroke-dasharray=\"4 3\"",
        ),
        (
            line.collect(),
            "fill=\"none\" stroke=\"#08519c\" stroke-width=\"1.5\"",
        ),
    ];
    for (points, style) in paths.iter().filter(|(points, _)| !points.is_empty()) {
        let _ = writeln!(text, "<path d=\"M{}\" {style}/>", points.join("L"));
    }
    let _ = writeln!(
        text,
        "<text x=\"{}\" y=\"{}\">step; line: loss, band: ± two standard errors, dashed: what noise alone makes</text></svg>",
        AXES[0],
        SIZE[1] - 8.0
    );
    text
}
