//! How smooth shading normals turn when vertices move.
//!
//! A computed normal is n_i = normalize(Σ α·m) over the corners at vertex i, with m the unit normal
//! of the corner's triangle and α its angle there (Thürmer & Wüthrich 1998).
//!
//! Let u and v be a triangle's sides from the corner, N = u×v and m = N/|N|. Then
//!
//! - m changes by (I − m·mᵀ)·Ṅ/|N| with Ṅ = u̇×v + u×v̇, and
//! - α by v̇·(m×v)/|v|² − u̇·(m×u)/|u|²: m×u points from u towards v, and m×v away from u.
//!
//! All of it is in f64, once a mesh.

use crate::scene::{Mesh, Normals, Scene, SceneDifferential};
use crate::trace::geometry::Geometry;
use glam::{DVec3, Vec3};

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

/// A triangle's corner.
struct Corner {
    /// Vertices in order from the corner.
    ids: [usize; 3],
    /// Sides to the other two.
    u: DVec3,
    v: DVec3,
    /// |u×v|, and the unit vector along u×v.
    area: f64,
    m: DVec3,
    angle_rad: f64,
}

/// The corners of a mesh, but for those of triangles without an area.
fn corners(mesh: &Mesh) -> impl Iterator<Item = Corner> + '_ {
    let of_triangle = move |t: &[u32; 3]| {
        let t = t.map(|v| v as usize);
        (0..3).filter_map(move |c| {
            let ids = [t[c], t[(c + 1) % 3], t[(c + 2) % 3]];
            Corner::new(ids, ids.map(|v| mesh.positions[v].as_dvec3()))
        })
    };
    mesh.triangles.iter().flat_map(of_triangle)
}

impl Corner {
    fn new(ids: [usize; 3], [p, a, b]: [DVec3; 3]) -> Option<Self> {
        let (u, v) = (a - p, b - p);
        let cross = u.cross(v);
        let area = cross.length();
        let m = cross / area;
        m.is_finite().then(|| Self {
            ids,
            u,
            v,
            area,
            m,
            angle_rad: area.atan2(u.dot(v)),
        })
    }

    /// α·m.
    fn value(&self) -> DVec3 {
        self.angle_rad * self.m
    }

    /// How the angle changes with the ends of u and v.
    fn angle_slopes(&self) -> [DVec3; 2] {
        let across = |side: DVec3| self.m.cross(side) / side.length_squared();
        [-across(self.u), across(self.v)]
    }

    /// How α·m changes with the vertices.
    fn change(&self, velocity: &[Vec3]) -> DVec3 {
        let [p, a, b] = self.ids.map(|v| velocity[v].as_dvec3());
        let (du, dv) = (a - p, b - p);
        let [by_u, by_v] = self.angle_slopes();
        let dn = du.cross(self.v) + self.u.cross(dv);
        let dm = (dn - self.m * self.m.dot(dn)) / self.area;
        (by_u.dot(du) + by_v.dot(dv)) * self.m + self.angle_rad * dm
    }

    /// The transpose: adds what a cotangent of α·m comes to at the vertices.
    fn pull_back(&self, bar: DVec3, positions: &mut [DVec3]) {
        let along = self.m.dot(bar);
        let dn = self.angle_rad * (bar - self.m * along) / self.area;
        let [by_u, by_v] = self.angle_slopes();
        let du = along * by_u + self.v.cross(dn);
        let dv = along * by_v + dn.cross(self.u);
        for (id, bar) in self.ids.into_iter().zip([-du - dv, du, dv]) {
            positions[id] += bar;
        }
    }
}

/// Sums of α·m at each vertex.
fn weighted_sums(mesh: &Mesh) -> Vec<DVec3> {
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for corner in corners(mesh) {
        sums[corner.ids[0]] += corner.value();
    }
    sums
}

fn computed_tangent(mesh: &Mesh, velocity: &[Vec3]) -> Vec<Vec3> {
    let mut sums = vec![(DVec3::ZERO, DVec3::ZERO); mesh.positions.len()];
    for corner in corners(mesh) {
        let (sum, change) = &mut sums[corner.ids[0]];
        *sum += corner.value();
        *change += corner.change(velocity);
    }
    let unit = |(sum, change)| normalized_change(sum, change).as_vec3();
    sums.into_iter().map(unit).collect()
}

fn computed_adjoint(mesh: &Mesh, normals: &[DVec3], positions: &mut [DVec3]) {
    let sums = weighted_sums(mesh);
    let bars: Vec<DVec3> = sums
        .iter()
        .zip(normals)
        .map(|(s, n)| normalized_change(*s, *n))
        .collect();
    for corner in corners(mesh) {
        corner.pull_back(bars[corner.ids[0]], positions);
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

#[cfg(test)]
mod tests {
    use super::*;

    const POINTS: [Vec3; 3] = [
        Vec3::new(0.25, -0.5, 1.0),
        Vec3::new(1.5, 0.125, 0.75),
        Vec3::new(-0.5, 1.0, 1.25),
    ];
    const VELOCITY: [Vec3; 3] = [
        Vec3::new(0.5, 1.0, -0.25),
        Vec3::new(-1.0, 0.75, 0.5),
        Vec3::new(0.25, -0.5, 1.5),
    ];

    fn corner(by: f64) -> Corner {
        let points = [0, 1, 2].map(|i| POINTS[i].as_dvec3() + by * VELOCITY[i].as_dvec3());
        Corner::new([0, 1, 2], points).expect("an area")
    }

    #[test]
    fn a_corner_changes_as_differences_say() {
        let h = 1e-5;
        let difference = (corner(h).value() - corner(-h).value()) / (2.0 * h);
        let change = corner(0.0).change(&VELOCITY);
        assert!(
            (difference - change).length() < 1e-8,
            "{difference} {change}"
        );
    }

    #[test]
    fn pulling_back_is_the_transpose() {
        let bar = DVec3::new(0.3, -1.2, 0.7);
        let mut pulled = [DVec3::ZERO; 3];
        corner(0.0).pull_back(bar, &mut pulled);
        let there: f64 = (0..3).map(|i| pulled[i].dot(VELOCITY[i].as_dvec3())).sum();
        let here = bar.dot(corner(0.0).change(&VELOCITY));
        assert!((here - there).abs() < 1e-14, "{here} {there}");
    }
}
