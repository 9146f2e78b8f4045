//! A body's part in the field that directions follow (`paths::lobe_drift`).
//!
//! **A ball** is followed by a disc: that of the circle in which a cone from x touches the sphere
//! around it, at the distance D cos²α with sin α = R/D, along the axis. On the ball's outline the
//! field is that of the outline itself. Close to a ball the disc is near and its points fast, so
//! that the field fades there.
//!
//! **Others** are followed by a sphere around x through their middle: what is seen of them lies
//! nearer and farther alike, and so does it from within the sphere around them, where all
//! directions follow.
//!
//! **A wall** is followed where a point close to its plane meets it far away, and there alone. At
//! the height h over the plane and with the cosine c = a·ω at which ω meets it, a being the
//! direction to the plane, the point met is at the distance h/c. A change ḣ of the height takes it
//! along the wall by ḣ/c, if ω is fixed; where h is small by many times as far as anything moves.
//! With V = ḣ c/h (a − c ω) it stays. V's divergence is about ḣ/h, so that nothing is gained where
//! the wall is met as near as light changes along it.

use crate::paths::drift_body::Body;
use glam::DVec3;

/// The field reaches to this multiple of a body's sphere.
pub const REACH: f64 = 1.5;
/// The cosine of a cone's half-angle below which that of a ball fades: x nearly touches it.
const NEAR: f64 = 0.6;
/// Of a body's radius: the least distance that is followed.
const LEAST_DISTANCE: f64 = 0.5;
/// Of a wall's radius: the heights over it between which its field fades, and the distances at
/// which it is met.
const WALL_HEIGHTS: [f64; 2] = [0.1, 0.2];
const WALL_DISTANCES: [f64; 2] = [0.25, 0.5];
/// What is lower, likewise, lies on it, and sees nothing of it above its horizon.
const LEAST_HEIGHT: f64 = 1e-6;

/// A body's part in the field at one direction.
#[derive(Clone, Copy, Debug, Default)]
pub struct BodyShare {
    pub body: usize,
    pub weight: f64,
    /// Of the weight, along the sphere of directions.
    pub gradient: DVec3,
    /// One over the distance that is followed in that direction, and how that changes likewise.
    pub nearness: f64,
    pub nearness_gradient: DVec3,
    /// From what the body turns about to x.
    pub arm: DVec3,
    /// Of a wall, the direction to it, along which alone its motion is followed.
    pub across: Option<DVec3>,
}

impl BodyShare {
    /// Of a body, not yet parted among bodies nor faded at the horizon. `None` where it is zero.
    pub fn new(body: &Body, number: usize, x: DVec3, d: DVec3) -> Option<Self> {
        let to = body.centre - x;
        if let Some(normal) = body.plane_normal() {
            let across = across_to_wall(normal, body.radius, to)?;
            return Self::of_wall(body, number, [to, across, x], d);
        }
        let distance = to.length();
        let whole = Self {
            body: number,
            weight: 1.0,
            nearness: 1.0 / distance.max(LEAST_DISTANCE * body.radius),
            arm: body.arm(x),
            ..Self::default()
        };
        if distance <= body.radius {
            return (!body.is_ball()).then_some(whole);
        }
        let axis = to / distance;
        let z = axis.dot(d);
        let [inner, outer] = [body.radius, REACH * body.radius].map(|r| cone(r / distance));
        if z <= outer {
            return None;
        }
        let (weight, slope) = rise(z, outer, inner);
        let along_axis = axis - d * z;
        let gradient = along_axis * slope;
        if !body.is_ball() {
            return Some(Self {
                weight,
                gradient,
                ..whole
            });
        }
        let near = (inner / NEAR).min(1.0);
        let near = near * near;
        let per_cosine = 1.0 / (distance * inner * inner);
        Some(Self {
            weight: near * weight,
            gradient: gradient * near,
            nearness: z * per_cosine,
            nearness_gradient: along_axis * per_cosine,
            ..whole
        })
    }

    /// The part of a velocity relative to x that is followed.
    pub fn followed(&self, velocity: DVec3) -> DVec3 {
        self.across.map_or(velocity, |a| a * a.dot(velocity))
    }

    /// How a direction turns with the body.
    pub fn turn(&self, rotation: DVec3, d: DVec3) -> DVec3 {
        match self.across {
            Some(_) => DVec3::ZERO,
            None => rotation.cross(d),
        }
    }

    /// That of a wall whose middle is at `to` from x, and to whose plane `across` leads.
    fn of_wall(body: &Body, number: usize, [to, across, x]: [DVec3; 3], d: DVec3) -> Option<Self> {
        let (height, cos) = (across.dot(to), across.dot(d));
        let [near, far] = WALL_DISTANCES.map(|part| height / (part * body.radius));
        if cos <= 0.0 || cos >= near {
            return None;
        }
        let (weight, slope) = rise(cos, near, far);
        let [low, high] = WALL_HEIGHTS.map(|part| part * body.radius);
        let (lowness, _) = rise(height, high, low);
        let along = across - d * cos;
        Some(Self {
            body: number,
            weight: lowness * weight,
            gradient: along * (lowness * slope),
            nearness: cos / height,
            nearness_gradient: along / height,
            arm: body.arm(x),
            across: Some(across),
        })
    }
}

/// Whether some directions from x follow a body.
pub fn is_followed_from(body: &Body, x: DVec3) -> bool {
    let leads = |normal| across_to_wall(normal, body.radius, body.centre - x).is_some();
    body.plane_normal().is_none_or(leads)
}

/// The unit direction to the plane of a wall whose middle is at `to` from x, if any direction
/// follows the wall: x is low over it, and in the sphere around it, so that lines which meet that
/// are known to meet all of its field.
fn across_to_wall(normal: DVec3, radius: f64, to: DVec3) -> Option<DVec3> {
    let height = normal.dot(to);
    let is_low = height.abs() < WALL_HEIGHTS[1] * radius && height.abs() > LEAST_HEIGHT * radius;
    let follows = is_low && to.length_squared() < radius * radius;
    follows.then(|| normal * height.signum())
}

/// From zero at `from` to one at `to` and beyond, smoothly; and its slope.
fn rise(x: f64, from: f64, to: f64) -> (f64, f64) {
    let u = ((x - from) / (to - from)).clamp(0.0, 1.0);
    (u * u * (3.0 - 2.0 * u), 6.0 * u * (1.0 - u) / (to - from))
}

/// The cosine of the half-angle whose sine this is; of a cone that x lies in, that of all
/// directions.
fn cone(sin: f64) -> f64 {
    if sin < 1.0 {
        (1.0 - sin * sin).sqrt()
    } else {
        -1.0
    }
}
