//! Where paths go on: drawing a lobe and a direction.

use crate::discontinuity::boundary::{dvec3, vector};
use crate::kernels::bsdf::bsdf_sample;
use crate::kernels::frame::direction_from_local;
use crate::kernels::fresnel::fresnel_dielectric;
use crate::kernels::layered::layered_sample;
use crate::kernels::microfacet::{ndf, smith_g1_over_cos};
use crate::lanes::{LANES, Lane, Real, V3};
use crate::paths::at::Numbers;
use crate::paths::dimensions::Pair;
use crate::paths::rays::{RayPacket, lane_mask, lane_of};
use crate::paths::scene_view::SceneView;
use crate::paths::store::{Lobes, Vertices};
use crate::paths::surface::layered_sample::{Chances, Grain, coat_normal, pdf_coat_normal};
use crate::paths::surface::microfacet_sample::{pdf_normal, visible_normal};
use crate::paths::surface::vertex::Surface;
use glam::DVec3;

/// Chance to go on from surfaces that are black at present, but asked about.
const LEAST_SURVIVAL: f32 = 0.1;
/// Neither of a plastic's two lobes is drawn more rarely than this.
const LEAST_CHANCE: f32 = 0.1;

/// From this many segments on, paths without Russian roulette (those of finite differences) go on
/// with a chance that depends on nothing, and so jumps with nothing: otherwise those in a closed
/// room would never end.
const LONG: u32 = 128;
const LONG_SURVIVAL: f32 = 0.9;

impl SceneView<'_> {
    /// Draws the next direction and decides who goes on and who looks for silhouettes. Only a part
    /// `rim` of the directions that a diffuse lobe may draw is wanted, those nearest to the horizon
    /// (1: all).
    pub fn bsdf_sample(
        &self,
        vertices: &mut Vertices,
        surface: &Surface,
        rim: Lane,
        numbers: &Numbers,
    ) -> RayPacket {
        let (u, v) = numbers.pair(Pair::LobeDirection);
        let one = Lane::splat(1.0);
        let u = <Lane as Real>::select(rim.lt(one), one - rim * (one - u), u);
        vertices.local = cosine_direction(u, v);
        let direction = if surface.interface.is_none() {
            vertices.weight = vertices.diffuse_reflectance;
            direction_from_local(surface.n, vertices.local)
        } else {
            let (choice, _) = numbers.pair(Pair::LobeChoice);
            self.draw_lobes(vertices, surface, [u, v], choice);
            self.bounce_direction(vertices, surface)
        };
        let alive = self.roulette(vertices, numbers);
        self.leaving(surface.x, surface.geometric, direction, alive)
    }

    /// Which paths go on, and which vertices look for silhouettes over their lobes; sets the
    /// weights of both.
    fn roulette(&self, vertices: &mut Vertices, numbers: &Numbers) -> u32 {
        let depth = numbers.depth;
        let zero = Lane::splat(0.0);
        let weight = vertices.throughput.times(vertices.weight);
        let brightest = weight.x.max(weight.y).max(weight.z);
        let mut alive = lane_mask(vertices.hit) & brightest.gt(zero);
        if self.limits.black_goes_on {
            // A black surface reflects nothing, but more if its colour changes.
            alive = lane_mask(vertices.hit & !vertices.kinds.black);
        }
        // Bounces below the horizon end, but what the lobe sees above it may still jump.
        let rough = (vertices.lobes.reflected | vertices.lobes.refracted) & !vertices.kinds.smooth;
        let arrives = vertices.throughput;
        let arrives = arrives.x.max(arrives.y).max(arrives.z);
        let mut looks = alive | (lane_mask(vertices.hit & rough) & arrives.gt(zero));
        let mut survival = Lane::splat(1.0);
        let mut line_survival = survival;
        let number = || numbers.pair(Pair::Roulette).0;
        if depth + 1 >= self.limits.rr_depth {
            let least = if self.limits.black_goes_on {
                LEAST_SURVIVAL
            } else {
                0.0
            };
            let chance = |brightest: Lane| {
                let least = Lane::splat(least);
                brightest.max(least).min(Lane::splat(0.95))
            };
            let u = number();
            let [of_path, of_line] = [
                chance(brightest),
                chance(<Lane as Real>::select(alive, brightest, arrives)),
            ];
            alive = alive & u.lt(of_path);
            looks = looks & u.lt(of_line);
            survival = Lane::splat(1.0) / of_path;
            line_survival = Lane::splat(1.0) / of_line;
        } else if depth + 1 >= LONG {
            let u = number();
            let goes_on = u.lt(Lane::splat(LONG_SURVIVAL));
            (alive, looks) = (alive & goes_on, looks & goes_on);
            survival = Lane::splat(1.0 / LONG_SURVIVAL);
            line_survival = survival;
        }
        vertices.survival = <Lane as Real>::select(alive, survival, zero);
        vertices.line_survival = <Lane as Real>::select(looks, line_survival, zero);
        alive.to_bits()
    }

    /// The kernel at θ₀: the next direction; sets the weight.
    fn bounce_direction(&self, vertices: &mut Vertices, surface: &Surface) -> V3<Lane> {
        let Some(interface) = &surface.interface else {
            return surface.n;
        };
        let local = vertices.local;
        let (next, weight) = bsdf_sample(
            surface.n,
            vertices.direction,
            local,
            *interface,
            self.transmission(vertices, surface.n, local.z),
            vertices.lobes.masks(),
            vertices.kinds.masks(),
        );
        vertices.weight = weight * vertices.inverse_density;
        let Some(layers) = &surface.layers else {
            vertices.weight = surface.shown(vertices, next, vertices.weight);
            return next;
        };
        let (own, weight) = layered_sample(
            surface.n,
            vertices.direction,
            local,
            *interface,
            *layers,
            vertices.lobes.masks(),
            vertices.kinds.masks(),
        );
        let is_layered = lane_mask(vertices.kinds.layered());
        let weight = weight * vertices.inverse_density;
        vertices.weight = V3::select(is_layered, weight, vertices.weight);
        let next = V3::select(is_layered, own, next);
        vertices.weight = surface.shown(vertices, next, vertices.weight);
        next
    }

    /// Sets the lobe, its coordinate and its density in lanes that are more than diffuse.
    // Long: one kind of surface after another.
    fn draw_lobes(
        &self,
        vertices: &mut Vertices,
        surface: &Surface,
        [u, v]: [Lane; 2],
        choice: Lane,
    ) {
        let [u, v, choice] = [u, v, choice].map(Lane::to_array);
        let V3 { x, y, z } = vertices.local;
        let [mut lx, mut ly, mut lz] = [x, y, z].map(Lane::to_array);
        let mut density = [1.0f32; LANES];
        let mut chances_of = [1.0f32; LANES];
        let mut lobes = Lobes::default();
        let kinds = vertices.kinds;
        for lane in 0..LANES {
            let bit = 1u32 << lane;
            if kinds.special() & bit == 0 {
                lobes.diffuse |= bit;
                continue;
            }
            if kinds.null & bit != 0 {
                continue;
            }
            let view = View::of_lane(vertices, surface, lane);
            if kinds.plastic & bit != 0 {
                let chance = view.specular_chance;
                if choice[lane] >= chance {
                    lobes.diffuse |= bit;
                    chances_of[lane] = 1.0 - chance;
                    continue;
                }
                chances_of[lane] = chance;
            }
            if let Some(chances) = &view.layers {
                if choice[lane] < chances.diffuse {
                    lobes.diffuse |= bit;
                    chances_of[lane] = chances.diffuse;
                    continue;
                }
                if choice[lane] < chances.diffuse + chances.coat {
                    let h = coat_normal(chances.gloss, [u[lane], v[lane]].map(f64::from));
                    density[lane] = pdf_coat_normal(chances.gloss, h) as f32;
                    (lx[lane], ly[lane], lz[lane]) = (h.x as f32, h.y as f32, h.z as f32);
                    lobes.reflected |= bit;
                    lobes.coat |= bit;
                    chances_of[lane] = chances.coat;
                    continue;
                }
            }
            if let Some(grain) = &view.grain {
                let h = grain.visible_normal(view.wi, [u[lane], v[lane]].map(f64::from));
                density[lane] = grain.pdf_normal(view.wi, h) as f32;
                (lx[lane], ly[lane], lz[lane]) = (h.x as f32, h.y as f32, h.z as f32);
                if let Some(chances) = &view.layers {
                    let main = 1.0 - chances.diffuse - chances.coat;
                    let passes = chances.passes(view.wi.dot(h));
                    let left = (choice[lane] - (1.0 - main)) / main;
                    if left < passes {
                        lobes.refracted |= bit;
                        chances_of[lane] = main * passes;
                    } else {
                        lobes.reflected |= bit;
                        chances_of[lane] = main * (1.0 - passes);
                    }
                    continue;
                }
            } else {
                let h = if kinds.smooth & bit != 0 {
                    DVec3::Z
                } else {
                    let h = visible_normal(view.wi, view.alpha, [u[lane], v[lane]].map(f64::from));
                    density[lane] = pdf_normal(view.wi, h, view.alpha) as f32;
                    h
                };
                (lx[lane], ly[lane], lz[lane]) = (h.x as f32, h.y as f32, h.z as f32);
            }
            if kinds.dielectric & bit != 0 {
                let h = DVec3::new(lx[lane].into(), ly[lane].into(), lz[lane].into());
                let ratio = if kinds.inside & bit != 0 {
                    1.0 / view.eta
                } else {
                    view.eta
                };
                let mut reflected = fresnel_dielectric(view.wi.dot(h).max(1e-6), ratio) as f32;
                if kinds.thin & bit != 0 {
                    reflected *= 2.0 / (1.0 + reflected);
                }
                if choice[lane] >= reflected {
                    lobes.refracted |= bit;
                    chances_of[lane] = 1.0 - reflected;
                    continue;
                }
                chances_of[lane] = reflected;
            }
            lobes.reflected |= bit;
        }
        vertices.lobes = lobes;
        vertices.local = V3::new(Lane::new(lx), Lane::new(ly), Lane::new(lz));
        let one = Lane::splat(1.0);
        vertices.lobe_chance = Lane::new(chances_of);
        let density = Lane::new(density) * vertices.lobe_chance;
        let zero = Lane::splat(0.0);
        vertices.inverse_density = <Lane as Real>::select(density.gt(zero), one / density, zero);
    }

    /// Density over solid angle of the bounce's direction `d` (unit) over its cosine to the normal,
    /// of all lobes that light samples light too.
    pub fn bsdf_pdf_over_cos(&self, vertices: &Vertices, surface: &Surface, d: V3<Lane>) -> Lane {
        let diffuse = std::f32::consts::FRAC_1_PI;
        if surface.interface.is_none() {
            return Lane::splat(std::f32::consts::FRAC_1_PI);
        }
        let kinds = vertices.kinds;
        Lane::new(std::array::from_fn(|lane| {
            let bit = 1u32 << lane;
            if kinds.special() & bit == 0 {
                return diffuse;
            }
            if kinds.lit_by_samples() & bit == 0 {
                return 0.0;
            }
            let view = View::of_lane(vertices, surface, lane);
            let chance = match &view.layers {
                Some(chances) => 1.0 - chances.diffuse - chances.coat,
                None if kinds.plastic & bit != 0 => view.specular_chance,
                None => 1.0,
            };
            let mut sum = diffuse
                * match &view.layers {
                    Some(chances) => chances.diffuse,
                    None => 1.0 - chance,
                };
            if kinds.wide & bit != 0 {
                let n = lane_of(surface.n, lane).as_dvec3();
                let d = lane_of(d, lane).as_dvec3();
                let cos = n.dot(d);
                if cos > 0.0 {
                    let h = (view.world + d).normalize();
                    let sin2 = n.cross(h).length_squared();
                    let facets = match &view.grain {
                        Some(grain) => {
                            let h = frame_of_lane(surface, lane).map(|axis| axis.dot(h));
                            let h = DVec3::from(h);
                            let passes = view.layers.as_ref();
                            let passes = passes.map_or(0.0, |l| l.passes(view.wi.dot(h)));
                            grain.visible_over_cos(view.wi, h) * f64::from(1.0 - passes)
                        }
                        None => {
                            ndf(1.0 - sin2, sin2, view.alpha, true)
                                * smith_g1_over_cos(view.wi.z, view.alpha, true)
                        }
                    };
                    sum += chance * (facets / (4.0 * cos)) as f32;
                }
            }
            sum
        }))
    }
}

/// One lane of a surface, seen from the ray that arrived.
pub struct View {
    /// Toward where the ray came from, unit, in the frame of the shading normal, above its horizon.
    pub wi: DVec3,
    /// The same in the world.
    pub world: DVec3,
    pub alpha: f64,
    pub eta: f64,
    /// Of a plastic: chance that its specular lobe is drawn.
    pub specular_chance: f32,
    /// Given where roughness depends on the direction, and where there are layers.
    pub grain: Option<Grain>,
    /// Given where there are layers.
    pub layers: Option<Chances>,
}

impl View {
    pub fn of_lane(vertices: &Vertices, surface: &Surface, lane: usize) -> Self {
        let world = -lane_of(vertices.direction, lane).as_dvec3().normalize();
        let frame = frame_of_lane(surface, lane);
        let mut wi = DVec3::from(frame.map(|axis| axis.dot(world)));
        wi.z = wi.z.max(1e-6);
        let Some(s) = &surface.interface else {
            return Self {
                wi,
                world,
                alpha: 1.0,
                eta: 1.0,
                specular_chance: 0.0,
                grain: None,
                layers: None,
            };
        };
        let eta = s.eta.x.to_array()[lane] as f64;
        let mut specular_chance = 0.0;
        if vertices.kinds.plastic >> lane & 1 == 1 {
            // As Mitsuba weighs them: by the mean reflectances, and by what the interface reflects
            // here.
            let mean = |v: V3<Lane>| lane_of(v, lane).element_sum().max(1e-6);
            let (diffuse, specular) = (mean(s.reflectance), mean(s.second_reflectance));
            let reflected = fresnel_dielectric(wi.z, eta) as f32;
            let (a, b) = (reflected * specular, (1.0 - reflected) * diffuse);
            specular_chance = (a / (a + b)).clamp(LEAST_CHANCE, 1.0 - LEAST_CHANCE);
        }
        Self {
            wi,
            world,
            alpha: s.alpha.to_array()[lane] as f64,
            eta,
            specular_chance,
            grain: Grain::of_lane(vertices, surface, lane, frame),
            layers: Chances::of_lane(vertices, surface, lane),
        }
    }

    /// Density over solid angle of facet normals in the lobe that was drawn, about z.
    pub fn pdf_normal(&self, vertices: &Vertices, lane: usize, h: DVec3) -> f64 {
        match (&self.grain, &self.layers) {
            (_, Some(chances)) if vertices.lobes.coat >> lane & 1 == 1 => {
                pdf_coat_normal(chances.gloss, h)
            }
            (Some(grain), _) => grain.pdf_normal(self.wi, h),
            _ => pdf_normal(self.wi, h, self.alpha),
        }
    }

    /// How rough the lobe that was drawn is in a direction across the normal (unit, in the world).
    pub fn alpha_along(&self, vertices: &Vertices, lane: usize, tangent: DVec3) -> f64 {
        match (&self.grain, &self.layers) {
            (_, Some(chances)) if vertices.lobes.coat >> lane & 1 == 1 => chances.coat_alpha(),
            (Some(grain), _) => grain.alpha_along(tangent),
            _ => self.alpha,
        }
    }
}

/// The axes of a lane's shading frame.
pub fn frame_of_lane(surface: &Surface, lane: usize) -> [DVec3; 3] {
    let n = vector(lane_of(surface.n, lane).as_dvec3());
    [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
        .map(|[x, y, z]| dvec3(direction_from_local(n, V3 { x, y, z })))
}

/// A cosine-distributed direction about +z from two uniform numbers.
pub fn cosine_direction(u: Lane, v: Lane) -> V3<Lane> {
    let radius = u.sqrt();
    let angle = v * Lane::splat(std::f32::consts::TAU);
    let (sin, cos) = angle.sin_cos();
    let up = (Lane::splat(1.0) - u).max(Lane::splat(0.0)).sqrt();
    V3::new(radius * cos, radius * sin, up)
}
