//! Gradient pictures side by side: the reference, and each method in about the same time.

use super::gradients;
use crate::jobs::failure::Failure;
use crate::output::colormap::diverging;
use crate::output::{chart, png};
use crate::picture::Image;
use crate::study::cell::{Cell, Row};
use std::path::Path;

/// Pictures are enlarged to about this many dots.
const SIDE: usize = 160;
const GAP: usize = 6;

/// The cells of the pictures: of each method the samples whose time is nearest to that which all
/// methods have at least at their most samples.
pub fn cells(row: &Row) -> Vec<&Cell> {
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

/// The pictures in one row, the reference first, all with one scale.
pub fn png(directory: &Path, row: &Row) -> Result<Vec<u8>, Failure> {
    let reference = gradients::reference_path(directory, &row.scene, &row.direction);
    let mut images = vec![gradients::read(&reference)?];
    for cell in cells(row) {
        let (scene, direction) = (&row.scene, &row.direction);
        let path = gradients::path(directory, scene, direction, &cell.method, cell.spp);
        images.push(gradients::read(&path)?);
    }
    let scales = images.iter().map(chart::robust_scale);
    // The reference sets it, unless there is nothing in it.
    let scale = match chart::robust_scale(&images[0]) {
        0.0 => scales.fold(0.0, f32::max),
        scale => scale,
    };
    draw(&images, scale)
}

fn draw(images: &[Image], scale: f32) -> Result<Vec<u8>, Failure> {
    let factor = SIDE.div_ceil(images[0].width.max(1));
    let [width, height] = [images[0].width * factor, images[0].height * factor];
    let across = images.len() * (width + GAP) - GAP;
    let mut bytes = vec![255; across * height * 3];
    let per_unit = if scale > 0.0 { 1.0 / scale } else { 0.0 };
    for (i, image) in images.iter().enumerate() {
        for y in 0..height {
            for x in 0..width {
                let pixel = &image.pixels[y / factor * image.width + x / factor];
                let mean = (pixel[0] + pixel[1] + pixel[2]) / 3.0;
                let at = (y * across + i * (width + GAP) + x) * 3;
                bytes[at..at + 3].copy_from_slice(&diverging(mean * per_unit));
            }
        }
    }
    let comment = format!("mean of the channels; the colours span -{scale} to +{scale}");
    let file = png::encode_file(across, height, &bytes, Some(&comment));
    file.map_err(|error| Failure::System(error.to_string()))
}
