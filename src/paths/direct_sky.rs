//! Light samples of an environment map; see `paths::direct` and `paths::sky`.

use super::materials::LightKind;
use super::random::Stream;
use super::rays::{RayPacket, from_lanes, lane_of, leave, to_rays};
use super::sky::Sky;
use super::sky_cells;
use super::store::{SkySample, TileStore, Vertices, lane_mask, masked};
use super::surface::Surface;
use super::tracer::{Counts, PAIRS_PER_VERTEX, Tracer};
use crate::kernels::light::direction_irradiance;
use crate::lanes::{LANES, Lane, Mask, Real, V3};
use crate::scene::Environment;
use crate::trace::Coherence;
use glam::Vec3;

/// Dimensions of a stream from which on families of meridians are drawn.
const AXIS: u32 = 0x6000_0000;
/// Pairs of random numbers for the sky lie beyond those of all other things at a vertex.
const SKY_PAIRS: u32 = 0x1000;
/// Streams of other draws of lines on a map are told by this, and the depth, from those on lights and even skies.
const DRAWS: u32 = 0x200;

impl Tracer<'_> {
    /// Draws a direction of the sky in every lane, and looks for the edges of what hides the sky.
    #[allow(clippy::too_many_arguments)]
    pub fn sample_sky(
        &self,
        sky: &Sky,
        vertices: &mut Vertices,
        surface: &Surface,
        stream: &Stream,
        index: &[u32; LANES],
        depth: u32,
        counts: &mut Counts,
        store: &mut TileStore,
    ) {
        let pairs = SKY_PAIRS + depth * PAIRS_PER_VERTEX;
        let (u, v) = stream.pair(index, pairs);
        let (u, v) = (u.to_array(), v.to_array());
        let mut pdf = [1.0; LANES];
        let directions: [Vec3; LANES] = std::array::from_fn(|l| {
            let (d, p) = sky.sample(u[l] as f64, v[l] as f64);
            pdf[l] = p;
            d
        });
        let direction = from_lanes(&directions);
        let zero = Lane::splat(0.0);
        let lit = vertices.hit & vertices.kinds.lit_by_samples() & !self.reflects_nothing(vertices);
        let above = surface.n.dot(direction).gt(zero).to_bits();
        let active = lit & above;
        let rays = RayPacket {
            active,
            origin: leave(surface.x, surface.geometric, direction),
            direction,
            near: 0.0,
            far: f32::INFINITY,
        };
        counts.shadow += active.count_ones() as u64;
        let blocked = self
            .accel
            .occluded(&to_rays(&rays), active, Coherence::Incoherent);
        let light = Lane::new(pdf);
        let cos = surface.n.dot(direction);
        let bounce = self.bounce_pdf_over_cos(vertices, surface, direction) * cos;
        let weight = light / (light * light + bounce * bounce);
        let first = store.sky_samples.len() as u32;
        vertices.sky = [first, first + 1];
        store.sky_samples.push(SkySample {
            direction,
            weight: <Lane as Real>::select(lane_mask(active & !blocked), weight, zero),
            irradiance: direction_irradiance(surface.n, direction),
            value: masked(
                active,
                self.value_toward(vertices, surface, direction, LightKind::Sampled),
            ),
        });
        if let (Some(adjacency), Some(environment)) = (self.adjacency, &self.scene.environment) {
            let (place, jitter) = stream.pair(index, pairs + 1);
            let number = index[0].wrapping_mul(8).wrapping_add(depth);
            let axis = (stream.uniform(AXIS + number) * 2.0) as usize;
            let first = store.bounce_crossings.len() as u32;
            sky_cells::find(
                self,
                sky,
                environment,
                adjacency,
                vertices,
                surface,
                lit,
                axis,
                [place.to_array(), jitter.to_array()],
                |lane| stream.branch([index[lane], DRAWS + depth]),
                counts,
                &mut store.bounce_crossings,
            );
            vertices.bounce_crossings = [first, store.bounce_crossings.len() as u32];
        }
    }

    /// What the sample brings, before the throughput.
    pub fn sky_light(&self, environment: &Environment, sample: &SkySample) -> V3<Lane> {
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

    /// For bounces that see the map in the lanes of `escaped`: the MIS weight against samples of it at the vertex `from`,
    /// times what turns its irradiance into the radiance of the path; and π times the BSDF times the irradiance.
    pub fn sampled_sky(
        &self,
        sky: &Sky,
        vertices: &Vertices,
        from: &Vertices,
        surface: &Surface,
        escaped: u32,
    ) -> (Lane, V3<Lane>) {
        let d = vertices.direction;
        let cos = surface.n.dot(d);
        let bounce = self.bounce_pdf_over_cos(from, surface, d) * cos;
        let light = Lane::new(std::array::from_fn(|l| {
            if escaped >> l & 1 == 1 {
                sky.pdf(lane_of(d, l))
            } else {
                1.0
            }
        }));
        let zero = Lane::splat(0.0);
        let counts = lane_mask(escaped) & bounce.gt(zero);
        let weight = bounce / (bounce * bounce + light * light) * from.survival;
        let value = self.value_toward(from, surface, d, LightKind::Sampled)
            * direction_irradiance(surface.n, d);
        (
            <Lane as Real>::select(counts, weight, zero),
            masked(counts.to_bits(), value),
        )
    }
}
