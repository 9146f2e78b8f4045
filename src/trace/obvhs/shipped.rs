//! obvhs as it ships, for rays that may leak: its traversal, its box test and its triangles.
//!
//! Boxes that a ray leaves within 10⁻⁴ of its direction's length are culled by the compressed
//! tree's own test.

use super::single::{NOWHERE, Nearest};
use super::tree::Tree;
use super::triangle::{Meeting, Triangle};
use glam::Vec3A;
use obvhs::ray::{Ray, RayHit};
use obvhs::rt_triangle::RtTriangle;

/// The library's triangles with edges and normal, in the order of the leaves.
pub fn triangles(triangles: &[Triangle]) -> Vec<RtTriangle> {
    let ready = |t: &Triangle| {
        let [a, b, c] = t.corners.map(Vec3A::from);
        RtTriangle::new(a, b, c)
    };
    triangles.iter().map(ready).collect()
}

/// The library's ray.
pub fn ray(ray: &super::ray::Ray, tfar: f32) -> Ray {
    Ray::new(ray.origin.into(), ray.direction.into(), ray.tnear, tfar)
}

/// The first triangle that a ray meets.
#[inline]
pub fn first(tree: &Tree, triangles: &[RtTriangle], ray: Ray) -> Nearest {
    let mut hit = RayHit::none();
    let meet = |ray: &Ray, place: usize| triangles[place].intersect(ray);
    let found = match tree {
        Tree::Wide(bvh) => bvh.ray_traverse(ray, &mut hit, meet),
        Tree::Binary(bvh) => bvh.ray_traverse(ray, &mut hit, meet),
    };
    if !found || hit.primitive_id == NOWHERE {
        return Nearest::nothing(ray.tmax);
    }
    Nearest {
        meeting: Meeting {
            t: hit.t,
            uv: triangles[hit.primitive_id as usize]
                .compute_barycentric(&ray)
                .to_array(),
        },
        place: hit.primitive_id,
    }
}

/// Whether a ray meets any triangle.
#[inline]
pub fn any(tree: &Tree, triangles: &[RtTriangle], ray: Ray) -> bool {
    let meet = |ray: &Ray, place: usize| triangles[place].intersect(ray);
    match tree {
        Tree::Wide(bvh) => !bvh.ray_traverse_miss(ray, meet),
        Tree::Binary(bvh) => !bvh.ray_traverse_miss(ray, meet),
    }
}
