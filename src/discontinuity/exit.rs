//! Where an arc leaves a triangle. All that goes over surfaces comes to the same numbers, to the
//! last bit: one may stop where another has ended.

use crate::discontinuity::arc::Arc;
use glam::DVec3;

/// What places points by an arc.
pub struct Gauge {
    /// Across its plane.
    normal: DVec3,
    toward_b: DVec3,
    toward_a: DVec3,
}

/// Where a point lies by an arc: on which side of its plane, and the parts of a and b in it, times
/// a factor that is the same for all points.
#[derive(Clone, Copy)]
pub struct Gauged {
    side: f64,
    of_b: f64,
    of_a: f64,
}

impl Gauge {
    pub fn new(arc: &Arc) -> Self {
        let normal = arc.normal();
        Self {
            normal,
            toward_b: normal.cross(arc.a),
            toward_a: arc.b.cross(normal),
        }
    }

    #[inline(always)]
    pub fn of(&self, point: DVec3) -> Gauged {
        Gauged {
            side: self.normal.dot(point),
            of_b: self.toward_b.dot(point),
            of_a: self.toward_a.dot(point),
        }
    }
}

impl Gauged {
    pub fn is_on_side_of(&self, other: Gauged) -> bool {
        (self.side >= 0.0) == (other.side >= 0.0)
    }
}

/// Where an arc crosses an edge, times a positive factor.
pub struct Exit {
    /// Of the edge's second end in the point.
    second: f64,
    /// Of both ends.
    weight: f64,
    of_b: f64,
    of_a: f64,
}

impl Exit {
    /// Of an edge from one side to the other.
    #[inline(always)]
    pub fn new(from: Gauged, to: Gauged) -> Self {
        let (first, second) = (to.side.abs(), from.side.abs());
        Self {
            second,
            weight: first + second,
            of_b: from.of_b * first + to.of_b * second,
            of_a: from.of_a * first + to.of_a * second,
        }
    }

    /// Where on the edge.
    pub fn along(&self) -> f64 {
        self.second / self.weight
    }

    /// How far from a toward b, to compare the ways out of one triangle.
    pub fn toward_b(&self) -> f64 {
        self.of_b / self.weight
    }

    /// Where on the arc.
    pub fn s(&self) -> f64 {
        parameter(self.of_b, self.of_a)
    }
}

/// The s for which a point α·a + β·b is parallel to (1−s)·a + s·b, from numbers proportional to β
/// and α with the same positive factor; infinite beyond the half-turn.
pub fn parameter(of_b: f64, of_a: f64) -> f64 {
    if of_a + of_b > 0.0 {
        of_b / (of_a + of_b)
    } else if of_b > 0.0 {
        f64::INFINITY
    } else {
        0.0
    }
}
