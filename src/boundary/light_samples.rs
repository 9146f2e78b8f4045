//! What a path's samples of lights bring where nothing stands before them, which is what radiances
//! jump by at the edges of shadows.

use crate::discontinuity::boundary::vector;
use crate::kernels::light::triangle_irradiance;
use crate::lanes::LANES;
use crate::paths::at::At;
use crate::paths::rays::{from_lanes, lane_of};
use crate::paths::surface::kinds::LightKind;
use glam::{DVec3, Vec3};

/// A lane's sample of a patch at a place of its square: throughput · πf · Le · irradiance over the
/// probability of the patch.
pub fn of_patch(at: &At, lane: usize, patch: u32, place: [f64; 2]) -> DVec3 {
    let At {
        view,
        vertices,
        surface,
        ..
    } = *at;
    let own = &view.lights.patches[patch as usize];
    let [s, r] = place.map(|p| p as f32);
    let (ids, [b1, b2]) = own.vertices_at(s, r);
    let corner = |v: u32| vector(view.geometry.positions[v as usize].as_dvec3());
    let n = vector(lane_of(surface.n, lane).as_dvec3());
    let x = vector(vertices.position(view.geometry, lane));
    let irradiance = triangle_irradiance(x, n, ids.map(corner), b1 as f64, b2 as f64);
    let radiance = Vec3::from(view.patch_radiance(patch, s, r));
    let value = if surface.interface.is_some() {
        let w = from_lanes(&[own.point(s, r) - lane_of(surface.x, lane); LANES]);
        let all = view.bsdf_evaluate(vertices, surface, w, LightKind::Sampled);
        lane_of(all, lane)
    } else {
        lane_of(vertices.diffuse_reflectance, lane)
    };
    let colour = lane_of(vertices.throughput, lane) * value * radiance;
    colour.as_dvec3() * (irradiance / own.probability as f64)
}
