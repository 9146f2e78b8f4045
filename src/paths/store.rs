//! What is kept of each path, so that the sweeps trace no ray.

use crate::kernels::bsdf::LobeMasks;
use crate::kernels::layered::LitMasks;
use crate::lanes::{LANES, Lane, Real, V3};
use crate::paths::boundary_sample::{BoundarySample, Found};
use crate::paths::counts::Counts;
use crate::paths::rays::lane_mask;
use crate::paths::relayed::Relay;
use crate::paths::surface::kinds::Kinds;
use crate::paths::warp::follow::{Follow, WarpedVertex};
use crate::trace::geometry::{Geometry, NO_TRIANGLE};
use glam::DVec3;

/// One path vertex in each lane: the ray that arrived and what was sampled where it ended. Some 150
/// bytes a path.
///
/// Everything here is a value at θ₀. The sweeps re-solve positions and normals from the rays and
/// triangles with tangents or cotangents attached.
#[derive(Clone, Debug)]
pub struct Vertices {
    /// Lanes whose ray ended on a surface.
    pub hit: u32,
    /// Lanes whose ray left the scene.
    pub escaped: u32,
    /// Lanes that move against what they see, where an estimator wants to know (`paths::moving`).
    pub moves: u32,
    pub origin: V3<Lane>,
    pub direction: V3<Lane>,
    /// Triangle in each lane, or [`NO_TRIANGLE`].
    pub triangle: [u32; LANES],
    /// ±1: the side of the shading normal that looks back along the ray.
    pub facing: Lane,
    pub kinds: Kinds,
    /// Which material each lane has met, where surfaces are made of several.
    pub choice: Option<Box<Choice>>,
    /// Product of weights before this vertex, and of that of the choice.
    pub throughput: V3<Lane>,
    /// Diffuse reflectance here, where there is nothing else; zero where the surface is black from
    /// this side.
    pub diffuse_reflectance: V3<Lane>,
    /// Multiplies the emission found by the arriving ray. 1 for camera rays and what narrow lobes
    /// found; for `sampled` lanes the MIS weight and what turns the irradiance of the previous
    /// vertex into radiance.
    pub emission_weight: Lane,
    /// Lanes whose emission is a sample of the previous vertex's integral over the lights.
    pub sampled: u32,
    /// π times the BSDF times the irradiance that `sampled` lanes bring to the previous vertex.
    pub sampled_value: V3<Lane>,
    pub light: LightSamples,
    /// Lanes whose path goes on by diffuse scattering, reflection or refraction; others go straight
    /// on.
    pub lobes: Lobes,
    /// Coordinate of the next direction in the frame of the shading normal: the direction itself,
    /// or the microfacet's normal (`kernels::bsdf`).
    pub local: V3<Lane>,
    /// One over the density of that coordinate and the chance of its lobe, in the measure of
    /// `bsdf_sample`.
    pub inverse_density: Lane,
    /// The chance that its lobe was drawn.
    pub lobe_chance: Lane,
    /// What the throughput is multiplied with, without survival.
    pub weight: V3<Lane>,
    /// 1/(chance of going on), 0 where the path ends here.
    pub survival: Lane,
    /// 1/(chance of looking for silhouettes over the hemisphere), 0 where none are looked for. Not
    /// `survival` where a rough lobe's bounce ends below the horizon: the lobe itself does not.
    pub line_survival: Lane,
    /// Lanes whose next directions drift (`paths::lobe_drift`).
    pub drifts: u32,
    /// Lanes whose next directions rest in the world where nothing carries them.
    pub rests: u32,
    /// What jumps in this vertex's integrals, as a range of the tile's list.
    pub boundary: [u32; 2],
    /// Which lanes see each delta light, likewise.
    pub delta_lights: [u32; 2],
    /// Its sample of the environment map, likewise: one or none.
    pub environment: [u32; 2],
    /// Which lanes are relays, as a range of the tile's list.
    pub relays: [u32; 2],
    /// What moves, if samples do.
    pub warped: WarpedVertex,
}

/// Of the materials that a surface is made of, the one that each lane has met.
#[derive(Clone, Debug)]
pub struct Choice {
    /// Its number among those of the surface (`paths::surface::choice`).
    pub part: [u16; LANES],
    /// One over the chance that it was chosen with.
    pub inverse_chance: Lane,
    /// Product of weights before the choice.
    pub arriving: V3<Lane>,
}

/// A sample of the environment map in each lane.
#[derive(Clone, Debug)]
pub struct EnvironmentSample {
    /// World, unit.
    pub direction: V3<Lane>,
    /// MIS weight over density over solid angle; 0 where the environment is hidden.
    pub weight: Lane,
    /// `kernels::light::direction_irradiance` of it.
    pub irradiance: Lane,
    /// π times the BSDF toward it.
    pub value: V3<Lane>,
}

impl EnvironmentSample {
    /// Lanes that would be lit by it if nothing stood between.
    pub fn drawn(&self) -> u32 {
        let V3 { x, y, z } = self.value;
        let lit = x.max(y).max(z) * self.irradiance;
        lit.gt(Lane::splat(0.0)).to_bits()
    }
}

/// Whether a delta light is seen, a bit a lane. Of lanes that it cannot light neither is said.
#[derive(Clone, Copy, Debug, Default)]
pub struct DeltaSight {
    pub seen: u32,
    /// Something stands before it.
    pub hidden: u32,
}

/// The lobe that was drawn, a bit a lane.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lobes {
    pub diffuse: u32,
    pub reflected: u32,
    pub refracted: u32,
    /// Of those that are reflected: by a clear coat above the rest.
    pub coat: u32,
}

impl Lobes {
    /// Of packets, as the kernels take them.
    pub fn masks<F: Real<Mask = <Lane as Real>::Mask>>(&self) -> LobeMasks<F> {
        self.map(lane_mask)
    }

    /// Of one lane.
    pub fn masks_of_lane<F: Real<Mask = bool>>(&self, lane: usize) -> LobeMasks<F> {
        self.map(|bits| bits >> lane & 1 == 1)
    }

    /// Which lobes of layered surfaces to light for each lane's lobe, and for all but that: what is
    /// scattered diffusely is lit with both.
    pub fn lit_alone<F: Real<Mask = <Lane as Real>::Mask>>(&self) -> [LitMasks<F>; 2] {
        let lit = |has_lobe, has_coat| LitMasks {
            has_lobe: lane_mask(has_lobe),
            has_coat: lane_mask(has_coat),
        };
        [lit(!self.coat, self.coat), lit(0, 0)]
    }

    fn map<F: Real>(&self, mask: impl Fn(u32) -> F::Mask) -> LobeMasks<F> {
        LobeMasks {
            is_diffuse: mask(self.diffuse),
            is_reflected: mask(self.reflected),
            is_refracted: mask(self.refracted),
            is_coat: mask(self.coat),
        }
    }
}

impl Vertices {
    /// Whether any lane looks for silhouettes over its lobe.
    pub fn looks(&self) -> bool {
        self.line_survival.gt(Lane::splat(0.0)).to_bits() != 0
    }

    /// Product of weights before this vertex.
    pub fn arriving_throughput(&self) -> V3<Lane> {
        self.choice
            .as_ref()
            .map_or(self.throughput, |choice| choice.arriving)
    }

    /// Lanes of rough metal, glass and plastic whose next directions rest in the world.
    pub fn resting_lobes(&self) -> u32 {
        self.rests & !self.drifts
    }

    /// Lanes whose lobe shares the lights with light samples.
    pub fn shares_lights(&self) -> u32 {
        self.lobes.diffuse | (self.lobes.reflected & self.kinds.wide & !self.lobes.coat)
    }

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
            choice: None,
            throughput: V3::splat(1.0),
            diffuse_reflectance: V3::splat(0.0),
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
            local: V3::new(zero, zero, one),
            inverse_density: one,
            lobe_chance: one,
            weight: V3::splat(0.0),
            survival: zero,
            line_survival: zero,
            drifts: 0,
            rests: 0,
            boundary: [0; 2],
            delta_lights: [0; 2],
            environment: [0; 2],
            relays: [0; 2],
            warped: WarpedVertex::default(),
        }
    }
}

/// A path of the film whose samples move.
#[derive(Clone, Copy, Debug)]
pub struct MovingFilmPath {
    /// The film point that it goes through.
    pub at: [Lane; 2],
    /// What that follows, as a range of [`TileStore::follows`].
    pub follows: [u32; 2],
}

/// Everything a tile's sweeps need.
#[derive(Default)]
pub struct TileStore {
    /// Vertices by packet and depth: packet p's are `vertices[depths[p]..depths[p + 1]]`.
    pub vertices: Vec<Vertices>,
    pub depths: Vec<u32>,
    /// Which lanes see each delta light: for each vertex one entry a light.
    pub delta_visible: Vec<DeltaSight>,
    pub environment_samples: Vec<EnvironmentSample>,
    /// If samples move: of each path, in the order of [`TileStore::depths`].
    pub film_paths: Vec<MovingFilmPath>,
    /// Paths of a packet that share their random numbers, one after another; 1 if none do.
    pub twins: usize,
    /// What samples follow.
    pub follows: Vec<Follow>,
    pub relays: Vec<Relay>,
    /// What jumps in the vertices' integrals, and then what jumps on the film.
    pub found: Found,
    /// Of `found`, what belongs to the vertices.
    pub vertex_samples: usize,
    pub counts: Counts,
}

impl TileStore {
    /// Forgets everything, and keeps the memory.
    pub fn clear(&mut self) {
        self.forget_paths();
        self.counts = Counts::default();
    }

    /// Forgets the paths, but not what was counted.
    pub fn forget_paths(&mut self) {
        self.vertices.clear();
        self.depths.clear();
        self.depths.push(0);
        self.delta_visible.clear();
        self.environment_samples.clear();
        self.film_paths.clear();
        self.twins = 1;
        self.follows.clear();
        self.relays.clear();
        self.found.clear();
        self.vertex_samples = 0;
    }

    /// A vertex's sample of the environment map.
    pub fn environment_sample(&self, vertices: &Vertices) -> Option<&EnvironmentSample> {
        let [from, to] = vertices.environment;
        (from != to).then(|| &self.environment_samples[from as usize])
    }

    /// Whether samples move.
    pub fn samples_move(&self) -> bool {
        !self.film_paths.is_empty()
    }

    /// The path that shares its random numbers with this one.
    pub fn twin(&self, path: usize) -> Option<usize> {
        (self.twins == 2).then_some(path ^ 1)
    }

    /// What some sample follows.
    pub fn followed(&self, range: [u32; 2]) -> &[Follow] {
        let [from, to] = range.map(|i| i as usize);
        &self.follows[from..to]
    }

    /// The relays among a vertex's lanes.
    pub fn relays(&self, vertices: &Vertices) -> &[Relay] {
        let [from, to] = vertices.relays.map(|i| i as usize);
        &self.relays[from..to]
    }

    /// What jumps in a vertex's integrals.
    pub fn boundary(&self, vertices: &Vertices) -> &[BoundarySample] {
        let [from, to] = vertices.boundary.map(|i| i as usize);
        &self.found.samples[from..to]
    }

    /// What jumps on the film.
    pub fn film_boundary(&self) -> &[BoundarySample] {
        &self.found.samples[self.vertex_samples..]
    }

    /// Which lanes of a vertex see each delta light.
    pub fn delta_visible(&self, vertices: &Vertices) -> &[DeltaSight] {
        let [from, to] = vertices.delta_lights.map(|i| i as usize);
        &self.delta_visible[from..to]
    }

    /// The vertices of a packet, camera side first.
    pub fn path(&self, packet: usize) -> &[Vertices] {
        &self.vertices[self.depths[packet] as usize..self.depths[packet + 1] as usize]
    }
}
