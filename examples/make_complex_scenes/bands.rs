//! The picture on the walls: smooth, so that what moves before it changes its colour from place to
//! place, and no edge of its own takes part.

use crate::chance::between;
use std::error::Error;
use std::f64::consts::TAU;
use std::path::Path;
use warpath::methods::Image;
use warpath::output::png;

const SIZE: usize = 128;
const WAVES: u64 = 5;

pub fn write(path: &Path) -> Result<(), Box<dyn Error>> {
    let pixels = (0..SIZE * SIZE).map(|i| {
        let place = |x: usize| (x as f64 + 0.5) / SIZE as f64;
        let (u, v) = (place(i % SIZE), place(i / SIZE));
        std::array::from_fn(|channel| {
            let wave = |k: u64| {
                // Whole numbers of waves over the picture, so that it repeats without a seam.
                let key = k + WAVES * channel as u64;
                let [a, b] = [40, 41].map(|property| between(-5.5, 5.5, key, property).round());
                (TAU * (a * u + b * v + between(0.0, 1.0, key, 42))).sin()
            };
            let sum: f64 = (0..WAVES).map(wave).sum();
            (0.4 + 0.09 * sum).clamp(0.02, 0.9) as f32
        })
    });
    let image = Image {
        width: SIZE,
        height: SIZE,
        pixels: pixels.collect(),
    };
    Ok(png::write_image(path, &image)?)
}

/// A wall across the view, at this distance behind the origin, that shows the picture.
pub fn wall(id: &str, half: f64, y: f64) -> String {
    let bsdf = format!("<bsdf type=\"diffuse\">{}</bsdf>", picture("reflectance"));
    rectangle(id, half, y, &bsdf)
}

/// The same, but it shines: with paths of one segment nothing but the film is at stake.
pub fn bright_wall(id: &str, half: f64, y: f64) -> String {
    let emitter = format!("<emitter type=\"area\">{}</emitter>", picture("radiance"));
    rectangle(id, half, y, &emitter)
}

fn picture(role: &str) -> String {
    format!(
        r#"
      <texture type="bitmap" name="{role}">
        <string name="filename" value="bands.png"/>
      </texture>
    "#
    )
}

fn rectangle(id: &str, half: f64, y: f64, what: &str) -> String {
    format!(
        r#"  <shape type="rectangle" id="{id}">
    <transform name="to_world">
      <scale value="{half}"/><rotate x="1" angle="90"/><translate y="{y}"/>
    </transform>
    {what}
  </shape>
"#
    )
}
