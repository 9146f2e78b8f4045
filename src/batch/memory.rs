//! How much memory there is, and how much things take: estimates from above, calibrated in `docs/batch.md`.

use super::job::{Job, Mode};
use super::settings;
use crate::methods::{Settings, group_count};
use crate::scene::Scene;
use std::fs;
use std::path::Path;

/// Bytes of a triangle in Embree: its own copy of the indices, and the hierarchy over robust triangles.
const ACCEL_BYTES_A_TRIANGLE: u64 = 130;
/// Embree's device and a small scene in it.
const ACCEL_BYTES: u64 = 1 << 20;
/// Bytes of a triangle in the numbered geometry and the adjacency, the tables for making the latter included.
const LINK_BYTES_A_TRIANGLE: u64 = 16 + 12 + 48;
/// Position, normal and texture coordinates.
const BYTES_A_VERTEX: u64 = 32;
/// A tile's store of paths, its image and its sums, in flight on a thread.
const TILE_BYTES: u64 = 6 << 20;
/// Vertices and texels that the paths of one tile touch, at most: what waits of a tile are these alone.
const TOUCHED: u64 = 1 << 17;
/// Tiles whose results wait for being added, a thread: as `methods::stage` hands them out.
const WAITING_TILES: u64 = 8;

/// Bytes the process may use: the machine's, or the limit of a control group or of its address space (`ulimit -v`).
pub fn of_machine() -> u64 {
    let machine = kilobytes(Path::new("/proc/meminfo"), "MemTotal:").unwrap_or(4 << 30);
    let groups = fs::read_to_string("/proc/self/cgroup").unwrap_or_default();
    let groups = groups.lines().filter_map(of_control_group);
    groups.chain(of_address_space()).fold(machine, u64::min)
}

/// The least limit of a control group, as a line of `/proc/self/cgroup` names it, and of those it is in.
fn of_control_group(line: &str) -> Option<u64> {
    let mut fields = line.splitn(3, ':').skip(1);
    let (controllers, group) = (fields.next()?, fields.next()?);
    let (root, file) = match controllers {
        "" => ("/sys/fs/cgroup", "memory.max"),
        names if names.split(',').any(|name| name == "memory") => {
            ("/sys/fs/cgroup/memory", "memory.limit_in_bytes")
        }
        _ => return None,
    };
    let number = |path: &Path| -> Option<u64> {
        let text = fs::read_to_string(path.join(file)).ok()?;
        text.trim().parse().ok()
    };
    let group = Path::new(root).join(group.trim_start_matches('/'));
    let all = group.ancestors().take_while(|path| path.starts_with(root));
    all.filter_map(number).min()
}

/// Bytes of memory that the address space has room for, if it is limited: what is in memory, and what may still be mapped.
pub fn of_address_space() -> Option<u64> {
    let limits = fs::read_to_string("/proc/self/limits").ok()?;
    let line = limits
        .lines()
        .find_map(|line| line.strip_prefix("Max address space"))?;
    let limit: u64 = line.split_whitespace().next()?.parse().ok()?;
    let mapped = kilobytes(Path::new("/proc/self/status"), "VmSize:")?;
    Some(limit.saturating_sub(mapped) + resident()?)
}

/// Bytes the process has now.
pub fn resident() -> Option<u64> {
    kilobytes(Path::new("/proc/self/status"), "VmRSS:")
}

/// The most bytes the process has held, where the system tells.
pub fn peak() -> Option<u64> {
    kilobytes(Path::new("/proc/self/status"), "VmHWM:")
}

fn kilobytes(path: &Path, name: &str) -> Option<u64> {
    let text = fs::read_to_string(path).ok()?;
    let line = text.lines().find_map(|line| line.strip_prefix(name))?;
    let kilobytes: u64 = line.trim().strip_suffix("kB")?.trim().parse().ok()?;
    Some(kilobytes * 1024)
}

/// Seconds of all cores together that the process has used.
pub fn processor_seconds() -> Option<f64> {
    // Fields 14 and 15 after the name in parentheses, which may hold spaces; in hundredths, as Linux has told them
    // to user space on every architecture since 2.6.
    let text = fs::read_to_string("/proc/self/stat").ok()?;
    let fields: Vec<&str> = text.rsplit_once(')')?.1.split_whitespace().collect();
    let ticks: f64 = fields.get(11)?.parse::<f64>().ok()? + fields.get(12)?.parse::<f64>().ok()?;
    Some(ticks / 100.0)
}

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
    let groups = match (settings.groups, settings.standard_error) {
        (Some(groups), _) => u64::from(groups.count),
        (None, true) => u64::from(group_count(settings.spp)),
        (None, false) => 1,
    };
    let [vertices, _] = counts(scene);
    // Single sums of a group, double ones of all, and their squares.
    let image = pixels * (12 + 24 + if groups > 1 { 24 } else { 0 });
    // Pictures being written are copied once more, and packed.
    let written = pixels * 12 * 3;
    let tiles = settings.threads as u64 * (TILE_BYTES + WAITING_TILES * (2 << 16));
    let own = match job.mode {
        Mode::Render => image,
        Mode::Forward if job.is_fd() => pixels * (24 + 12) * (groups + 1) + of_scene(scene),
        // The directions of all vertices, and their motion.
        Mode::Forward => 2 * image + 3 * 12 * vertices,
        Mode::Backward => {
            let smooth = scene.meshes.iter().any(|m| m.normals.vertex().is_some());
            let numbers = vertices * if smooth { 2 } else { 1 } + texels(scene);
            let waiting = WAITING_TILES * 16 * numbers.min(TOUCHED);
            let scratch = settings.threads as u64 * (17 * numbers + waiting);
            // Double sums of every group, then single ones, then those by parameter.
            2 * image + numbers * (groups * (24 + 12 + 12) + 24) + scratch
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

/// Bytes as people read them.
pub fn shown(bytes: u64) -> String {
    match bytes {
        b if b >= 10 << 30 => format!("{:.0} GB", b as f64 / f64::from(1 << 30)),
        b if b >= 1 << 30 => format!("{:.1} GB", b as f64 / f64::from(1 << 30)),
        b => format!("{} MB", b.div_ceil(1 << 20)),
    }
}

#[cfg(test)]
mod tests {
    #[test]
    #[cfg(target_os = "linux")]
    fn the_system_tells() {
        assert!(super::peak().is_some_and(|bytes| bytes > 100_000));
        assert!(super::resident() <= super::peak());
        assert!(super::of_machine() > 100_000_000);
        assert!(super::processor_seconds().is_some_and(|s| (0.0..1e6).contains(&s)));
    }
}
