//! Results as a chart: every backend's speed over that of the first one.

use super::{Column, Results};
use std::fmt::Write;

/// Width of the names, of a case's panel, and height of a row.
const NAMES: f64 = 130.0;
const PANEL: f64 = 230.0;
const ROW: f64 = 16.0;
const MARGIN: f64 = 24.0;
/// The axis spans this many doublings to either side.
const DOUBLINGS: f64 = 4.0;
const COLOURS: [&str; 6] = [
    "#555555", "#4477aa", "#ee6677", "#228833", "#ccbb44", "#aa3377",
];

/// An SVG picture; one panel a case, one row a number, one mark a backend, right of the line where
/// it is faster than the first backend. All of them on all threads.
pub fn svg(results: &Results) -> String {
    let (cases, columns) = (results.cases(), results.columns());
    let mut whats: Vec<&str> = Vec::new();
    let timed = |r: &&super::Record| r.threads == results.threads && !r.backend.contains(':');
    for r in results.records.iter().filter(timed) {
        if !whats.contains(&r.what.as_str()) {
            whats.push(&r.what);
        }
    }
    let across = cases.len().clamp(1, 3);
    let panel_height = ROW * (whats.len() as f64 + 2.0) + MARGIN;
    let width = NAMES + PANEL * across as f64 + MARGIN;
    let height = MARGIN * 2.0 + panel_height * cases.len().div_ceil(across) as f64;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-size=\"11\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    legend(&mut out, &columns);
    for (i, (case, _)) in cases.iter().enumerate() {
        let left = NAMES + PANEL * (i % across) as f64;
        let top = MARGIN * 2.0 + panel_height * (i / across) as f64;
        let panel = Panel {
            results,
            case,
            whats: &whats,
            columns: &columns,
            corner: [left, top],
            is_named: i % across == 0,
        };
        panel.draw(&mut out);
    }
    out + "</svg>\n"
}

fn legend(out: &mut String, columns: &[Column]) {
    for (i, column) in columns.iter().enumerate() {
        let x = MARGIN + 130.0 * i as f64;
        mark(out, x, MARGIN * 0.75, i, column.robust);
        text(out, x + 8.0, MARGIN * 0.75 + 4.0, "start", &column.title());
    }
}

/// One case: what was measured of it, a row each.
struct Panel<'a> {
    results: &'a Results,
    case: &'a str,
    whats: &'a [&'a str],
    columns: &'a [Column],
    /// Left and top.
    corner: [f64; 2],
    /// Whether the rows have their names beside them.
    is_named: bool,
}

impl Panel<'_> {
    fn draw(&self, out: &mut String) {
        let [left, top] = self.corner;
        let inner = PANEL - 2.0 * MARGIN / 2.0;
        let at =
            |ratio: f64| left + inner * (0.5 + ratio.log2() / (2.0 * DOUBLINGS)).clamp(0.0, 1.0);
        let bottom = top + ROW * (self.whats.len() as f64 + 0.5);
        text(out, at(1.0), top, "middle", self.case);
        for power in [-4, -2, 0, 2, 4] {
            let ratio = f64::powi(2.0, power);
            let (x, grey) = (at(ratio), if power == 0 { "#888888" } else { "#dddddd" });
            let _ = writeln!(
                out,
                "<line x1=\"{x:.1}\" y1=\"{:.1}\" x2=\"{x:.1}\" y2=\"{bottom:.1}\" stroke=\"{grey}\"/>",
                top + 6.0
            );
            let label = if power < 0 {
                format!("1/{}", 1.0 / ratio)
            } else {
                format!("{ratio}")
            };
            text(out, x, bottom + 12.0, "middle", &label);
        }
        for (i, what) in self.whats.iter().enumerate() {
            let y = top + ROW * (i as f64 + 1.0);
            if self.is_named {
                text(out, NAMES - 12.0, y + 4.0, "end", what);
            }
            let of = |column: &Column| {
                self.results
                    .find(self.case, what, column, self.results.threads)
            };
            let Some(first) = self.columns.first().and_then(of) else {
                continue;
            };
            for (c, column) in self.columns.iter().enumerate() {
                if let Some(record) = of(column) {
                    let more_is_faster = record.unit == "Mrays/s";
                    let ratio = record.median / first.median;
                    mark(
                        out,
                        at(if more_is_faster { ratio } else { 1.0 / ratio }),
                        y,
                        c,
                        column.robust,
                    );
                }
            }
        }
    }
}

/// Full where nothing leaks.
fn mark(out: &mut String, x: f64, y: f64, index: usize, robust: bool) {
    let colour = COLOURS[index % COLOURS.len()];
    let fill = if robust { colour } else { "none" };
    let _ = writeln!(
        out,
        "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"{fill}\" fill-opacity=\"0.8\" stroke=\"{colour}\"/>"
    );
}

fn text(out: &mut String, x: f64, y: f64, anchor: &str, text: &str) {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    let _ = writeln!(
        out,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{text}</text>"
    );
}
