//! An interval of a line over a lobe.

use super::line::Line;
use crate::boundary::cells::delta::follow::Rays;
use crate::boundary::cells::line_search::Cell;
use crate::boundary::occlusion::{NEAREST, PROBE, SurfacePoint, probe_angle};
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::arc::Arc;
use crate::discontinuity::boundary::Boundary;
use crate::discontinuity::crossing::Crossing;
use glam::DVec3;

/// The interval between two points of a line over a lobe, or a part of it.
#[derive(Clone, Copy)]
pub struct LobeCell<'a> {
    pub scene: &'a SearchScene<'a>,
    pub line: &'a Line,
    pub point: &'a SurfacePoint,
    /// Whether all that is seen moves as seen from here.
    pub lane_moves: bool,
    pub arc: Arc,
    /// Of the whole interval.
    pub ends: [f64; 2],
    pub triangles: [u32; 2],
}

impl LobeCell<'_> {
    /// Its rays, from its second end to its first if they are reversed.
    pub fn rays(&self, is_reversed: bool) -> Rays<impl Fn(f64) -> u32> {
        let (mut arc, mut seen) = (self.arc, self.triangles);
        if is_reversed {
            arc = arc.reversed();
            seen.reverse();
        }
        Rays {
            arc,
            seen,
            first_hit: move |s: f64| self.first_hit(if is_reversed { 1.0 - s } else { s }),
        }
    }
}

impl Cell for LobeCell<'_> {
    type Line = ();

    fn line(&self) {}

    fn triangles(&self) -> [u32; 2] {
        self.triangles
    }

    fn part(&self, ends: [f64; 2], triangles: [u32; 2]) -> Self {
        let [a, b] = ends.map(|s| self.arc.direction(s));
        Self {
            arc: Arc { a, b, ..self.arc },
            triangles,
            ..*self
        }
    }

    fn arc(&self) -> Arc {
        self.arc
    }

    fn direction(&self, s: f64) -> DVec3 {
        self.arc.direction(s).normalize()
    }

    fn coordinate(&self, s: f64) -> f64 {
        self.line.psi_of(self.arc.direction(s))
    }

    fn first_hit(&self, s: f64) -> u32 {
        let d = self.arc.direction(s);
        self.point.first_hit(self.scene.view, d, f32::INFINITY)
    }

    fn gap(&self) -> f64 {
        (2.0 * NEAREST / self.arc.a.angle_between(self.arc.b)).min(2.0 * PROBE)
    }

    fn beside(&self, crossing: &Crossing) -> f64 {
        let arc = &self.arc;
        let direction = arc.direction(crossing.s);
        let geometry = self.scene.view.geometry;
        let [angle, most] = probe_angle(geometry, crossing, (arc.origin, 0.0), direction);
        (angle / arc.a.angle_between(arc.b)).min(most)
    }

    fn moves(&self, boundary: &Boundary) -> bool {
        let geometry = self.scene.view.geometry;
        self.lane_moves || self.scene.moving.boundary(geometry, boundary)
    }

    fn weight(&self) -> f64 {
        1.0
    }
}
