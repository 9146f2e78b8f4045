//! The last steps for every mesh: into the world, orientation, degenerate faces, normals.

use super::{MeshError, RawMesh};
use crate::scene::data::{Mesh, Normals};
use crate::scene::vertex_normals::vertex_normals;
use glam::{DAffine3, Vec3};

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

/// The mesh in the world, without id, material and light, and a remark if faces were dropped
/// or there are none.
///
/// A mesh that no ray can meet is empty.
///
/// Vertices keep their numbers, also those that nothing uses: `vertex_positions` is as in the file.
pub(in crate::scene) fn finish(
    raw: RawMesh,
    placement: &Placement,
) -> Result<(Mesh, Option<String>), MeshError> {
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
        return Ok((Mesh::default(), Some(what.into())));
    }
    triangles.retain(|t| has_area(&positions, t));
    let dropped = all - triangles.len();
    if triangles.is_empty() {
        let what = format!("none of the mesh's {all} faces has an area: the shape is left out");
        return Ok((Mesh::default(), Some(what)));
    }
    let normals = if placement.face_normals {
        Normals::Flat
    } else if let Some(given) = raw.normals {
        let sign = if placement.flip_normals { -1.0 } else { 1.0 };
        let world = given.iter().map(|n| (normal_matrix * n.as_dvec3()) * sign);
        let mut units: Vec<Option<Vec3>> = world
            .map(|n| n.try_normalize().map(|n| n.as_vec3()))
            .collect();
        // A normal of length zero means nothing: the vertex gets the one that its faces suggest.
        if units.contains(&None) {
            let computed = vertex_normals(&positions, &triangles);
            for (unit, computed) in units.iter_mut().zip(computed) {
                unit.get_or_insert(computed);
            }
        }
        Normals::Given(units.into_iter().flatten().collect())
    } else if placement.smooth {
        Normals::Computed(vertex_normals(&positions, &triangles))
    } else {
        Normals::Flat
    };
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
    Ok((mesh, remark))
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
