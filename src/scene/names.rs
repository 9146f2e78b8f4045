//! The ids under which objects are listed: as in the file, or Mitsuba's default names.

use super::xml::Object;
use std::collections::{HashMap, HashSet};

/// Names handed out so far.
pub(super) struct Names {
    taken: HashSet<String>,
    /// For each default name the number that the next one of that name gets.
    next: HashMap<&'static str, u32>,
}

impl Names {
    /// Default names never collide with the `ids` of the file.
    pub fn new<'a>(ids: impl Iterator<Item = &'a str>) -> Self {
        Self {
            taken: ids.map(str::to_string).collect(),
            next: HashMap::new(),
        }
    }

    /// The object's id, or `PLYMesh`, `PLYMesh_1`, … as `mi.traverse` names objects without one.
    pub fn of(&mut self, object: &Object) -> String {
        if let Some(id) = &object.id {
            return id.clone();
        }
        let base = class_name(object);
        let number = self.next.entry(base).or_insert(0);
        loop {
            let name = match *number {
                0 => base.to_string(),
                n => format!("{base}_{n}"),
            };
            *number += 1;
            if self.taken.insert(name.clone()) {
                return name;
            }
        }
    }
}

/// Mitsuba's name for the class of the object.
fn class_name(object: &Object) -> &'static str {
    match (object.tag, object.plugin.as_str()) {
        ("shape", "ply") => "PLYMesh",
        ("shape", "obj") => "OBJMesh",
        ("shape", "serialized") => "SerializedMesh",
        ("shape", "rectangle") => "Rectangle",
        ("shape", "cube") => "Cube",
        ("shape", "sphere") => "Sphere",
        ("shape", "disk") => "Disk",
        ("shape", "cylinder") => "Cylinder",
        ("shape", "instance") => "Instance",
        ("sensor", "thinlens") => "ThinLensCamera",
        ("sensor", "orthographic") => "OrthographicCamera",
        ("sensor", _) => "PerspectiveCamera",
        ("emitter", "envmap") => "EnvironmentMapEmitter",
        ("emitter", "point") => "PointLight",
        ("emitter", "spot") => "SpotLight",
        ("emitter", "projector") => "Projector",
        ("emitter", "directional") => "DirectionalEmitter",
        ("emitter", _) => "ConstantBackgroundEmitter",
        ("bsdf", "twosided") => "TwoSidedBRDF",
        ("bsdf", "conductor") => "SmoothConductor",
        ("bsdf", "roughconductor") => "RoughConductor",
        ("bsdf", "dielectric") => "SmoothDielectric",
        ("bsdf", "roughdielectric") => "RoughDielectric",
        ("bsdf", "plastic") => "SmoothPlastic",
        ("bsdf", "roughplastic") => "RoughPlastic",
        ("bsdf", "null") => "Null",
        ("bsdf", "mask") => "MaskBSDF",
        ("bsdf", "normalmap") => "NormalMap",
        ("bsdf", "bumpmap") => "BumpMap",
        ("bsdf", "thindielectric") => "ThinDielectric",
        ("bsdf", "principled") => "Principled",
        ("bsdf", "blendbsdf") => "BlendBSDF",
        ("bsdf", _) => "SmoothDiffuse",
        ("texture", "checkerboard") => "Checkerboard",
        ("texture", _) => "BitmapTexture",
        _ => "Object",
    }
}
