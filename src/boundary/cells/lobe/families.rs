//! Two families of half great circles that share the motion of every border between them.
//!
//! On the unit sphere a border moves by a vector in the tangent plane, which is known up to a
//! multiple of the border's own tangent. A line brings the part that lies along it.
//!
//! **Shortest motion.** With F_f the derivative of F along the line of family f the shortest vector
//! that keeps F = 0 has the parts −Ḟ F_f / (F₁² + F₂²). None of them is singular.
//!
//! **The point's motion.** The point of an edge that is seen moves by a₁t₁ + a₂t₂, with t the
//! directions of both families there. The borders of a thing that is much smaller than the
//! distances between lines move alike then, and what they bring together is as small as the thing.
//! The parts are singular where both families have one direction.

use crate::discontinuity::boundary::Boundary;
use crate::trace::geometry::Geometry;
use glam::DVec3;

/// Where the sine of the angle between the families' directions is smaller, points' motions are not
/// parted among them.
const LEAST_ANGLE: f64 = 0.1;

/// The half great circles through either of two poles, and the pole of one of them.
#[derive(Clone, Copy, Debug)]
pub struct Family {
    pub poles: [DVec3; 2],
    pub axis: usize,
}

impl Family {
    pub fn pole(&self) -> DVec3 {
        self.poles[self.axis]
    }

    /// The directions of both families at the unit direction `d`.
    fn tangents(&self, d: DVec3) -> [DVec3; 2] {
        self.poles.map(|pole| (pole - d * d.dot(pole)).normalize())
    }

    /// An edge as its point that is seen from `x` along `d`; what cannot be parted as it is.
    pub fn of_point(&self, edge: Boundary, geometry: &Geometry, x: DVec3, d: DVec3) -> Boundary {
        let tangents = self.tangents(d);
        if tangents[0].cross(tangents[1]).length() < LEAST_ANGLE {
            return edge;
        }
        edge.of_point(geometry, x, d, tangents[1 - self.axis])
    }

    /// The speed along this family's line at which a border with F = `c`·d crosses it at `d`, per
    /// unit of Ḟ, times cos ψ; `None` where it does not cross.
    pub fn weight(&self, boundary: &Boundary, c: DVec3, d: DVec3) -> Option<f64> {
        if !matches!(boundary, Boundary::Point { .. }) {
            return self.shortest_weight(c, d);
        }
        let along = c.dot(self.tangents(d)[self.axis]);
        (along != 0.0).then(|| -self.cos_psi(d) / along)
    }

    /// The same of the shortest motion.
    pub fn shortest_weight(&self, c: DVec3, d: DVec3) -> Option<f64> {
        let along = self.tangents(d).map(|t| c.dot(t));
        let norm = along[0] * along[0] + along[1] * along[1];
        if norm.is_nan() || norm <= 0.0 {
            return None;
        }
        Some(-along[self.axis] / norm * self.cos_psi(d))
    }

    fn cos_psi(&self, d: DVec3) -> f64 {
        let sin_psi = d.dot(self.pole());
        (1.0 - sin_psi * sin_psi).max(0.0).sqrt()
    }
}
