//! What surfaces do with light, all materials in one: which lanes are of which kind is told by
//! masks.
//!
//! Directions are differentiated at a fixed *coordinate* in the frame of the shading normal: the
//! direction itself for diffuse light, the microfacet's normal h for what is reflected and
//! refracted. With h fixed the lobe turns with the surface and with the arriving ray as a mirror's
//! image does, whatever its width, and a smooth interface is the case h = n. Per solid angle of h
//! reflection and refraction both have the value F·D(h)·G₁(ωᵢ)·G₁(ωₒ)·(ωᵢ·h)/cosθᵢ (Walter et al.
//! 2007, eqs. 20, 21 and the Jacobians 14, 17), in which only D depends on h alone.

use crate::kernels::frame::direction_from_local;
use crate::kernels::fresnel::{fresnel_conductor, fresnel_dielectric, inner_reflectance};
use crate::kernels::microfacet::{ndf, smith_g1_over_cos};
use crate::lanes::{Real, V3};

/// What a surface is made of where a path meets it.
#[derive(Clone, Copy, Debug)]
pub struct Interface<F> {
    /// Diffuse reflectance; specular reflectance of conductors and dielectrics.
    pub reflectance: V3<F>,
    /// Specular reflectance of plastics, transmittance of dielectrics.
    pub second_reflectance: V3<F>,
    /// Real part of the index of refraction, inside over outside; dielectrics have it in x.
    pub eta: V3<F>,
    pub k: V3<F>,
    pub alpha: F,
}

/// What a rough dielectric lets through at the two ends of a diffuse path below it: linear in the
/// cosines, in α and in the index of refraction about where it was looked up.
#[derive(Clone, Copy, Debug)]
pub struct RoughTransmission<F> {
    pub at_in: F,
    pub by_cos_in: F,
    pub by_alpha_in: F,
    pub by_eta_in: F,
    pub at_out: F,
    pub by_cos_out: F,
    pub by_alpha_out: F,
    pub by_eta_out: F,
    /// Mean reflectance from inside.
    pub inner: F,
    pub by_alpha_inner: F,
    pub by_eta_inner: F,
}

/// Which lanes are of which kind.
#[derive(Clone, Copy, Debug)]
pub struct KindMasks<F: Real> {
    pub is_conductor: F::Mask,
    pub is_plastic: F::Mask,
    pub is_smooth: F::Mask,
    pub is_ggx: F::Mask,
    pub is_nonlinear: F::Mask,
    /// A pane: what it reflects is that of both of its sides.
    pub is_thin: F::Mask,
    /// Of many layers (`kernels::layered`).
    pub is_principled: F::Mask,
    /// The ray comes from outside.
    pub is_entering: F::Mask,
}

/// The lobe in which each lane's path goes on; in none it goes straight on.
#[derive(Clone, Copy, Debug)]
pub struct LobeMasks<F: Real> {
    pub is_diffuse: F::Mask,
    pub is_reflected: F::Mask,
    pub is_refracted: F::Mask,
    /// It is reflected by a clear coat above the rest.
    pub is_coat: F::Mask,
}

/// The shading normal, mirrored at the plane across the arriving ray if it looks away from that:
/// continuous, and never below the horizon.
///
/// inputs: n -1..1, direction -1..1
pub fn consistent_normal<F: Real>(n: V3<F>, direction: V3<F>) -> V3<F> {
    let wi = -direction.normalize();
    n + wi * (F::splat(-2.0) * n.dot(wi)).max(F::splat(0.0))
}

/// What reaches a diffuse surface below a dielectric and leaves it again, over π times the
/// irradiance.
///
/// `eta` stands for the index in `s`, which metals have no use for.
///
/// inputs: cos_in 0.4..0.9, cos_out 0.4..0.9, s 0.1..0.9, eta 1.1..1.8, t 0.1..0.6
pub fn below_dielectric<F: Real>(
    cos_in: F,
    cos_out: F,
    s: Interface<F>,
    eta: F,
    t: RoughTransmission<F>,
    kinds: KindMasks<F>,
) -> V3<F> {
    let alpha = s.alpha;
    let colour = s.reflectance;
    let one = F::splat(1.0);
    let rough_in = t.at_in + t.by_cos_in * cos_in + t.by_alpha_in * alpha + t.by_eta_in * eta;
    let rough_out = t.at_out + t.by_cos_out * cos_out + t.by_alpha_out * alpha + t.by_eta_out * eta;
    let smooth_in = one - fresnel_dielectric(cos_in, eta);
    let smooth_out = one - fresnel_dielectric(cos_out, eta);
    let through = F::select(
        kinds.is_smooth,
        smooth_in * smooth_out,
        rough_in * rough_out,
    );
    let rough_inner = t.inner + t.by_alpha_inner * alpha + t.by_eta_inner * eta;
    let inner = F::select(kinds.is_smooth, inner_reflectance(eta), rough_inner);
    let scale = through / (eta * eta);
    let white = V3::splat(1.0);
    let again = V3::select(kinds.is_nonlinear, colour, white) * inner;
    let left = V3::new(
        scale / (one - again.x),
        scale / (one - again.y),
        scale / (one - again.z),
    );
    colour.times(left)
}

/// π times the BSDF for light that arrives along `w` (not a unit vector) and leaves against
/// `direction`, the ray that arrived from the camera's side; without what smooth interfaces
/// reflect, and without specular reflection at all where `has_lobe` does not hold. Zero below the
/// horizon of the unit normal `n`.
///
/// inputs: n 0.5..0.6, direction -0.9..-0.3, w 0.3..0.9, s 0.3..0.9, t 0.1..0.6
pub fn bsdf_evaluate<F: Real>(
    n: V3<F>,
    direction: V3<F>,
    w: V3<F>,
    s: Interface<F>,
    t: RoughTransmission<F>,
    kinds: KindMasks<F>,
    has_lobe: F::Mask,
) -> V3<F> {
    let zero = F::splat(0.0);
    let tiny = F::splat(1e-6);
    let wi = -direction.normalize();
    let any = w.normalize();
    let is_above = n.dot(any).gt(zero);
    let wo = V3::select(is_above, any, n);
    let cos_in = n.dot(wi).max(tiny);
    let cos_out = n.dot(wo).max(tiny);
    let h = (wi + wo).normalize();
    let cos_half = wi.dot(h).max(tiny);
    let across = n.cross(h);
    let sin2 = across.dot(across);
    let cos2 = F::splat(1.0) - sin2;
    let alpha = F::select(kinds.is_smooth, F::splat(0.5), s.alpha);
    let density = ndf(cos2, sin2, alpha, kinds.is_ggx);
    let hidden = smith_g1_over_cos(cos_in, alpha, kinds.is_ggx)
        * smith_g1_over_cos(cos_out, alpha, kinds.is_ggx);
    let shape = density * hidden * F::splat(std::f64::consts::PI * 0.25);
    let metal = V3::new(
        fresnel_conductor(cos_half, s.eta.x, s.k.x),
        fresnel_conductor(cos_half, s.eta.y, s.k.y),
        fresnel_conductor(cos_half, s.eta.z, s.k.z),
    );
    // Metals have no use for it, and where it is zero what is not selected would not be finite.
    let dense = F::select(kinds.is_conductor, F::splat(1.5), s.eta.x);
    let glass = s.second_reflectance * fresnel_dielectric(cos_half, dense);
    let specular = V3::select(kinds.is_conductor, s.reflectance.times(metal), glass) * shape;
    let below = below_dielectric(cos_in, cos_out, s, dense, t, kinds);
    let diffuse = V3::select(kinds.is_plastic, below, s.reflectance);
    let none = V3::splat(0.0);
    let lobes =
        V3::select(has_lobe, specular, none) + V3::select(kinds.is_conductor, none, diffuse);
    V3::select(is_above, lobes, none)
}

/// What rough glass sends against `direction`, the ray that arrived from the camera's side, of a
/// beam of unit irradiance (across it) that comes from `w` (not a unit vector), on either side of
/// the unit normal `n`: the BSDF times the cosine.
///
/// Walter et al. 2007, eqs. 20 and 21, with half vectors by eqs. 13 and 16. The length of the
/// latter is the denominator of eq. 21. Radiance that crosses into a denser medium is squeezed as
/// in [`bsdf_sample`], so that the squared ratio of indices in eq. 21 is gone.
///
/// inputs: n 0.5..0.6, direction -0.9..-0.3, w 0.3..0.9, s 0.3..0.9
pub fn bsdf_evaluate_glass<F: Real>(
    n: V3<F>,
    direction: V3<F>,
    w: V3<F>,
    s: Interface<F>,
    is_glass: F::Mask,
    kinds: KindMasks<F>,
) -> V3<F> {
    let zero = F::splat(0.0);
    let one = F::splat(1.0);
    let tiny = F::splat(1e-6);
    let wi = -direction.normalize();
    let wo = w.normalize();
    let cos_in = n.dot(wi).max(tiny);
    let cos_w = n.dot(wo);
    let is_through = cos_w.lt(zero);
    let cos_out = cos_w.abs().max(tiny);
    let dense = F::select(is_glass, s.eta.x, F::splat(1.5));
    let ratio = F::select(kinds.is_entering, dense, one / dense);
    let bent = F::select(is_through, ratio, one);
    let sum = wi + wo * bent;
    let length2 = sum.dot(sum);
    // Light that goes straight on through what does not bend it has no half vector.
    let has_half = length2.gt(F::splat(1e-12));
    let length = F::select(has_half, length2, one).sqrt();
    let any = sum * (one / length);
    let h = any * n.dot(any).signum();
    let cos_half = wi.dot(h);
    let beyond = wo.dot(h) * F::select(is_through, -one, one);
    let meets = cos_half.gt(tiny) & beyond.gt(tiny) & has_half;
    let cos_facet = F::select(meets, cos_half, one);
    let across = n.cross(h);
    let sin2 = across.dot(across);
    let density = ndf(one - sin2, sin2, s.alpha, kinds.is_ggx);
    let hidden = smith_g1_over_cos(cos_in, s.alpha, kinds.is_ggx)
        * (cos_out * smith_g1_over_cos(cos_out, s.alpha, kinds.is_ggx));
    let shape = density * hidden;
    let mirror = fresnel_dielectric(cos_facet, ratio);
    let reflection = s.reflectance * (shape * mirror * F::splat(0.25));
    let squeezed = shape * (one - mirror) * (cos_facet * beyond / (length * length));
    let sent = V3::select(is_through, s.second_reflectance * squeezed, reflection);
    V3::select(meets & is_glass, sent, V3::splat(0.0))
}

/// The next direction (unit) and what the path is multiplied with, per unit of the coordinate's
/// measure: solid angle times cos/π for diffuse light, solid angle of h for rough lobes, one
/// direction for smooth ones.
///
/// `local` is the coordinate in the frame of the unit normal `n`; `direction` is the ray that
/// arrived. Lanes that neither scatter diffusely, nor reflect, nor refract go straight on. Radiance
/// that crosses into a denser medium is squeezed: transmission is divided by the squared ratio of
/// the indices.
///
/// inputs: n 0.5..0.6, direction -0.9..-0.5, local 0.3..0.6, s 0.3..0.9, t 0.1..0.6
pub fn bsdf_sample<F: Real>(
    n: V3<F>,
    direction: V3<F>,
    local: V3<F>,
    s: Interface<F>,
    t: RoughTransmission<F>,
    lobes: LobeMasks<F>,
    kinds: KindMasks<F>,
) -> (V3<F>, V3<F>) {
    let zero = F::splat(0.0);
    let one = F::splat(1.0);
    let tiny = F::splat(1e-6);
    let wi = -direction.normalize();
    let m = direction_from_local(n, local);
    let cos_in = n.dot(wi).max(tiny);
    let cos_half = wi.dot(m).max(tiny);
    let dense = F::select(kinds.is_conductor, F::splat(1.5), s.eta.x);
    let ratio = F::select(kinds.is_entering, dense, one / dense);
    let reflected = m * (cos_half + cos_half) - wi;
    let beyond2 = one - (one - cos_half * cos_half) / (ratio * ratio);
    let passes = beyond2.gt(tiny) & lobes.is_refracted;
    let beyond = F::select(passes, beyond2, one).sqrt();
    let refracted = m * (cos_half / ratio - beyond) - wi * (one / ratio);
    let refracted = V3::select(kinds.is_thin, -wi, refracted);
    let bent = V3::select(
        lobes.is_reflected,
        reflected,
        V3::select(lobes.is_refracted, refracted, -wi),
    );
    let next = V3::select(lobes.is_diffuse, m, bent);

    let cos_next = n.dot(next);
    let cos_out = F::select(lobes.is_refracted, -cos_next, cos_next).max(zero);
    let alpha = F::select(kinds.is_smooth, F::splat(0.5), s.alpha);
    let density = ndf(
        local.z * local.z,
        local.x * local.x + local.y * local.y,
        alpha,
        kinds.is_ggx,
    );
    let hidden = smith_g1_over_cos(cos_in, alpha, kinds.is_ggx)
        * (cos_out * smith_g1_over_cos(cos_out, alpha, kinds.is_ggx));
    let shape = F::select(kinds.is_smooth, one, density * hidden * cos_half);
    let metal = V3::new(
        fresnel_conductor(cos_half, s.eta.x, s.k.x),
        fresnel_conductor(cos_half, s.eta.y, s.k.y),
        fresnel_conductor(cos_half, s.eta.z, s.k.z),
    );
    let once = fresnel_dielectric(cos_half, ratio);
    // r + trt + tr³t + …
    let glass = F::select(kinds.is_thin, (once + once) / (one + once), once);
    let mirror = V3::select(kinds.is_plastic, s.second_reflectance, s.reflectance) * glass;
    let reflection = V3::select(kinds.is_conductor, s.reflectance.times(metal), mirror) * shape;
    let squeezed = shape * (one - glass) / (ratio * ratio);
    let squeezed = F::select(passes, squeezed, zero);
    let refraction = s.second_reflectance * F::select(kinds.is_thin, one - glass, squeezed);
    let below = below_dielectric(cos_in, cos_out.max(tiny), s, dense, t, kinds);
    let diffuse = V3::select(kinds.is_plastic, below, s.reflectance);
    let white = V3::splat(1.0);
    let specular = V3::select(
        lobes.is_reflected,
        reflection,
        V3::select(lobes.is_refracted, refraction, white),
    );
    (next, V3::select(lobes.is_diffuse, diffuse, specular))
}
