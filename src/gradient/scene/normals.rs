//! How smooth shading normals turn when vertices move.
//!
//! A computed normal is n_i = normalize(Σ α·m) over the corners at vertex i, with m the unit normal
//! of the corner's triangle and α its angle there (Thürmer & Wüthrich 1998). Each corner is a small
//! function of nine numbers; its Jacobian comes from dual numbers, in f64, once a mesh: nothing
//! here is worth a kernel.

use crate::lanes::{Dual, V3};
use crate::scene::{Mesh, Normals, Scene, SceneDifferential};
use crate::trace::geometry::Geometry;
use glam::{DMat3, DVec3, Vec3};

/// Per mesh, the change of each vertex normal; `None` for flat meshes and meshes at rest.
pub fn tangent(scene: &Scene, tangent: &SceneDifferential) -> Vec<Option<Vec<Vec3>>> {
    let turn = |(index, mesh): (usize, &Mesh)| match (&mesh.normals, &tangent.positions[index]) {
        (Normals::Given(_), _) => tangent.given_normals[index].clone(),
        (Normals::Computed(_), Some(velocity)) => Some(computed_tangent(mesh, velocity)),
        _ => None,
    };
    scene.meshes.iter().enumerate().map(turn).collect()
}

/// Adds to `positions` what cotangents of computed normals come to, and returns those of given
/// normals by mesh.
pub fn adjoint(
    scene: &Scene,
    geometry: &Geometry,
    request: &SceneDifferential,
    normals: &[DVec3],
    positions: &mut [DVec3],
) -> Vec<Option<Vec<Vec3>>> {
    let mut given = vec![None; scene.meshes.len()];
    if normals.is_empty() || positions.is_empty() {
        return given;
    }
    for (index, mesh) in scene.meshes.iter().enumerate() {
        let range =
            geometry.first_vertex[index] as usize..geometry.first_vertex[index + 1] as usize;
        match mesh.normals {
            Normals::Given(_) if request.given_normals[index].is_some() => {
                given[index] = Some(normals[range].iter().map(|n| n.as_vec3()).collect());
            }
            Normals::Computed(_) if request.positions[index].is_some() => {
                computed_adjoint(mesh, &normals[range.clone()], &mut positions[range]);
            }
            _ => {}
        }
    }
    given
}

/// The corners of a mesh: vertices in order from the corner, and the derivative of α·m by each of
/// them.
fn corners(mesh: &Mesh) -> impl Iterator<Item = ([usize; 3], DVec3, [DMat3; 3])> + '_ {
    mesh.triangles.iter().flat_map(move |t| {
        (0..3).map(move |c| {
            let ids = [t[c], t[(c + 1) % 3], t[(c + 2) % 3]].map(|v| v as usize);
            let points = ids.map(|v| mesh.positions[v].as_dvec3());
            let (value, jacobian) = corner_jacobian(points);
            (ids, value, jacobian)
        })
    })
}

fn corner_jacobian(points: [DVec3; 3]) -> (DVec3, [DMat3; 3]) {
    let mut value = DVec3::ZERO;
    let jacobian = std::array::from_fn(|moved| {
        let columns: [DVec3; 3] = std::array::from_fn(|axis| {
            let duals: [V3<Dual<f64>>; 3] = std::array::from_fn(|i| {
                let p = points[i].to_array();
                let [x, y, z] = std::array::from_fn(|k| Dual {
                    value: p[k],
                    tangent: if i == moved && k == axis { 1.0 } else { 0.0 },
                });
                V3 { x, y, z }
            });
            let n = corner_normal(duals);
            value = DVec3::new(n.x.value, n.y.value, n.z.value);
            DVec3::new(n.x.tangent, n.y.tangent, n.z.tangent)
        });
        DMat3::from_cols(columns[0], columns[1], columns[2])
    });
    (value, jacobian)
}

/// α·m at the first of three vertices.
fn corner_normal([p, a, b]: [V3<Dual<f64>>; 3]) -> V3<Dual<f64>> {
    let (u, v) = ((a - p).normalize(), (b - p).normalize());
    let cross = u.cross(v);
    let (sin, cos) = (cross.length(), u.dot(v));
    // d atan2(s, c) = c·ds − s·dc for unit (c, s).
    let angle = Dual {
        value: sin.value.atan2(cos.value),
        tangent: cos.value * sin.tangent - sin.value * cos.tangent,
    };
    cross * (angle / sin)
}

/// Sums of α·m at each vertex.
fn weighted_sums(mesh: &Mesh) -> Vec<DVec3> {
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for (ids, value, _) in corners(mesh) {
        if value.is_finite() {
            sums[ids[0]] += value;
        }
    }
    sums
}

fn computed_tangent(mesh: &Mesh, velocity: &[Vec3]) -> Vec<Vec3> {
    let sums = weighted_sums(mesh);
    let mut change = vec![DVec3::ZERO; sums.len()];
    for (ids, value, jacobian) in corners(mesh).filter(|c| c.1.is_finite()) {
        let _ = value;
        change[ids[0]] += (0..3)
            .map(|i| jacobian[i] * velocity[ids[i]].as_dvec3())
            .sum::<DVec3>();
    }
    sums.iter()
        .zip(change)
        .map(|(s, c)| normalized_change(*s, c).as_vec3())
        .collect()
}

fn computed_adjoint(mesh: &Mesh, normals: &[DVec3], positions: &mut [DVec3]) {
    let sums = weighted_sums(mesh);
    let bars: Vec<DVec3> = sums
        .iter()
        .zip(normals)
        .map(|(s, n)| normalized_change(*s, *n))
        .collect();
    for (ids, _, jacobian) in corners(mesh).filter(|c| c.1.is_finite()) {
        for i in 0..3 {
            positions[ids[i]] += jacobian[i].transpose() * bars[ids[0]];
        }
    }
}

/// How s/|s| changes with s: (I − n·nᵀ)·c/|s|, a symmetric matrix; zero where there is no normal.
fn normalized_change(s: DVec3, c: DVec3) -> DVec3 {
    let length = s.length();
    if length == 0.0 {
        return DVec3::ZERO;
    }
    let n = s / length;
    (c - n * n.dot(c)) / length
}
