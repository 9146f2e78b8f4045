//! Loubet, Holzschuch & Jakob (2019), "Reparameterizing discontinuous integrands for
//! differentiable rendering".
//!
//! Inside a narrow cone of directions a silhouette moves about as a rotation turns it. So all
//! directions of the cone turn with one point of a surface that a bundle of rays has met (their
//! §4.2): the silhouette stands still, and a rotation has no divergence. The cone is the pixel, the
//! lobe or the light if that is narrow. If it is not, the integral is convolved with a narrow
//! kernel k (their §4.3): with ω drawn as ever, and μ from k around ω,
//!
//!   ∫f dω = E[ f(μ) / p(ω) ],  and μ turns while ω rests, so that ∂log k = κ Ω·(μ×ω)
//!
//! is what brings the silhouette's part. Its mean is zero and its noise is large, which two paths
//! cancel that share all other random numbers (their §4.4): each is weighed by the difference of
//! their radiances.
//!
//! As published, this is biased where more than one silhouette crosses a cone, where silhouettes do
//! not move by rotations, and where a light has a sharp border.

use crate::lanes::{LANES, Lane, V3};
use crate::paths::at::{At, Numbers};
use crate::paths::bounce::BounceEnd;
use crate::paths::counts::Counts;
use crate::paths::estimator::BoundaryEstimator;
use crate::paths::film::camera::Camera;
use crate::paths::random::Stream;
use crate::paths::rays::{from_lanes, lane_mask, lane_of};
use crate::paths::surface::world_bounce::log_kept_above_by_cos;
use crate::paths::warp::follow::Follow;
use crate::paths::warp::kernel::{LobeKernel, Use, around, auxiliary, kernel_numbers};
use crate::paths::warp::seam::{FilmPath, FilmPoints, MapSamples, Warp, WarpedBounce};
use crate::scene::{Film, Filter};
use crate::trace::geometry::Geometry;
use crate::warp::bundle::{Hit, PacketHits, lanes, unit};
use crate::warp::of_two::{gaussian, light_directions};
use crate::warp::options::{LoubetOptions, WarpOptions};
use glam::{DMat3, DVec3};

/// Cosine between normals above which surfaces count as one (absolute, as published).
const ALIKE: f64 = 0.99;
/// Below this |(p_A − o)×(p_B − o)| two points count as one (absolute, as published).
const LEAST_CROSS: f64 = 1e-3;

/// Turns bundles of directions with a point that one of them has met.
pub struct Loubet<'a> {
    pub options: &'a LoubetOptions,
}

/// Points to follow, with their shares.
type Chosen = Vec<(Hit, f64)>;

/// The film that this method samples. Its kernel blurs the image, so a Gaussian filter gets
/// narrower by as much (its variance by that of the kernel), if it is wide enough. Other filters
/// keep their width, and the blur.
pub fn film(options: &WarpOptions, film: Film) -> Result<Film, String> {
    let kernel = options.loubet.film_kernel_px.powi(2);
    let filter = match film.filter {
        Filter::Gaussian { stddev } if f64::from(stddev).powi(2) > 1.5 * kernel => {
            Filter::Gaussian {
                stddev: (f64::from(stddev).powi(2) - kernel).sqrt() as f32,
            }
        }
        other => other,
    };
    Ok(Film {
        filter,
        sample_border: true,
        ..film
    })
}

/// The point that a bundle from `o` follows, from what its rays met in their order.
fn choose(geometry: &Geometry, o: DVec3, bundle: &[Option<Hit>]) -> Chosen {
    let mesh = |hit: &Option<Hit>| hit.map(|h| h.mesh(geometry));
    let a = bundle[0];
    // The last that is another shape; else the second.
    let other = bundle.iter().skip(2).rev().find(|h| mesh(h) != mesh(&a));
    let b = other.copied().unwrap_or(bundle[1]);
    let (a, b) = match (a, b) {
        (None, None) => return Vec::new(),
        (Some(one), None) | (None, Some(one)) => return vec![(one, 1.0)],
        (Some(a), Some(b)) => (a, b),
    };
    let [pa, pb] = [a, b].map(|h| h.point(geometry));
    let [na, nb] = [a, b].map(|h| h.normal(geometry).normalize_or_zero());
    // Whether a point's plane separates the other point from the eye.
    let a_hides = na.dot(pb - pa) * na.dot(o - pa) < 0.0;
    let b_hides = nb.dot(pa - pb) * nb.dot(o - pb) < 0.0;
    if a_hides != b_hides {
        return vec![(if a_hides { a } else { b }, 1.0)];
    }
    let across = (pa - o).cross(pb - o);
    if na.dot(nb).abs() > ALIKE || across.length() <= LEAST_CROSS {
        return vec![(a, 1.0)];
    }
    // Where both tangent planes meet the plane through the eye and both points.
    let m = across.normalize();
    let rows = DMat3::from_cols(na, nb, m).transpose();
    let crease = rows.inverse() * DVec3::new(na.dot(pa), nb.dot(pb), m.dot(o));
    let near = [a, b].map(|h| at(geometry, &h, crease));
    if !crease.is_finite() || near.iter().flatten().flatten().any(|b| !b.is_finite()) {
        return vec![(a, 1.0)];
    }
    // Both surfaces' points there: where they move alike, so does the crease.
    let [near_a, near_b] = near;
    let moved = |hit: Hit, b: Option<[f32; 2]>| {
        b.map(|barycentrics| Hit {
            barycentrics,
            ..hit
        })
    };
    match (moved(a, near_a), moved(b, near_b)) {
        (Some(a), Some(b)) => vec![(a, 0.5), (b, 0.5)],
        _ => vec![(a, 1.0)],
    }
}

/// The barycentrics of a point in a triangle's plane.
fn at(geometry: &Geometry, hit: &Hit, point: DVec3) -> Option<[f32; 2]> {
    let corners = geometry.triangles[hit.triangle as usize];
    let [p, q, r] = corners.map(|v| geometry.positions[v as usize].as_dvec3());
    let (e1, e2, to) = (q - p, r - p, point - p);
    let n = e1.cross(e2);
    let size = n.length_squared();
    let b = [to.cross(e2).dot(n) / size, e1.cross(to).dot(n) / size];
    b.iter()
        .all(|b| b.is_finite())
        .then_some(b.map(|b| b as f32))
}

impl BoundaryEstimator for Loubet<'_> {
    fn warp(&self) -> Option<&dyn Warp> {
        Some(self)
    }
}

impl Warp for Loubet<'_> {
    fn film(&self, points: &FilmPoints, counts: &mut Counts) -> Vec<FilmPath> {
        let width = self.options.film_kernel_px;
        let camera = &points.view.camera;
        let paths = if self.options.pairs { 2 } else { 1 };
        let offsets: Vec<[[f64; 2]; LANES]> = (0..self.options.film_rays)
            .map(|ray| {
                // Those of paths in streams of their own.
                let stream = if ray < paths {
                    kernel_numbers(points.stream, Use::Film, 0, ray)
                } else {
                    auxiliary(points.stream, Use::Film, 0)
                };
                let (x, y) = stream.pair(points.index, ray);
                let (x, y) = (x.to_array(), y.to_array());
                std::array::from_fn(|l| gaussian([x[l].into(), y[l].into()]))
            })
            .collect();
        let film_point = |offset: &[[f64; 2]; LANES]| {
            let moved =
                |at: Lane, axis: usize| at + Lane::new(offset.map(|o| (o[axis] * width) as f32));
            [moved(points.u, 0), moved(points.v, 1)]
        };
        let hits: Vec<PacketHits> = offsets
            .iter()
            .map(|offset| {
                let [u, v] = film_point(offset);
                let rays = camera.rays(camera.direction(u, v), points.active);
                PacketHits::trace(points.view, &rays, counts)
            })
            .collect();
        let chosen = choose_lanes(points.view.geometry, camera, &hits, points.active);
        (0..paths as usize)
            .map(|path| {
                let mut follows = Vec::new();
                for lane in lanes(points.active) {
                    // ∂log k = −(μ − u)·V/σ².
                    let [x, y] = offsets[path][lane].map(|o| -o / width);
                    for (hit, share) in &chosen[lane] {
                        let score = DVec3::new(x, y, 0.0) * *share;
                        follows.push(hit.followed(lane, *share, score));
                    }
                }
                FilmPath {
                    at: film_point(&offsets[path]),
                    follows,
                }
            })
            .collect()
    }

    fn filter_follows(&self) -> bool {
        false
    }

    fn lobe_kernel(&self) -> Option<LobeKernel> {
        self.options.convolution.then_some(LobeKernel {
            kappa: self.options.lobe_kappa,
            least_roughness: self.options.least_roughness,
        })
    }

    fn environment_kernel(&self) -> Option<f64> {
        let kappa = self.options.environment_kappa;
        self.options.convolution.then_some(kappa)
    }

    /// The mean of what hides the light from a bundle, if anything does; there is no kernel.
    fn light(&self, at: &At, out: &mut Vec<Follow>, counts: &mut Counts) -> u32 {
        let (_, seen) = light_directions(at);
        if seen == 0 {
            return 0;
        }
        let stream = auxiliary(at.numbers.stream, Use::Light, at.numbers.depth);
        let numbers = Numbers {
            stream: &stream,
            ..at.numbers
        };
        let mut hiding: [Vec<Hit>; LANES] = std::array::from_fn(|_| Vec::new());
        for ray in 1..self.options.light_rays {
            // Vertex numbers make the random numbers of further samples.
            let other = At {
                numbers: Numbers {
                    depth: ray,
                    ..numbers
                },
                ..*at
            };
            let y = other.light_points();
            let rays = at.view.toward(at.surface.x, at.surface.geometric, y, seen);
            let hits = PacketHits::trace(at.view, &rays, counts);
            for lane in lanes(seen) {
                hiding[lane].extend(hits.lane(lane));
            }
        }
        let mut moving = 0;
        for lane in lanes(seen) {
            let share = 1.0 / hiding[lane].len().max(1) as f64;
            for hit in &hiding[lane] {
                moving |= 1 << lane;
                out.push(hit.followed(lane, share, DVec3::ZERO));
            }
        }
        moving
    }

    fn environment(&self, samples: &MapSamples, out: &mut Vec<Follow>, counts: &mut Counts) {
        let MapSamples {
            at,
            direction,
            axis,
            active,
            seen,
        } = *samples;
        let own = self.own_hits(at, direction, (active, seen), counts);
        let kappa = self.options.environment_kappa;
        let convolved = if self.options.convolution { active } else { 0 };
        let bundle = Bundle {
            user: Use::Environment,
            axis,
            convolved,
            kappa,
        };
        self.follow(at, &bundle, (direction, active), own, out, counts);
    }

    fn bounce(&self, at: &At, bounce: &WarpedBounce, out: &mut Vec<Follow>, counts: &mut Counts) {
        let rays = bounce.bounce.rays;
        let world = rays.active & at.vertices.warped.world;
        let (own, active) = match bounce.bounce.seen {
            BounceEnd::Environment(seen) => (
                self.own_hits(at, rays.direction, (world, seen), counts),
                world,
            ),
            BounceEnd::Triangles(triangle) => {
                let hits = PacketHits::of(at.view, rays.origin, rays.direction, *triangle);
                ((0..LANES).map(|l| hits.lane(l)).collect(), world)
            }
        };
        let bundle = Bundle {
            user: Use::Bounce,
            axis: bounce.axis,
            convolved: bounce.convolved,
            kappa: self.options.lobe_kappa,
        };
        self.follow(at, &bundle, (rays.direction, active), own, out, counts);
    }
}

/// How the directions of a bundle are drawn.
struct Bundle {
    user: Use,
    /// The middle of the kernel.
    axis: V3<Lane>,
    /// Lanes with a kernel; in others the lobe is drawn from again.
    convolved: u32,
    kappa: f64,
}

impl Loubet<'_> {
    /// What directions meet that see the sky, or something before it. That matters to pairs alone:
    /// what is hidden brings nothing, but its twin may.
    fn own_hits(
        &self,
        at: &At,
        direction: V3<Lane>,
        (active, seen): (u32, u32),
        counts: &mut Counts,
    ) -> Vec<Option<Hit>> {
        let hidden = active & !seen;
        if hidden == 0 || !self.options.pairs {
            return vec![None; LANES];
        }
        let rays = at
            .view
            .leaving(at.surface.x, at.surface.geometric, direction, hidden);
        let hits = PacketHits::trace(at.view, &rays, counts);
        (0..LANES).map(|lane| hits.lane(lane)).collect()
    }

    /// What directions at a vertex follow, of which `own` says what they meet.
    fn follow(
        &self,
        at: &At,
        bundle: &Bundle,
        (direction, active): (V3<Lane>, u32),
        own: Vec<Option<Hit>>,
        out: &mut Vec<Follow>,
        counts: &mut Counts,
    ) {
        if active == 0 {
            return;
        }
        let mut met: Vec<Vec<Option<Hit>>> = own.into_iter().map(|hit| vec![hit]).collect();
        let stream = auxiliary(at.numbers.stream, bundle.user, at.numbers.depth);
        for ray in 1..self.options.lobe_rays {
            let others = bundle.directions(at, &stream, ray);
            let (x, geometric) = (at.surface.x, at.surface.geometric);
            let rays = at.view.leaving(x, geometric, others, active);
            let hits = PacketHits::trace(at.view, &rays, counts);
            for lane in lanes(active) {
                met[lane].push(hits.lane(lane));
            }
        }
        for lane in lanes(active) {
            let o = lane_of(at.surface.x, lane).as_dvec3();
            let score = bundle.score(at, direction, lane);
            for (hit, share) in choose(at.view.geometry, o, &met[lane]) {
                out.push(hit.followed(lane, share, score * share));
            }
        }
    }
}

impl Bundle {
    /// Further directions of each lane's bundle.
    fn directions(&self, at: &At, stream: &Stream, ray: u32) -> V3<Lane> {
        let numbers = Numbers {
            stream,
            depth: ray,
            ..at.numbers
        };
        let (x, y) = stream.pair(at.numbers.index, u32::MAX - ray);
        let (x, y) = (x.to_array(), y.to_array());
        let mut vertices = at.vertices.clone();
        let whole = Lane::splat(1.0);
        let again = at
            .view
            .bsdf_sample(&mut vertices, at.surface, whole, &numbers);
        // Another lobe is another integral.
        let again = V3::select(
            lane_mask(vertices.lobes.reflected),
            again.direction,
            self.axis,
        );
        from_lanes(&std::array::from_fn(|lane| {
            if self.convolved >> lane & 1 == 0 {
                return lane_of(again, lane);
            }
            let place = [x[lane], y[lane]].map(f64::from);
            around(unit(self.axis, lane), self.kappa, place).0.as_vec3()
        }))
    }

    /// By what Ω is multiplied in the score: κ μ×ω of the kernel, and what the part of the kernel
    /// that lies above the horizon changes by.
    fn score(&self, at: &At, direction: V3<Lane>, lane: usize) -> DVec3 {
        if self.convolved >> lane & 1 == 0 {
            return DVec3::ZERO;
        }
        let (mu, axis) = (unit(direction, lane), unit(self.axis, lane));
        let kernel = self.kappa * mu.cross(axis);
        let Use::Bounce = self.user else {
            return kernel;
        };
        let n = lane_of(at.surface.n, lane).as_dvec3();
        kernel - log_kept_above_by_cos(n.dot(mu), self.kappa) * mu.cross(n)
    }
}

/// What the bundles of a packet of the film follow.
fn choose_lanes(
    geometry: &Geometry,
    camera: &Camera,
    hits: &[PacketHits],
    active: u32,
) -> Vec<Chosen> {
    (0..LANES)
        .map(|lane| {
            if active >> lane & 1 == 0 {
                return Vec::new();
            }
            let bundle: Vec<Option<Hit>> = hits.iter().map(|h| h.lane(lane)).collect();
            choose(geometry, camera.origin.as_dvec3(), &bundle)
        })
        .collect()
}
