//! The plane of the triangle that a vertex lies on, as a border of what arrives there.
//!
//! A smooth normal n leans over the horizon of its triangle. Rays below the triangle's plane start
//! on its other side, where the inside of a body hides what would be reflected from there. The
//! plane moves with the triangle, and over it what arrives jumps: it is a great circle of
//! directions, of which the half counts that is above n's own horizon.

use super::directions::{Directions, Part};
use super::point::EdgePoint;
use crate::boundary::occlusion::SurfacePoint;
use crate::discontinuity::boundary::Boundary;
use crate::discontinuity::crossing::{Crossing, Kind};
use crate::paths::scene_view::SceneView;
use crate::trace::geometry::Geometry;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// The horizon is drawn with the sine by which normals lean over it, which is what directions there
/// bring, but not more often than this.
const MOST_OFTEN: f64 = 0.5;
/// Normals that lean by less are those of the triangle.
const LEAST_LEAN: f64 = 1e-5;
/// Probes look so far above and below (radians): a plane is known to 1e-6 or so in single
/// precision.
const BESIDE_RAD: f64 = 1e-4;

/// The part of a plane's directions that matters: within `half_rad` of `middle`.
pub struct Horizon {
    pub chance: f64,
    /// Unit, on the side of the shading normal.
    plane: DVec3,
    middle: DVec3,
    half_rad: f64,
    edge: [u32; 2],
}

impl Horizon {
    /// `None` where normals do not lean, or what matters does not reach the plane.
    pub fn new(view: &SceneView, directions: &Directions, point: &SurfacePoint) -> Option<Self> {
        let g = point.geometric.as_dvec3().normalize();
        let plane = g * g.dot(directions.up).signum();
        let leans = directions.up - plane * directions.up.dot(plane);
        let lean = leans.length();
        if lean < LEAST_LEAN {
            return None;
        }
        let (mut middle, mut half_rad) = (leans / lean, FRAC_PI_2);
        if let Part::Cone {
            axis,
            half_rad: cone_rad,
            ..
        } = directions.part
            && cone_rad < FRAC_PI_2
        {
            // cos of the angle to the axis: |axis in the plane| times that of the angle within it.
            let within = axis - plane * axis.dot(plane);
            let cos = cone_rad.cos() / within.length();
            if cos.is_nan() || cos >= 1.0 {
                return None;
            }
            (middle, half_rad) = (within.normalize(), cos.acos());
        }
        Some(Self {
            chance: lean.min(MOST_OFTEN),
            plane,
            middle,
            half_rad,
            edge: point.plane_edge(view),
        })
    }

    /// A point of it by a uniform number.
    pub fn draw(
        self,
        geometry: &Geometry,
        directions: &Directions,
        along: f64,
    ) -> Option<EdgePoint> {
        let angle = (2.0 * along - 1.0) * self.half_rad;
        let aside = self.plane.cross(self.middle);
        let direction = self.middle * angle.cos() + aside * angle.sin();
        let boundary = Boundary::Edge(self.edge);
        let c = boundary.normal(geometry, directions.x);
        let across = c.normalize();
        let open_side = across.dot(self.plane).signum();
        let per_side = 2.0 * self.half_rad / (self.chance * c.length());
        (per_side.is_finite() && across.is_finite()).then_some(EdgePoint {
            boundary,
            crossing: Crossing::new(boundary, Kind::Silhouette, 0.0),
            open_side: Some(open_side),
            direction,
            way: direction,
            across,
            beside_rad: BESIDE_RAD,
            per_side,
            is_horizon: true,
        })
    }
}
