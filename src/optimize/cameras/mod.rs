//! Cameras that other programs have found, as sensors of the scene.
//!
//! Here a camera looks along +z, +x is to the left of its image and +y up. NeRF's look along −z with
//! +x to the right and +y up, COLMAP's along +z with +x to the right and +y down.

mod colmap;
mod found;
mod lens;
mod transforms;

use super::config::{Cameras, MaskFrom};
use super::problem::view::Wanted;
use crate::jobs::failure::Failure;
use crate::output::picture::PictureFile;
use crate::scene::{Film, Scene, Sensor};
use found::Found;
use glam::Affine3A;
use std::path::Path;

/// Adds the cameras to the scene, and says which views they are. Of a known scene, whose targets
/// are rendered, no pictures are looked for.
pub fn add(cameras: &Cameras, scene: &mut Scene, has_truth: bool) -> Result<Vec<Wanted>, Failure> {
    let (found, place, alpha) = match cameras {
        Cameras::Transforms { file, place, alpha } => (transforms::read(file)?, place, *alpha),
        Cameras::Colmap {
            folder,
            images,
            place,
            alpha,
        } => (colmap::read(folder, images)?, place, *alpha),
    };
    let Some(like) = scene.sensors.first().cloned() else {
        return Err(Failure::Input(format!("{place}: the scene has no sensor")));
    };
    let mut wanted = Vec::new();
    for camera in found {
        let size = match (camera.lens.size, has_truth) {
            (Some(size), _) => size,
            (None, true) => like.film.crop_size,
            (None, false) => size_of(&camera.picture)?,
        };
        wanted.push(Wanted {
            place: place.clone(),
            sensor: scene.sensors.len(),
            target: (!has_truth).then(|| camera.picture.clone()),
            mask: (alpha && !has_truth).then_some(MaskFrom::Alpha),
        });
        scene.sensors.push(sensor(camera, size, &like));
    }
    Ok(wanted)
}

/// With the filter, the clips and the samples of another sensor.
fn sensor(camera: Found, size: [u32; 2], like: &Sensor) -> Sensor {
    let (x_fov_rad, principal_point_offset) = camera.lens.settle(size);
    let to_world = camera.to_world;
    Sensor {
        id: camera.name,
        to_world: Affine3A::from_mat3_translation(
            to_world.matrix3.as_mat3(),
            to_world.translation.as_vec3(),
        ),
        x_fov_rad,
        principal_point_offset,
        film: Film {
            width: size[0],
            height: size[1],
            crop_offset: [0; 2],
            crop_size: size,
            ..like.film.clone()
        },
        ..like.clone()
    }
}

fn size_of(picture: &Path) -> Result<[u32; 2], Failure> {
    let size = PictureFile::open(picture)?.size();
    let size = size.and_then(|[w, h]| Some([u32::try_from(w).ok()?, u32::try_from(h).ok()?]));
    size.ok_or_else(|| {
        let what = "its size cannot be told; say w and h in transforms.json";
        Failure::Input(format!("{}: {what}", picture.display()))
    })
}
