//! How much memory things take: estimates from above, calibrated in `docs/batch.md`.

use crate::jobs::job::Job;
use crate::jobs::mode::Mode;
use crate::jobs::settings;
use crate::methods::Settings;
use crate::scene::Scene;

/// Bytes of a triangle in Embree: its own copy of the indices, and the hierarchy over robust
/// triangles.
const ACCEL_BYTES_A_TRIANGLE: u64 = 130;
/// Embree's device and a small scene in it.
const ACCEL_BYTES: u64 = 1 << 20;
/// Bytes of a triangle in the numbered geometry and the adjacency, the tables for making the latter
/// included.
const LINK_BYTES_A_TRIANGLE: u64 = 16 + 12 + 48;
/// Position, normal and texture coordinates.
const BYTES_A_VERTEX: u64 = 32;
/// A tile's store of paths, its image and its sums, in flight on a thread.
const TILE_BYTES: u64 = 6 << 20;
/// Vertices and texels that the paths of one tile touch, at most: what waits of a tile are these
/// alone.
const TOUCHED: u64 = 1 << 17;
/// Tiles whose results wait for being added, a thread: as `methods::stage` hands them out.
const WAITING_TILES: u64 = 8;

/// A scene as it stands in memory, ready to be traced.
pub fn of_scene(scene: &Scene) -> u64 {
    of_meshes(scene) + of_accel(scene) + of_links(scene) + 2 * of_texels(scene)
}

/// An acceleration structure over the scene's meshes.
pub fn of_accel(scene: &Scene) -> u64 {
    let [vertices, triangles] = counts(scene);
    ACCEL_BYTES + 12 * vertices + ACCEL_BYTES_A_TRIANGLE * triangles
}

/// A second scene in which `set` has changed something; `moves`: vertices among it.
pub fn of_changed(scene: &Scene, moves: bool) -> u64 {
    let copy = of_meshes(scene) + 2 * of_texels(scene);
    match moves {
        // A structure to refit, and a fresh one should refitting not do.
        true => copy + of_links(scene) + 2 * of_accel(scene),
        false => copy,
    }
}

fn of_meshes(scene: &Scene) -> u64 {
    let [vertices, triangles] = counts(scene);
    BYTES_A_VERTEX * vertices + 12 * triangles
}

fn of_links(scene: &Scene) -> u64 {
    let [vertices, triangles] = counts(scene);
    BYTES_A_VERTEX * vertices + LINK_BYTES_A_TRIANGLE * triangles
}

fn of_texels(scene: &Scene) -> u64 {
    12 * texels(scene)
}

fn counts(scene: &Scene) -> [u64; 2] {
    let count = |of: fn(&crate::scene::Mesh) -> usize| -> u64 {
        scene.meshes.iter().map(|mesh| of(mesh) as u64).sum()
    };
    [count(|m| m.positions.len()), count(|m| m.triangles.len())]
}

fn texels(scene: &Scene) -> u64 {
    scene.textures.iter().map(|t| t.texels.len() as u64).sum()
}

/// What a job takes beside its scene; `kept`: groups whose results are kept apart.
pub fn of_job(scene: &Scene, settings: &Settings, job: &Job, kept: u64) -> u64 {
    let [width, height] = settings::size(settings, scene).map(u64::from);
    let pixels = width * height;
    let groups = u64::from(settings.groups().count);
    let [vertices, _] = counts(scene);
    // Single sums of a group, double ones of all, and their squares.
    let image = pixels * (12 + 24 + if groups > 1 { 24 } else { 0 });
    // Pictures being written are copied once more, and packed.
    let written = pixels * 12 * 3;
    let tiles = settings.threads as u64 * (TILE_BYTES + WAITING_TILES * (2 << 16));
    let method = settings.method;
    // By a pilot it may be either.
    let displaces = method.displaces_scenes() || method.asks_a_pilot();
    let own = match job.mode {
        Mode::Render => image,
        Mode::Forward => {
            // The directions of all vertices, and their motion.
            let swept = 2 * image + 3 * 12 * vertices;
            let of_images = pixels * (24 + 12) * (groups + 1) + of_scene(scene);
            match (displaces, method.asks_a_pilot()) {
                (true, false) => of_images,
                (true, true) => of_images.max(swept),
                (false, _) => swept,
            }
        }
        Mode::Backward => {
            let smooth = scene.meshes.iter().any(|m| m.normals.vertex().is_some());
            let numbers = vertices * if smooth { 2 } else { 1 } + texels(scene);
            let waiting = WAITING_TILES * 16 * numbers.min(TOUCHED);
            let scratch = settings.threads as u64 * (17 * numbers + waiting);
            // Double sums of every group, then single ones, then those by parameter.
            let swept = 2 * image + numbers * (groups * (24 + 12 + 12) + 24) + scratch;
            // The images of one displaced scene, beside the groups' gradients by all else.
            let of_images = pixels * 12 * (groups + 1) + of_scene(scene) + numbers * groups * 12;
            match displaces {
                true => swept.max(of_images),
                false => swept,
            }
        }
    };
    let set = match job.set.0.is_empty() {
        true => 0,
        false => of_changed(scene, true),
    };
    // As tensors, and once more as the file that is written.
    let apart = 2 * kept * (2 * 12 * pixels + 4 * (3 * vertices + 3 * texels(scene)));
    own + written + tiles + set + apart
}
