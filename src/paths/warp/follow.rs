//! What a sample follows.

use crate::trace::geometry::Geometry;
use glam::DVec3;

/// A point of a surface that a sample follows.
#[derive(Clone, Copy, Debug)]
pub struct Follow {
    /// Of the packet.
    pub lane: u8,
    pub triangle: u32,
    /// Of the triangle's second and third vertex.
    pub barycentrics: [f32; 2],
    /// Its part of the velocity.
    pub share: f32,
    /// The score's derivative by the point's Ω; over the film, by its velocity in pixels (x and y).
    pub score: [f32; 3],
}

impl Follow {
    /// The weights of the triangle's vertices.
    pub fn weights(&self) -> [f64; 3] {
        let [b1, b2] = self.barycentrics.map(f64::from);
        [1.0 - b1 - b2, b1, b2]
    }

    /// The point in the world.
    pub fn point(&self, geometry: &Geometry) -> DVec3 {
        let corners = geometry.triangles[self.triangle as usize];
        let corner = |(v, b): (u32, f64)| geometry.positions[v as usize].as_dvec3() * b;
        corners.into_iter().zip(self.weights()).map(corner).sum()
    }
}

/// What moves along a vertex of a path.
#[derive(Clone, Copy, Debug, Default)]
pub struct WarpedVertex {
    /// Lanes whose bounce is drawn as a direction of the world, which is in `local`, with its
    /// `inverse_density` over solid angle.
    pub world: u32,
    /// Lanes whose light sample is a direction, too, and not a point of the light.
    pub light: u32,
    /// What the bounce follows, as a range of the tile's list.
    pub bounce_follows: [u32; 2],
    /// What the light sample follows, likewise.
    pub light_follows: [u32; 2],
    /// What the sample of the environment map follows, likewise.
    pub environment_follows: [u32; 2],
}
