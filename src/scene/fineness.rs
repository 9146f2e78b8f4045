//! Meshes that are too small for where they are: the distance at which rays leave surfaces is a
//! good part of them.

use super::data::Mesh;
use super::origin::origin;
use glam::Vec3;

/// Rays leave surfaces at this distance, per unit of the largest coordinate and `unit`: some
/// hundred units in the last place, what rounding can have moved the hit by.
pub const RAY_OFFSET: f32 = 2e-5;

/// Of a mesh's extent, what rays may leave it by: what is nearer to its outline than that is wrong.
const MOST: f32 = 0.01;

/// What to say of meshes that rays leave by too much; `None` if there are none.
pub(super) fn warning(meshes: &[Mesh]) -> Option<String> {
    let origin = origin(meshes);
    let unit = unit(meshes, origin);
    let parts = meshes
        .iter()
        .filter_map(|mesh| Some((part(mesh, unit, origin)?, mesh)));
    let too_fine: Vec<_> = parts.filter(|(part, _)| *part > MOST).collect();
    let (part, worst) = too_fine.iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let others = match too_fine.len() {
        1 => String::new(),
        n => format!(" and {} more", n - 1),
    };
    let nearer = if origin == Vec3::ZERO {
        "origin"
    } else {
        "middle of the scene"
    };
    Some(format!(
        "{}{others}: rays leave surfaces by {RAY_OFFSET:e} of the coordinates' size, which is {:.2} of its own: \
         light leaks there, and edges are off; put what is small nearer to the {nearer}",
        worst.id, part
    ))
}

/// The distance at which rays leave a mesh over its extent; `None` if it has none.
fn part(mesh: &Mesh, unit: f32, origin: Vec3) -> Option<f32> {
    let positions = || mesh.positions.iter().map(|p| *p - origin);
    let low = positions().reduce(|a, b| a.min(b))?;
    let high = positions().reduce(|a, b| a.max(b))?;
    let extent = low.distance(high);
    let farthest = low.abs().max(high.abs()).max_element();
    (extent > 0.0).then(|| RAY_OFFSET * (unit + farthest) / extent)
}

/// What rays leave surfaces by besides what their own coordinates ask for, over `RAY_OFFSET`: a
/// part of the largest coordinate of all, for large triangles have small coordinates too. At most
/// one.
pub fn unit(meshes: &[Mesh], origin: Vec3) -> f32 {
    let positions = meshes.iter().flat_map(|mesh| &mesh.positions);
    let farthest = positions.map(|p| (*p - origin).abs().max_element());
    farthest.fold(0.0, f32::max).min(1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DAffine3, vec3};

    fn triangle(id: &str, size: f32, at: Vec3) -> Mesh {
        Mesh {
            id: id.into(),
            positions: [Vec3::ZERO, Vec3::X, Vec3::Y]
                .map(|p| at + p * size)
                .to_vec(),
            to_world: DAffine3::IDENTITY,
            triangles: vec![[0, 1, 2]],
            normals: crate::scene::Normals::Flat,
            uvs: Vec::new(),
            material: 0,
            area_light: None,
        }
    }

    #[test]
    fn what_is_small_for_its_place_is_told() {
        let usual = triangle("usual", 1.0, vec3(5.0, 0.0, 0.0));
        let small = triangle("small", 1e-4, Vec3::ZERO);
        let far = triangle("far", 1.0, vec3(0.0, 1e4, 0.0));
        assert_eq!(warning(std::slice::from_ref(&usual)), None);
        for mesh in [small, far] {
            let said = warning(&[usual.clone(), mesh.clone()]).expect("a warning");
            assert!(said.starts_with(&format!("{}: ", mesh.id)), "{said}");
        }
    }
}
