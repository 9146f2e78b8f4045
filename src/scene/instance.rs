//! `shapegroup` and `instance`: shapes that stand in several places. Each place gets meshes of its
//! own, so that every instance moves alone.

use super::camera::cannot_stand_inside;
use super::data::{Mesh, Normals};
use super::error::{Place, SceneError};
use super::xml::{Object, Tree};
use glam::DAffine3;

/// The `shapegroup` object that an instance shows.
pub(super) fn group_of(tree: &Tree, object: &Object) -> Result<usize, SceneError> {
    let mut found = None;
    for child in &object.children {
        let inner = &tree.objects[child.object];
        if inner.tag != "shape" || inner.plugin != "shapegroup" {
            return Err(cannot_stand_inside(child, inner, object));
        }
        if found.replace(child.object).is_some() {
            let what = "an instance shows only one shapegroup";
            return Err(SceneError::at(&child.place, what));
        }
    }
    found.ok_or_else(|| {
        let what = "an instance needs a shapegroup inside, such as <ref id=\"…\"/> to one";
        object.error(what)
    })
}

/// The shapes of the group that is object `group`.
pub(super) fn shapes_of(tree: &Tree, group: usize) -> Result<Vec<&Object>, SceneError> {
    let object = &tree.objects[group];
    check_group(tree, object)?;
    let shapes = object.children.iter().map(|c| &tree.objects[c.object]);
    Ok(shapes.collect())
}

/// Refuses what cannot be part of a group, as Mitsuba does.
pub(super) fn check_group(tree: &Tree, object: &Object) -> Result<(), SceneError> {
    if object.children.is_empty() {
        return Err(object.error("a shapegroup needs shapes inside"));
    }
    for child in &object.children {
        let inner = &tree.objects[child.object];
        if inner.tag != "shape" || matches!(inner.plugin.as_str(), "shapegroup" | "instance") {
            return Err(cannot_stand_inside(child, inner, object));
        }
        let emits = |c: &&super::xml::Child| tree.objects[c.object].tag == "emitter";
        if let Some(emitter) = inner.children.iter().find(emits) {
            let what = "a shape of a shapegroup cannot emit; take it out of the group";
            return Err(SceneError::at(&emitter.place, what));
        }
    }
    Ok(())
}

/// A mesh of the group where the instance puts it.
pub(super) fn placed(
    mesh: &Mesh,
    to_world: DAffine3,
    instance: &Object,
) -> Result<Mesh, SceneError> {
    let matrix = to_world.matrix3;
    let normal_matrix = matrix.inverse().transpose();
    let determinant = matrix.determinant();
    if determinant == 0.0 || !normal_matrix.is_finite() {
        let what = "to_world flattens the instance (its determinant is zero)";
        return Err(instance.property_error("to_world", what));
    }
    let mut out = Mesh {
        to_world,
        ..mesh.clone()
    };
    for position in &mut out.positions {
        *position = to_world.transform_point3(position.as_dvec3()).as_vec3();
        if !position.is_finite() {
            let what = "a position of the instance is not finite in world space";
            return Err(instance.property_error("to_world", what));
        }
    }
    if determinant < 0.0 {
        for triangle in &mut out.triangles {
            triangle.swap(1, 2);
        }
    }
    let turned = |normals: &[glam::Vec3]| {
        let world = normals.iter().map(|n| normal_matrix * n.as_dvec3());
        world.map(|n| n.normalize_or_zero().as_vec3()).collect()
    };
    out.normals = match &mesh.normals {
        Normals::Flat => Normals::Flat,
        Normals::Given(normals) => Normals::Given(turned(normals)),
        // Mitsuba computes them in the group. Computed here from what stretches they would differ.
        Normals::Computed(normals) => match is_similarity(to_world) {
            true => Normals::Computed(turned(normals)),
            false => Normals::Given(turned(normals)),
        },
    };
    Ok(out)
}

/// Whether all lengths change by one factor.
fn is_similarity(to_world: DAffine3) -> bool {
    let gram = to_world.matrix3.transpose() * to_world.matrix3;
    let square = gram.x_axis.x;
    let off = gram - glam::DMat3::from_diagonal(glam::DVec3::splat(square));
    let columns = [off.x_axis, off.y_axis, off.z_axis];
    columns
        .iter()
        .all(|c| c.abs().max_element() < 1e-5 * square)
}

/// How often groups were copied, in the order of the file: place, copies, triangles.
#[derive(Default)]
pub(super) struct Copies(Vec<(Place, usize, usize)>);

impl Copies {
    pub fn add(&mut self, group: &Place, triangles: usize) {
        match self.0.iter_mut().find(|(place, _, _)| place == group) {
            Some((_, copies, sum)) => {
                *copies += 1;
                *sum += triangles;
            }
            None => self.0.push((group.clone(), 1, triangles)),
        }
    }

    /// One line for each group that stands in several places.
    pub fn remarks(&self) -> impl Iterator<Item = String> {
        let several = self.0.iter().filter(|(_, copies, _)| *copies > 1);
        several.map(|(place, copies, triangles)| {
            format!(
                "{place}: the shapegroup stands in {copies} places, each with vertices of its own, so that it can move \
                 alone: {triangles} triangles in all"
            )
        })
    }
}
