//! Pictures that turn the normals of smooth surfaces, where rays of chains meet these.
//!
//! The picture is looked up in f64: borders are looked for at places that single precision does not
//! tell apart, and what turns a normal by rounding moves what is seen in a mirror.

use crate::kernels::relief::relief_normal;
use crate::lanes::{Number, V3};
use crate::paths::scene_view::SceneView;
use crate::paths::surface::relief::{Turned, by_uv, local, sides};
use crate::paths::surface::texture::mix;
use crate::scene::{Layout, Relief};
use glam::{DVec2, DVec3, Vec3};

/// A place on a relief.
pub struct ReliefPlace<'a> {
    pub relief: &'a Relief,
    /// The picture, and how it changes.
    pub turned: Turned,
    pub facing: f64,
    /// Of the parts along the grain and across it, which sides say.
    pub signs: [f64; 2],
    /// How the derivatives of the position by u and by v are made of the triangle's edges.
    pub slopes: [[f64; 2]; 2],
    /// The direction, or the rises.
    value: DVec3,
}

impl<'a> ReliefPlace<'a> {
    /// At barycentrics of a triangle that is seen from this side.
    pub fn new(
        relief: &'a Relief,
        view: &SceneView,
        (triangle, b): (u32, [f64; 2]),
        facing: f64,
    ) -> Self {
        Self {
            relief,
            turned: view.relief_at(relief, triangle, b.map(|b| b as f32)),
            facing,
            signs: sides(relief, facing as f32).map(f64::from),
            slopes: view.uv_slopes_of(triangle).map(|of| of.map(f64::from)),
            value: value(relief, view, triangle, b),
        }
    }

    /// The direction, or the rises, at barycentrics `b`, if the picture changes so.
    pub fn numbers<F: Number>(&self, b: [F; 2], change: Vec3) -> V3<F> {
        let slopes = self.turned.slopes(self.relief);
        let number = |i: usize| {
            let slides = b
                .iter()
                .zip(slopes)
                .map(|(&b, slope)| (b - F::splat(b.value())) * F::splat(f64::from(slope[i])));
            let still = F::with_tangent(self.value[i], f64::from(change[i]));
            slides.fold(still, |sum, slide| sum + slide)
        };
        V3::new(number(0), number(1), number(2))
    }

    /// The direction in the frame of the normal `n`, on the side that is seen.
    pub fn local<F: Number>(&self, n: V3<F>, [du, dv]: [V3<F>; 2], numbers: V3<F>) -> V3<F> {
        let is_bumpy = self.relief.bumps.is_some();
        let signs = self.signs.map(F::splat);
        local(
            (n, F::splat(self.facing)),
            [du, dv],
            [numbers; 2],
            is_bumpy,
            signs,
        )
    }

    /// The normal `n` of a triangle with these corners, turned.
    pub fn turn<F: Number>(
        &self,
        n: V3<F>,
        direction: V3<F>,
        corners: [V3<F>; 3],
        numbers: V3<F>,
    ) -> V3<F> {
        let [du, dv] = by_uv(corners, self.slopes.map(|of| of.map(F::splat)));
        relief_normal(n, du, direction, self.local(n, [du, dv], numbers))
    }
}

/// The direction of a normal map, or the rises of a bump map.
fn value(relief: &Relief, view: &SceneView, triangle: u32, b: [f64; 2]) -> DVec3 {
    let texture = &view.scene.textures[relief.texture];
    let texel = |t: u32| Vec3::from(texture.texels[t as usize]).as_dvec3();
    let geometry = view.geometry;
    let mesh = geometry.mesh_of_triangle[triangle as usize] as usize;
    let colour = match texture.layout {
        Layout::Constant => texel(0),
        Layout::Faces => texel(triangle - geometry.first_triangle[mesh]),
        Layout::Vertices => {
            let first = geometry.first_vertex[mesh];
            let [p, q, r] = geometry.triangles[triangle as usize].map(|v| texel(v - first));
            p + (q - p) * b[0] + (r - p) * b[1]
        }
        Layout::Bitmap { .. } | Layout::Checkerboard { .. } => {
            let [p, q, r] = view.texture_coordinates(triangle).map(|uv| uv.as_dvec2());
            let uv: DVec2 = p + (q - p) * b[0] + (r - p) * b[1];
            let mixed = mix(texture, uv);
            let of = |weights: [f64; 4]| -> DVec3 {
                let parts = mixed.texels.iter().zip(weights);
                parts.map(|(&t, w)| texel(t) * w).sum()
            };
            if let Some(scale) = relief.bumps {
                let [x, y] = mixed.by_uv.map(|weights| of(weights).x * f64::from(scale));
                return DVec3::new(x, y, 0.0);
            }
            of(mixed.weights)
        }
    };
    match relief.bumps {
        // What does not vary over texture coordinates does not rise.
        Some(_) => DVec3::ZERO,
        None => colour * 2.0 - 1.0,
    }
}
