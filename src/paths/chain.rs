//! Chains: rays through smooth surfaces, along which the world is seen by a deterministic map.
//!
//! A chain begins with a ray from the camera or from a vertex. At each smooth surface it is
//! reflected, refracted or goes straight on, and which of these is decided before. Then its last
//! ray is a function of the first one and of the surfaces ([`through`]), which is smooth as long as
//! the surfaces are.

use crate::kernels::smooth::{smooth_hit, smooth_turn};
use crate::lanes::{Number, V3};
use crate::paths::chain_relief::ReliefPlace;
use crate::paths::chain_vertex::ChainVertex;
use crate::paths::scene_view::SceneView;
use crate::paths::surface::materials::{ETA, Entry};
use crate::paths::surface::relief::Turned;
use crate::scene::Relief;
use crate::trace::geometry::Geometry;
use glam::{DVec3, Vec3};

/// What chains meet, in numbers with tangents or without.
pub trait ChainScene<F> {
    fn point(&self, vertex: u32) -> V3<F>;
    /// The shading normal of a vertex.
    fn normal(&self, vertex: u32) -> V3<F>;
    /// The index of refraction that a texture holds.
    fn eta(&self, texture: usize) -> F;
    /// How a place of a relief changes: its direction, or its rises.
    fn relief_change(&self, relief: &Relief, turned: &Turned) -> Vec3;
}

/// A scene in which nothing moves.
pub struct AtRest<'a>(pub &'a SceneView<'a>);

impl<F: Number> ChainScene<F> for AtRest<'_> {
    fn point(&self, vertex: u32) -> V3<F> {
        constant(self.0.geometry.positions[vertex as usize])
    }

    fn normal(&self, vertex: u32) -> V3<F> {
        constant(self.0.geometry.normals[vertex as usize])
    }

    fn eta(&self, texture: usize) -> F {
        F::splat(f64::from(self.0.scene.constant(texture)[0]))
    }

    fn relief_change(&self, _: &Relief, _: &Turned) -> Vec3 {
        Vec3::ZERO
    }
}

fn constant<F: Number>(v: Vec3) -> V3<F> {
    let [x, y, z] = v.to_array().map(|c| F::splat(f64::from(c)));
    V3 { x, y, z }
}

/// What a vertex of a chain is made of.
fn entry<'v>(vertex: &ChainVertex, view: &SceneView<'v>) -> &'v Entry {
    let mesh = view.geometry.mesh_of_triangle[vertex.triangle as usize] as usize;
    let material = view.scene.meshes[mesh].material;
    view.materials.entry_of_part(material, vertex.turn.part)
}

/// The texture of a vertex's index of refraction, if it has one.
pub fn eta_texture(vertex: &ChainVertex, view: &SceneView) -> Option<usize> {
    let slots = &entry(vertex, view).slots;
    let eta = slots.iter().find(|(slot, _)| *slot == ETA);
    eta.filter(|_| vertex.is_refracted())
        .map(|&(_, texture)| texture)
}

/// The place on a relief at barycentrics `b` of a vertex; `None` where no picture turns its normal.
pub fn relief_place<'v>(
    vertex: &ChainVertex,
    view: &SceneView<'v>,
    b: [f64; 2],
) -> Option<ReliefPlace<'v>> {
    let relief = entry(vertex, view).relief.as_ref()?;
    let at = (vertex.triangle, b);
    Some(ReliefPlace::new(relief, view, at, vertex.facing()))
}

/// Whether a triangle has shading normals of its own.
pub fn is_shaded(geometry: &Geometry, triangle: u32) -> bool {
    geometry.smooth[geometry.mesh_of_triangle[triangle as usize] as usize]
}

/// The shading normals of a triangle's vertices; harmless ones where it has none.
pub fn vertex_normals(geometry: &Geometry, triangle: u32) -> [DVec3; 3] {
    if !is_shaded(geometry, triangle) {
        return [DVec3::Z; 3];
    }
    geometry.triangles[triangle as usize].map(|v| geometry.normals[v as usize].as_dvec3())
}

/// The last ray of a chain whose first ray starts at `o` along `d`: where it starts, and its unit
/// direction.
pub fn through<F: Number>(
    view: &SceneView,
    chain: &[ChainVertex],
    (o, d): (V3<F>, V3<F>),
    scene: &impl ChainScene<F>,
) -> (V3<F>, V3<F>) {
    chain.iter().fold((o, d), |(o, d), vertex| {
        let ids = view.geometry.triangles[vertex.triangle as usize];
        let corners = ids.map(|v| scene.point(v));
        let is_shaded = is_shaded(view.geometry, vertex.triangle);
        let normals = if is_shaded {
            ids.map(|v| scene.normal(v))
        } else {
            [constant(Vec3::Z); 3]
        };
        let facing = F::splat(vertex.facing());
        let (x, n, b1, b2) = smooth_hit(o, d, corners, normals, facing, is_shaded);
        let n = match relief_place(vertex, view, [b1, b2].map(F::value)) {
            None => n,
            Some(place) => {
                let change = scene.relief_change(place.relief, &place.turned);
                let numbers = place.numbers([b1, b2], change);
                place.turn(n, d, corners, numbers)
            }
        };
        let eta = eta_texture(vertex, view).map_or(F::splat(1.0), |t| scene.eta(t));
        let [is_reflected, is_refracted] = [vertex.is_reflected(), vertex.is_refracted()];
        let next = smooth_turn(n, d, vertex.ratio(eta), is_reflected, is_refracted);
        (x, next)
    })
}
