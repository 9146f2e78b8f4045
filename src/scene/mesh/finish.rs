//! The last steps for every mesh: into the world, orientation, degenerate faces, normals.

use super::{Attribute, MeshError, RawMesh};
use crate::scene::data::{Mesh, Normals};
use crate::scene::vertex_normals::vertex_normals;
use glam::{DAffine3, DMat3, Vec3};

/// Where a mesh goes and how it is shaded.
pub(in crate::scene) struct Placement {
    pub to_world: DAffine3,
    pub flip_normals: bool,
    pub face_normals: bool,
    /// v becomes 1 − v.
    pub flip_tex_coords: bool,
    /// Without `face_normals`, and without normals in the file: smooth or flat.
    pub smooth: bool,
}

/// A mesh in the world.
pub(in crate::scene) struct Finished {
    /// Without id, material and light.
    pub mesh: Mesh,
    pub attributes: Vec<Attribute>,
    /// If faces were dropped, or there are none.
    pub remark: Option<String>,
}

impl Finished {
    fn nothing(remark: String) -> Self {
        Self {
            mesh: Mesh::default(),
            attributes: Vec::new(),
            remark: Some(remark),
        }
    }
}

/// Places a mesh in the world.
///
/// A mesh that no ray can meet is empty.
///
/// Vertices keep their numbers, also those that nothing uses: `vertex_positions` is as in the file.
pub(in crate::scene) fn finish(raw: RawMesh, placement: &Placement) -> Result<Finished, MeshError> {
    let matrix = placement.to_world.matrix3;
    let determinant = matrix.determinant();
    let normal_matrix = matrix.inverse().transpose();
    if determinant == 0.0 || !determinant.is_finite() || !normal_matrix.is_finite() {
        let what = "to_world flattens the shape (its determinant is zero)";
        return Err(MeshError::new("", what));
    }
    let mut positions = raw.positions;
    for (index, position) in positions.iter_mut().enumerate() {
        let world = placement.to_world.transform_point3(position.as_dvec3());
        *position = world.as_vec3();
        if !position.is_finite() {
            let what = "the position is not finite in world space";
            return Err(MeshError::new(format!(", vertex {index}"), what));
        }
    }
    let mut triangles = raw.triangles;
    // A mirror image turns counter-clockwise into clockwise; normals, which go with the inverse
    // transpose, still point outside.
    if (determinant < 0.0) != placement.flip_normals {
        for triangle in &mut triangles {
            triangle.swap(1, 2);
        }
    }
    let all = triangles.len();
    if all == 0 {
        let what = "the mesh has no faces: the shape is left out";
        return Ok(Finished::nothing(what.into()));
    }
    let mut attributes = raw.attributes;
    let have_area: Vec<bool> = triangles.iter().map(|t| has_area(&positions, t)).collect();
    let keep = |i: usize| have_area[i];
    for attribute in attributes.iter_mut().filter(|a| a.is_of_faces()) {
        retain(&mut attribute.values, keep);
    }
    retain(&mut triangles, keep);
    let dropped = all - triangles.len();
    if triangles.is_empty() {
        let what = format!("none of the mesh's {all} faces has an area: the shape is left out");
        return Ok(Finished::nothing(what));
    }
    let normals = normals(
        raw.normals,
        placement,
        normal_matrix,
        (&positions, &triangles),
    );
    let remark = (dropped > 0).then(|| {
        let s = if dropped == 1 { "" } else { "s" };
        format!("dropped {dropped} face{s} without area (of {all})")
    });
    let mut uvs = raw.uvs.unwrap_or_default();
    if placement.flip_tex_coords {
        for uv in &mut uvs {
            uv.y = 1.0 - uv.y;
        }
    }
    let mesh = Mesh {
        positions,
        to_world: placement.to_world,
        triangles,
        normals,
        uvs,
        ..Mesh::default()
    };
    Ok(Finished {
        mesh,
        attributes,
        remark,
    })
}

/// The normals of a placed mesh, of which the file has `given` some.
fn normals(
    given: Option<Vec<Vec3>>,
    placement: &Placement,
    normal_matrix: DMat3,
    (positions, triangles): (&[Vec3], &[[u32; 3]]),
) -> Normals {
    if placement.face_normals {
        Normals::Flat
    } else if let Some(given) = given {
        let sign = if placement.flip_normals { -1.0 } else { 1.0 };
        let world = given.iter().map(|n| (normal_matrix * n.as_dvec3()) * sign);
        let mut units: Vec<Option<Vec3>> = world
            .map(|n| n.try_normalize().map(|n| n.as_vec3()))
            .collect();
        // A normal of length zero means nothing: the vertex gets the one that its faces suggest.
        if units.contains(&None) {
            let computed = vertex_normals(positions, triangles);
            for (unit, computed) in units.iter_mut().zip(computed) {
                unit.get_or_insert(computed);
            }
        }
        Normals::Given(units.into_iter().flatten().collect())
    } else if placement.smooth {
        Normals::Computed(vertex_normals(positions, triangles))
    } else {
        Normals::Flat
    }
}

/// Keeps those whose number says so.
fn retain<T>(all: &mut Vec<T>, keep: impl Fn(usize) -> bool) {
    let mut number = 0..;
    all.retain(|_| number.next().is_some_and(&keep));
}

/// Whether the triangle has a normal: different corners, not in line, neither in single nor in
/// double precision.
fn has_area(positions: &[Vec3], triangle: &[u32; 3]) -> bool {
    let [a, b, c] = triangle.map(|i| positions[i as usize]);
    let single = (b - a).cross(c - a);
    let a64 = a.as_dvec3();
    let double = (b.as_dvec3() - a64).cross(c.as_dvec3() - a64);
    single != Vec3::ZERO && double.length_squared() > 0.0 && single.is_finite()
}
