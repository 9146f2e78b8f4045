//! Gradient pictures side by side: the reference, and each method in about the same time.

use super::gradients;
use crate::jobs::failure::Failure;
use crate::output::colormap::diverging;
use crate::output::{chart, png};
use crate::picture::Image;
use crate::study::cell::{Cell, Row};
use crate::study::chart::dots as svg_dots;
use crate::study::chart::svg::{Anchor, Svg};
use std::path::Path;

/// Pictures are enlarged to about this many dots.
const SIDE: usize = 160;
const GAP: usize = 6;
/// Dots above a picture for what it is.
const LABEL: usize = 42;
/// Pictures side by side.
const ACROSS: usize = 5;

/// The cells of the pictures: of each method the samples whose time is nearest to that which all
/// methods have at least at their most samples.
fn cells(row: &Row) -> Vec<&Cell> {
    let seconds = |cell: &Cell| cell.times.as_ref().map(|t| t.processor_seconds);
    let mut methods: Vec<&str> = row.cells.iter().map(|cell| cell.method.as_str()).collect();
    methods.dedup();
    methods.truncate(
        row.cells
            .iter()
            .take_while(|c| c.spp == row.cells[0].spp)
            .count(),
    );
    let of = |name: &str| {
        let name = name.to_string();
        row.cells.iter().filter(move |cell| cell.method == name)
    };
    let longest = methods
        .iter()
        .filter_map(|name| of(name).filter_map(seconds).reduce(f64::max));
    let Some(common) = longest.reduce(f64::min) else {
        return Vec::new();
    };
    let distance = |cell: &Cell| seconds(cell).map_or(f64::INFINITY, |s| (s / common).ln().abs());
    let nearest = |name: &&str| {
        of(name)
            .filter(|cell| cell.times.is_some())
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
    };
    methods.iter().filter_map(nearest).collect()
}

/// The pictures, each with its name, the reference first, all with one scale.
pub fn png(directory: &Path, row: &Row) -> Result<Vec<u8>, Failure> {
    let reference = gradients::reference_path(directory, &row.scene, &row.direction);
    let mut panels = vec![Panel {
        image: gradients::read(&reference)?,
        name: "reference".into(),
        cost: String::new(),
    }];
    for cell in cells(row) {
        let (scene, direction) = (&row.scene, &row.direction);
        let path = gradients::path(directory, scene, direction, &cell.method, cell.spp);
        let seconds = cell.times.as_ref().map_or(0.0, |t| t.processor_seconds);
        panels.push(Panel {
            image: gradients::read(&path)?,
            name: cell.method.clone(),
            cost: format!("{} spp, {seconds:.2} s", cell.spp),
        });
    }
    let scales = panels.iter().map(|panel| chart::robust_scale(&panel.image));
    // The reference sets it, unless there is nothing in it.
    let scale = match chart::robust_scale(&panels[0].image) {
        0.0 => scales.fold(0.0, f32::max),
        scale => scale,
    };
    draw(&panels, scale)
}

struct Panel {
    image: Image,
    name: String,
    /// Samples a pixel and processor seconds.
    cost: String,
}

fn draw(panels: &[Panel], scale: f32) -> Result<Vec<u8>, Failure> {
    let first = &panels[0].image;
    let factor = SIDE.div_ceil(first.width.max(1));
    let [width, height] = [first.width * factor, first.height * factor];
    let columns = panels.len().min(ACROSS);
    let across = columns * (width + GAP) - GAP;
    let down = panels.len().div_ceil(columns) * (LABEL + height + GAP) - GAP;
    let mut svg = Svg::new(across as f64, down as f64);
    let corner = |i: usize| {
        let (column, line) = (i % columns, i / columns);
        [
            column * (width + GAP),
            line * (LABEL + height + GAP) + LABEL,
        ]
    };
    for (i, panel) in panels.iter().enumerate() {
        let [x, y] = corner(i).map(|dots| dots as f64);
        svg.text([x, y - 22.0], Anchor::Start, 16.0, "#000", &panel.name);
        svg.text([x, y - 6.0], Anchor::Start, 13.0, "#444", &panel.cost);
    }
    let mut bytes = svg_dots(&svg.finish("gradient pictures"))?;
    let per_unit = if scale > 0.0 { 1.0 / scale } else { 0.0 };
    for (i, panel) in panels.iter().enumerate() {
        let ([left, top], image) = (corner(i), &panel.image);
        for y in 0..height {
            for x in 0..width {
                let pixel = &image.pixels[y / factor * image.width + x / factor];
                let mean = (pixel[0] + pixel[1] + pixel[2]) / 3.0;
                let at = ((top + y) * across + left + x) * 3;
                bytes[at..at + 3].copy_from_slice(&diverging(mean * per_unit));
            }
        }
    }
    let comment = format!("mean of the channels; the colours span -{scale} to +{scale}");
    let file = png::encode_file(across, down, &bytes, Some(&comment));
    file.map_err(|error| Failure::System(error.to_string()))
}
