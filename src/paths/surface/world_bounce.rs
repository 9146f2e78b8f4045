//! Bounces that are directions of the world instead of places in a lobe, for methods that move
//! them (`paths::warp`).

use crate::lanes::{Lane, Real, V3};
use crate::paths::at::Numbers;
use crate::paths::rays::{RayPacket, from_lanes, lane_mask, lane_of};
use crate::paths::scene_view::SceneView;
use crate::paths::store::Vertices;
use crate::paths::surface::kinds::{Kinds, LightKind};
use crate::paths::surface::vertex::Surface;
use crate::paths::warp::kernel::{LobeKernel, Use, around, kernel_numbers, per_solid_angle};
use std::f32::consts::PI;

/// The directions that a packet's bounces were drawn around, and the lanes in which that is not
/// their own.
pub struct Drawn {
    pub axis: V3<Lane>,
    pub convolved: u32,
}

impl Kinds {
    /// Lanes whose BSDF [`SceneView::lobe_value`] knows per solid angle, lobe by lobe.
    fn known_by_direction(&self) -> u32 {
        !(self.dielectric | self.null | self.layered() | (self.conductor & self.smooth))
    }
}

impl SceneView<'_> {
    /// Takes the bounces of a packet for directions of the world, drawn anew around themselves with
    /// a kernel if one is given.
    pub fn bounce_in_world(
        &self,
        vertices: &mut Vertices,
        surface: &Surface,
        rays: &mut RayPacket,
        (kernel, twin): (Option<LobeKernel>, u32),
        numbers: &Numbers,
    ) -> Drawn {
        let axis = rays.direction;
        let lobes = vertices.lobes.diffuse | (vertices.lobes.reflected & !vertices.kinds.smooth);
        let world = rays.active & vertices.kinds.known_by_direction() & lobes;
        let mut drawn = Drawn { axis, convolved: 0 };
        if world == 0 {
            return drawn;
        }
        let mut inverse = self.inverse_density_solid_angle(vertices, axis);
        let mut direction = axis;
        if let Some(kernel) = kernel {
            drawn.convolved = world & wide(vertices, surface, kernel.least_roughness);
            direction = draw(
                drawn.convolved,
                axis,
                kernel.kappa,
                (Use::Bounce, twin),
                numbers,
            );
            let kept = kept_above(surface.n.dot(direction), kernel.kappa);
            let one = Lane::splat(1.0);
            let kept = <Lane as Real>::select(lane_mask(drawn.convolved), kept, one);
            inverse /= kept;
        }
        let zero = Lane::splat(0.0);
        let mask = lane_mask(world);
        let select = |yes, no| <Lane as Real>::select(mask, yes, no);
        vertices.warped.world = world;
        vertices.inverse_density = select(inverse, vertices.inverse_density);
        vertices.local = V3::select(mask, direction, vertices.local);
        let value = per_solid_angle(
            self.lobe_value(vertices, surface, direction),
            surface.n,
            direction,
        );
        vertices.weight = V3::select(mask, value * inverse, vertices.weight);
        let below = world & surface.n.dot(direction).le(zero).to_bits();
        vertices.survival = <Lane as Real>::select(lane_mask(below), zero, vertices.survival);
        let active = rays.active & !below;
        *rays = self.leaving(surface.x, surface.geometric, direction, active);
        drawn
    }

    /// π times the BSDF of the lobe that was drawn, toward `w`.
    fn lobe_value(&self, vertices: &Vertices, surface: &Surface, w: V3<Lane>) -> V3<Lane> {
        let all = self.bsdf_evaluate(vertices, surface, w, LightKind::Delta);
        if vertices.kinds.plastic == 0 {
            return all;
        }
        let diffuse = self.bsdf_evaluate(vertices, surface, w, LightKind::Diffuse);
        let is_diffuse = lane_mask(vertices.lobes.diffuse);
        V3::select(is_diffuse, diffuse, all - diffuse)
    }

    /// One over the density of the bounce's direction `axis`, and the chance of its lobe.
    fn inverse_density_solid_angle(&self, vertices: &Vertices, axis: V3<Lane>) -> Lane {
        let diffuse = Lane::splat(PI) / (vertices.local.z * vertices.lobe_chance);
        if vertices.kinds.special() == 0 {
            return diffuse;
        }
        // dω = 4 (ω·h) dh.
        let wi = -vertices.direction.normalize();
        let h = (wi + axis).normalize();
        let reflected = Lane::splat(4.0) * wi.dot(h) * vertices.inverse_density;
        <Lane as Real>::select(lane_mask(vertices.lobes.diffuse), diffuse, reflected)
    }
}

/// Lanes whose lobe gets a kernel.
fn wide(vertices: &Vertices, surface: &Surface, least_roughness: f32) -> u32 {
    let rough = surface
        .interface
        .as_ref()
        .map_or(0, |s| s.alpha.gt(Lane::splat(least_roughness)).to_bits());
    vertices.lobes.diffuse | (vertices.lobes.reflected & rough)
}

/// Directions around `axis` in the lanes of `bits`; others keep theirs.
pub fn draw(
    bits: u32,
    axis: V3<Lane>,
    kappa: f64,
    (user, twin): (Use, u32),
    numbers: &Numbers,
) -> V3<Lane> {
    let stream = kernel_numbers(numbers.stream, user, numbers.depth, twin);
    let (u, v) = stream.pair(numbers.index, 0);
    let (u, v) = (u.to_array(), v.to_array());
    from_lanes(&std::array::from_fn(|lane| {
        let axis = lane_of(axis, lane);
        if bits >> lane & 1 == 0 {
            return axis;
        }
        let at = [u[lane], v[lane]].map(f64::from);
        around(axis.as_dvec3().normalize(), kappa, at).0.as_vec3()
    }))
}

/// The part of a kernel around directions of the hemisphere that reaches one at this cosine to its
/// axis; in the plane, which is good enough for kernels this narrow.
fn kept_above(cos: Lane, kappa: f64) -> Lane {
    let cos = cos.to_array();
    Lane::new(std::array::from_fn(|l| {
        gaussian_below(kappa.sqrt() * f64::from(cos[l]).max(0.0)) as f32
    }))
}

/// The derivative, by the cosine, of the logarithm of the part of a kernel that is kept above.
pub fn log_kept_above_by_cos(cos: f64, kappa: f64) -> f64 {
    let x = kappa.sqrt() * cos.max(0.0);
    let density = (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt();
    density * kappa.sqrt() / gaussian_below(x)
}

/// The part of a normal distribution below `x` ≥ 0, to 1e-7 (Abramowitz & Stegun 26.2.17).
fn gaussian_below(x: f64) -> f64 {
    let t = 1.0 / (1.0 + 0.231_641_9 * x);
    let c = [
        0.319_381_530,
        -0.356_563_782,
        1.781_477_937,
        -1.821_255_978,
        1.330_274_429,
    ];
    let sum = c.iter().rev().fold(0.0, |sum, c| (sum + c) * t);
    1.0 - (-0.5 * x * x).exp() / std::f64::consts::TAU.sqrt() * sum
}
