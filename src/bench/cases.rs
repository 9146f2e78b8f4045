//! What is measured on: scenes given, meshes given, meshes generated.

use super::meshes::{Class, generate};
use crate::scene::parameters::{self, Parameter};
use crate::scene::source::{Disk, FileSource, read_file};
use crate::scene::{Mesh, Scene, SceneError, load_from};
use crate::trace::MeshView;
use glam::Vec3;
use std::io;
use std::path::{Path, PathBuf};

/// The scene around a mesh, and where it pretends to be.
const SURROUNDINGS: &str = include_str!("scene.xml");
const SURROUNDINGS_PATH: &str = "<bench>.xml";
/// The mesh's shape in it.
const SUBJECT: &str = "subject";

/// A scene with a name.
pub struct Case {
    pub name: String,
    pub scene: Scene,
}

impl Case {
    /// A generated mesh in the usual surroundings.
    pub fn generated(class: Class, count: usize) -> Result<Self, SceneError> {
        let name = Class::ALL.iter().find(|c| c.0 == class).map_or("", |c| c.1);
        let mut scene = load_from(&WithSurroundings, SURROUNDINGS_PATH, &[])?;
        if let Some(subject) = subject(&mut scene) {
            (subject.positions, subject.triangles) = generate(class, count);
            subject.uvs.clear();
        }
        Ok(Self {
            name: format!("{name}, {}", short_count(count)),
            scene,
        })
    }

    /// A scene file, or a mesh file in the usual surroundings.
    pub fn file(path: &Path) -> Result<Self, SceneError> {
        let name = path.file_name().unwrap_or(path.as_os_str());
        let name = name.to_string_lossy().into_owned();
        let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
        let scene = match extension.as_deref() {
            Some(format @ ("ply" | "obj")) => {
                // A file that is not there is no fault of the surroundings, which would be named.
                read_file(&Disk, path)?;
                let defines = [
                    ("format".to_string(), format.to_string()),
                    (
                        "file".to_string(),
                        absolute(path).to_string_lossy().into_owned(),
                    ),
                ];
                let mut scene = load_from(&WithSurroundings, SURROUNDINGS_PATH, &defines)?;
                if let Some(subject) = subject(&mut scene) {
                    into_unit_ball(&mut subject.positions);
                }
                scene
            }
            _ => load_from(&Disk, path, &[])?,
        };
        Ok(Self { name, scene })
    }

    /// Views of its meshes.
    pub fn views(&self) -> Vec<MeshView<'_>> {
        let meshes = self.scene.meshes.iter();
        meshes
            .map(|mesh| MeshView {
                positions: &mesh.positions,
                triangles: &mesh.triangles,
            })
            .collect()
    }

    pub fn triangle_count(&self) -> usize {
        self.scene.meshes.iter().map(|m| m.triangles.len()).sum()
    }

    /// What gradients are taken by: the first shape's translation to the right, the subject's if
    /// there is one.
    pub fn direction(&self) -> Option<Vec<(Parameter, Vec<f32>)>> {
        let named = |id: &str| parameters::find(&self.scene, &format!("{id}.translation")).ok();
        let ids = self.scene.meshes.iter().map(|m| m.id.as_str());
        let parameter = named(SUBJECT).or_else(|| ids.into_iter().find_map(named))?;
        Some(vec![(parameter, vec![1.0, 0.0, 0.0])])
    }
}

/// The disk, and the surroundings.
struct WithSurroundings;

impl FileSource for WithSurroundings {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        match path.to_str() {
            Some(SURROUNDINGS_PATH) => Ok(SURROUNDINGS.into()),
            _ => Disk.read(path),
        }
    }

    fn exists(&self, path: &Path) -> bool {
        path == Path::new(SURROUNDINGS_PATH) || Disk.exists(path)
    }
}

fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.into())
}

fn subject(scene: &mut Scene) -> Option<&mut Mesh> {
    scene.meshes.iter_mut().find(|mesh| mesh.id == SUBJECT)
}

/// Moves and scales a mesh so that its bounding box has its corners on the unit sphere.
fn into_unit_ball(positions: &mut [Vec3]) {
    let low = positions
        .iter()
        .copied()
        .reduce(Vec3::min)
        .unwrap_or_default();
    let high = positions
        .iter()
        .copied()
        .reduce(Vec3::max)
        .unwrap_or_default();
    let (centre, size) = ((low + high) / 2.0, (high - low).length());
    if size > 0.0 {
        positions
            .iter_mut()
            .for_each(|p| *p = (*p - centre) * (2.0 / size));
    }
}

/// `20 k`, `1.8 M`.
pub fn short_count(count: usize) -> String {
    match count {
        0..1_000 => count.to_string(),
        1_000..1_000_000 => format!("{} k", count as f64 / 1e3),
        _ => format!("{} M", count as f64 / 1e6),
    }
}
