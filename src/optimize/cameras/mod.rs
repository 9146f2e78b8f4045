//! Cameras that other programs have found, as sensors of the scene.
//!
//! Here a camera looks along +z, +x is to the left of its image and +y up. NeRF's look along −z
//! with +x to the right and +y up, COLMAP's along +z with +x to the right and +y down.

mod colmap;
mod found;
mod lens;
mod transforms;

use super::config::{Cameras, CamerasFrom, MaskFrom};
use super::problem::view::Wanted;
use crate::jobs::failure::Failure;
use crate::output::picture::PictureFile;
use crate::scene::{Film, Scene, Sensor};
use found::Found;
use glam::Affine3A;
use std::collections::BTreeSet;
use std::path::Path;

/// Adds the cameras to the scene, and says which views they are. Where targets are rendered, no
/// pictures are looked for.
pub fn add(
    cameras: &Cameras,
    scene: &mut Scene,
    is_rendered: bool,
) -> Result<Vec<Wanted>, Failure> {
    let wrong = |what: String| Failure::Input(format!("{}: {what}", cameras.place));
    if let Some(file) = cameras.from.files().iter().find(|file| !file.exists()) {
        return Err(wrong(format!("{}: there is no such file", file.display())));
    }
    let found = match &cameras.from {
        CamerasFrom::Transforms(file) => transforms::read(file)?,
        CamerasFrom::Colmap {
            folder,
            images,
            masks,
        } => colmap::read(folder, images, masks.as_deref())?,
    };
    let Some(like) = scene.sensors.first().cloned() else {
        return Err(wrong("the scene has no sensor".into()));
    };
    let ids = ids(&found);
    let mut wanted = Vec::new();
    for (camera, id) in found.into_iter().zip(ids) {
        if scene.sensors.iter().any(|other| other.id == id) {
            return Err(wrong(format!(
                "two cameras are called \"{id}\"; rename a picture, or the scene's sensor"
            )));
        }
        let size = match (camera.lens.size, is_rendered) {
            (Some(size), _) => size,
            (None, true) => like.film.crop_size,
            (None, false) => size_of(&camera.picture)?,
        };
        let mask = match cameras.alpha {
            true => Some(MaskFrom::Alpha),
            false => camera.mask.clone().map(MaskFrom::File),
        };
        wanted.push(Wanted {
            place: cameras.place.clone(),
            sensor: scene.sensors.len(),
            target: (!is_rendered).then(|| camera.picture.clone()),
            mask: mask.filter(|_| !is_rendered),
        });
        scene.sensors.push(sensor(camera, id, size, &like));
    }
    Ok(wanted)
}

/// The names of the pictures without endings, and without folders if they differ without them.
fn ids(found: &[Found]) -> Vec<String> {
    let stem = |camera: &Found| {
        let stem = camera.named.file_stem().unwrap_or_default();
        stem.to_string_lossy().into_owned()
    };
    let path = |camera: &Found| {
        let path = camera.named.with_extension("");
        path.to_string_lossy().into_owned()
    };
    let stems: Vec<String> = found.iter().map(stem).collect();
    match stems.iter().collect::<BTreeSet<_>>().len() == found.len() {
        true => stems,
        false => found.iter().map(path).collect(),
    }
}

/// With the filter, the clips and the samples of another sensor.
fn sensor(camera: Found, id: String, size: [u32; 2], like: &Sensor) -> Sensor {
    let (x_fov_rad, principal_point_offset) = camera.lens.settle(size);
    let to_world = camera.to_world;
    Sensor {
        id,
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
