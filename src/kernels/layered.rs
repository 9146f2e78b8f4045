//! What many layers do with light (`principled`), and rough interfaces whose roughness depends on
//! the direction: brushed metal and glass.
//!
//! The layers are those of Burley ("Physically Based Shading at Disney", 2012, and "Extending the
//! Disney BRDF to a BSDF with Integrated Subsurface Scattering", 2015), with the conventions of
//! Mitsuba's `principled` (docs/mitsuba_conventions.md). Coordinates are as in `kernels::bsdf`.

use crate::kernels::bsdf::{Interface, KindMasks, LobeMasks};
use crate::kernels::frame::direction_from_local;
use crate::kernels::fresnel::{fresnel_conductor, fresnel_dielectric};
use crate::lanes::{Real, V3};

/// What a surface has beside an [`Interface`], where it has layers or a grain.
#[derive(Clone, Copy, Debug)]
pub struct Layers<F> {
    /// The direction of the grain, of any length and up to what is along the normal: that in which
    /// the first texture coordinate grows.
    pub tangent: V3<F>,
    /// Roughness across the grain, where that along it is the interface's.
    pub alpha_v: F,
    pub roughness: F,
    pub anisotropic: F,
    pub metallic: F,
    pub spec_trans: F,
    pub spec_tint: F,
    pub sheen: F,
    pub sheen_tint: F,
    pub flatness: F,
    pub clearcoat: F,
    pub clearcoat_gloss: F,
}

/// Which lobes count beside diffuse light.
#[derive(Clone, Copy, Debug)]
pub struct LitMasks<F: Real> {
    /// The main specular lobe.
    pub has_lobe: F::Mask,
    pub has_coat: F::Mask,
}

/// The axes along the grain and across it, unit and orthogonal to the unit normal `n`.
///
/// inputs: n 0.5..0.6, tangent -0.9..-0.3
pub fn grain_axes<F: Real>(n: V3<F>, tangent: V3<F>) -> (V3<F>, V3<F>) {
    let zero = F::splat(0.0);
    let along = tangent.normalize();
    let flat = along - n * n.dot(along);
    let is_flat = flat.dot(flat).gt(F::splat(1e-8));
    let any = direction_from_local(n, V3::new(F::splat(1.0), zero, zero));
    let u = V3::select(is_flat, flat, any).normalize();
    (u, n.cross(u))
}

/// Roughness along the grain and across it.
///
/// inputs: s 0.3..0.9, l 0.3..0.9
pub fn grain_roughness<F: Real>(s: Interface<F>, l: Layers<F>, is_principled: F::Mask) -> (F, F) {
    let least = F::splat(0.001);
    let alpha = l.roughness * l.roughness;
    let aspect = (F::splat(1.0) - F::splat(0.9) * l.anisotropic).sqrt();
    let along = F::select(is_principled, (alpha / aspect).max(least), s.alpha);
    let across = F::select(is_principled, (alpha * aspect).max(least), l.alpha_v);
    (along, across)
}

/// Density of microfacet normals (per solid angle and projected area) at the normal with these
/// components along the grain, across it and along the surface's normal.
///
/// As `kernels::microfacet::ndf`, stretched.
///
/// inputs: u 0.1..0.6, v 0.1..0.6, z 0.5..0.9, along 0.2..0.9, across 0.2..0.9
pub fn ndf_grained<F: Real>(u: F, v: F, z: F, along: F, across: F, is_ggx: F::Mask) -> F {
    let pi = F::splat(std::f64::consts::PI);
    let x = u / along;
    let y = v / across;
    let slope2 = x * x + y * y;
    let cos2 = z * z;
    let area = pi * along * across;
    let spread = slope2 + cos2;
    let ggx = F::splat(1.0) / (area * spread * spread);
    let safe = cos2.max(F::splat(1e-6));
    let beckmann = (-(slope2 / safe)).exp() / (area * safe * safe);
    F::select(is_ggx, ggx, beckmann)
}

/// The part of the microfacets seen from the unit direction with these components that is not
/// hidden by others, over its cosine `z`.
///
/// inputs: u 0.1..0.6, v 0.1..0.6, z 0.1..0.9, along 0.2..0.9, across 0.2..0.9
pub fn g1_grained_over_cos<F: Real>(u: F, v: F, z: F, along: F, across: F, is_ggx: F::Mask) -> F {
    let one = F::splat(1.0);
    let x = along * u;
    let y = across * v;
    let stretch2 = x * x + y * y;
    let ggx = F::splat(2.0) / (z + (z * z + stretch2).sqrt());
    let slope = one / stretch2.max(F::splat(1e-12)).sqrt();
    let a = z * slope;
    let fit = slope * (F::splat(3.535) + F::splat(2.181) * a)
        / (one + F::splat(2.276) * a + F::splat(2.577) * (a * a));
    let beckmann = F::select(a.lt(F::splat(1.6)), fit, one / z);
    F::select(is_ggx, ggx, beckmann)
}

/// Schlick's (1 − cos)⁵.
///
/// inputs: cos 0.1..0.9
pub fn schlick_weight<F: Real>(cos: F) -> F {
    let m = (F::splat(1.0) - cos).max(F::splat(0.0)).min(F::splat(1.0));
    let m2 = m * m;
    m2 * m2 * m
}

/// [`schlick_weight`] of the angle on the thinner side of an interface whose far side is `ratio`
/// times as dense.
///
/// inputs: cos 0.3..0.9, ratio 0.7..1.8
pub fn schlick_at<F: Real>(cos: F, ratio: F) -> F {
    let one = F::splat(1.0);
    let beyond2 = one - (one - cos * cos) / (ratio * ratio);
    let passes = beyond2.gt(F::splat(1e-6));
    let beyond = F::select(passes, beyond2, one).sqrt();
    let thin = F::select(passes, beyond, F::splat(0.0));
    schlick_weight(F::select(ratio.gt(one), cos, thin))
}

/// A colour over its luminance; white where it is black.
///
/// inputs: 0.2..0.9
pub fn tint<F: Real>(colour: V3<F>) -> V3<F> {
    let luminance = colour.x * F::splat(0.212671)
        + colour.y * F::splat(0.715160)
        + colour.z * F::splat(0.072169);
    let is_bright = luminance.gt(F::splat(1e-8));
    let safe = F::select(is_bright, luminance, F::splat(1.0));
    V3::select(is_bright, colour * (F::splat(1.0) / safe), V3::splat(1.0))
}

/// The part of the light that the main specular lobe reflects, at cosine `cos` to the facet;
/// `glass` is what a dielectric does there.
///
/// inputs: cos 0.3..0.9, glass 0.1..0.9, ratio 1.1..1.8, s 0.3..0.9, l 0.1..0.9
pub fn principled_fresnel<F: Real>(
    cos: F,
    glass: F,
    ratio: F,
    s: Interface<F>,
    l: Layers<F>,
    is_entering: F::Mask,
) -> V3<F> {
    let one = F::splat(1.0);
    let weight = schlick_at(cos, ratio);
    let white = V3::splat(1.0);
    let base = s.reflectance;
    let metal = base + (white - base) * weight;
    let normal = (ratio - one) / (ratio + one);
    let tinted = tint(base) * (normal * normal);
    let tinted = tinted + (white - tinted) * weight;
    let rest = one - l.metallic;
    let outside = white * (rest * (one - l.spec_tint) * glass)
        + metal * l.metallic
        + tinted * (rest * l.spec_tint);
    V3::select(is_entering, outside, white * (rest * l.spec_trans * glass))
}

/// Diffuse reflection, retroreflection, what imitates subsurface scattering, and sheen: π times the
/// BSDF; `cos_half` is that of the angle between light and half vector.
///
/// inputs: cos_in 0.3..0.9, cos_out 0.3..0.9, cos_half 0.3..0.9, s 0.3..0.9, l 0.1..0.9
pub fn principled_diffuse<F: Real>(
    cos_in: F,
    cos_out: F,
    cos_half: F,
    s: Interface<F>,
    l: Layers<F>,
) -> V3<F> {
    let one = F::splat(1.0);
    let half = F::splat(0.5);
    let at_in = schlick_weight(cos_in);
    let at_out = schlick_weight(cos_out);
    let plain = (one - half * at_in) * (one - half * at_out);
    let rough = F::splat(2.0) * l.roughness * (cos_half * cos_half);
    let retro = rough * (at_out + at_in + at_out * at_in * (rough - one));
    let flat90 = half * rough - one;
    let flat = (one + flat90 * at_out) * (one + flat90 * at_in);
    let below = F::splat(1.25) * (flat * (one / (cos_out + cos_in) - half) + half);
    let shape = (plain + retro) * (one - l.flatness) + below * l.flatness;
    let rest = one - l.metallic;
    let diffuse = s.reflectance * (rest * (one - l.spec_trans) * shape);
    let white = V3::splat(1.0);
    let colour = white + (tint(s.reflectance) - white) * l.sheen_tint;
    let sheen = F::splat(std::f64::consts::PI) * l.sheen * rest * schlick_weight(cos_half);
    diffuse + colour * sheen
}

/// The part of the coat's facets that is seen at this cosine, of roughness a quarter.
///
/// inputs: cos 0.1..0.9
pub fn coat_shown<F: Real>(cos: F) -> F {
    let cos2 = cos * cos;
    let spread = cos2 + F::splat(0.0625) * (F::splat(1.0) - cos2).max(F::splat(0.0));
    F::splat(2.0) * cos / (cos + spread.sqrt())
}

/// Density of the coat's facets (GTR1) at a normal with this cosine; `sin2` is the square of the
/// sine.
///
/// inputs: sin2 0.1..0.6, gloss 0.1..0.9
pub fn coat_ndf<F: Real>(sin2: F, gloss: F) -> F {
    let one = F::splat(1.0);
    let alpha = F::splat(0.1) - F::splat(0.099) * gloss;
    let alpha2 = alpha * alpha;
    let spread = alpha2 + (one - alpha2) * sin2;
    (alpha2 - one) / (F::splat(std::f64::consts::PI) * alpha2.ln() * spread)
}

/// What the coat reflects over the density of its facets: a quarter of Schlick's Fresnel term
/// times the parts that are seen. `cos_half` is at the facet.
///
/// inputs: cos_in 0.3..0.9, cos_out 0.3..0.9, cos_half 0.3..0.9, ratio 1.1..1.8, clearcoat 0.1..0.9
pub fn coat_reflects<F: Real>(cos_in: F, cos_out: F, cos_half: F, ratio: F, clearcoat: F) -> F {
    let least = F::splat(0.04);
    let fresnel = least + (F::splat(1.0) - least) * schlick_at(cos_half, ratio);
    F::splat(0.25) * clearcoat * fresnel * (coat_shown(cos_in) * coat_shown(cos_out))
}

/// What the main specular lobe lets through, of what a dielectric would.
///
/// inputs: s 0.2..0.9, l 0.1..0.9
pub fn transmittance<F: Real>(s: Interface<F>, l: Layers<F>, is_principled: F::Mask) -> V3<F> {
    let part = (F::splat(1.0) - l.metallic) * l.spec_trans;
    let root = V3::new(
        safe_root(s.reflectance.x),
        safe_root(s.reflectance.y),
        safe_root(s.reflectance.z),
    );
    V3::select(is_principled, root * part, s.second_reflectance)
}

/// The square root, whose derivative at zero is zero rather than infinite.
///
/// inputs: 0.1..0.9
pub fn safe_root<F: Real>(x: F) -> F {
    let is_some = x.gt(F::splat(1e-8));
    F::select(
        is_some,
        F::select(is_some, x, F::splat(1.0)).sqrt(),
        F::splat(0.0),
    )
}

/// What facets reflect, at cosine `cos` to them: metal, glass, or the main lobe of many layers.
///
/// inputs: cos 0.3..0.9, glass 0.1..0.9, ratio 1.1..1.8, s 0.3..0.9, l 0.1..0.9
pub fn facets_reflect<F: Real>(
    cos: F,
    glass: F,
    ratio: F,
    s: Interface<F>,
    l: Layers<F>,
    kinds: KindMasks<F>,
) -> V3<F> {
    let metal = V3::new(
        fresnel_conductor(cos, s.eta.x, s.k.x),
        fresnel_conductor(cos, s.eta.y, s.k.y),
        fresnel_conductor(cos, s.eta.z, s.k.z),
    );
    let other = V3::select(kinds.is_conductor, metal, V3::splat(1.0) * glass);
    let layers = principled_fresnel(cos, glass, ratio, s, l, kinds.is_entering);
    V3::select(kinds.is_principled, layers, s.reflectance.times(other))
}

/// What is sent against `direction`, the ray that arrived from the camera's side, of light that
/// comes from `w` (not a unit vector): π times the BSDF on the side of the ray, and the BSDF times
/// the cosine beyond. Without what is not in `lit`.
///
/// As `bsdf_evaluate` and `bsdf_evaluate_glass`.
///
/// inputs: n 0.5..0.6, direction -0.9..-0.3, w 0.3..0.9, s 0.3..0.9, l 0.1..0.9
pub fn layered_parts<F: Real>(
    n: V3<F>,
    direction: V3<F>,
    w: V3<F>,
    s: Interface<F>,
    l: Layers<F>,
    kinds: KindMasks<F>,
    lit: LitMasks<F>,
) -> (V3<F>, V3<F>) {
    let zero = F::splat(0.0);
    let one = F::splat(1.0);
    let tiny = F::splat(1e-6);
    let pi = F::splat(std::f64::consts::PI);
    let quarter = F::splat(0.25);
    let none = V3::splat(0.0);
    let wi = -direction.normalize();
    let wo = w.normalize();
    let cos_in = n.dot(wi).max(tiny);
    let cos_w = n.dot(wo);
    let is_through = cos_w.lt(zero);
    let cos_out = cos_w.abs().max(tiny);
    let dense = F::select(kinds.is_conductor, F::splat(1.5), s.eta.x);
    let ratio = F::select(kinds.is_entering, dense, one / dense);
    let bent = F::select(is_through, ratio, one);
    let sum = wi + wo * bent;
    let length2 = sum.dot(sum);
    let has_half = length2.gt(F::splat(1e-12));
    let length = F::select(has_half, length2, one).sqrt();
    let any = sum * (one / length);
    let h = any * n.dot(any).signum();
    let cos_half = wi.dot(h);
    let beyond = wo.dot(h) * F::select(is_through, -one, one);
    let meets = cos_half.gt(tiny) & beyond.gt(tiny) & has_half;
    let cos_facet = F::select(meets, cos_half, one);
    let axes = grain_axes(n, l.tangent);
    let u = axes.0;
    let v = axes.1;
    let alphas = grain_roughness(s, l, kinds.is_principled);
    let along = alphas.0;
    let across = alphas.1;
    let is_ggx = kinds.is_ggx | kinds.is_principled;
    let density = ndf_grained(h.dot(u), h.dot(v), h.dot(n), along, across, is_ggx);
    let hidden = g1_grained_over_cos(wi.dot(u), wi.dot(v), cos_in, along, across, is_ggx)
        * g1_grained_over_cos(wo.dot(u), wo.dot(v), cos_out, along, across, is_ggx);
    let shape = density * hidden;
    let glass = fresnel_dielectric(cos_facet, ratio);
    let main = facets_reflect(cos_facet, glass, ratio, s, l, kinds) * (shape * pi * quarter);
    let below = principled_diffuse(cos_in, cos_out, cos_facet, s, l);
    let flat = n.cross(h);
    let coat = coat_ndf(flat.dot(flat), l.clearcoat_gloss)
        * coat_reflects(cos_in, cos_out, cos_facet, ratio, l.clearcoat)
        * pi;
    let layers = below + V3::select(lit.has_coat, V3::splat(1.0) * coat, none);
    let layers = V3::select(kinds.is_principled & kinds.is_entering, layers, none);
    let above = V3::select(lit.has_lobe, main, none) + layers;
    let squeezed = shape * cos_out * (one - glass) * (cos_facet * beyond / (length * length));
    let through = transmittance(s, l, kinds.is_principled) * squeezed;
    let passes = is_through & meets & !kinds.is_conductor;
    (
        V3::select(meets & !is_through, above, none),
        V3::select(passes, through, none),
    )
}

/// π times the BSDF for light that arrives along `w` on the side of the ray; zero below the
/// horizon.
///
/// inputs: n 0.5..0.6, direction -0.9..-0.3, w 0.3..0.9, s 0.3..0.9, l 0.1..0.9
pub fn layered_evaluate<F: Real>(
    n: V3<F>,
    direction: V3<F>,
    w: V3<F>,
    s: Interface<F>,
    l: Layers<F>,
    kinds: KindMasks<F>,
    lit: LitMasks<F>,
) -> V3<F> {
    let parts = layered_parts(n, direction, w, s, l, kinds, lit);
    parts.0
}

/// What is sent against `direction` of a beam of unit irradiance (across it) that comes from `w`,
/// on either side: the BSDF times the cosine.
///
/// inputs: n 0.5..0.6, direction -0.9..-0.3, w 0.3..0.9, s 0.3..0.9, l 0.1..0.9
pub fn layered_sent<F: Real>(
    n: V3<F>,
    direction: V3<F>,
    w: V3<F>,
    s: Interface<F>,
    l: Layers<F>,
    kinds: KindMasks<F>,
    is_glass: F::Mask,
) -> V3<F> {
    let all = LitMasks {
        has_lobe: is_glass,
        has_coat: is_glass,
    };
    let parts = layered_parts(n, direction, w, s, l, kinds, all);
    let cos = n.dot(w.normalize()).max(F::splat(0.0));
    let sent = parts.0 * (cos * F::splat(std::f64::consts::FRAC_1_PI)) + parts.1;
    V3::select(is_glass, sent, V3::splat(0.0))
}

/// The next direction (unit) and what the path is multiplied with, per unit of the coordinate's
/// measure, as `bsdf_sample`.
///
/// inputs: n 0.5..0.6, direction -0.9..-0.5, local 0.3..0.6, s 0.3..0.9, l 0.1..0.9
pub fn layered_sample<F: Real>(
    n: V3<F>,
    direction: V3<F>,
    local: V3<F>,
    s: Interface<F>,
    l: Layers<F>,
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
    let bent = V3::select(lobes.is_refracted, refracted, reflected);
    let next = V3::select(lobes.is_diffuse, m, bent);

    let cos_next = n.dot(next);
    let cos_beyond = F::select(lobes.is_refracted, -cos_next, cos_next);
    let leaves = cos_beyond.gt(tiny);
    let cos_out = F::select(leaves, cos_beyond, one);
    let axes = grain_axes(n, l.tangent);
    let u = axes.0;
    let v = axes.1;
    let alphas = grain_roughness(s, l, kinds.is_principled);
    let along = alphas.0;
    let across = alphas.1;
    let is_ggx = kinds.is_ggx | kinds.is_principled;
    let density = ndf_grained(m.dot(u), m.dot(v), local.z, along, across, is_ggx);
    let hidden = g1_grained_over_cos(wi.dot(u), wi.dot(v), cos_in, along, across, is_ggx)
        * g1_grained_over_cos(next.dot(u), next.dot(v), cos_out, along, across, is_ggx);
    let shape = density * hidden * (cos_half * cos_out);
    let glass = fresnel_dielectric(cos_half, ratio);
    let main = facets_reflect(cos_half, glass, ratio, s, l, kinds) * shape;
    let coat = coat_ndf(local.x * local.x + local.y * local.y, l.clearcoat_gloss)
        * coat_reflects(cos_in, cos_out, cos_half, ratio, l.clearcoat)
        * (F::splat(4.0) * cos_half * cos_out);
    let reflection = V3::select(lobes.is_coat, V3::splat(1.0) * coat, main);
    let squeezed = shape * (one - glass) / (ratio * ratio);
    let refraction = transmittance(s, l, kinds.is_principled) * F::select(passes, squeezed, zero);
    let half = (wi + m).normalize();
    let below = principled_diffuse(cos_in, cos_out, m.dot(half), s, l);
    let specular = V3::select(lobes.is_refracted, refraction, reflection);
    let weight = V3::select(lobes.is_diffuse, below, specular);
    (next, V3::select(leaves, weight, V3::splat(0.0)))
}
