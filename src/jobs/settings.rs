//! From what was asked for, in options or in a job, to the engine's settings.

use super::failure::Failure;
use super::shown::counted;
use crate::methods::{Constants, Groups, Method, Settings};
use crate::scene::Scene;
use crate::trace::Backend;

/// Camera paths per pixel; more are better had from several seeds.
pub const MOST_SAMPLES: u32 = 1 << 20;

/// Pixels of an image.
const MOST_PIXELS: u64 = 1 << 28;

/// What is `None` comes from the scene.
#[derive(Clone, Debug, Default)]
pub struct RequestedSettings {
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

impl RequestedSettings {
    /// The settings for `scene`, refusing what it has not or what no machine's memory holds.
    pub fn settle(&self, scene: &Scene) -> Result<Settings, Failure> {
        check_sensor(scene, self.sensor)?;
        let sensor = &scene.sensors[self.sensor];
        let settings = Settings {
            constants: Constants::default(),
            part_of_film: None,
            counts_tiles: false,
            noise: None,
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
