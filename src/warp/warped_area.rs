//! Warped-area sampling: Bangaru, Li & Durand (2020), "Unbiased warped-area sampling for
//! differentiable rendering".
//!
//! The velocity at ω is a mean of those of surface points around it,
//!
//!   V(ω) = Σ w_i V_i / Σ w_i,  w_i = e^(t_i) / (D_i + B_i)^γ,
//!
//! with auxiliary directions ω_i of density ∝ e^(−t), t = κ(1 − ω·ω_i), D = e^t − 1, and B the
//! boundary test, which vanishes on silhouettes. A silhouette at ω gets an unbounded weight, so
//! that V is its velocity there. Only D depends on ω, and ∇_ω t = −κ ω_i:
//!
//!   ∇w = −γ w/(D + B) ∇D = γ κ w e^t/(D + B) ω_i, as far as that is tangential.
//!
//! With few rays the mean of 1/Σw is not one over that of Σw, so V does not quite have the
//! silhouettes' velocity: the method is consistent, and not unbiased. Russian roulette over the
//! number of rays removes that (§5.2 there): V is the telescoping sum of the differences that
//! further batches make.

use crate::discontinuity::adjacency::Adjacency;
use crate::lanes::{LANES, Lane, V3};
use crate::paths::at::At;
use crate::paths::bounce::BounceEnd;
use crate::paths::counts::Counts;
use crate::paths::dimensions::Single;
use crate::paths::estimator::BoundaryEstimator;
use crate::paths::random::Stream;
use crate::paths::rays::{from_lanes, lane_of};
use crate::paths::scene_view::SceneView;
use crate::paths::warp::follow::Follow;
use crate::paths::warp::kernel::{LobeKernel, Use, around, auxiliary};
use crate::paths::warp::seam::{FilmPath, FilmPoints, MapSamples, Warp, WarpedBounce};
use crate::scene::{Film, Filter};
use crate::warp::boundary_distance::{boundary_distance, vertex_normals};
use crate::warp::bundle::{Hit, PacketHits, lanes, unit};
use crate::warp::of_two::{gaussian, light_directions};
use crate::warp::options::{WarpOptions, WarpedAreaOptions};
use glam::{DVec3, Vec3};
use std::sync::OnceLock;

/// Rays whose D + B is below this count for nothing, as in the published program.
const LEAST_DISTANCE: f64 = 1e-4;
/// Further batches that Russian roulette may add.
const MOST_BATCHES: u32 = 30;

/// Moves samples by harmonic means of what lies around them.
pub struct WarpedArea<'a> {
    adjacency: &'a Adjacency,
    options: &'a WarpedAreaOptions,
    /// Of vertices (`boundary_distance::vertex_normals`).
    normals: OnceLock<Vec<Vec3>>,
}

impl<'a> WarpedArea<'a> {
    pub fn new(adjacency: &'a Adjacency, options: &'a WarpedAreaOptions) -> Self {
        Self {
            adjacency,
            options,
            normals: OnceLock::new(),
        }
    }
}

/// The film that this method samples: beyond its border, too, where samples move across that.
pub fn film(_: &WarpOptions, film: Film) -> Result<Film, String> {
    match film.filter {
        Filter::Box { .. } => Err(
            "warped-area moves samples across the borders of a box filter, where it jumps, so gradients would be wrong; \
             use a gaussian or a tent filter"
                .into(),
        ),
        _ => Ok(Film {
            sample_border: true,
            ..film
        }),
    }
}

/// What one auxiliary ray says.
#[derive(Clone, Copy)]
struct Weighed {
    /// `None`: the sky, which rests.
    hit: Option<Hit>,
    weight: f64,
    /// Of the weight, by the direction or the film point.
    gradient: DVec3,
}

/// The auxiliary rays of a packet: their offsets, or what mirrors the ones before.
struct Draws<'a> {
    stream: Stream,
    index: &'a [u32; LANES],
    antithetic: bool,
}

impl Draws<'_> {
    /// Uniform in the unit square, of ray `number`; and whether it mirrors the one before.
    fn at(&self, number: u32) -> ([[f32; LANES]; 2], bool) {
        let own = if self.antithetic { number / 2 } else { number };
        let (x, y) = self.stream.pair(self.index, own);
        let mirrors = self.antithetic && number % 2 == 1;
        ([x.to_array(), y.to_array()], mirrors)
    }

    /// Batches of rays beyond the first that a lane draws, each with this chance.
    fn batches(&self, lane: usize, chance: f64) -> u32 {
        let of_lane = self.index[lane];
        let goes_on = |batch: &u32| {
            let number = self.stream.single(Single::Debias, [of_lane, *batch, 0]);
            f64::from(number) < chance
        };
        (0..MOST_BATCHES).take_while(goes_on).count() as u32
    }
}

impl WarpedArea<'_> {
    /// w and ∇w of a ray with this t. `along` is ∇_ω t = −`along`, tangential.
    fn weigh(
        &self,
        view: &SceneView,
        origin: DVec3,
        hit: Option<Hit>,
        exponent: f64,
        along: DVec3,
    ) -> Weighed {
        let none = Weighed {
            hit,
            weight: 0.0,
            gradient: DVec3::ZERO,
        };
        let grown = exponent.exp();
        let border = hit.map_or(1.0, |hit| {
            let place = (hit.triangle, hit.barycentrics);
            let normals = self.normals.get_or_init(|| vertex_normals(view.geometry));
            let normals = (normals.as_slice(), self.options.beta);
            boundary_distance(view.geometry, self.adjacency, normals, place, origin)
        });
        let distance = grown - 1.0 + border;
        if distance < LEAST_DISTANCE || !grown.is_finite() {
            return none;
        }
        let gamma = self.options.exponent;
        let weight = grown / distance.powf(gamma);
        Weighed {
            weight,
            gradient: along * (gamma * weight * grown / distance),
            ..none
        }
    }

    /// What a sample follows, from its rays in the order in which they were drawn. `score` turns
    /// the gradient of a share into the score per velocity.
    fn follow(
        &self,
        rays: &[Weighed],
        lane: usize,
        score: impl Fn(DVec3) -> DVec3,
        out: &mut Vec<Follow>,
    ) {
        let batch = self.options.rays as usize;
        let mut shares = vec![(0.0, DVec3::ZERO); rays.len()];
        let mut chance = 1.0;
        for end in (batch..=rays.len()).step_by(batch) {
            // This many rays in place of one batch fewer.
            add_mean(&rays[..end], 1.0 / chance, &mut shares);
            if end > batch {
                add_mean(&rays[..end - batch], -1.0 / chance, &mut shares);
            }
            chance *= self.options.debias_chance;
        }
        for (ray, (share, gradient)) in rays.iter().zip(shares) {
            if let (Some(hit), true) = (ray.hit, share != 0.0) {
                out.push(hit.followed(lane, share, score(gradient)));
            }
        }
    }

    /// Rays that the lane that draws the most needs.
    fn rays(&self, draws: &Draws, active: u32) -> ([u32; LANES], u32) {
        let per_batch = self.options.rays;
        let mut own = [per_batch; LANES];
        if self.options.debias {
            for lane in lanes(active) {
                own[lane] += per_batch * draws.batches(lane, self.options.debias_chance);
            }
        }
        let most = lanes(active).map(|l| own[l]).max().unwrap_or(0);
        (own, most)
    }

    /// What directions at a vertex follow.
    fn directions(
        &self,
        at: &At,
        user: Use,
        (direction, active): (V3<Lane>, u32),
        out: &mut Vec<Follow>,
        counts: &mut Counts,
    ) {
        if active == 0 {
            return;
        }
        let kappa = self.options.kappa;
        let draws = Draws {
            stream: auxiliary(at.numbers.stream, user, at.numbers.depth),
            index: at.numbers.index,
            antithetic: self.options.antithetic,
        };
        let (own, most) = self.rays(&draws, active);
        let mut weighed: [Vec<Weighed>; LANES] = std::array::from_fn(|_| Vec::new());
        for number in 0..most {
            let ([x, y], mirrors) = draws.at(number);
            let mut exponents = [0.0; LANES];
            let towards: [DVec3; LANES] = std::array::from_fn(|lane| {
                if active >> lane & 1 == 0 {
                    return DVec3::Z;
                }
                let axis = unit(direction, lane);
                let place = [x[lane], y[lane]].map(f64::from);
                let (d, exponent) = around(axis, kappa, place);
                exponents[lane] = exponent;
                if mirrors {
                    2.0 * axis.dot(d) * axis - d
                } else {
                    d
                }
            });
            let wanted = lanes(active).filter(|&l| number < own[l]);
            let wanted = wanted.fold(0, |bits, l| bits | 1 << l);
            let towards_packed = from_lanes(&towards.map(|d| d.as_vec3()));
            let (x, geometric) = (at.surface.x, at.surface.geometric);
            let rays = at.view.leaving(x, geometric, towards_packed, wanted);
            let hits = PacketHits::trace(at.view, &rays, counts);
            for lane in lanes(wanted) {
                let axis = unit(direction, lane);
                let d = towards[lane];
                let along = kappa * (d - axis * axis.dot(d));
                let origin = lane_of(x, lane).as_dvec3();
                let ray = self.weigh(at.view, origin, hits.lane(lane), exponents[lane], along);
                weighed[lane].push(ray);
            }
        }
        for lane in lanes(active) {
            let axis = unit(direction, lane);
            self.follow(&weighed[lane], lane, |by| axis.cross(by), out);
        }
    }
}

/// Adds `scale` times the shares of a weighted mean over `rays`, and their gradients.
fn add_mean(rays: &[Weighed], scale: f64, shares: &mut [(f64, DVec3)]) {
    let sum: f64 = rays.iter().map(|r| r.weight).sum();
    if sum <= 0.0 {
        return;
    }
    let slope: DVec3 = rays.iter().map(|r| r.gradient).sum();
    for (ray, (share, gradient)) in rays.iter().zip(shares) {
        let own = ray.weight / sum;
        *share += scale * own;
        *gradient += scale * (ray.gradient - own * slope) / sum;
    }
}

impl BoundaryEstimator for WarpedArea<'_> {
    fn warp(&self) -> Option<&dyn Warp> {
        Some(self)
    }
}

impl Warp for WarpedArea<'_> {
    fn film(&self, points: &FilmPoints, counts: &mut Counts) -> Vec<FilmPath> {
        let width = self.options.film_px;
        let draws = Draws {
            stream: auxiliary(points.stream, Use::Film, 0),
            index: points.index,
            antithetic: self.options.antithetic,
        };
        let (own, most) = self.rays(&draws, points.active);
        let camera = &points.view.camera;
        let mut weighed: [Vec<Weighed>; LANES] = std::array::from_fn(|_| Vec::new());
        for number in 0..most {
            let ([x, y], mirrors) = draws.at(number);
            let sign = if mirrors { -1.0 } else { 1.0 };
            // In standard deviations.
            let offsets: [[f64; 2]; LANES] = std::array::from_fn(|l| {
                let place = [x[l], y[l]].map(f64::from);
                gaussian(place).map(|o| o * sign)
            });
            let moved =
                |at: Lane, axis: usize| at + Lane::new(offsets.map(|o| (o[axis] * width) as f32));
            let (u, v) = (moved(points.u, 0), moved(points.v, 1));
            let wanted = lanes(points.active).filter(|&l| number < own[l]);
            let wanted = wanted.fold(0, |bits, l| bits | 1 << l);
            let rays = camera.rays(camera.direction(u, v), wanted);
            let hits = PacketHits::trace(points.view, &rays, counts);
            for lane in lanes(wanted) {
                let [ox, oy] = offsets[lane];
                let exponent = 0.5 * (ox * ox + oy * oy);
                let along = DVec3::new(ox, oy, 0.0) / width;
                let origin = camera.origin.as_dvec3();
                let ray = self.weigh(points.view, origin, hits.lane(lane), exponent, along);
                weighed[lane].push(ray);
            }
        }
        let mut follows = Vec::new();
        for lane in lanes(points.active) {
            self.follow(&weighed[lane], lane, |by| by, &mut follows);
        }
        vec![FilmPath {
            at: [points.u, points.v],
            follows,
        }]
    }

    fn filter_follows(&self) -> bool {
        true
    }

    fn lobe_kernel(&self) -> Option<LobeKernel> {
        None
    }

    fn environment_kernel(&self) -> Option<f64> {
        None
    }

    fn light(&self, at: &At, out: &mut Vec<Follow>, counts: &mut Counts) -> u32 {
        let (direction, seen) = light_directions(at);
        self.directions(at, Use::Light, (direction, seen), out, counts);
        seen
    }

    fn environment(&self, samples: &MapSamples, out: &mut Vec<Follow>, counts: &mut Counts) {
        let directions = (samples.direction, samples.seen);
        self.directions(samples.at, Use::Environment, directions, out, counts);
    }

    fn bounce(&self, at: &At, bounce: &WarpedBounce, out: &mut Vec<Follow>, counts: &mut Counts) {
        let rays = bounce.bounce.rays;
        let seen = match bounce.bounce.seen {
            BounceEnd::Environment(seen) => seen,
            BounceEnd::Triangles(_) => u32::MAX,
        };
        let active = rays.active & seen & at.vertices.warped.world;
        self.directions(at, Use::Bounce, (rays.direction, active), out, counts);
    }
}
