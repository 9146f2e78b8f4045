//! Samples of an environment map; see `paths::light::sample` and
//! `paths::environment::distribution`.

use crate::kernels::light::direction_irradiance;
use crate::lanes::{LANES, Lane, Mask, Real, V3};
use crate::paths::at::At;
use crate::paths::counts::Counts;
use crate::paths::dimensions::Pair;
use crate::paths::environment::distribution::MapDistribution;
use crate::paths::rays::{from_lanes, lane_mask, lane_of, masked};
use crate::paths::scene_view::SceneView;
use crate::paths::store::{EnvironmentSample, Vertices};
use crate::paths::surface::kinds::LightKind;
use crate::paths::surface::vertex::Surface;
use crate::paths::surface::world_bounce;
use crate::paths::warp::kernel::Use;
use crate::scene::Environment;
use glam::Vec3;

impl At<'_> {
    /// Draws a direction of the map in every lane. Where samples move (`moved`: the concentration
    /// of the kernel around them, if there is one, and which of two twins draws) they share nothing
    /// with bounces. Also returns the directions around which the kernel lies.
    pub fn sample_environment(
        &self,
        distribution: &MapDistribution,
        moved: Option<(Option<f64>, u32)>,
        counts: &mut Counts,
    ) -> (EnvironmentSample, V3<Lane>) {
        let Self {
            view,
            vertices,
            surface,
            ..
        } = *self;
        let (u, v) = self.numbers.pair(Pair::EnvironmentDirection);
        let (u, v) = (u.to_array(), v.to_array());
        let lit = view.lit_by_map(vertices);
        let mut pdf = [1.0; LANES];
        let directions: [Vec3; LANES] = std::array::from_fn(|l| {
            // Such as on smooth metal, which sees the map by its bounces alone.
            if lit >> l & 1 == 0 {
                return Vec3::Y;
            }
            let (d, p) = distribution.sample(u[l] as f64, v[l] as f64);
            pdf[l] = p;
            d
        });
        let axis = from_lanes(&directions);
        let direction = match moved {
            Some((Some(kappa), twin)) => {
                let draw = (Use::Environment, twin);
                world_bounce::draw(u32::MAX, axis, kappa, draw, &self.numbers)
            }
            _ => axis,
        };
        let zero = Lane::splat(0.0);
        let above = surface.n.dot(direction).gt(zero).to_bits();
        let active = lit & above;
        let rays = view.leaving(surface.x, surface.geometric, direction, active);
        let visible = view.unoccluded(&rays, &mut counts.shadow);
        let light = Lane::new(pdf);
        let cos = surface.n.dot(direction);
        let bounce = view.bsdf_pdf_over_cos(vertices, surface, direction) * cos;
        let weight = match moved {
            Some(_) => Lane::splat(1.0) / light,
            None => light / (light * light + bounce * bounce),
        };
        let sample = EnvironmentSample {
            direction,
            weight: <Lane as Real>::select(lane_mask(visible), weight, zero),
            irradiance: direction_irradiance(surface.n, direction),
            value: masked(
                active,
                view.bsdf_evaluate(vertices, surface, direction, LightKind::Sampled),
            ),
        };
        (sample, axis)
    }
}

impl SceneView<'_> {
    /// Lanes that samples of an environment map light.
    pub fn lit_by_map(&self, vertices: &Vertices) -> u32 {
        vertices.hit & vertices.kinds.lit_by_samples() & !self.reflects_nothing(vertices)
    }

    /// What the sample brings, before the throughput.
    pub fn environment_light(
        &self,
        environment: &Environment,
        sample: &EnvironmentSample,
    ) -> V3<Lane> {
        let lit = sample.weight.gt(Lane::splat(0.0));
        if !lit.any() {
            return V3::splat(0.0);
        }
        let irradiance = sample.irradiance * sample.weight;
        let radiance = self.environment_radiance(environment, sample.direction);
        V3::select(
            lit,
            sample.value.times(radiance) * irradiance,
            V3::splat(0.0),
        )
    }

    /// For bounces that see the map: the MIS weight against samples of it at the vertex `from`,
    /// times what turns its irradiance into the radiance of the path; and π times the BSDF times
    /// the irradiance.
    pub fn sampled_environment(
        &self,
        distribution: &MapDistribution,
        vertices: &Vertices,
        from: &Vertices,
        surface: &Surface,
    ) -> (Lane, V3<Lane>) {
        let escaped = vertices.escaped;
        let d = vertices.direction;
        let cos = surface.n.dot(d);
        let bounce = self.bsdf_pdf_over_cos(from, surface, d) * cos;
        let light = Lane::new(std::array::from_fn(|l| {
            if escaped >> l & 1 == 1 {
                distribution.pdf(lane_of(d, l))
            } else {
                1.0
            }
        }));
        let zero = Lane::splat(0.0);
        let counts = lane_mask(escaped) & bounce.gt(zero);
        let weight = bounce / (bounce * bounce + light * light) * from.survival;
        let value = self.bsdf_evaluate(from, surface, d, LightKind::Sampled)
            * direction_irradiance(surface.n, d);
        (
            <Lane as Real>::select(counts, weight, zero),
            masked(counts.to_bits(), value),
        )
    }
}
