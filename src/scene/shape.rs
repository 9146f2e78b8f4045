//! A shape element: its mesh, and which bsdf and emitter hang on it.

use super::camera::cannot_stand_inside;
use super::data::Mesh;
use super::error::{Place, SceneError};
use super::input::Input;
use super::mesh::{MeshError, Placement, RawMesh, finish, obj, ply, primitives, serialized};
use super::xml::{Child, Object, Tree};
use glam::DAffine3;
use std::collections::BTreeMap;

/// What hangs on a shape.
pub(super) struct Parts<'a> {
    pub bsdf: Option<&'a Child>,
    pub emitter: Option<&'a Child>,
}

/// Finds the shape's bsdf and area emitter.
pub(super) fn parts<'a>(tree: &Tree, object: &'a Object) -> Result<Parts<'a>, SceneError> {
    let mut bsdf = None;
    let mut emitter = None;
    for child in &object.children {
        let inner = &tree.objects[child.object];
        let slot = match inner.tag {
            "bsdf" => &mut bsdf,
            "emitter" if inner.plugin == "area" => &mut emitter,
            _ => return Err(cannot_stand_inside(child, inner, object)),
        };
        if slot.replace(child).is_some() {
            let what = format!("a shape has only one {}", inner.tag);
            return Err(SceneError::at(&child.place, what));
        }
    }
    Ok(Parts { bsdf, emitter })
}

/// How the spheres of a scene were made into meshes: the first of each way, how many, and their
/// triangles.
#[derive(Default)]
pub(super) struct Spheres(BTreeMap<String, (Place, usize, usize)>);

impl Spheres {
    fn add(&mut self, how: String, place: &Place, triangles: usize) {
        let (_, count, sum) = self.0.entry(how).or_insert((place.clone(), 0, 0));
        *count += 1;
        *sum += triangles;
    }

    /// One for each way.
    pub fn remarks(&self) -> Vec<String> {
        let remark = |(how, (place, count, triangles)): (&String, &(Place, usize, usize))| {
            match count {
                1 => format!("{place}: the sphere is tessellated: {how}, {triangles} triangles"),
                _ => format!(
                    "{place}: this sphere and {} more are tessellated, each {how}: {triangles} triangles in all. If these take too \
                 much time or memory, put coarser meshes of your own (ply, obj) in their place",
                    count - 1
                ),
            }
        };
        self.0.iter().map(remark).collect()
    }
}

/// Loads the shape's mesh, without id, material and light, and remarks on it. Only one that
/// `is_textured` pays for texture coordinates with vertices split along seams.
pub(super) fn mesh(
    input: &mut Input,
    object: &Object,
    is_textured: bool,
    spheres: &mut Spheres,
) -> Result<(Mesh, Vec<String>), SceneError> {
    let mut remarks = Vec::new();
    let plugin = object.plugin.as_str();
    let is_file = matches!(plugin, "ply" | "obj" | "serialized");
    let placement = Placement {
        to_world: to_world(object)?,
        flip_normals: object.boolean("flip_normals", false)?,
        face_normals: object.boolean("face_normals", false)?,
        // Mitsuba's defaults: v counts downwards in most OBJ files.
        flip_tex_coords: is_file && object.boolean("flip_tex_coords", plugin == "obj")?,
        smooth: !matches!(plugin, "rectangle" | "cube"),
    };
    let (raw, file) = match plugin {
        "rectangle" => (primitives::rectangle(), None),
        "cube" if is_textured => (primitives::cube_of_six_sides(), None),
        "cube" => (primitives::cube(), None),
        "sphere" => {
            let (mesh, how) = sphere(is_textured);
            spheres.add(how, &object.place, mesh.triangles.len());
            (mesh, None)
        }
        _ => {
            let (mesh, file) = mesh_file(input, object, placement.face_normals, is_textured)?;
            (mesh, Some(file))
        }
    };
    if is_textured && raw.uvs.is_none() {
        let what = "the material or light of this shape has a texture, but its mesh has no texture coordinates";
        return Err(object.property_error("filename", what));
    }
    let name = file.clone().unwrap_or_else(|| object.place.to_string());
    let (mesh, remark) = finish(raw, &placement).map_err(|e| match file {
        // Formulas have nothing wrong in themselves: it is the transform.
        None => object.property_error("to_world", e.what),
        Some(file) => mesh_error(file, e, &object.place),
    })?;
    remarks.extend(remark.map(|r| format!("{name}: {r}")));
    Ok((mesh, remarks))
}

/// The unit sphere, and how it is made.
fn sphere(is_textured: bool) -> (RawMesh, String) {
    if is_textured {
        let mesh = primitives::globe(primitives::GLOBE_RINGS);
        let how = format!("as {} rings of latitude", primitives::GLOBE_RINGS);
        return (mesh, how);
    }
    let mesh = primitives::sphere(primitives::SPHERE_SUBDIVISIONS);
    let how = format!(
        "an icosahedron subdivided {} times",
        primitives::SPHERE_SUBDIVISIONS
    );
    (mesh, how)
}

/// `to_world`, for a sphere after its radius and centre.
fn to_world(object: &Object) -> Result<DAffine3, SceneError> {
    let to_world = object.transform("to_world")?;
    if object.plugin != "sphere" {
        return Ok(to_world);
    }
    let center = object.vector("center")?.unwrap_or_default();
    let radius = object.positive("radius", 1.0)?;
    Ok(to_world
        * DAffine3::from_translation(center)
        * DAffine3::from_scale(glam::DVec3::splat(radius)))
}

fn mesh_file(
    input: &mut Input,
    object: &Object,
    face_normals: bool,
    is_textured: bool,
) -> Result<(RawMesh, String), SceneError> {
    let named = input.named_file(object, &object.plugin)?;
    let parsed = match object.plugin.as_str() {
        "ply" => ply::parse(&named.bytes),
        "serialized" => {
            let number = object.count("shape_index", 0, 0)?;
            serialized::parse(&named.bytes, number)
        }
        _ => {
            let reads = obj::Reads {
                normals: !face_normals,
                uvs: is_textured,
            };
            obj::parse(&named.bytes, reads)
        }
    };
    let file = named.path.display().to_string();
    match parsed {
        Ok(mesh) => Ok((mesh, file)),
        Err(e) => Err(mesh_error(file, e, &object.place)),
    }
}

fn mesh_error(file: String, error: MeshError, used_at: &Place) -> SceneError {
    SceneError::Mesh {
        file,
        at: error.at,
        what: error.what,
        used_at: used_at.clone(),
    }
}
