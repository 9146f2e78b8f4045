//! Charts as SVG, and as PNG for where that is wanted.

pub mod axis;
pub mod error_time;
pub mod summary;
pub mod svg;

use crate::jobs::failure::Failure;
use resvg::{tiny_skia, usvg};
use std::sync::Arc;

/// Dots of a PNG for each unit of its SVG.
const DOTS: f32 = 2.0;

/// The colour of a method, by its place among those of a study: told apart by colour-blind readers
/// (Okabe and Ito 2008).
pub fn colour(place: usize) -> &'static str {
    const COLOURS: [&str; 7] = [
        "#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00", "#000000",
    ];
    COLOURS[place % COLOURS.len()]
}

/// A chart as PNG.
pub fn png(svg: &str) -> Result<Vec<u8>, Failure> {
    drawn(svg, DOTS)?.encode_png().map_err(failed)
}

/// A chart's red, green and blue, a dot for each of its units; it has whole sides.
pub fn dots(svg: &str) -> Result<Vec<u8>, Failure> {
    let canvas = drawn(svg, 1.0)?;
    let opaque = canvas.pixels().iter();
    Ok(opaque
        .flat_map(|dot| [dot.red(), dot.green(), dot.blue()])
        .collect())
}

fn drawn(svg: &str, dots_per_unit: f32) -> Result<tiny_skia::Pixmap, Failure> {
    // The same letters on every machine.
    let mut fonts = usvg::fontdb::Database::new();
    fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
    let options = usvg::Options {
        font_family: "Ubuntu".into(),
        fontdb: Arc::new(fonts),
        ..usvg::Options::default()
    };
    let tree = usvg::Tree::from_str(svg, &options).map_err(failed)?;
    let sides = [tree.size().width(), tree.size().height()];
    let [width, height] = sides.map(|x| (x * dots_per_unit) as u32);
    let mut canvas = tiny_skia::Pixmap::new(width, height)
        .ok_or_else(|| failed(format!("{width}x{height} dots are too many")))?;
    let scale = tiny_skia::Transform::from_scale(dots_per_unit, dots_per_unit);
    resvg::render(&tree, scale, &mut canvas.as_mut());
    Ok(canvas)
}

fn failed(what: impl std::fmt::Display) -> Failure {
    Failure::System(format!("a chart cannot be drawn: {what}"))
}
