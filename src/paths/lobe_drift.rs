//! The drift of directions over diffuse lobes: a velocity field that carries a bounce along with
//! the body that it meets.
//!
//! Differentiated at a fixed direction, the point that a bounce meets slides over a body by one over
//! the cosine c at which it meets it. The mean square of 1/c has no bound, and a narrow lobe or a
//! small radius multiplies what the point reflects. For any smooth field V over directions, with f
//! what a direction brings, cosine and all,
//!
//!   ∂∫f = ∫ (∂f + V·∇f + f ∇·V)  +  Σ_borders (V_b − V)·n (f₋ − f₊),
//!
//! as on the film (`paths::film::drift`), if f V vanishes at the horizon. V is that of a disc for
//! each body: of the circle in which a cone from x touches the sphere around it, moving as the body
//! does. On the outline of a ball that is the velocity of the outline itself, so that nothing slides
//! there, and near it a point slides by no more than the ball's radius over its distance.
//!
//! Elsewhere V is zero, or, over meshes that an estimator names, such that directions *rest* in the
//! world while the frame turns.
//!
//! V depends on geometry alone and on no random number. It is linear in the velocities of the body
//! and of x and in the turn of the frame, so that the backward sweep can hand its cotangent on.

use crate::discontinuity::pieces::Pieces;
use crate::lanes::LANES;
use crate::paths::moving::{Moving, Sector};
use crate::trace::geometry::{Geometry, NO_TRIANGLE};
use glam::DVec3;

/// So many bodies are followed at most, the largest.
const MOST_BODIES: usize = 16;
/// Vertices whose mean velocity is that of a body.
const MOST_VERTICES: usize = 64;
/// The field reaches to this multiple of a body's sphere.
const REACH: f64 = 1.5;
/// The cosine of a cone's half-angle below which the field fades: x nearly touches the body.
const NEAR: f64 = 0.6;
/// The cosine from which the field fades toward the horizon. What that adds to the mean square of a
/// weight's change does not depend on it: bounces are distributed as the cosine.
const HORIZON: f64 = 0.05;

/// Something round that directions follow.
#[derive(Clone, Debug)]
pub struct Body {
    pub centre: DVec3,
    pub radius: f64,
    /// Of these the mean velocity is taken.
    pub vertices: Vec<u32>,
    moves: bool,
}

/// All that directions follow.
#[derive(Clone, Debug)]
pub struct LobeDrift {
    pub bodies: Vec<Body>,
    any_moves: bool,
    /// Meshes over whose lobes directions rest in the world.
    rests: Vec<bool>,
}

/// A body's part in the field at one direction.
#[derive(Clone, Copy, Debug, Default)]
struct BodyShare {
    body: usize,
    weight: f64,
    /// Of the weight, along the sphere of directions.
    gradient: DVec3,
    axis: DVec3,
    /// One over the distance of the disc.
    nearness: f64,
}

/// The field at one direction.
#[derive(Clone, Copy, Debug)]
pub struct LobeField {
    normal: DVec3,
    direction: DVec3,
    /// How much of the turn of its frame a direction does not share, and how that changes.
    rest: f64,
    rest_gradient: DVec3,
    shares: [BodyShare; MOST_BODIES],
    count: usize,
}

/// What the field is linear in.
#[derive(Clone, Copy, Debug, Default)]
pub struct FieldBars {
    pub x: DVec3,
    /// Of the velocity of a direction that keeps its place in the frame.
    pub turning: DVec3,
}

impl LobeDrift {
    /// Follows the pieces that `is_followed` vertices belong to, and rests over the lobes of some
    /// meshes; `None` if there are neither.
    pub fn new(
        geometry: &Geometry,
        pieces: &Pieces,
        moving: &Moving,
        is_followed: impl Fn(u32) -> bool,
        rests: Vec<bool>,
    ) -> Option<Self> {
        let mut vertices: Vec<Vec<u32>> = vec![Vec::new(); pieces.count()];
        for v in 0..geometry.positions.len() as u32 {
            if is_followed(v) {
                vertices[pieces.number(v) as usize].push(v);
            }
        }
        let body = |all: Vec<u32>| {
            let sphere = pieces.around(*all.first()?);
            let step = all.len().div_ceil(MOST_VERTICES);
            let corners = all
                .iter()
                .map(|&v| geometry.positions[v as usize].as_dvec3());
            let radius = corners
                .map(|p| p.distance(sphere.centre))
                .fold(0.0, f64::max);
            (radius > 0.0).then(|| Body {
                centre: sphere.centre,
                radius,
                moves: moving.vertex(geometry, all[0]),
                vertices: all.into_iter().step_by(step).collect(),
            })
        };
        let mut bodies: Vec<Body> = vertices.into_iter().filter_map(body).collect();
        bodies.sort_by(|a, b| b.radius.total_cmp(&a.radius));
        bodies.truncate(MOST_BODIES);
        let any_moves = bodies.iter().any(|b| b.moves);
        let any = !bodies.is_empty() || rests.contains(&true);
        any.then_some(Self {
            bodies,
            any_moves,
            rests,
        })
    }

    /// The lanes whose triangle belongs to a mesh over which directions rest.
    pub fn resting_lanes(&self, geometry: &Geometry, triangles: &[u32; LANES]) -> u32 {
        let mesh = |t: u32| geometry.mesh_of_triangle[t as usize] as usize;
        let rests = |&l: &usize| triangles[l] != NO_TRIANGLE && self.rests[mesh(triangles[l])];
        (0..LANES).filter(rests).fold(0, |bits, l| bits | 1 << l)
    }

    /// Whether any body moves.
    pub fn any_moves(&self) -> bool {
        self.any_moves
    }

    /// Whether the field of a body that moves may be other than zero in a sector.
    pub fn meets(&self, sector: &Sector) -> bool {
        let reaches = |body: &Body| {
            let (to, radius) = (body.centre - sector.origin, REACH * body.radius);
            let is_ahead = |side: &DVec3| side.dot(to) + side.length() * radius >= 0.0;
            sector.normal.dot(to).abs() <= sector.normal.length() * radius
                && sector.inward.iter().all(is_ahead)
        };
        self.bodies.iter().any(|body| body.moves && reaches(body))
    }

    /// The field at a direction `d` from `x`, where the normal is `n`; `None` where it is zero. If x
    /// rests (`x_moves` is false) bodies that rest have none. `rests` says whether directions from x
    /// rest in the world where nothing carries them.
    pub fn field(&self, [x, n, d]: [DVec3; 3], x_moves: bool, rests: bool) -> Option<LobeField> {
        let cos = n.dot(d);
        if cos <= 0.0 {
            return None;
        }
        let mut field = LobeField {
            normal: n,
            direction: d,
            rest: 0.0,
            rest_gradient: DVec3::ZERO,
            shares: [BodyShare::default(); MOST_BODIES],
            count: 0,
        };
        for (number, body) in self.bodies.iter().enumerate() {
            if !(x_moves || body.moves) {
                continue;
            }
            let Some(share) = body.share(number, x, d) else {
                continue;
            };
            field.shares[field.count] = share;
            field.count += 1;
        }
        let rests = rests && x_moves;
        if field.count == 0 && !rests {
            return None;
        }
        let all = field.shares[..field.count].iter();
        let (sum, slope) = all.fold((0.0, DVec3::ZERO), |(s, g), share| {
            (s + share.weight, g + share.gradient)
        });
        let (most, slope) = if sum > 1.0 {
            (sum, slope)
        } else {
            (1.0, DVec3::ZERO)
        };
        let fading = (cos / HORIZON).min(1.0);
        let by_cos = if cos < HORIZON { 1.0 / HORIZON } else { 0.0 };
        let along_n = n - d * cos;
        if rests {
            field.rest = fading;
            field.rest_gradient = along_n * by_cos;
        }
        for share in &mut field.shares[..field.count] {
            let part = share.weight / most;
            let gradient = (share.gradient - slope * part) / most;
            share.weight = fading * part;
            share.gradient = gradient * fading + along_n * (by_cos * part);
            if !rests {
                field.rest += share.weight;
                field.rest_gradient += share.gradient;
            }
        }
        Some(field)
    }
}

impl Body {
    /// The mean of something over what stands for the body.
    pub fn mean(&self, of: impl Fn(u32) -> DVec3) -> DVec3 {
        let sum: DVec3 = self.vertices.iter().map(|&v| of(v)).sum();
        sum / self.vertices.len() as f64
    }

    /// Its share, not yet parted among bodies nor faded at the horizon.
    fn share(&self, body: usize, x: DVec3, d: DVec3) -> Option<BodyShare> {
        let to = self.centre - x;
        let distance = to.length();
        let cos_of = |radius: f64| {
            let sin = radius / distance;
            if sin < 1.0 {
                (1.0 - sin * sin).sqrt()
            } else {
                -1.0
            }
        };
        let inner = cos_of(self.radius);
        if inner <= 0.0 {
            return None;
        }
        let outer = cos_of(REACH * self.radius);
        let axis = to / distance;
        let z = axis.dot(d);
        if z <= outer {
            return None;
        }
        let near = (inner / NEAR).min(1.0);
        let near = near * near;
        let u = ((z - outer) / (inner - outer)).min(1.0);
        let by_z = 6.0 * u * (1.0 - u) / (inner - outer);
        Some(BodyShare {
            body,
            weight: near * u * u * (3.0 - 2.0 * u),
            gradient: (axis - d * z) * (near * by_z),
            axis,
            nearness: 1.0 / (distance * inner * inner),
        })
    }
}

impl LobeField {
    /// The velocity of the direction, beside that of a direction that keeps its place in the frame,
    /// which is `turning`; and by what part the sample's weight changes: the field's divergence and
    /// that of the cosine, of which the samples' density keeps the value.
    pub fn velocity(
        &self,
        of_body: impl Fn(usize) -> DVec3,
        of_x: DVec3,
        turning: DVec3,
    ) -> (DVec3, f64) {
        let d = self.direction;
        let mut velocity = turning * -self.rest;
        let mut divergence = -self.rest_gradient.dot(turning);
        for share in &self.shares[..self.count] {
            let w = of_body(share.body) - of_x;
            let along = d.dot(w);
            let z = share.axis.dot(d);
            let beside = (w - d * along) * (z * share.nearness);
            velocity += beside * share.weight;
            divergence += share.gradient.dot(beside)
                + share.weight * share.nearness * (share.axis.dot(w) - 3.0 * along * z);
        }
        let cos = self.normal.dot(d);
        (velocity, divergence + self.normal.dot(velocity) / cos)
    }

    /// From the cotangents of the velocity and of the weight's change to those of what they are
    /// linear in; `of_body` is given each body's.
    pub fn velocity_adjoint(
        &self,
        velocity_bar: DVec3,
        weight_bar: f64,
        mut of_body: impl FnMut(usize, DVec3),
    ) -> FieldBars {
        let d = self.direction;
        let cos = self.normal.dot(d);
        let velocity_bar = velocity_bar + self.normal * (weight_bar / cos);
        let mut bars = FieldBars {
            x: DVec3::ZERO,
            turning: -(velocity_bar * self.rest + self.rest_gradient * weight_bar),
        };
        for share in &self.shares[..self.count] {
            let z = share.axis.dot(d);
            let beside = velocity_bar * share.weight + share.gradient * weight_bar;
            let divergence = share.weight * share.nearness * weight_bar;
            let w = (beside - d * d.dot(beside)) * (z * share.nearness)
                + (share.axis - d * (3.0 * z)) * divergence;
            bars.x -= w;
            of_body(share.body, w);
        }
        bars
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(centre: [f64; 3], radius: f64) -> Body {
        Body {
            centre: centre.into(),
            radius,
            vertices: vec![0],
            moves: true,
        }
    }

    /// Two balls that overlap as seen from the origin.
    fn two_balls() -> LobeDrift {
        LobeDrift {
            bodies: vec![body([0.9, 0.2, 1.1], 0.5), body([1.6, -0.3, 1.0], 0.7)],
            any_moves: true,
            rests: Vec::new(),
        }
    }

    const N: DVec3 = DVec3::Z;
    const VELOCITIES: [DVec3; 2] = [DVec3::new(0.3, -1.0, 0.4), DVec3::new(-0.7, 0.2, 0.9)];
    const OF_X: DVec3 = DVec3::new(0.5, 0.1, -0.3);
    const TURN: DVec3 = DVec3::new(0.2, -0.4, 0.6);

    /// Directions in, between and around the balls.
    fn directions() -> impl Iterator<Item = DVec3> {
        let at = |i: u32| {
            let (height, angle) = (0.04 + 0.9 * f64::from(i) / 60.0, 0.8 * (f64::from(i)).sin());
            let radius = (1.0 - height * height).sqrt();
            DVec3::new(radius * angle.cos(), radius * angle.sin(), height)
        };
        (0..60).map(at)
    }

    /// From surfaces over which they rest, and from others.
    fn directions_twice() -> impl Iterator<Item = (DVec3, bool)> {
        directions().flat_map(|d| [(d, false), (d, true)])
    }

    fn velocity(drift: &LobeDrift, d: DVec3, rests: bool) -> Option<(DVec3, f64)> {
        let field = drift.field([DVec3::ZERO, N, d], true, rests)?;
        Some(field.velocity(|body| VELOCITIES[body], OF_X, TURN.cross(d)))
    }

    /// The change of the weight is the divergence of the field times the cosine, over the cosine.
    #[test]
    fn weights_change_by_the_divergence() {
        let drift = two_balls();
        let mut tried = 0;
        for (d, rests) in directions_twice() {
            let Some((_, change)) = velocity(&drift, d, rests) else {
                continue;
            };
            let s = d.any_orthonormal_vector();
            let axes = [s, d.cross(s)];
            let h = 1e-6;
            let along = |axis: DVec3, step: f64| {
                let moved = (d + axis * step).normalize();
                // On the sphere a neighbour's axis leans by what the direction does.
                let axis = (axis - moved * moved.dot(axis)).normalize();
                velocity(&drift, moved, rests).map_or(0.0, |(v, _)| v.dot(axis) * moved.dot(N))
            };
            let slope = |axis| (along(axis, h) - along(axis, -h)) / (2.0 * h);
            let expected: f64 = axes.map(slope).iter().sum::<f64>() / d.dot(N);
            let error = (change - expected).abs();
            assert!(
                error < 1e-6 * (1.0 + expected.abs()),
                "{d}: {change} {expected}"
            );
            tried += 1;
        }
        assert!(tried > 100, "{tried}");
    }

    #[test]
    fn the_adjoint_is_the_transpose() {
        let drift = two_balls();
        let (velocity_bar, change_bar) = (DVec3::new(0.3, 0.9, -0.5), 0.7);
        let mut tried = 0;
        for (d, rests) in directions_twice() {
            let Some(field) = drift.field([DVec3::ZERO, N, d], true, rests) else {
                continue;
            };
            let turning = TURN.cross(d);
            let (v, change) = field.velocity(|body| VELOCITIES[body], OF_X, turning);
            let mut back = 0.0;
            let bars = field.velocity_adjoint(velocity_bar, change_bar, |body, bar| {
                back += bar.dot(VELOCITIES[body]);
            });
            back += bars.x.dot(OF_X) + bars.turning.dot(turning);
            let there = v.dot(velocity_bar) + change * change_bar;
            assert!(
                (back - there).abs() < 1e-12 * (1.0 + there.abs()),
                "{back} {there}"
            );
            tried += 1;
        }
        assert!(tried > 100, "{tried}");
    }

    /// Across the outline of a ball the field moves as the outline does.
    #[test]
    fn the_outline_of_a_ball_rests() {
        let (centre, radius) = (DVec3::new(0.4, 0.3, 2.0), 0.6);
        let drift = LobeDrift {
            bodies: vec![body(centre.into(), radius)],
            any_moves: true,
            rests: Vec::new(),
        };
        let w = VELOCITIES[0] - OF_X;
        let (axis, sin) = (centre.normalize(), radius / centre.length());
        let s = axis.any_orthonormal_vector();
        for step in 0..8 {
            let (sin_turn, cos_turn) = f64::from(step).sin_cos();
            let beside = s * cos_turn + axis.cross(s) * sin_turn;
            let d = axis * (1.0 - sin * sin).sqrt() + beside * sin;
            let field = drift
                .field([DVec3::ZERO, N, d * (1.0 - 1e-12)], true, false)
                .unwrap();
            let (v, _) = field.velocity(|_| VELOCITIES[0], OF_X, DVec3::ZERO);
            // Where a ray touches the ball it keeps touching it: (w − |y| v)·normal = 0.
            let distance = (centre.length_squared() - radius * radius).sqrt();
            let normal = (d * distance - centre) / radius;
            let slides = (w - v * distance).dot(normal);
            assert!(slides.abs() < 1e-9, "{slides}");
        }
    }
}
