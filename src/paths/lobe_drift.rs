//! The drift of directions over diffuse lobes: a velocity field that carries a bounce along with
//! the body that it meets.
//!
//! Differentiated at a fixed direction, the point that a bounce meets slides over a body by one
//! over the cosine c at which it meets it. The mean square of 1/c has no bound, and a narrow lobe
//! or a small radius multiplies what the point reflects. For any smooth field V over directions,
//! with f what a direction brings, cosine and all,
//!
//!   ∂∫f = ∫ (∂f + V·∇f + f ∇·V)  +  Σ_borders (V_b − V)·n (f₋ − f₊),
//!
//! as on the film (`paths::film::drift`), if f V vanishes at the horizon. V is that of points which
//! move as a body does (`paths::drift_body`), at a distance that depends on where it is
//! (`paths::body_share`). On the outline of a ball that is the velocity of the outline itself, so
//! that nothing slides there, and near it a point slides by no more than the ball's radius over its
//! distance. What x sees of a body that it moves with rests.
//!
//! Elsewhere V is zero, or, over meshes that an estimator names, such that directions *rest* in the
//! world while the frame turns.
//!
//! V depends on geometry alone and on no random number. It is linear in the velocities of the body
//! and of x and in the turn of the frame, so that the backward sweep can hand its cotangent on.

use crate::lanes::LANES;
use crate::paths::body_share::{BodyShare, REACH, is_followed_from};
use crate::paths::drift_body::{Body, BodyMotion};
use crate::paths::moving::Sector;
use crate::trace::geometry::{Geometry, NO_TRIANGLE};
use glam::DVec3;

/// So many bodies are followed at most, the largest, and so many walls.
const MOST_BODIES: usize = 16;
const MOST_WALLS: usize = 6;
/// The cosine c from which the field fades toward the horizon. Bounces are distributed as the
/// cosine, so above it the mean square of a weight's change goes with ln 1/c; what fading adds to
/// that does not depend on it (`docs/method.md`, 15).
const HORIZON: f64 = 0.2;

/// All that directions follow.
#[derive(Clone, Debug)]
pub struct LobeDrift {
    pub bodies: Vec<Body>,
    /// Whether a body moves that points which rest follow.
    any_moves: bool,
    /// Whether a mesh is of so many pieces that most lines see several.
    pub has_crowd: bool,
    rests: Vec<Rests>,
}

/// Over which lobes of a mesh directions rest in the world.
#[derive(Clone, Copy, Debug, Default)]
pub struct Rests {
    pub diffuse: bool,
    /// Of rough metal, glass and plastic.
    pub rough: bool,
}

/// The field at one direction.
#[derive(Clone, Copy, Debug)]
pub struct LobeField {
    normal: DVec3,
    direction: DVec3,
    /// How much of the turn of its frame a direction does not share, and how that changes.
    rest: f64,
    rest_gradient: DVec3,
    shares: [BodyShare; MOST_BODIES + MOST_WALLS],
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
    /// Follows the largest of these bodies and walls, and rests over the lobes of some meshes;
    /// `None` if there are none of them.
    pub fn new(
        [mut bodies, mut walls]: [Vec<Body>; 2],
        has_crowd: bool,
        rests: Vec<Rests>,
    ) -> Option<Self> {
        for (all, most) in [(&mut bodies, MOST_BODIES), (&mut walls, MOST_WALLS)] {
            all.sort_by(|a, b| b.radius.total_cmp(&a.radius));
            all.truncate(most);
        }
        bodies.append(&mut walls);
        let any_moves = bodies.iter().any(|b| b.moves);
        let any = !bodies.is_empty() || rests.iter().any(|r| r.diffuse || r.rough);
        any.then_some(Self {
            bodies,
            any_moves,
            has_crowd,
            rests,
        })
    }

    /// The same for points that move only.
    pub fn from_moving_points(self) -> Self {
        Self {
            any_moves: false,
            ..self
        }
    }

    /// The lanes whose triangle belongs to a mesh over whose lobes directions rest: diffuse ones,
    /// and those of rough metal, glass and plastic.
    pub fn resting_lanes(&self, geometry: &Geometry, triangles: &[u32; LANES]) -> [u32; 2] {
        let mesh = |t: u32| geometry.mesh_of_triangle[t as usize] as usize;
        let mut lanes = [0; 2];
        for (lane, &triangle) in triangles.iter().enumerate() {
            if triangle != NO_TRIANGLE {
                let Rests { diffuse, rough } = self.rests[mesh(triangle)];
                lanes[0] |= u32::from(diffuse) << lane;
                lanes[1] |= u32::from(rough) << lane;
            }
        }
        lanes
    }

    /// Whether directions from points that rest may drift.
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
        let follows = |body: &Body| body.moves && is_followed_from(body, sector.origin);
        let mut bodies = self.bodies.iter();
        bodies.any(|body| follows(body) && reaches(body))
    }

    /// Whether directions from `x` may drift; if it rests only bodies that move are followed.
    pub fn reaches(&self, x: DVec3, x_moves: bool) -> bool {
        let mut bodies = self.bodies.iter();
        bodies.any(|body| (x_moves || body.moves) && is_followed_from(body, x))
    }

    /// The field at a direction `d` from `x`, where the normal is `n`; `None` where it is zero. If
    /// x rests (`x_moves` is false) bodies that rest have none. `rests` says whether directions
    /// from x rest in the world where nothing carries them.
    pub fn field(&self, [x, n, d]: [DVec3; 3], x_moves: bool, rests: bool) -> Option<LobeField> {
        let cos = n.dot(d);
        if cos <= 0.0 {
            return None;
        }
        let rests = rests && x_moves;
        let bodies = self.bodies.iter().enumerate();
        let of_body = |(number, body): (usize, &Body)| {
            let share = (x_moves || body.moves).then(|| BodyShare::new(body, number, x, d));
            share.flatten()
        };
        let mut shares = bodies.filter_map(of_body).peekable();
        if shares.peek().is_none() && !rests {
            return None;
        }
        let mut field = LobeField {
            normal: n,
            direction: d,
            rest: 0.0,
            rest_gradient: DVec3::ZERO,
            shares: [BodyShare::default(); MOST_BODIES + MOST_WALLS],
            count: 0,
        };
        for share in shares {
            field.shares[field.count] = share;
            field.count += 1;
        }
        let all = field.shares[..field.count].iter();
        let bodies = all.filter(|share| share.across.is_none());
        let (sum, slope) = bodies.fold((0.0, DVec3::ZERO), |(s, g), share| {
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
        // Walls come last, and are followed where no body is.
        let mut taken = (0.0, DVec3::ZERO);
        for share in &mut field.shares[..field.count] {
            let is_wall = share.across.is_some();
            let (part, gradient) = if is_wall {
                let left = 1.0 - taken.0;
                let gradient = share.gradient * left - taken.1 * share.weight;
                (share.weight * left, gradient)
            } else {
                let part = share.weight / most;
                let gradient = (share.gradient - slope * part) / most;
                taken = (taken.0 + part, taken.1 + gradient);
                (part, gradient)
            };
            share.weight = fading * part;
            share.gradient = gradient * fading + along_n * (by_cos * part);
            if !(rests || is_wall) {
                field.rest += share.weight;
                field.rest_gradient += share.gradient;
            }
        }
        Some(field)
    }
}

impl LobeField {
    /// The velocity of the direction, beside that of a direction that keeps its place in the frame,
    /// which is `turning`; and by what part the sample's weight changes: the field's divergence and
    /// that of the cosine, of which the samples' density keeps the value.
    pub fn velocity(
        &self,
        of_body: impl Fn(usize) -> BodyMotion,
        of_x: DVec3,
        turning: DVec3,
    ) -> (DVec3, f64) {
        let d = self.direction;
        let mut velocity = turning * -self.rest;
        let mut divergence = -self.rest_gradient.dot(turning);
        for share in &self.shares[..self.count] {
            let BodyMotion {
                velocity: v,
                rotation,
            } = of_body(share.body);
            let w = share.followed(v + rotation.cross(share.arm) - of_x);
            let along = d.dot(w);
            let drift = (w - d * along) * share.nearness + share.turn(rotation, d);
            velocity += drift * share.weight;
            divergence += share.gradient.dot(drift)
                + share.weight * (share.nearness_gradient.dot(w) - 2.0 * along * share.nearness);
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
        mut of_body: impl FnMut(usize, BodyMotion),
    ) -> FieldBars {
        let d = self.direction;
        let cos = self.normal.dot(d);
        let velocity_bar = velocity_bar + self.normal * (weight_bar / cos);
        let mut bars = FieldBars {
            x: DVec3::ZERO,
            turning: -(velocity_bar * self.rest + self.rest_gradient * weight_bar),
        };
        for share in &self.shares[..self.count] {
            let drift = velocity_bar * share.weight + share.gradient * weight_bar;
            let divergence = share.weight * weight_bar;
            let w = share.followed(
                (drift - d * d.dot(drift)) * share.nearness
                    + (share.nearness_gradient - d * (2.0 * share.nearness)) * divergence,
            );
            bars.x -= w;
            let motion = BodyMotion {
                velocity: w,
                rotation: share.arm.cross(w) - share.turn(drift, d),
            };
            of_body(share.body, motion);
        }
        bars
    }
}

#[cfg(test)]
mod tests;
