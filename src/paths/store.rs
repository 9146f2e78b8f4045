//! What is kept of each path, so that the sweeps trace no ray.

use super::bounce_cells::BounceCrossing;
use super::materials::Kinds;
use crate::lanes::{LANES, Lane, Real, V3};
use crate::scene::Rgb;
use crate::trace::geometry::{Geometry, NO_TRIANGLE};
use crate::warp::boundary::Boundary;
use glam::DVec3;

/// One path vertex in each lane: the ray that arrived and what was sampled where it ended. Some 150 bytes a path.
///
/// Everything here is a value at θ₀. The sweeps re-solve positions and normals from the rays and triangles with
/// tangents or cotangents attached.
#[derive(Clone, Debug)]
pub struct Vertices {
    /// Lanes whose ray ended on a surface.
    pub hit: u32,
    /// Lanes whose ray left the scene.
    pub escaped: u32,
    /// Lanes that move against what they see, where silhouettes are looked for (`paths::moving`).
    pub moves: u32,
    pub origin: V3<Lane>,
    pub direction: V3<Lane>,
    /// Triangle in each lane, or [`NO_TRIANGLE`].
    pub triangle: [u32; LANES],
    /// ±1: the side of the shading normal that looks back along the ray.
    pub facing: Lane,
    pub kinds: Kinds,
    /// Product of weights before this vertex.
    pub throughput: V3<Lane>,
    /// Diffuse reflectance here, where there is nothing else; zero where the surface is black from this side.
    pub colour: V3<Lane>,
    /// Multiplies the emission found by the arriving ray. 1 for camera rays and what narrow lobes found; for `sampled`
    /// lanes the MIS weight and what turns the irradiance of the previous vertex into radiance.
    pub emission_weight: Lane,
    /// Lanes whose emission is a sample of the previous vertex's integral over the lights.
    pub sampled: u32,
    /// π times the BSDF times the irradiance that `sampled` lanes bring to the previous vertex.
    pub sampled_value: V3<Lane>,
    pub light: LightSamples,
    /// Lanes whose path goes on by diffuse scattering, reflection or refraction; others go straight on.
    pub lobes: Lobes,
    /// Coordinate of the next direction in the frame of the shading normal: the direction itself, or the microfacet's
    /// normal (`kernels::interface`).
    pub local: [Lane; 3],
    /// One over the density of that coordinate and the chance of its lobe, in the measure of `interface_bounce`.
    pub inverse_density: Lane,
    /// The chance that its lobe was drawn.
    pub lobe_chance: Lane,
    /// What the throughput is multiplied with, without survival.
    pub weight: V3<Lane>,
    /// 1/(chance of going on), 0 where the path ends here.
    pub survival: Lane,
    /// 1/(chance of looking for silhouettes over the hemisphere), 0 where none are looked for. Not `survival` where a rough lobe's
    /// bounce ends below the horizon: the lobe itself does not.
    pub line_survival: Lane,
    /// The shadow edges on this vertex's light lines, as a range of the tile's list.
    pub crossings: [u32; 2],
    /// The silhouettes on its bounce lines, likewise.
    pub bounce_crossings: [u32; 2],
    /// Lanes that see each light without an extent, likewise.
    pub delta_lights: [u32; 2],
    /// Its sample of the environment map, likewise: one or none.
    pub sky: [u32; 2],
}

/// A sample of the environment map in each lane.
#[derive(Clone, Debug)]
pub struct SkySample {
    /// World, unit.
    pub direction: V3<Lane>,
    /// MIS weight over density over solid angle; 0 where the sky is hidden.
    pub weight: Lane,
    /// `kernels::light::direction_irradiance` of it.
    pub irradiance: Lane,
    /// π times the BSDF toward it.
    pub value: V3<Lane>,
}

/// The lobe that was drawn, a bit a lane.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lobes {
    pub diffuse: u32,
    pub reflected: u32,
    pub refracted: u32,
}

impl Vertices {
    /// Where a lane's ray ends, in f64.
    pub fn position(&self, geometry: &Geometry, lane: usize) -> DVec3 {
        let of = |v: V3<Lane>| {
            DVec3::new(
                v.x.to_array()[lane] as f64,
                v.y.to_array()[lane] as f64,
                v.z.to_array()[lane] as f64,
            )
        };
        let (o, d) = (of(self.origin), of(self.direction));
        let [p, q, r] = geometry.triangles[self.triangle[lane] as usize]
            .map(|v| geometry.positions[v as usize].as_dvec3());
        let n = (q - p).cross(r - p);
        o + d * (n.dot(p - o) / n.dot(d))
    }
}

/// The light sample of each lane.
#[derive(Clone, Debug)]
pub struct LightSamples {
    pub patch: [u32; LANES],
    pub s: Lane,
    pub r: Lane,
    /// MIS weight over probability density in (s, r); 0 where the point is hidden or there is none.
    pub weight: Lane,
    /// `kernels::light::triangle_irradiance` of the point.
    pub irradiance: Lane,
    /// π times the BSDF toward the point.
    pub value: V3<Lane>,
}

impl Default for Vertices {
    fn default() -> Self {
        let (zero, one) = (Lane::splat(0.0), Lane::splat(1.0));
        Self {
            hit: 0,
            escaped: 0,
            moves: 0,
            origin: V3::splat(0.0),
            direction: V3::splat(0.0),
            triangle: [NO_TRIANGLE; LANES],
            facing: one,
            kinds: Kinds::default(),
            throughput: V3::splat(1.0),
            colour: V3::splat(0.0),
            emission_weight: zero,
            sampled: 0,
            sampled_value: V3::splat(0.0),
            light: LightSamples {
                patch: [0; LANES],
                s: zero,
                r: zero,
                weight: zero,
                irradiance: zero,
                value: V3::splat(0.0),
            },
            lobes: Lobes {
                diffuse: u32::MAX,
                ..Lobes::default()
            },
            local: [zero, zero, one],
            inverse_density: one,
            lobe_chance: one,
            weight: V3::splat(0.0),
            survival: zero,
            line_survival: zero,
            crossings: [0; 2],
            bounce_crossings: [0; 2],
            delta_lights: [0; 2],
            sky: [0; 2],
        }
    }
}

/// A jump of the light's visibility, in the square of its patch.
#[derive(Clone, Copy, Debug)]
pub struct LightCrossing {
    pub boundary: Boundary,
    pub lane: u8,
    pub patch: u32,
    pub at: [f64; 2],
    /// Radiance of the path per unit of Ḟ, all at θ₀.
    pub radiance_per_side: Rgb,
}

/// A jump of the radiance along a film lattice line.
#[derive(Clone, Copy, Debug)]
pub struct FilmCrossing {
    pub boundary: Boundary,
    /// 0: found along a row; 1: along a column.
    pub axis: u8,
    /// Film position in pixels.
    pub at: [f64; 2],
    /// Radiance before minus radiance after the crossing.
    pub jump: Rgb,
}

/// Everything a tile's sweeps need.
#[derive(Default)]
pub struct TileStore {
    /// Vertices by packet and depth: packet p's are `vertices[depths[p]..depths[p + 1]]`.
    pub vertices: Vec<Vertices>,
    pub depths: Vec<u32>,
    pub light_crossings: Vec<LightCrossing>,
    pub bounce_crossings: Vec<BounceCrossing>,
    /// Lanes that see a light without an extent: for each vertex one entry a light.
    pub delta_visible: Vec<u32>,
    pub film_crossings: Vec<FilmCrossing>,
    pub sky_samples: Vec<SkySample>,
}

impl TileStore {
    pub fn clear(&mut self) {
        self.vertices.clear();
        self.depths.clear();
        self.depths.push(0);
        self.light_crossings.clear();
        self.bounce_crossings.clear();
        self.delta_visible.clear();
        self.sky_samples.clear();
        self.film_crossings.clear();
    }

    /// A vertex's sample of the environment map.
    pub fn sky_sample(&self, vertices: &Vertices) -> Option<&SkySample> {
        let [from, to] = vertices.sky;
        (from != to).then(|| &self.sky_samples[from as usize])
    }

    /// The vertices of a packet, camera side first.
    pub fn path(&self, packet: usize) -> &[Vertices] {
        &self.vertices[self.depths[packet] as usize..self.depths[packet + 1] as usize]
    }
}

/// The lanes of a bit mask, as the lane type's own mask.
pub fn lane_mask(bits: u32) -> <Lane as Real>::Mask {
    let ones = std::array::from_fn(|l| if bits >> l & 1 == 1 { 1.0 } else { 0.0 });
    Lane::new(ones).gt(Lane::splat(0.5))
}

/// The lanes of a vector that `bits` selects, zero elsewhere.
pub fn masked(bits: u32, v: V3<Lane>) -> V3<Lane> {
    V3::select(lane_mask(bits), v, V3::splat(0.0))
}
