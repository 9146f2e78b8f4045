//! From a scene file to a [`Scene`].

use super::camera;
use super::data::{AreaLight, Scene};
use super::emitter;
use super::error::SceneError;
use super::input::Input;
use super::integrator::{DEFAULT_INTEGRATOR, integrator};
use super::material::Materials;
use super::names::Names;
use super::reads::properties_of;
use super::shape;
use super::source::{Disk, FileSource, Fnv1a};
use super::texture::Textures;
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
    let mut loader = Loader::new(Input::new(&tree, files, hash));
    loader.everything()?;
    let root = &tree.objects[0];
    if loader.scene.sensors.is_empty() {
        return Err(
            root.error("the scene has no sensor; add <sensor type=\"perspective\">…</sensor>")
        );
    }
    loader.warn();
    let mut scene = loader.scene;
    scene.materials = loader.materials.list;
    scene.textures = loader.textures.list;
    scene.hash = loader.input.hash.0;
    Ok(scene)
}

struct Loader<'a> {
    tree: &'a Tree,
    input: Input<'a>,
    scene: Scene,
    materials: Materials,
    textures: Textures,
    names: Names,
    rounds: shape::RoundShapes,
    has_integrator: bool,
    /// Shapes, sensors and so on that were already met, and by `<ref>` again.
    met: HashSet<usize>,
}

impl<'a> Loader<'a> {
    fn new(input: Input<'a>) -> Self {
        let tree = input.tree;
        Self {
            tree,
            input,
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
            textures: Textures::default(),
            names: Names::new(tree.objects.iter().filter_map(|o| o.id.as_deref())),
            rounds: shape::RoundShapes::default(),
            has_integrator: false,
            met: HashSet::new(),
        }
    }

    fn everything(&mut self) -> Result<(), SceneError> {
        let tree = self.tree;
        let root = &tree.objects[0];
        for child in &root.children {
            let object = &tree.objects[child.object];
            let is_part = match object.tag {
                "film" | "rfilter" | "sampler" => true,
                "emitter" => object.plugin == "area",
                _ => false,
            };
            if is_part && self.input.is_referenced(child.object) {
                // It is kept here for the objects that reference it.
                continue;
            }
            if !matches!(object.tag, "bsdf" | "texture") && !self.met.insert(child.object) {
                let what = format!("{} is already part of the scene", object.shown());
                return Err(SceneError::at(&child.place, what));
            }
            match object.tag {
                "bsdf" | "texture" => {}
                "integrator" => {
                    if std::mem::replace(&mut self.has_integrator, true) {
                        return Err(SceneError::at(
                            &child.place,
                            "a scene has only one integrator",
                        ));
                    }
                    self.scene.integrator = integrator(tree, object, &mut self.scene.warnings)?;
                }
                "sensor" => {
                    let id = self.names.of(object);
                    self.scene.sensors.push(camera::sensor(tree, object, id)?);
                }
                "shape" => self.shape(object)?,
                "emitter" => self.emitter(object)?,
                _ => return Err(camera::cannot_stand_inside(child, object, root)),
            }
        }
        for child in &root.children {
            let object = &tree.objects[child.object];
            if object.tag == "bsdf" {
                let key = self.names.of(object);
                self.materials
                    .unused(&mut self.input, &mut self.textures, child.object, &key)?;
            }
        }
        for child in &root.children {
            let object = &tree.objects[child.object];
            if object.tag == "texture" {
                let key = self.names.of(object);
                self.textures.unused(&mut self.input, child.object, &key)?;
            }
        }
        Ok(())
    }

    fn shape(&mut self, object: &'a Object) -> Result<(), SceneError> {
        let id = self.names.of(object);
        let parts = shape::parts(self.tree, object)?;
        let bsdf_key = format!("{id}.bsdf");
        let material = match parts.bsdf {
            Some(child) => {
                self.materials
                    .bsdf(&mut self.input, &mut self.textures, child.object, &bsdf_key)?
            }
            None => {
                let emits = parts.emitter.is_some();
                self.materials
                    .add_default(&mut self.textures, &bsdf_key, emits)
            }
        };
        let mut textures = self.materials.textures(material);
        let mut area_light = None;
        if let Some(child) = parts.emitter {
            if !self.met.insert(child.object) {
                let what = "an area emitter belongs to one shape only";
                return Err(SceneError::at(&child.place, what));
            }
            let key = format!("{id}.emitter");
            let radiance = emitter::area(&mut self.input, &mut self.textures, child.object, &key)?;
            textures.push(radiance);
            area_light = Some(self.scene.area_lights.len());
            self.scene.area_lights.push(AreaLight {
                mesh: self.scene.meshes.len(),
                radiance,
                key,
            });
        }
        let coordinates = if textures
            .iter()
            .any(|&t| self.textures.list[t].varies_by_uv())
        {
            shape::Coordinates::Needed
        } else if self.materials.has_grain(material) {
            shape::Coordinates::Welcome
        } else {
            shape::Coordinates::Idle
        };
        let (mut mesh, colours, mut remarks) =
            shape::mesh(&mut self.input, object, coordinates, &mut self.rounds)?;
        self.textures
            .bring(&textures, (&id, &object.place), colours.as_deref())?;
        mesh.id = id;
        mesh.material = material;
        mesh.area_light = area_light;
        self.scene.warnings.append(&mut remarks);
        self.scene.meshes.push(mesh);
        Ok(())
    }

    /// An emitter that stands in the scene itself.
    fn emitter(&mut self, object: &'a Object) -> Result<(), SceneError> {
        let (input, textures) = (&mut self.input, &mut self.textures);
        match object.plugin.as_str() {
            "area" => Err(object.error("an area emitter stands inside the shape that emits")),
            "point" | "directional" => {
                let key = self.names.of(object);
                let light = emitter::delta_light(input, textures, object, key)?;
                self.scene.delta_lights.push(light);
                Ok(())
            }
            _ if self.scene.environment.is_some() => {
                Err(object.error("a scene has only one environment emitter; this is a second one"))
            }
            _ => {
                let key = self.names.of(object);
                let environment = emitter::environment(input, textures, object, key)?;
                self.scene.environment = Some(environment);
                Ok(())
            }
        }
    }

    /// Warns of what is approximated, and of what the file says and nobody asked for.
    fn warn(&mut self) {
        self.scene
            .warnings
            .extend(self.tree.warnings.iter().cloned());
        self.scene.warnings.extend(self.rounds.remarks());
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
