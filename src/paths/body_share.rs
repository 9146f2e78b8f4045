//! A body's part in the field that directions follow (`paths::lobe_drift`).
//!
//! **A ball** is followed by a disc: that of the circle in which a cone from x touches the sphere
//! around it, at the distance D cos²α with sin α = R/D, along the axis. On the ball's outline the
//! field is that of the outline itself. Close to a ball the disc is near and its points fast, so
//! that the field fades there.
//!
//! **Others** are followed by a sphere around x through their middle: what is seen of them lies
//! nearer and farther alike, and so does it from within the sphere around them, where all directions
//! follow.

use crate::paths::drift_body::Body;
use glam::DVec3;

/// The field reaches to this multiple of a body's sphere.
pub const REACH: f64 = 1.5;
/// The cosine of a cone's half-angle below which that of a ball fades: x nearly touches it.
const NEAR: f64 = 0.6;
/// Of a body's radius: the least distance that is followed.
const LEAST_DISTANCE: f64 = 0.5;

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
}

impl BodyShare {
    /// Of a body, not yet parted among bodies nor faded at the horizon. `None` where it is zero.
    pub fn new(body: &Body, number: usize, x: DVec3, d: DVec3) -> Option<Self> {
        let to = body.centre - x;
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
        let u = ((z - outer) / (inner - outer)).min(1.0);
        let weight = u * u * (3.0 - 2.0 * u);
        let along_axis = axis - d * z;
        let gradient = along_axis * (6.0 * u * (1.0 - u) / (inner - outer));
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
}

/// The cosine of the half-angle whose sine this is; of a cone that x lies in, that of all directions.
fn cone(sin: f64) -> f64 {
    if sin < 1.0 {
        (1.0 - sin * sin).sqrt()
    } else {
        -1.0
    }
}
