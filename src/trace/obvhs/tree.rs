//! Building and refitting obvhs's trees.

use super::triangle::Triangle;
use crate::trace::{ObvhsPreset, ObvhsTree};
use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::aabb::Aabb;
use obvhs::bvh2::{Bvh2, builder::build_bvh2_from_tris};
use obvhs::cwbvh::node::CwBvhNode;
use obvhs::cwbvh::{CwBvh, builder::build_cwbvh_from_tris};
use std::time::Duration;

/// One of obvhs's trees. Triangles lie in the order of its leaves.
pub enum Tree {
    Wide(CwBvh),
    Binary(Bvh2),
}

impl Tree {
    /// Builds on the threads of the pool it is called in.
    pub fn build(triangles: &[Triangle], tree: ObvhsTree, preset: ObvhsPreset) -> Self {
        let vertices: Vec<obvhs::triangle::Triangle> = triangles
            .iter()
            .map(|t| {
                let [v0, v1, v2] = t.corners.map(Vec3A::from);
                obvhs::triangle::Triangle { v0, v1, v2 }
            })
            .collect();
        let parameters = match preset {
            ObvhsPreset::Fastest => BvhBuildParams::fastest_build(),
            ObvhsPreset::VeryFast => BvhBuildParams::very_fast_build(),
            ObvhsPreset::Fast => BvhBuildParams::fast_build(),
            ObvhsPreset::Medium => BvhBuildParams::medium_build(),
            ObvhsPreset::Slow => BvhBuildParams::slow_build(),
            ObvhsPreset::VerySlow => BvhBuildParams::very_slow_build(),
        };
        let mut unused = Duration::ZERO;
        match tree {
            ObvhsTree::Cwbvh if vertices.is_empty() => Self::Wide(CwBvh::default()),
            ObvhsTree::Bvh2 if vertices.is_empty() => Self::Binary(Bvh2::default()),
            ObvhsTree::Cwbvh => {
                Self::Wide(build_cwbvh_from_tris(&vertices, parameters, &mut unused))
            }
            ObvhsTree::Bvh2 => {
                Self::Binary(build_bvh2_from_tris(&vertices, parameters, &mut unused))
            }
        }
    }

    /// Which triangle lies where, in the order of the leaves. Spatial splits put one in several
    /// places.
    pub fn order(&self) -> &[u32] {
        match self {
            Self::Wide(bvh) => &bvh.primitive_indices,
            Self::Binary(bvh) => &bvh.primitive_indices,
        }
    }

    /// Bytes of the nodes and of what the library keeps beside them.
    pub fn memory_bytes(&self) -> usize {
        match self {
            Self::Wide(bvh) => {
                size_of_val(&bvh.nodes[..]) + size_of_val(&bvh.primitive_indices[..])
            }
            Self::Binary(bvh) => {
                let indices = bvh.primitive_indices.len()
                    + bvh.primitive_indices_freelist.len()
                    + bvh.primitives_to_nodes.len()
                    + bvh.parents.len();
                size_of_val(&bvh.nodes[..]) + indices * size_of::<u32>()
            }
        }
    }

    /// Moves the boxes to where `triangles`, in the order of the leaves, are now.
    pub fn refit(&mut self, triangles: &[Triangle]) {
        match self {
            Self::Wide(bvh) => refit_wide(bvh, triangles),
            Self::Binary(bvh) => {
                for node in bvh.nodes.iter_mut().filter(|node| node.is_leaf()) {
                    let (first, count) = (node.first_index as usize, node.prim_count as usize);
                    node.set_aabb(bounds(&triangles[first..first + count]));
                }
                bvh.refit_all();
            }
        }
    }
}

fn bounds(triangles: &[Triangle]) -> Aabb {
    let mut bounds = Aabb::empty();
    for corner in triangles.iter().flat_map(|t| t.corners) {
        bounds.extend(corner.into());
    }
    bounds
}

/// obvhs refits binary trees only. Children come after their parents, so that one pass backwards
/// knows them first.
fn refit_wide(bvh: &mut CwBvh, triangles: &[Triangle]) {
    let mut exact = vec![Aabb::empty(); bvh.nodes.len()];
    for i in (0..bvh.nodes.len()).rev() {
        let node = &mut bvh.nodes[i];
        let children: [Aabb; 8] = std::array::from_fn(|child| {
            if node.is_child_empty(child) {
                Aabb::empty()
            } else if node.is_leaf(child) {
                let (first, count) = node.child_primitives(child);
                bounds(&triangles[first as usize..(first + count) as usize])
            } else {
                exact[node.child_node_index(child) as usize]
            }
        });
        exact[i] = children
            .iter()
            .fold(Aabb::empty(), |all, child| all.union(child));
        compress(node, &exact[i], &children);
    }
    if let Some(root) = exact.first() {
        bvh.total_aabb = *root;
    }
}

/// Puts the boxes of a node's children on the finest grid of 255 steps, each a power of two, that
/// holds them.
fn compress(node: &mut CwBvhNode, whole: &Aabb, children: &[Aabb; 8]) {
    // As in building, so that flat nodes have steps too.
    const LEAST_EXTENT: f32 = 1e-20;
    let corner = whole.min;
    node.p = corner.into();
    let extent = (whole.max - corner).max(Vec3A::splat(LEAST_EXTENT)) / 255.0;
    node.e = extent.to_array().map(exponent_above);
    let step = node.compute_extent();
    for (child, bounds) in children.iter().enumerate() {
        if node.is_child_empty(child) {
            continue;
        }
        let low = ((bounds.min - corner) / step).floor().to_array();
        let high = ((bounds.max - corner) / step).ceil().to_array();
        // The conversion saturates.
        [
            node.child_min_x[child],
            node.child_min_y[child],
            node.child_min_z[child],
        ] = low.map(|x| x as u8);
        [
            node.child_max_x[child],
            node.child_max_y[child],
            node.child_max_z[child],
        ] = high.map(|x| x as u8);
    }
}

/// The biased exponent of the least power of two that is not below a positive `x`.
fn exponent_above(x: f32) -> u8 {
    let bits = x.to_bits();
    (bits >> 23) as u8 + u8::from(bits & 0x007f_ffff != 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_powers_of_two_that_suffice() {
        for x in [1.0, 1.5, 2.0, 0.3, 1e-20, 7e17, 1.000_000_1] {
            let step = f32::from_bits(u32::from(exponent_above(x)) << 23);
            assert!(step >= x && step < 2.0 * x, "{x}: {step}");
        }
    }
}
