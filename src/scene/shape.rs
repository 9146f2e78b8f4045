//! A shape element: its mesh, and which bsdf and emitter hang on it.

use super::camera::cannot_stand_inside;
use super::data::Mesh;
use super::error::{Place, SceneError};
use super::input::Input;
use super::mesh::{
    Attribute, MeshError, Placement, RawMesh, finish, obj, ply, primitives, round, serialized,
};
use super::xml::{Child, Object, Tree};
use glam::{DAffine3, DMat3, DVec3};
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

/// How the round shapes of a scene were made into meshes: the first of each kind and way, how many,
/// and their triangles.
#[derive(Default)]
pub(super) struct RoundShapes(BTreeMap<(String, String), (Place, usize, usize)>);

impl RoundShapes {
    fn add(&mut self, kind: &str, how: String, place: &Place, triangles: usize) {
        let entry = self.0.entry((kind.to_string(), how));
        let (_, count, sum) = entry.or_insert((place.clone(), 0, 0));
        *count += 1;
        *sum += triangles;
    }

    /// One for each way.
    pub fn remarks(&self) -> Vec<String> {
        let remark = |((kind, how), (place, count, triangles)): (
            &(String, String),
            &(Place, usize, usize),
        )| {
            match count {
                1 => format!("{place}: the {kind} is tessellated: {how}, {triangles} triangles"),
                _ => format!(
                    "{place}: this {kind} and {} more are tessellated, each {how}: {triangles} triangles in all. If these take too \
                 much time or memory, put coarser meshes of your own (ply, obj) in their place",
                    count - 1
                ),
            }
        };
        self.0.iter().map(remark).collect()
    }
}

/// What texture coordinates are to a shape.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Coordinates {
    /// It has no use for any.
    Idle,
    /// They say in which direction its surface is brushed; without any its triangles do.
    Welcome,
    /// It has a texture.
    Needed,
}

/// A mesh, the attributes that its file has, and remarks on it.
type Loaded = (Mesh, Vec<Attribute>, Vec<String>);

/// Loads the shape's mesh, without id, material and light. Only one that has a use for texture
/// coordinates pays for them with vertices split along seams.
pub(super) fn mesh(
    input: &mut Input,
    object: &Object,
    coordinates: Coordinates,
    rounds: &mut RoundShapes,
) -> Result<Loaded, SceneError> {
    let is_textured = coordinates != Coordinates::Idle;
    let mut remarks = Vec::new();
    let plugin = object.plugin.as_str();
    let is_file = matches!(plugin, "ply" | "obj" | "serialized");
    let placement = Placement {
        to_world: to_world(object)?,
        flip_normals: object.boolean("flip_normals", false)?,
        face_normals: object.boolean("face_normals", false)?,
        // Mitsuba's defaults: v counts downwards in most OBJ files.
        flip_tex_coords: is_file && object.boolean("flip_tex_coords", plugin == "obj")?,
        smooth: !matches!(plugin, "rectangle" | "cube" | "disk"),
    };
    let (raw, file) = match plugin {
        "rectangle" => (primitives::rectangle(), None),
        "cube" if is_textured => (primitives::cube_of_six_sides(), None),
        "cube" => (primitives::cube(), None),
        "sphere" => {
            let (mesh, how) = sphere(is_textured);
            rounds.add(plugin, how, &object.place, mesh.triangles.len());
            (mesh, None)
        }
        "disk" | "cylinder" => {
            let mesh = if plugin == "disk" {
                round::disk()
            } else {
                round::cylinder()
            };
            let how = format!("as {} sectors", round::SECTORS);
            rounds.add(plugin, how, &object.place, mesh.triangles.len());
            (mesh, None)
        }
        _ => {
            let (mesh, file) = mesh_file(input, object, placement.face_normals, is_textured)?;
            (mesh, Some(file))
        }
    };
    let needs_uvs = coordinates == Coordinates::Needed && !raw.triangles.is_empty();
    if needs_uvs && raw.uvs.is_none() {
        let what = "the material or light of this shape has a texture, but its mesh has no texture coordinates";
        return Err(object.property_error("filename", what));
    }
    let name = file.clone().unwrap_or_else(|| object.place.to_string());
    let finished = finish(raw, &placement).map_err(|e| match file {
        // Formulas have nothing wrong in themselves: it is the transform.
        None => object.property_error("to_world", e.what),
        Some(file) => mesh_error(file, e, &object.place),
    })?;
    remarks.extend(finished.remark.map(|r| format!("{name}: {r}")));
    Ok((finished.mesh, finished.attributes, remarks))
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

/// `to_world`, for spheres and cylinders after what says where they are.
fn to_world(object: &Object) -> Result<DAffine3, SceneError> {
    let to_world = object.transform("to_world")?;
    match object.plugin.as_str() {
        "sphere" => {
            let center = object.vector("center")?.unwrap_or_default();
            let radius = DVec3::splat(object.positive("radius", 1.0)?);
            let place = DAffine3::from_translation(center);
            Ok(to_world * place * DAffine3::from_scale(radius))
        }
        "cylinder" => {
            let from = object.vector("p0")?.unwrap_or_default();
            let along = object.vector("p1")?.unwrap_or(DVec3::Z) - from;
            let radius = object.positive("radius", 1.0)?;
            let Some(axis) = along.try_normalize() else {
                let what =
                    "\"p0\" and \"p1\" are the same point: a cylinder goes from one to the other";
                return Err(object.property_error("p1", what));
            };
            // The frame that Mitsuba takes, by which texture coordinates turn (Duff et al. 2017).
            let (s, t) = axis.any_orthonormal_pair();
            let axes = DMat3::from_cols(s * radius, t * radius, along);
            Ok(to_world * DAffine3::from_mat3_translation(axes, from))
        }
        _ => Ok(to_world),
    }
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
