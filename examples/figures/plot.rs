//! A chart of errors against samples a pixel, both on logarithmic axes, as SVG.

use std::fmt::Write;

const WIDTH: f64 = 520.0;
const HEIGHT: f64 = 340.0;
/// Left, right, top and bottom of the frame.
const FRAME: [f64; 4] = [70.0, 500.0, 40.0, 290.0];

/// At one number of samples.
pub struct Point {
    pub spp: u32,
    /// RMS error of one run.
    pub error: f64,
    /// What averaging leaves, and where it may lie.
    pub bias: f64,
    pub limits: [f64; 2],
}

pub fn svg(title: &str, points: &[Point]) -> String {
    let axes = Axes::around(points);
    let mut out = format!(
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {HEIGHT}" font-family="sans-serif" font-size="12">
<rect width="{WIDTH}" height="{HEIGHT}" fill="white"/>
<text x="{x}" y="22" font-size="14">{title}</text>
"#,
        x = FRAME[0]
    );
    axes.draw(&mut out, points);
    line(
        &mut out,
        "#b2182b",
        points.iter().map(|p| axes.place(p.spp, p.error)),
    );
    line(
        &mut out,
        "#2166ac",
        points
            .iter()
            .filter(|p| p.bias > 0.0)
            .map(|p| axes.place(p.spp, p.bias)),
    );
    for point in points {
        let [x, low] = axes.place(point.spp, point.limits[0]);
        let [_, high] = axes.place(point.spp, point.limits[1]);
        let _ = writeln!(
            out,
            r##"<path d="M{x:.1} {low:.1}V{high:.1}M{l:.1} {high:.1}H{r:.1}" stroke="#2166ac" fill="none"/>"##,
            l = x - 4.0,
            r = x + 4.0
        );
    }
    let [left, _, top, bottom] = FRAME;
    for (k, (colour, text)) in [
        ("#b2182b", "RMS error of one run"),
        (
            "#2166ac",
            "error that averaging leaves, ± 2 standard errors",
        ),
    ]
    .iter()
    .enumerate()
    {
        let y = bottom - 26.0 + 16.0 * k as f64;
        let _ = writeln!(
            out,
            r#"<text x="{x}" y="{y}" fill="{colour}">{text}</text>"#,
            x = left + 8.0
        );
    }
    let _ = writeln!(
        out,
        r#"<text x="{x}" y="{y}" text-anchor="middle">samples a pixel</text>
<text transform="translate(18 {middle}) rotate(-90)" text-anchor="middle">relative to the reference's RMS</text>
</svg>"#,
        x = (FRAME[0] + FRAME[1]) / 2.0,
        y = bottom + 38.0,
        middle = (top + bottom) / 2.0,
    );
    out
}

fn line(out: &mut String, colour: &str, places: impl Iterator<Item = [f64; 2]>) {
    let places: Vec<[f64; 2]> = places.collect();
    let corners: Vec<String> = places
        .iter()
        .map(|[x, y]| format!("{x:.1},{y:.1}"))
        .collect();
    let _ = writeln!(
        out,
        r#"<polyline points="{}" fill="none" stroke="{colour}" stroke-width="1.5"/>"#,
        corners.join(" ")
    );
    for [x, y] in places {
        let _ = writeln!(
            out,
            r#"<circle cx="{x:.1}" cy="{y:.1}" r="3" fill="{colour}"/>"#
        );
    }
}

/// Decades that hold all there is.
struct Axes {
    /// Of the samples: log₂.
    x: [f64; 2],
    /// Of the errors: whole powers of ten.
    y: [f64; 2],
}

impl Axes {
    fn around(points: &[Point]) -> Self {
        let spp = |p: &Point| f64::from(p.spp).log2();
        let errors = || {
            points
                .iter()
                .flat_map(|p| [p.error, p.bias, p.limits[1]])
                .filter(|e| *e > 0.0 && e.is_finite())
                .map(f64::log10)
        };
        let [low, high] = [errors().fold(0.0, f64::min), errors().fold(-9.0, f64::max)];
        Self {
            x: [
                points.iter().map(spp).fold(f64::INFINITY, f64::min) - 0.5,
                points.iter().map(spp).fold(0.0, f64::max) + 0.5,
            ],
            // Half a decade below is room for the legend.
            y: [(low - 0.5).floor(), high.ceil().max(low.floor() + 1.0)],
        }
    }

    fn place(&self, spp: u32, error: f64) -> [f64; 2] {
        let [left, right, top, bottom] = FRAME;
        let part = |v: f64, [low, high]: [f64; 2]| ((v - low) / (high - low)).clamp(0.0, 1.0);
        [
            left + (right - left) * part(f64::from(spp).log2(), self.x),
            bottom - (bottom - top) * part(error.max(1e-30).log10(), self.y),
        ]
    }

    fn draw(&self, out: &mut String, points: &[Point]) {
        let [left, right, top, bottom] = FRAME;
        for power in self.y[0] as i32..=self.y[1] as i32 {
            let [_, y] = self.place(1, 10f64.powi(power));
            let _ = writeln!(
                out,
                r##"<path d="M{left} {y:.1}H{right}" stroke="#ccc"/><text x="{x}" y="{t:.1}" text-anchor="end">{label}</text>"##,
                x = left - 6.0,
                t = y + 4.0,
                label = 10f64.powi(power)
            );
        }
        for point in points {
            let [x, _] = self.place(point.spp, 1.0);
            let _ = writeln!(
                out,
                r##"<path d="M{x:.1} {top}V{bottom}" stroke="#eee"/><text x="{x:.1}" y="{y}" text-anchor="middle">{spp}</text>"##,
                y = bottom + 18.0,
                spp = point.spp
            );
        }
        let _ = writeln!(
            out,
            r##"<rect x="{left}" y="{top}" width="{w}" height="{h}" fill="none" stroke="#333"/>"##,
            w = right - left,
            h = bottom - top
        );
    }
}
