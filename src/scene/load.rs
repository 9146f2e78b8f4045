//! From a scene file to a [`Scene`].

use super::camera::{self, DEFAULT_INTEGRATOR};
use super::data::{AreaLight, Environment, Scene, Texture};
use super::error::SceneError;
use super::material::{Materials, radiance};
use super::names::Names;
use super::shape;
use super::source::{Disk, FileSource, Fnv1a};
use super::xml::{Object, Tree, read_tree};
use std::collections::HashSet;
use std::path::Path;

/// Loads the scene file at `path`; `defines` are the `-D name=value`.
pub fn load(path: impl AsRef<Path>, defines: &[(String, String)]) -> Result<Scene, SceneError> {
    load_from(&Disk, path, defines)
}

/// Loads a scene from any source of files.
pub fn load_from(
    files: &dyn FileSource,
    path: impl AsRef<Path>,
    defines: &[(String, String)],
) -> Result<Scene, SceneError> {
    let mut hash = Fnv1a::default();
    let tree = read_tree(files, path.as_ref(), defines, &mut hash)?;
    let mut loader = Loader::new(&tree, files, hash);
    loader.everything()?;
    let root = &tree.objects[0];
    if loader.scene.sensors.is_empty() {
        return Err(
            root.error("the scene has no sensor; add <sensor type=\"perspective\">…</sensor>")
        );
    }
    loader.warn_unread();
    let mut scene = loader.scene;
    scene.materials = loader.materials.list;
    scene.textures = loader.materials.textures;
    scene.hash = loader.hash.0;
    Ok(scene)
}

struct Loader<'a> {
    tree: &'a Tree,
    files: &'a dyn FileSource,
    hash: Fnv1a,
    scene: Scene,
    materials: Materials,
    names: Names,
    has_integrator: bool,
    /// Shapes, sensors and so on that were already met, and by `<ref>` again.
    met: HashSet<usize>,
}

impl<'a> Loader<'a> {
    fn new(tree: &'a Tree, files: &'a dyn FileSource, hash: Fnv1a) -> Self {
        Self {
            tree,
            files,
            hash,
            scene: Scene {
                meshes: Vec::new(),
                materials: Vec::new(),
                textures: Vec::new(),
                area_lights: Vec::new(),
                delta_lights: Vec::new(),
                environment: None,
                sensors: Vec::new(),
                integrator: DEFAULT_INTEGRATOR,
                warnings: Vec::new(),
                hash: 0,
            },
            materials: Materials::default(),
            names: Names::new(tree.objects.iter().filter_map(|o| o.id.as_deref())),
            has_integrator: false,
            met: HashSet::new(),
        }
    }

    fn everything(&mut self) -> Result<(), SceneError> {
        let tree = self.tree;
        let root = &tree.objects[0];
        for child in &root.children {
            let object = &tree.objects[child.object];
            if object.tag != "bsdf" && !self.met.insert(child.object) {
                let what = format!("{} is already part of the scene", object.shown());
                return Err(SceneError::at(&child.place, what));
            }
            match object.tag {
                "bsdf" => {}
                "integrator" => {
                    if std::mem::replace(&mut self.has_integrator, true) {
                        return Err(SceneError::at(
                            &child.place,
                            "a scene has only one integrator",
                        ));
                    }
                    camera::no_children(tree, object)?;
                    self.scene.integrator = camera::integrator(object)?;
                }
                "sensor" => {
                    let id = self.names.of(object);
                    self.scene.sensors.push(camera::sensor(tree, object, id)?);
                }
                "shape" => self.shape(object)?,
                "emitter" => self.environment(object)?,
                _ => return Err(camera::cannot_stand_inside(child, object, root)),
            }
        }
        for child in &root.children {
            let object = &tree.objects[child.object];
            if object.tag == "bsdf" {
                let key = self.names.of(object);
                self.materials.unused(tree, child.object, &key)?;
            }
        }
        Ok(())
    }

    fn shape(&mut self, object: &Object) -> Result<(), SceneError> {
        let tree = self.tree;
        let id = self.names.of(object);
        let mut shape = shape::shape(tree, object, self.files, &mut self.hash)?;
        self.scene.warnings.append(&mut shape.remarks);
        let mesh_index = self.scene.meshes.len();
        let bsdf_key = format!("{id}.bsdf");
        shape.mesh.material = match shape.bsdf {
            Some(child) => self.materials.bsdf(tree, child.object, &bsdf_key)?,
            None => self
                .materials
                .add_default(&bsdf_key, shape.emitter.is_some()),
        };
        if let Some(child) = shape.emitter {
            if !self.met.insert(child.object) {
                let what = "an area emitter belongs to one shape only";
                return Err(SceneError::at(&child.place, what));
            }
            shape.mesh.area_light = Some(self.scene.area_lights.len());
            let key = format!("{id}.emitter");
            let radiance = Texture::constant(
                format!("{key}.radiance"),
                radiance(tree, &tree.objects[child.object])?,
            );
            self.scene.area_lights.push(AreaLight {
                mesh: mesh_index,
                radiance: self.materials.texture(radiance),
                key,
            });
        }
        shape.mesh.id = id;
        self.scene.meshes.push(shape.mesh);
        Ok(())
    }

    fn environment(&mut self, object: &Object) -> Result<(), SceneError> {
        if object.plugin == "area" {
            // It may stand in the scene for shapes that reference it; in itself it lights nothing.
            let what = "an area emitter stands inside the shape that emits";
            return Err(object.error(what));
        }
        if self.scene.environment.is_some() {
            return Err(
                object.error("a scene has only one environment emitter; this is a second one")
            );
        }
        let key = self.names.of(object);
        let radiance = Texture::constant(format!("{key}.radiance"), radiance(self.tree, object)?);
        self.scene.environment = Some(Environment {
            key,
            radiance: self.materials.texture(radiance),
            map: None,
        });
        Ok(())
    }

    /// Warns of what the file says and nobody asked for.
    fn warn_unread(&mut self) {
        for object in &self.tree.objects {
            let warnings = object.unread(properties_of(object));
            self.scene.warnings.extend(warnings);
        }
        if !self.has_integrator {
            let place = &self.tree.objects[0].place;
            let what = format!(
                "{place}: the scene has no integrator; using \"path\" without a depth limit"
            );
            self.scene.warnings.push(what);
        }
    }
}

/// The properties that a plugin reads, for hints.
fn properties_of(object: &Object) -> &'static [&'static str] {
    match (object.tag, object.plugin.as_str()) {
        ("integrator", "direct") => &["rr_depth", "hide_emitters"],
        ("integrator", _) => &["max_depth", "rr_depth", "hide_emitters"],
        ("sensor", _) => &[
            "fov",
            "fov_axis",
            "to_world",
            "near_clip",
            "far_clip",
            "principal_point_offset_x",
            "principal_point_offset_y",
        ],
        ("film", _) => &[
            "width",
            "height",
            "crop_offset_x",
            "crop_offset_y",
            "crop_width",
            "crop_height",
            "sample_border",
            "pixel_format",
            "component_format",
            "file_format",
        ],
        ("sampler", _) => &["sample_count", "seed"],
        ("rfilter", "tent") => &["radius"],
        ("rfilter", "gaussian") => &["stddev"],
        ("shape", "ply" | "obj") => &["filename", "face_normals", "flip_normals", "to_world"],
        ("shape", "sphere") => &[
            "center",
            "radius",
            "face_normals",
            "flip_normals",
            "to_world",
        ],
        ("shape", _) => &["flip_normals", "to_world"],
        ("bsdf", "diffuse") => &["reflectance"],
        ("emitter", _) => &["radiance"],
        _ => &[],
    }
}
