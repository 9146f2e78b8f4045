//! From what was asked for, in options or in a job, to the engine's settings.

use super::failure::Failure;
use crate::methods::{Groups, Image, Method, Settings};
use crate::output::picture::PictureFile;
use crate::scene::Scene;
use crate::trace::Backend;
use std::path::Path;

/// Camera paths per pixel; more are better had from several seeds.
pub const MOST_SAMPLES: u32 = 1 << 20;

/// Largest width or height; past it a typing error is likelier than a wish.
const LARGEST_SIDE: u32 = 65_536;

/// Pixels of an image.
const MOST_PIXELS: u64 = 1 << 28;

/// Reads `WxH`.
pub fn resolution(text: &str) -> Result<[u32; 2], String> {
    let wrong = || "write width x height, as in 640x480".to_string();
    let (width, height) = text.split_once(['x', 'X']).ok_or_else(wrong)?;
    let side = |text: &str| text.parse::<u32>().map_err(|_| wrong());
    check_resolution([side(width)?, side(height)?])
}

/// The same, if it is one that an image can have.
pub fn check_resolution(sides: [u32; 2]) -> Result<[u32; 2], String> {
    match sides.iter().all(|side| (1..=LARGEST_SIDE).contains(side)) {
        true => Ok(sides),
        false => Err(format!("each side is from 1 to {LARGEST_SIDE} pixels")),
    }
}

/// What is `None` comes from the scene.
#[derive(Clone, Debug, Default)]
pub struct Wishes {
    pub sensor: usize,
    pub spp: Option<u32>,
    pub seed: Option<u64>,
    /// Segments; `u32::MAX` for no limit.
    pub max_depth: Option<u32>,
    /// Width and height in pixels.
    pub resolution: Option<[u32; 2]>,
    pub method: Method,
    pub backend: Backend,
    pub standard_error: bool,
    pub groups: Option<u32>,
    pub threads: usize,
}

impl Wishes {
    /// The settings for `scene`, refusing what it has not or what no machine's memory holds.
    pub fn settle(&self, scene: &Scene) -> Result<Settings, Failure> {
        check_sensor(scene, self.sensor)?;
        let sensor = &scene.sensors[self.sensor];
        let settings = Settings {
            spp: self.spp.unwrap_or(sensor.sample_count).max(1),
            seed: self.seed.unwrap_or(sensor.seed.into()),
            threads: self.threads,
            max_depth: self.max_depth.unwrap_or(scene.integrator.max_depth),
            rr_depth: scene.integrator.rr_depth,
            hide_emitters: scene.integrator.hide_emitters,
            sensor: self.sensor,
            resolution: self.resolution,
            method: self.method,
            backend: self.backend,
            standard_error: self.standard_error,
            groups: self.groups.map(|count| Groups { count, only: None }),
        };
        let [width, height] = size(&settings, scene);
        if u64::from(width) * u64::from(height) > MOST_PIXELS {
            return Err(Failure::Input(format!(
                "{width}x{height} pixels are too many: at most {MOST_PIXELS}"
            )));
        }
        if settings.spp > MOST_SAMPLES {
            return Err(Failure::Input(format!(
                "{} samples a pixel are too many: at most {MOST_SAMPLES}",
                settings.spp
            )));
        }
        match self.groups {
            Some(count) if !settings.spp.is_multiple_of(count.max(1)) || count == 0 => {
                Err(Failure::Input(format!(
                    "groups: {} samples a pixel cannot be parted into {count} equal groups",
                    settings.spp
                )))
            }
            _ => Ok(settings),
        }
    }
}

/// Refuses a sensor that the scene has not.
pub fn check_sensor(scene: &Scene, sensor: usize) -> Result<(), Failure> {
    if sensor < scene.sensors.len() {
        return Ok(());
    }
    let ids: Vec<&str> = scene.sensors.iter().map(|s| s.id.as_str()).collect();
    Err(Failure::Input(format!(
        "sensor {sensor}: the scene has {}, counted from 0: {}",
        counted(ids.len(), "sensor"),
        ids.join(", ")
    )))
}

/// Width and height of the image in pixels.
pub fn size(settings: &Settings, scene: &Scene) -> [u32; 2] {
    let film = &scene.sensors[settings.sensor].film;
    settings.resolution.unwrap_or(film.crop_size)
}

/// Opens a target or an adjoint; one that is not of the size of the image is refused before it is decoded.
pub fn picture(file: &Path, size: [u32; 2]) -> Result<PictureFile, Failure> {
    let picture = PictureFile::open(file)?;
    match picture.size() {
        Some(found) => check_size(file, found, size).map(|()| picture),
        None => Ok(picture),
    }
}

/// Reads a target or an adjoint of the size of the image.
pub fn image(file: &Path, size: [u32; 2]) -> Result<Image, Failure> {
    let image = picture(file, size)?.read()?;
    check_size(file, [image.width as u64, image.height as u64], size)?;
    Ok(image)
}

fn check_size(file: &Path, found: [u64; 2], wanted: [u32; 2]) -> Result<(), Failure> {
    if found == wanted.map(u64::from) {
        return Ok(());
    }
    let ([found_width, found_height], [width, height]) = (found, wanted);
    Err(Failure::Input(format!(
        "{}: {found_width}x{found_height} pixels, the image rendered has {width}x{height}; give another picture or \
         resolution",
        file.display(),
    )))
}

/// `1 sensor`, `2 sensors`.
pub fn counted(count: usize, thing: &str) -> String {
    format!("{count} {thing}{}", if count == 1 { "" } else { "s" })
}
