//! Central finite differences with common random numbers: the reference every other method is measured against.
//!
//! The image is rendered at θ ± h and θ ± 2h with the same random numbers and the two central differences are combined
//! so that the error of order h² vanishes (Richardson): (4·D(h) − D(2h))/3. Russian roulette is off, since a path that
//! ends because θ moved is a jump that no derivative has.

use super::render::group_images;
use super::{
    EngineError, ForwardGradient, Image, Prepared, Progress, Settings, Statistics, Workers,
};
use crate::paths::camera::Camera;
use crate::scene::parameters::{Parameter, displace, tangent};
use crate::scene::{Rgb, Scene};

/// Renderings that one difference takes.
pub const IMAGES: usize = 4;
/// Pixels that the fastest point moves at the step h.
const STEP_PIXELS: f64 = 0.1;
/// Step for parameters that move nothing: the image is linear or smooth in them.
const STEP_COLOUR: f64 = 0.01;
/// And no more than this part of the way to the nearest limit.
const STEP_ROOM: f64 = 0.2;

/// The gradient image along `direction`, by differences.
pub fn forward(
    scene: &Scene,
    workers: &Workers,
    settings: &Settings,
    direction: &[(Parameter, Vec<f32>)],
    progress: &dyn Progress,
) -> Result<ForwardGradient, EngineError> {
    let mut statistics = Statistics::default();
    let refused = |e: crate::scene::SceneError| EngineError::Refused(e.to_string());
    let step = step(scene, settings, direction)?;
    statistics.notes.push(format!(
        "finite differences with steps of {step:.3e} and twice that"
    ));
    let settings = Settings {
        rr_depth: u32::MAX,
        ..settings.clone()
    };
    let offsets: [f64; IMAGES] = [-2.0, -1.0, 1.0, 2.0];
    // D = Σ weight·I(θ + offset·h)/h.
    let weights = [1.0, -8.0, 8.0, -1.0].map(|w| w / (12.0 * step));
    let mut groups: Vec<Vec<[f64; 3]>> = Vec::new();
    let mut mean: Vec<[f64; 3]> = Vec::new();
    let mut size = [0, 0];
    for (part, (offset, weight)) in offsets.into_iter().zip(weights).enumerate() {
        let moved = displace(scene, direction, offset * step).map_err(refused)?;
        let part_progress = Part {
            whole: progress,
            part: part as u64,
            parts: offsets.len() as u64,
        };
        let prepared =
            Prepared::with_workers(&moved, workers, settings.backend, &|| progress.cancelled())?;
        statistics.spend("build", prepared.build_seconds);
        let (images, image_size) =
            group_images(&prepared, &settings, &part_progress, &mut statistics)?;
        size = image_size;
        groups.resize(images.len(), vec![[0.0; 3]; size[0] * size[1]]);
        mean.resize(size[0] * size[1], [0.0; 3]);
        let share = 1.0 / (offsets.len() * images.len()) as f64;
        for (group, image) in groups.iter_mut().zip(&images) {
            for ((sum, average), value) in group.iter_mut().zip(&mut mean).zip(image) {
                for c in 0..3 {
                    sum[c] += weight * value[c] as f64;
                    average[c] += share * value[c] as f64;
                }
            }
        }
    }
    let image = |pixels: Vec<Rgb>| Image {
        width: size[0],
        height: size[1],
        pixels,
    };
    let n = groups.len() as f64;
    let average = |i: usize, c: usize| groups.iter().map(|g| g[i][c]).sum::<f64>() / n;
    let pixels = size[0] * size[1];
    let gradient = (0..pixels)
        .map(|i| std::array::from_fn(|c| average(i, c) as f32))
        .collect();
    let stderr = (groups.len() > 1).then(|| {
        let error = |i: usize, c: usize| {
            let centre = average(i, c);
            let squares: f64 = groups.iter().map(|g| (g[i][c] - centre).powi(2)).sum();
            (squares / (n - 1.0) / n).sqrt() as f32
        };
        image(
            (0..pixels)
                .map(|i| std::array::from_fn(|c| error(i, c)))
                .collect(),
        )
    });
    Ok(ForwardGradient {
        image: image(mean.iter().map(|p| p.map(|x| x as f32)).collect()),
        gradient: image(gradient),
        stderr,
        statistics,
    })
}

/// A step along the direction that moves the fastest visible point by a tenth of a pixel.
pub fn step(
    scene: &Scene,
    settings: &Settings,
    direction: &[(Parameter, Vec<f32>)],
) -> Result<f64, EngineError> {
    let named: Vec<(&str, &[f32])> = direction
        .iter()
        .map(|(p, v)| (p.key.as_str(), v.as_slice()))
        .collect();
    let tangent =
        tangent(scene, &named, settings.sensor).map_err(|e| EngineError::Refused(e.to_string()))?;
    let camera = Camera::new(&scene.sensors[settings.sensor]);
    let width = settings
        .resolution
        .map_or(scene.sensors[settings.sensor].film.width, |r| r[0]) as f64;
    // Pixels per unit of (velocity over depth).
    let pixels = width / (2.0 * camera.tan_half_x_fov);
    let mut fastest: f64 = 0.0;
    for (mesh, velocities) in scene.meshes.iter().zip(&tangent.positions) {
        let Some(velocities) = velocities else {
            continue;
        };
        for (p, v) in mesh.positions.iter().zip(velocities) {
            let distance = (*p - camera.origin).length() as f64;
            fastest = fastest.max(v.length() as f64 / distance.max(1e-6) * pixels);
        }
    }
    if let Some(motion) = &tangent.camera {
        let nearest = scene
            .meshes
            .iter()
            .flat_map(|m| &m.positions)
            .map(|p| (*p - camera.origin).dot(camera.axes[2]))
            .filter(|depth| *depth > camera.near_clip)
            .fold(f32::INFINITY, f32::min) as f64;
        let by_translation = motion.translation.length() as f64 / nearest;
        let by_turn = motion.rotation.length() as f64 + (motion.x_fov_deg as f64).to_radians();
        fastest = fastest.max((by_translation + by_turn) * pixels);
    }
    Ok(if fastest > 0.0 && fastest.is_finite() {
        STEP_PIXELS / fastest
    } else {
        colour_step(scene, &tangent)
    })
}

/// A step along which no number leaves its limits: a roughness of 0.01 cannot change by 0.02.
fn colour_step(scene: &Scene, tangent: &crate::scene::SceneDifferential) -> f64 {
    let mut step = STEP_COLOUR;
    for (texture, changes) in scene.textures.iter().zip(&tangent.texels) {
        let [low, high] = texture.limits;
        let values = texture.texels.iter().flatten();
        for (value, by) in values.zip(changes.iter().flatten().flatten()) {
            let room = (value - low).min(high - value);
            if room > 0.0 && *by != 0.0 {
                step = step.min(STEP_ROOM * f64::from(room / by.abs()));
            }
        }
    }
    step
}

/// Progress of one of several renderings.
struct Part<'a> {
    whole: &'a dyn Progress,
    part: u64,
    parts: u64,
}

impl Progress for Part<'_> {
    fn advance(&self, done: u64, total: u64) {
        self.whole
            .advance(self.part * total + done, self.parts * total);
    }
    fn cancelled(&self) -> bool {
        self.whole.cancelled()
    }
}
