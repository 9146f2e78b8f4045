//! Smooth surfaces as maps of rays.

use crate::kernels::bsdf::consistent_normal;
use crate::kernels::normal::{face_normal, shading_normal};
use crate::kernels::triangle::triangle_hit;
use crate::lanes::{Real, V3};

/// Where the ray from `o` along `d` meets the plane of a triangle, the unit normal there on the
/// side from which the ray comes, and the barycentrics of the second and third vertex.
///
/// `corners` and `normals` are those of the triangle's vertices; the latter count where `is_shaded`
/// holds. `facing` is ±1, the side of the normal from which the ray comes.
///
/// inputs: o -0.3..0.3, d 0.7..0.9, corners 1..2, normals 0.3..0.9, facing 1..1.2
pub fn smooth_hit<F: Real>(
    o: V3<F>,
    d: V3<F>,
    corners: [V3<F>; 3],
    normals: [V3<F>; 3],
    facing: F,
    is_shaded: F::Mask,
) -> (V3<F>, V3<F>, F, F) {
    let (t, b1, b2) = triangle_hit(o, d, corners[0], corners[1], corners[2]);
    let flat = face_normal(corners[0], corners[1], corners[2]) * facing;
    let shaded = shading_normal(normals[0], normals[1], normals[2], b1, b2) * facing;
    let kept_above = consistent_normal(shaded, d);
    let n = V3::select(is_shaded, kept_above, flat);
    (o + d * t, n, b1, b2)
}

/// The unit direction in which a smooth interface of unit normal `n` reflects or refracts a ray
/// along `d`; what does neither lets it go straight on.
///
/// `ratio` is the index of refraction beyond the surface over that on this side. Where nothing is
/// refracted the direction is of no meaning.
///
/// inputs: n -0.7..-0.4, d 0.7..0.9, ratio 1.1..1.8
pub fn smooth_turn<F: Real>(
    n: V3<F>,
    d: V3<F>,
    ratio: F,
    is_reflected: F::Mask,
    is_refracted: F::Mask,
) -> V3<F> {
    let one = F::splat(1.0);
    let wi = -d.normalize();
    let cos = n.dot(wi);
    let reflected = n * (cos + cos) - wi;
    let beyond2 = one - (one - cos * cos) / (ratio * ratio);
    let passes = beyond2.gt(F::splat(1e-6));
    let beyond = F::select(passes, beyond2, one).sqrt();
    let refracted = n * (cos / ratio - beyond) - wi * (one / ratio);
    V3::select(
        is_reflected,
        reflected,
        V3::select(is_refracted, refracted, -wi),
    )
}
