//! From a scene file to a [`Scene`].

use super::beam;
use super::camera;
use super::data::{AreaLight, Body, Bsdf, Instance, Material, Mesh, Scene};
use super::emitter;
use super::error::SceneError;
use super::fineness;
use super::input::Input;
use super::instance;
use super::integrator::{DEFAULT_INTEGRATOR, integrator};
use super::material::Materials;
use super::names::Names;
use super::reads::properties_of;
use super::shape;
use super::source::{Disk, FileSource, Fnv1a};
use super::texture::Textures;
use super::xml::{Child, Object, Tree, read_tree};
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Loads the scene file at `path`; `defines` are the `-D name=value`.
pub fn load(path: impl AsRef<Path>, defines: &[(String, String)]) -> Result<Scene, SceneError> {
    load_from(&Disk, path, defines)
}

/// Loads what can be loaded of a scene, so that its parameters can be listed: what is not supported
/// is left out, with warnings. Its image would be another.
pub fn load_to_list(
    path: impl AsRef<Path>,
    defines: &[(String, String)],
) -> Result<Scene, SceneError> {
    load_as(&Disk, path.as_ref(), defines, true)
}

/// Loads a scene from any source of files.
pub fn load_from(
    files: &dyn FileSource,
    path: impl AsRef<Path>,
    defines: &[(String, String)],
) -> Result<Scene, SceneError> {
    load_as(files, path.as_ref(), defines, false)
}

fn load_as(
    files: &dyn FileSource,
    path: &Path,
    defines: &[(String, String)],
    to_list: bool,
) -> Result<Scene, SceneError> {
    let mut hash = Fnv1a::default();
    let tree = read_tree(files, path, defines, &mut hash, to_list)?;
    let mut loader = Loader::new(Input::new(&tree, files, hash));
    let mut errors = loader.everything();
    let of_materials: Vec<usize> = (0..loader.materials.list.len())
        .flat_map(|m| loader.materials.textures(m))
        .collect();
    errors.extend(loader.textures.refuse_homeless(&of_materials).err());
    let errors: Vec<SceneError> = match loader.samples_are_missed() {
        Some(error) => errors.into_iter().chain([error]).collect(),
        None => errors,
    };
    SceneError::all(errors)?;
    let root = &tree.objects[0];
    if loader.scene.sensors.is_empty() {
        if loader.scene.meshes.is_empty() && !to_list {
            let what = "the scene has no sensor; add <sensor type=\"perspective\">…</sensor>";
            return Err(root.error(what));
        }
        let what = "the scene has no sensor; a camera before it that looks along +z takes its place, until you add \
                    <sensor type=\"perspective\">…</sensor>";
        let warning = format!("{}: {what}", root.place);
        loader.scene.warnings.push(warning);
        let camera = camera::overview(&loader.scene.meshes);
        loader.scene.sensors.push(camera);
    }
    loader.warn();
    let mut scene = loader.scene;
    scene.warnings.extend(fineness::warning(&scene.meshes));
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
    /// The meshes of each shape group that an instance shows, by its object.
    groups: HashMap<usize, Vec<Mesh>>,
    copies: instance::Copies,
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
                instances: Vec::new(),
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
            groups: HashMap::new(),
            copies: instance::Copies::default(),
            has_integrator: false,
            met: HashSet::new(),
        }
    }

    /// Loads all of it, and goes on after errors: the file is to be mended once.
    fn everything(&mut self) -> Vec<SceneError> {
        let tree = self.tree;
        let root = &tree.objects[0];
        let mut errors = Vec::new();
        for child in &root.children {
            errors.extend(self.child(child).err());
        }
        for child in &root.children {
            errors.extend(self.unused(child, "bsdf").err());
        }
        for child in &root.children {
            errors.extend(self.unused(child, "texture").err());
        }
        errors
    }

    /// What stands in the scene itself, but bsdfs and textures.
    fn child(&mut self, child: &'a Child) -> Result<(), SceneError> {
        let tree = self.tree;
        let root = &tree.objects[0];
        let object = &tree.objects[child.object];
        let is_part = match object.tag {
            "film" | "rfilter" | "sampler" => true,
            "emitter" => object.plugin == "area",
            _ => false,
        };
        if is_part && self.input.is_referenced(child.object) {
            // It is kept here for the objects that reference it.
            return Ok(());
        }
        if !matches!(object.tag, "bsdf" | "texture") && !self.met.insert(child.object) {
            let what = format!("{} is already part of the scene", object.shown());
            return Err(SceneError::at(&child.place, what));
        }
        match object.tag {
            "bsdf" | "texture" => Ok(()),
            "integrator" => {
                if std::mem::replace(&mut self.has_integrator, true) {
                    let what = "a scene has only one integrator";
                    return Err(SceneError::at(&child.place, what));
                }
                self.scene.integrator = integrator(tree, object, &mut self.scene.warnings)?;
                Ok(())
            }
            "sensor" => {
                let id = self.names.of(object);
                self.scene.sensors.push(camera::sensor(tree, object, id)?);
                Ok(())
            }
            "shape" => self.shape(object),
            "emitter" => self.emitter(object),
            _ => Err(camera::cannot_stand_inside(child, object, root)),
        }
    }

    /// A bsdf or texture of the scene that nothing uses: it is listed, and its errors are found.
    fn unused(&mut self, child: &'a Child, tag: &str) -> Result<(), SceneError> {
        let object = &self.tree.objects[child.object];
        if object.tag != tag || self.tree.lacks_support(child.object) {
            return Ok(());
        }
        let key = self.names.of(object);
        let (input, textures) = (&mut self.input, &mut self.textures);
        match tag {
            "bsdf" => self.materials.unused(input, textures, child.object, &key),
            _ => textures.unused(input, child.object, &key),
        }
    }

    fn shape(&mut self, object: &'a Object) -> Result<(), SceneError> {
        match object.plugin.as_str() {
            // It is nothing until an instance shows it.
            "shapegroup" => instance::check_group(self.tree, object),
            "instance" => self.instance(object),
            _ => {
                let id = self.names.of(object);
                let mesh = self.mesh(object, id)?;
                self.scene.meshes.extend(mesh);
                Ok(())
            }
        }
    }

    /// All shapes of the group, put where the instance says.
    fn instance(&mut self, object: &'a Object) -> Result<(), SceneError> {
        let id = self.names.of(object);
        let group = instance::group_of(self.tree, object)?;
        let to_world = object.transform("to_world")?;
        if !self.groups.contains_key(&group) {
            let mut meshes = Vec::new();
            for inner in instance::shapes_of(self.tree, group)? {
                let id = self.names.of(inner);
                meshes.extend(self.mesh(inner, id)?);
            }
            self.groups.insert(group, meshes);
        }
        let meshes = &self.groups[&group];
        let body = Body {
            first: self.scene.meshes.len(),
            count: meshes.len(),
        };
        let placed: Result<Vec<Mesh>, SceneError> = meshes
            .iter()
            .map(|mesh| instance::placed(mesh, to_world, object))
            .collect();
        for mut mesh in placed? {
            mesh.id = match body.count {
                1 => id.clone(),
                _ => format!("{id}.{}", mesh.id),
            };
            self.scene.meshes.push(mesh);
        }
        if body.count > 1 {
            self.scene.instances.push(Instance { id, body });
        }
        let group = &self.tree.objects[group];
        let triangles = self.scene.meshes[body.meshes()].iter();
        let triangles = triangles.map(|m| m.triangles.len()).sum();
        self.copies.add(&group.place, triangles);
        Ok(())
    }

    /// The mesh of a shape that is one, with its material and light; none if it has no area.
    fn mesh(&mut self, object: &'a Object, id: String) -> Result<Option<Mesh>, SceneError> {
        let parts = shape::parts(self.tree, object)?;
        let bsdf_key = format!("{id}.bsdf");
        let material = match parts.bsdf {
            Some(child) if self.tree.lacks_support(child.object) => {
                self.materials.unknown(&bsdf_key)
            }
            Some(child) => {
                let (input, textures) = (&mut self.input, &mut self.textures);
                self.materials
                    .bsdf(input, textures, child.object, &bsdf_key)?
            }
            None => {
                let emits = parts.emitter.is_some();
                self.materials
                    .add_default(&mut self.textures, &bsdf_key, emits)
            }
        };
        let mut textures = self.materials.textures(material);
        let mut light = None;
        if let Some(child) = parts.emitter {
            if !self.met.insert(child.object) {
                let what = "an area emitter belongs to one shape only";
                return Err(SceneError::at(&child.place, what));
            }
            let key = format!("{id}.emitter");
            let radiance = emitter::area(&mut self.input, &mut self.textures, child.object, &key)?;
            textures.push(radiance);
            light = Some(AreaLight {
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
        let (mut mesh, attributes, mut remarks) =
            shape::mesh(&mut self.input, object, coordinates, &mut self.rounds)?;
        self.scene.warnings.append(&mut remarks);
        if mesh.triangles.is_empty() {
            return Ok(None);
        }
        self.textures
            .bring(&textures, (&id, &object.place), &attributes)?;
        mesh.id = id;
        mesh.material = material;
        mesh.area_light = light.is_some().then_some(self.scene.area_lights.len());
        self.scene.area_lights.extend(light);
        Ok(Some(mesh))
    }

    /// An emitter that stands in the scene itself.
    fn emitter(&mut self, object: &'a Object) -> Result<(), SceneError> {
        // How often a light is looked at changes no mean, but a light that no ray meets by chance
        // is black if it never is.
        let weight = object.float("sampling_weight")?.unwrap_or(1.0);
        let is_met = matches!(object.plugin.as_str(), "constant" | "envmap");
        if weight == 0.0 && !is_met {
            let what = "its \"sampling_weight\" is 0: it lights nothing, and is left out";
            let warning = format!("{}: {} {what}", object.place, object.shown());
            self.scene.warnings.push(warning);
            return Ok(());
        }
        let (input, textures) = (&mut self.input, &mut self.textures);
        match object.plugin.as_str() {
            "area" => Err(object.error("an area emitter stands inside the shape that emits")),
            "point" | "directional" | "spot" | "projector" => {
                let key = self.names.of(object);
                let light = match object.plugin.as_str() {
                    "spot" => beam::spot(input, textures, object, key)?,
                    "projector" => beam::projector(input, textures, object, key)?,
                    _ => emitter::delta_light(input, textures, object, key)?,
                };
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

    /// `direct` may leave out one of two ways to find light; what only that one finds is black
    /// then.
    fn samples_are_missed(&self) -> Option<SceneError> {
        let is_integrator = |o: &&Object| o.tag == "integrator" && o.plugin == "direct";
        let object = self.tree.objects.iter().find(is_integrator)?;
        let none = |name| matches!(object.integer(name), Ok(Some(0)));
        let is_smooth = |m: &Material| {
            matches!(
                m.bsdf,
                Bsdf::Null
                    | Bsdf::Mask { .. }
                    | Bsdf::ThinDielectric { .. }
                    | Bsdf::Conductor {
                        microfacets: None,
                        ..
                    }
                    | Bsdf::Dielectric {
                        microfacets: None,
                        ..
                    }
                    | Bsdf::Plastic {
                        microfacets: None,
                        ..
                    }
            )
        };
        let (name, what) = if none("emitter_samples") && !self.scene.delta_lights.is_empty() {
            ("emitter_samples", "point and directional lights")
        } else if none("bsdf_samples") && self.materials.list.iter().any(is_smooth) {
            ("bsdf_samples", "what smooth surfaces show")
        } else {
            return None;
        };
        let what = format!(
            "\"{name}\" of 0 leaves out {what}, which Warpath always finds; take the property out"
        );
        Some(object.property_error(name, what))
    }

    /// Warns of what is approximated, and of what the file says and nobody asked for.
    fn warn(&mut self) {
        self.scene
            .warnings
            .extend(self.tree.warnings.iter().cloned());
        self.scene.warnings.extend(self.rounds.remarks());
        self.scene.warnings.extend(self.copies.remarks());
        self.scene.warnings.append(&mut self.textures.remarks);
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
