//! A shape element: its mesh, and which bsdf and emitter hang on it.

use super::camera::cannot_stand_inside;
use super::data::Mesh;
use super::error::{Place, SceneError};
use super::mesh::{MeshError, Placement, RawMesh, finish, obj, ply, primitives};
use super::source::{FileSource, Fnv1a, read_file};
use super::xml::{Child, Object, Tree};
use glam::DAffine3;
use std::path::Path;

/// What a scene file says of one shape.
pub(super) struct Shape<'a> {
    /// Without id, material and light.
    pub mesh: Mesh,
    pub bsdf: Option<&'a Child>,
    pub emitter: Option<&'a Child>,
    pub remarks: Vec<String>,
}

/// Loads the shape and its mesh file.
pub(super) fn shape<'a>(
    tree: &Tree,
    object: &'a Object,
    files: &dyn FileSource,
    hash: &mut Fnv1a,
) -> Result<Shape<'a>, SceneError> {
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
    let mut remarks = Vec::new();
    let placement = Placement {
        to_world: to_world(object)?,
        flip_normals: object.boolean("flip_normals", false)?,
        face_normals: object.boolean("face_normals", false)?,
        smooth: !matches!(object.plugin.as_str(), "rectangle" | "cube"),
    };
    let (raw, file) = match object.plugin.as_str() {
        "rectangle" => (primitives::rectangle(), None),
        "cube" => (primitives::cube(), None),
        "sphere" => {
            let mesh = primitives::sphere(primitives::SPHERE_SUBDIVISIONS);
            remarks.push(format!(
                "{}: the sphere is tessellated: an icosahedron subdivided {} times, {} triangles",
                object.place,
                primitives::SPHERE_SUBDIVISIONS,
                mesh.triangles.len()
            ));
            (mesh, None)
        }
        _ => {
            let (mesh, file) = mesh_file(tree, object, files, hash, placement.face_normals)?;
            (mesh, Some(file))
        }
    };
    let name = file.clone().unwrap_or_else(|| object.place.to_string());
    let (mesh, remark) = finish(raw, &placement).map_err(|e| match file {
        // Formulas have nothing wrong in themselves: it is the transform.
        None => object.property_error("to_world", e.what),
        Some(file) => mesh_error(file, e, &object.place),
    })?;
    remarks.extend(remark.map(|r| format!("{name}: {r}")));
    Ok(Shape {
        mesh,
        bsdf,
        emitter,
        remarks,
    })
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
    tree: &Tree,
    object: &Object,
    files: &dyn FileSource,
    hash: &mut Fnv1a,
    face_normals: bool,
) -> Result<(RawMesh, String), SceneError> {
    let Some(name) = object.string("filename")? else {
        let what = format!(
            "{} has no \"filename\"; give <string name=\"filename\" value=\"….{}\"/>",
            object.shown(),
            object.plugin
        );
        return Err(object.error(what));
    };
    let path = tree
        .find_file(files, &object.folder, &name)
        .map_err(|what| object.property_error("filename", what))?;
    let bytes = read_mesh_bytes(object, files, &path)?;
    hash.write(&bytes);
    let parsed = match object.plugin.as_str() {
        "ply" => ply::parse(&bytes),
        _ => obj::parse(&bytes, face_normals),
    };
    // Texture coordinates are not read, so neither is their orientation: no warning for it.
    object.property("flip_tex_coords");
    let file = path.display().to_string();
    match parsed {
        Ok(mesh) => Ok((mesh, file)),
        Err(e) => Err(mesh_error(file, e, &object.place)),
    }
}

fn read_mesh_bytes(
    object: &Object,
    files: &dyn FileSource,
    path: &Path,
) -> Result<Vec<u8>, SceneError> {
    read_file(files, path).map_err(|error| match error {
        SceneError::Missing { what } => object.property_error("filename", what),
        other => other,
    })
}

fn mesh_error(file: String, error: MeshError, used_at: &Place) -> SceneError {
    SceneError::Mesh {
        file,
        at: error.at,
        what: error.what,
        used_at: used_at.clone(),
    }
}
