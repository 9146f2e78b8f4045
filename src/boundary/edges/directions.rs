//! Which directions around a vertex matter, for drawing edges (`boundary::edges::tree`).

use super::tree::Query;
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// Beside a narrow lobe edges are drawn this much less often than in its middle.
const LEAST: f64 = 1e-3;
/// Ends of edges that rise above the horizon by less than this sine lie in the surface.
const HORIZON: f64 = 1e-6;

/// Directions above a horizon.
pub struct Directions {
    pub x: DVec3,
    /// Away from the horizon's dark side, unit.
    pub up: DVec3,
    pub part: Part,
}

/// What part of them matters.
pub enum Part {
    /// All, by their cosine.
    Hemisphere,
    /// A lobe about a unit direction, of a width as for GGX (`boundary::cells::lobe::line`).
    Lobe { main: DVec3, width_rad: f64 },
    /// What stands before a light: a cone, no farther than the light.
    Cone {
        axis: DVec3,
        half_rad: f64,
        far: f64,
    },
}

impl Directions {
    fn value(&self, d: DVec3, spread_rad: f64) -> f64 {
        let nearest = |axis: DVec3| (angle(axis, d) - spread_rad).max(0.0);
        let low = nearest(self.up);
        if low >= FRAC_PI_2 {
            return 0.0;
        }
        match self.part {
            Part::Hemisphere => low.cos(),
            Part::Lobe { main, width_rad } => {
                let tilt = nearest(main) / width_rad;
                (1.0 + tilt * tilt).powi(-2) + LEAST
            }
            Part::Cone { axis, half_rad, .. } => {
                if nearest(axis) > half_rad {
                    0.0
                } else {
                    low.cos()
                }
            }
        }
    }
}

impl Query for Directions {
    fn origin(&self) -> DVec3 {
        self.x
    }

    fn weight(&self, d: DVec3, spread_rad: f64, distance: f64) -> f64 {
        match self.part {
            Part::Cone { far, .. } if distance > far => 0.0,
            _ => self.value(d, spread_rad),
        }
    }

    fn edge_weight(&self, ends: [DVec3; 2]) -> f64 {
        let [a, b] = ends.map(DVec3::normalize);
        // The shorter arc between two directions below a plane stays below it.
        if [a, b].iter().all(|d| d.dot(self.up) < HORIZON) {
            return 0.0;
        }
        let middle = (a + b).normalize();
        let angle = a.angle_between(b);
        if let Part::Cone { far, .. } = self.part {
            let [p, q] = ends;
            let nearest = p.cross(q).length() / p.distance(q);
            return if nearest > far {
                0.0
            } else {
                self.value(middle, 0.5 * angle)
            };
        }
        // Bounds of both halves: an edge is mostly short.
        let halves = [a, b].map(|end| self.value((end + middle).normalize(), 0.25 * angle));
        0.5 * (halves[0] + halves[1])
    }

    fn wants_shading(&self) -> bool {
        !matches!(self.part, Part::Cone { .. })
    }
}

fn angle(a: DVec3, b: DVec3) -> f64 {
    a.dot(b).clamp(-1.0, 1.0).acos()
}
