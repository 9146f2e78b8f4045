//! Views: a sensor, the size of its image, its target and its mask.

use super::pictures;
use crate::jobs::failure::Failure;
use crate::jobs::settings::check_sensor;
use crate::optimize::config::{Config, MaskFrom};
use crate::picture::Image;
use crate::scene::Scene;
use std::path::PathBuf;

/// What an image should be, seen from one sensor.
#[derive(Clone, Debug)]
pub struct View {
    pub name: String,
    pub sensor: usize,
    /// Width and height in pixels in place of those of the sensor's film.
    pub resolution: Option<[u32; 2]>,
    pub target: Image,
    /// One a pixel, from 0 to 1.
    pub mask: Option<Vec<f32>>,
}

/// A view before its pictures are read.
#[derive(Clone, Debug)]
pub struct Wanted {
    pub place: String,
    pub sensor: usize,
    /// None if a known scene is rendered for it.
    pub target: Option<PathBuf>,
    pub mask: Option<MaskFrom>,
}

impl View {
    /// Width and height of its image.
    pub fn size(&self) -> [usize; 2] {
        [self.target.width, self.target.height]
    }
}

/// The views that the configuration asks for, of sensors that the scene has.
pub fn wanted(config: &Config, scene: &Scene) -> Result<Vec<Wanted>, Failure> {
    let settings = &config.views.list;
    if settings.is_empty() {
        let all = 0..scene.sensors.len();
        return Ok(all
            .map(|sensor| Wanted {
                place: config.file.display().to_string(),
                sensor,
                target: None,
                mask: None,
            })
            .collect());
    }
    let one = |view: &crate::optimize::config::ViewSettings| {
        let wrong = |what: String| Failure::Input(format!("{}: {what}", view.place));
        let sensor = match &view.sensor {
            None => 0,
            Some(name) => {
                let named = scene.sensors.iter().position(|s| s.id == *name);
                match named.or_else(|| name.parse().ok()) {
                    Some(sensor) => {
                        check_sensor(scene, sensor).map_err(|e| wrong(e.to_string()))?;
                        sensor
                    }
                    None => {
                        let ids: Vec<&str> = scene.sensors.iter().map(|s| s.id.as_str()).collect();
                        let what = format!(
                            "there is no sensor \"{name}\"; the scene has {}",
                            ids.join(", ")
                        );
                        return Err(wrong(what));
                    }
                }
            }
        };
        Ok(Wanted {
            place: view.place.clone(),
            sensor,
            target: view.target.clone(),
            mask: view.mask.clone(),
        })
    };
    settings.iter().map(one).collect()
}

/// Reads the pictures of a view, which is known by its number; `render` makes the target of one
/// that has none.
pub fn read(
    number: usize,
    wanted: &Wanted,
    scene: &Scene,
    resolution: Option<[u32; 2]>,
    render: impl FnOnce(Option<[u32; 2]>) -> Result<Image, Failure>,
) -> Result<View, Failure> {
    let sensor = &scene.sensors[wanted.sensor];
    let wrong = |what: String| Failure::Input(format!("{}: {what}", wanted.place));
    let unread = |error: Failure| error.at(&wanted.place);
    let (target, resolution) = match &wanted.target {
        Some(file) => {
            let image = pictures::image(file).map_err(unread)?;
            let own = [image.width as u32, image.height as u32];
            if let Some(size) = resolution.filter(|size| *size != own) {
                let what = format!(
                    "{} has {}x{} pixels, render.resolution says {}x{}; take that out, or give pictures of its size",
                    file.display(),
                    own[0],
                    own[1],
                    size[0],
                    size[1]
                );
                return Err(wrong(what));
            }
            let film = &sensor.film;
            let is_film = film.crop_size == own;
            let [width, height] = [film.width, film.height].map(f64::from);
            let aspect = f64::from(own[0]) / f64::from(own[1]);
            if !is_film && (aspect * height / width - 1.0).abs() > 0.02 {
                let what = format!(
                    "{} has {}x{} pixels, the film of {} is {width}x{height}, of another shape; give a picture of its shape",
                    file.display(),
                    own[0],
                    own[1],
                    sensor.id
                );
                return Err(wrong(what));
            }
            (image, (!is_film).then_some(own))
        }
        None => (render(resolution)?, resolution),
    };
    let size = [target.width, target.height];
    let mask = match (&wanted.mask, &wanted.target) {
        (None, _) => None,
        (Some(MaskFrom::File(file)), _) => Some(pictures::mask(file, size).map_err(unread)?),
        (Some(MaskFrom::Alpha), Some(file)) => Some(pictures::alpha(file, size).map_err(unread)?),
        (Some(MaskFrom::Alpha), None) => {
            return Err(wrong(
                "a rendered target has no alpha; take the mask out".into(),
            ));
        }
    };
    if mask
        .as_ref()
        .is_some_and(|mask| mask.iter().all(|w| *w == 0.0))
    {
        return Err(wrong(
            "its mask is black everywhere: nothing would count".into(),
        ));
    }
    Ok(View {
        name: format!("{number}-{}", sensor.id),
        sensor: wanted.sensor,
        resolution,
        target,
        mask,
    })
}

/// A picture whose sides are shorter by a whole factor: means over squares, by their weights.
pub fn shrunk(view: &View, factor: usize) -> (Image, Option<Vec<f32>>) {
    if factor == 1 {
        return (view.target.clone(), view.mask.clone());
    }
    let [width, height] = view.size().map(|n| n / factor);
    let mut pixels = Vec::with_capacity(width * height);
    let mut weights = Vec::with_capacity(width * height);
    let area = (factor * factor) as f64;
    for y in 0..height {
        for x in 0..width {
            let (mut sum, mut weight) = ([0.0; 3], 0.0);
            for i in 0..factor * factor {
                let at = (y * factor + i / factor) * view.target.width + x * factor + i % factor;
                let w = view.mask.as_ref().map_or(1.0, |mask| f64::from(mask[at]));
                weight += w;
                for (sum, value) in sum.iter_mut().zip(view.target.pixels[at]) {
                    *sum += w * f64::from(value);
                }
            }
            let scale = if weight > 0.0 { 1.0 / weight } else { 0.0 };
            pixels.push(sum.map(|v| (v * scale) as f32));
            weights.push((weight / area) as f32);
        }
    }
    let image = Image {
        width,
        height,
        pixels,
    };
    (image, view.mask.is_some().then_some(weights))
}

/// Refuses a factor by which a view cannot be made smaller.
pub fn check_factor(view: &View, scene: &Scene, factor: u64) -> Result<(), String> {
    let film = &scene.sensors[view.sensor].film;
    let [width, height] = view.size();
    let divides = [width, height]
        .iter()
        .all(|&side| (side as u64).is_multiple_of(factor));
    let is_cropped = view.resolution.is_none() && film.crop_size != [film.width, film.height];
    if factor == 1 || divides && !is_cropped {
        return Ok(());
    }
    Err(match divides {
        true => format!(
            "{} has a crop window, which cannot be made smaller",
            view.name
        ),
        false => format!(
            "{factor} does not divide {width}x{height}, the size of {}",
            view.name
        ),
    })
}
