//! One ray through a tree.

use super::boxes;
use super::ray::Ray;
use super::stack::Stack;
use super::tree::Tree;
use super::triangle::{Meeting, Triangle};
use glam::{UVec2, uvec2};
use obvhs::bvh2::Bvh2;
use obvhs::faststack::FastStack;

/// No place among the triangles.
pub const NOWHERE: u32 = u32::MAX;

/// The nearest triangle so far.
#[derive(Clone, Copy)]
pub struct Nearest {
    pub meeting: Meeting,
    /// Its place among the triangles, or [`NOWHERE`].
    pub place: u32,
}

impl Nearest {
    /// Nothing, up to `tfar`.
    pub fn nothing(tfar: f32) -> Self {
        Self {
            meeting: Meeting {
                t: tfar,
                uv: [0.0; 2],
            },
            place: NOWHERE,
        }
    }

    /// Takes a triangle that is nearer; of two equally near, that of the lower number, so that the
    /// answer does not depend on the tree.
    #[inline(always)]
    pub fn offer(&mut self, meeting: Meeting, place: u32, triangles: &[Triangle]) {
        let nearest = self.meeting.t;
        let takes =
            meeting.t < nearest || (meeting.t == nearest && precedes(place, self.place, triangles));
        if takes {
            *self = Self { meeting, place };
        }
    }
}

/// Whether the triangle at one place has a lower number than that at another.
#[inline]
fn precedes(place: u32, other: u32, triangles: &[Triangle]) -> bool {
    let number = |place: u32| triangles.get(place as usize).map(|t| (t.mesh, t.triangle));
    other == NOWHERE || number(place) < number(other)
}

/// Where obvhs's traversal of a compressed tree is.
pub struct Walk {
    pub stack: Stack,
    pub current_group: UVec2,
    pub primitive_group: UVec2,
    pub oct_inv4: u32,
    pub primitive_id: u32,
    pub hitmask: u32,
}

impl Walk {
    /// At the root of a tree that has one.
    #[inline(always)]
    pub fn along(direction: [f32; 3]) -> Self {
        let bits = [0x0404_0404, 0x0202_0202, 0x0101_0101];
        let ahead = direction.iter().zip(bits).filter(|(d, _)| **d >= 0.0);
        Self {
            stack: Stack::default(),
            current_group: uvec2(0, 0x8000_0000),
            primitive_group: UVec2::ZERO,
            oct_inv4: ahead.fold(0, |all, (_, bit)| all | bit),
            primitive_id: 0,
            hitmask: 0,
        }
    }
}

/// The first triangle that a ray meets up to `tfar`.
#[inline]
pub fn first(tree: &Tree, triangles: &[Triangle], ray: &Ray, tfar: f32) -> Nearest {
    let mut nearest = Nearest::nothing(tfar);
    let offer = |place: u32, nearest: &mut Nearest| {
        if let Some(meeting) = triangles[place as usize].meet(ray)
            && meeting.t > ray.tnear
        {
            nearest.offer(meeting, place, triangles);
        }
    };
    match tree {
        Tree::Wide(bvh) if bvh.nodes.is_empty() => {}
        Tree::Wide(bvh) => {
            let mut state = Walk::along(ray.direction);
            let mut node;
            obvhs::traverse!(
                bvh,
                node,
                state,
                boxes::wide_hits(node, ray, nearest.meeting.t, state.oct_inv4),
                offer(state.primitive_id, &mut nearest)
            );
        }
        Tree::Binary(bvh) => binary(bvh, ray, &mut nearest, |places, nearest| {
            for place in places {
                offer(place, nearest);
            }
            true
        }),
    }
    nearest
}

/// Whether a ray meets any triangle up to `tfar`.
#[inline]
pub fn any(tree: &Tree, triangles: &[Triangle], ray: &Ray, tfar: f32) -> bool {
    let blocks = |place: u32| {
        triangles[place as usize]
            .meet(ray)
            .is_some_and(|meeting| meeting.t > ray.tnear && meeting.t <= tfar)
    };
    match tree {
        Tree::Wide(bvh) if bvh.nodes.is_empty() => false,
        Tree::Wide(bvh) => {
            let mut state = Walk::along(ray.direction);
            let mut node;
            obvhs::traverse!(
                bvh,
                node,
                state,
                boxes::wide_hits(node, ray, tfar, state.oct_inv4),
                if blocks(state.primitive_id) {
                    return true;
                }
            );
            false
        }
        Tree::Binary(bvh) => {
            let mut blocked = false;
            binary(bvh, ray, &mut Nearest::nothing(tfar), |mut places, _| {
                blocked = places.any(blocks);
                !blocked
            });
            blocked
        }
    }
}

/// Visits the leaves whose boxes a ray meets, nearest first where that is known, until `visit` says
/// no.
#[inline(always)]
fn binary(
    bvh: &Bvh2,
    ray: &Ray,
    nearest: &mut Nearest,
    mut visit: impl FnMut(std::ops::Range<u32>, &mut Nearest) -> bool,
) {
    let enters = |index: u32, tfar: f32| {
        let node = bvh.nodes.get(index as usize)?;
        boxes::entry(node.aabb(), ray, tfar)
    };
    if enters(0, nearest.meeting.t).is_none() {
        return;
    }
    let mut stack = Stack::default();
    let mut index = 0;
    loop {
        let node = &bvh.nodes[index as usize];
        let first = node.first_index;
        let next = if node.is_leaf() {
            if !visit(first..first + node.prim_count, nearest) {
                return;
            }
            None
        } else {
            let tfar = nearest.meeting.t;
            match (enters(first, tfar), enters(first + 1, tfar)) {
                (Some(left), Some(right)) => {
                    let (near, far, t) = if left <= right {
                        (first, first + 1, right)
                    } else {
                        (first + 1, first, left)
                    };
                    stack.push(uvec2(far, t.to_bits()));
                    Some(near)
                }
                (Some(_), None) => Some(first),
                (None, Some(_)) => Some(first + 1),
                (None, None) => None,
            }
        };
        index = match next {
            Some(next) => next,
            None => loop {
                let Some(waiting) = stack.pop() else {
                    return;
                };
                if f32::from_bits(waiting.y) <= nearest.meeting.t {
                    break waiting.x;
                }
            },
        };
    }
}
