//! What can move, and where: silhouettes are looked for only where one that moves may be found.
//!
//! A silhouette that x sees brings something only if it moves in the coordinates in which x sees
//! it: if its own mesh moves, or x does. A line or a cell of a point that rests is left out if it
//! passes all boxes around meshes that move. It is left out whole or not at all: what weighs a
//! silhouette by the chance of finding it (`boundary::inclusion`) needs all that lies beside it,
//! moving or not.

use crate::discontinuity::arc::normal_between;
use crate::discontinuity::boundary::Boundary;
use crate::lanes::LANES;
use crate::scene::{RAY_OFFSET, Scene, SceneDifferential};
use crate::trace::geometry::{Geometry, NO_TRIANGLE};
use glam::DVec3;

/// What a direction in parameter space moves, or a request asks about.
#[derive(Clone, Debug, Default)]
pub struct Moving {
    /// Whether all points move against what they see.
    everything: bool,
    mesh: Vec<bool>,
    delta_light: Vec<bool>,
    /// Around each mesh that moves, and each through which one may be seen.
    boxes: Vec<AlignedBox>,
}

#[derive(Clone, Copy, Debug)]
struct AlignedBox {
    middle: DVec3,
    /// Half its extent.
    half: DVec3,
}

impl AlignedBox {
    fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        let none = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let [low, high] = points
            .into_iter()
            .fold(none, |[low, high], p| [low.min(p), high.max(p)]);
        Self {
            middle: 0.5 * (low + high),
            half: 0.5 * (high - low),
        }
    }
}

/// The part of the plane through `origin` across `normal` for which all `inward` point ahead.
pub struct Sector {
    pub origin: DVec3,
    pub normal: DVec3,
    pub inward: [DVec3; 2],
}

impl Sector {
    /// Between the directions `a` and `b`.
    pub fn between(origin: DVec3, a: DVec3, b: DVec3) -> Self {
        let normal = normal_between(a, b);
        Self {
            origin,
            normal,
            inward: [normal.cross(a), b.cross(normal)],
        }
    }
}

/// Boxes are taken for larger, per unit of the largest coordinate and one: several times what rays
/// leave surfaces by.
const MARGIN: f64 = 1e-4;

impl Moving {
    pub fn new(scene: &Scene, geometry: &Geometry, asked: &SceneDifferential) -> Self {
        let mesh: Vec<bool> = asked.positions.iter().map(Option::is_some).collect();
        let any = mesh.contains(&true);
        // Anything may be seen through smooth surfaces.
        let is_smooth = |m: usize| scene.materials[scene.meshes[m].material].bsdf.is_smooth();
        let boxes = (0..mesh.len())
            .filter(|&m| mesh[m] || (any && is_smooth(m)))
            .map(|m| {
                let vertices = geometry.first_vertex[m]..geometry.first_vertex[m + 1];
                let all = &geometry.positions[vertices.start as usize..vertices.end as usize];
                AlignedBox::around(all.iter().map(|p| p.as_dvec3()))
            })
            .collect();
        // An environment map that turns, and a texture that slides, move against what rests.
        let everything = asked.camera.is_some()
            || asked.refraction_moves(scene)
            || asked.turns_environment(scene)
            || asked.to_uv.iter().any(Option::is_some);
        Self {
            everything,
            mesh,
            delta_light: asked.delta_lights.iter().map(Option::is_some).collect(),
            boxes,
        }
    }

    /// The lanes whose rays move when they leave the camera.
    pub(crate) fn camera_lanes(&self) -> u32 {
        if self.everything { u32::MAX } else { 0 }
    }

    /// The lanes whose triangle moves.
    pub(crate) fn lanes(&self, geometry: &Geometry, triangle: &[u32; LANES]) -> u32 {
        let moves =
            |t: u32| t != NO_TRIANGLE && self.mesh[geometry.mesh_of_triangle[t as usize] as usize];
        (0..LANES)
            .filter(|&l| moves(triangle[l]))
            .fold(0, |bits, l| bits | 1 << l)
    }

    /// Whether anything moves in the scene.
    pub(crate) fn anything(&self) -> bool {
        self.everything || self.mesh.contains(&true) || self.delta_light.contains(&true)
    }

    /// Whether a delta light moves against what rests, or the triangle that it shines on.
    pub(crate) fn shines_anew(&self, geometry: &Geometry, light: usize, receiver: u32) -> bool {
        let mesh = geometry.mesh_of_triangle[receiver as usize] as usize;
        self.everything || self.delta_light[light] || self.mesh[mesh]
    }

    /// Whether a vertex moves as seen from what rests.
    pub(crate) fn vertex(&self, geometry: &Geometry, vertex: u32) -> bool {
        self.moves_mesh(geometry.mesh_of_vertex(vertex) as usize)
    }

    /// Whether a mesh does.
    pub(crate) fn moves_mesh(&self, mesh: usize) -> bool {
        self.everything || self.mesh[mesh]
    }

    /// Whether what has these vertices may touch a mesh that does.
    pub(crate) fn touches(
        &self,
        geometry: &Geometry,
        vertices: impl IntoIterator<Item = u32>,
    ) -> bool {
        let own = AlignedBox::around(
            vertices
                .into_iter()
                .map(|v| geometry.positions[v as usize].as_dvec3()),
        );
        let near = f64::from(RAY_OFFSET) * geometry.room(own.middle.abs() + own.half);
        let meets = |other: &AlignedBox| {
            let apart = (own.middle - other.middle).abs() - own.half - other.half;
            apart.max_element() <= near
        };
        self.boxes.iter().any(meets)
    }

    /// Whether either mesh of two triangles moves in the world.
    pub(crate) fn either(&self, geometry: &Geometry, triangles: [u32; 2]) -> bool {
        let of = |t: u32| geometry.mesh_of_triangle.get(t as usize);
        let moves = |t: u32| of(t).is_some_and(|&mesh| self.mesh[mesh as usize]);
        triangles.into_iter().any(moves)
    }

    /// Whether a boundary does.
    pub(crate) fn boundary(&self, geometry: &Geometry, boundary: &Boundary) -> bool {
        match *boundary {
            // Its light knows.
            Boundary::Plane(_) => false,
            Boundary::Edge([a, _]) | Boundary::Point { edge: [a, _], .. } => {
                self.vertex(geometry, a)
            }
            Boundary::Crease([[a, ..], [b, ..]]) => {
                self.vertex(geometry, a) || self.vertex(geometry, b)
            }
            Boundary::TextureEdge {
                triangle: [a, ..], ..
            } => self.vertex(geometry, a),
        }
    }

    /// Whether something that moves may be found in a sector.
    pub(crate) fn meets(&self, sector: &Sector) -> bool {
        let Sector {
            origin,
            normal,
            inward,
        } = *sector;
        self.everything
            || self.boxes.iter().any(|b| {
                let middle = b.middle - origin;
                let largest = origin.abs().max_element() + b.middle.abs().max_element() + 1.0;
                let half = b.half + MARGIN * largest;
                normal.dot(middle).abs() <= normal.abs().dot(half)
                    && inward
                        .iter()
                        .all(|side| side.dot(middle) + side.abs().dot(half) >= 0.0)
            })
    }
}
