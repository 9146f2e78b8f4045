//! A mesh turning before the camera, in even light.

use crate::jobs::failure::Failure;
use crate::methods::{EngineError, Prepared, Progress, Settings};
use crate::optimize::problem::Problem;
use crate::output::png;
use crate::scene::{
    AreaLight, Bsdf, Environment, Film, Filter, Integrator, Lens, Material, Mesh, Normals, Scene,
    Sensor, Texture,
};
use glam::{Affine3A, Vec2, Vec3};

/// Width and height in pixels, samples a pixel, frames a second.
const SIDE: u32 = 192;
const SPP: u32 = 32;
const FRAMES_PER_SECOND: u16 = 12;
/// Horizontal opening angle; the mesh's sphere fills most of it.
const X_FOV_RAD: f32 = 0.6;

/// An animated PNG of so many pictures, once around the vertical axis of the first camera.
pub fn turntable(
    problem: &Problem,
    mesh: &Mesh,
    pictures: u64,
    progress: &dyn Progress,
) -> Result<Vec<u8>, Failure> {
    let up = up(problem);
    let mut frames = Vec::new();
    for number in 0..pictures {
        let angle_rad = std::f32::consts::TAU * number as f32 / pictures as f32;
        let scene = scene(mesh, up, angle_rad);
        let settings = Settings {
            spp: SPP,
            seed: 1,
            sensor: 0,
            resolution: None,
            max_depth: 3,
            hide_emitters: true,
            ..problem.settings.clone()
        };
        let machine = &problem.machine;
        let prepared = Prepared::with_workers(&scene, &machine.workers, machine.backend, &|| {
            progress.cancelled()
        })
        .and_then(|prepared| prepared.render(&settings, progress))
        .map_err(|error: EngineError| Failure::from_engine(error, None))?;
        frames.push(png::srgb_bytes(&prepared.image));
    }
    let side = SIDE as usize;
    png::animation(side, side, &frames, FRAMES_PER_SECOND)
        .map_err(|error| Failure::System(error.to_string()))
}

/// The axis that the cameras' up is nearest to.
fn up(problem: &Problem) -> Vec3 {
    let sensors = problem.base.scene.sensors.iter();
    let sum: Vec3 = sensors.map(|s| Vec3::from(s.to_world.matrix3.y_axis)).sum();
    let axes = [
        Vec3::Y,
        Vec3::Z,
        Vec3::X,
        Vec3::NEG_Y,
        Vec3::NEG_Z,
        Vec3::NEG_X,
    ];
    axes.into_iter()
        .max_by(|a, b| a.dot(sum).total_cmp(&b.dot(sum)))
        .unwrap_or(Vec3::Y)
}

/// The mesh in clay, a lamp above the camera, a dim sky.
fn scene(mesh: &Mesh, up: Vec3, angle_rad: f32) -> Scene {
    let points = || mesh.positions.iter().copied();
    let low = points().fold(Vec3::splat(f32::INFINITY), Vec3::min);
    let high = points().fold(Vec3::splat(f32::NEG_INFINITY), Vec3::max);
    let middle = 0.5 * (low + high);
    let radius = (0.5 * (high - low).length()).max(1e-6);
    let side = up.any_orthonormal_vector();
    let around = glam::Quat::from_axis_angle(up, angle_rad) * side;
    let away = (around + 0.5 * up).normalize();
    let eye = middle + away * radius / (0.5 * X_FOV_RAD).sin();
    let forward = -away;
    let left = up.cross(forward).normalize();
    let above = forward.cross(left);
    let lamp_at = middle + radius * (4.0 * away + 4.0 * above + 2.0 * left);
    let material = |key: &str, reflectance| Material {
        key: key.into(),
        bsdf: Bsdf::Diffuse { reflectance },
        two_sided: true,
        relief: None,
    };
    let clay = Mesh {
        material: 0,
        area_light: None,
        ..mesh.clone()
    };
    Scene {
        meshes: vec![clay, lamp(lamp_at, middle, radius)],
        materials: vec![material("clay", 0), material("black", 3)],
        textures: vec![
            Texture::constant("clay".into(), [0.7, 0.66, 0.6]),
            Texture::constant("lamp".into(), [12.0; 3]),
            Texture::constant("sky".into(), [0.35, 0.37, 0.4]),
            Texture::constant("black".into(), [0.0; 3]),
        ],
        area_lights: vec![AreaLight {
            mesh: 1,
            radiance: 1,
            key: "lamp".into(),
        }],
        instances: Vec::new(),
        delta_lights: Vec::new(),
        environment: Some(Environment {
            key: "sky".into(),
            radiance: 2,
            map: None,
        }),
        sensors: vec![Sensor {
            id: "camera".into(),
            to_world: Affine3A::from_mat3_translation(
                glam::Mat3::from_cols(left, above, forward),
                eye,
            ),
            x_fov_rad: X_FOV_RAD,
            lens: Lens::Pinhole,
            near_clip: 1e-2 * radius,
            far_clip: 1e3 * radius,
            principal_point_offset: Vec2::ZERO,
            film: Film {
                width: SIDE,
                height: SIDE,
                crop_offset: [0; 2],
                crop_size: [SIDE; 2],
                filter: Filter::Gaussian { stddev: 0.5 },
                sample_border: false,
            },
            sample_count: SPP,
            seed: 0,
        }],
        integrator: Integrator {
            max_depth: 3,
            rr_depth: 5,
            hide_emitters: true,
        },
        warnings: Vec::new(),
        hash: 0,
    }
}

/// A square that looks at a point.
fn lamp(at: Vec3, target: Vec3, radius: f32) -> Mesh {
    let normal = (target - at).normalize();
    let [x, y] = <[Vec3; 2]>::from(normal.any_orthonormal_pair()).map(|axis| axis * radius);
    Mesh {
        id: "lamp".into(),
        positions: vec![at - x - y, at + x - y, at + x + y, at - x + y],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        normals: Normals::Flat,
        material: 1,
        area_light: Some(0),
        ..Mesh::default()
    }
}
