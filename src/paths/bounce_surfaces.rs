//! Lines over the hemisphere of a vertex that other surfaces surround.
//!
//! What lies beyond a silhouette has to be known here: the ends of cells are first hits, silhouettes are walked to from both, and a
//! path is traced on either side of each (`super::bounce_search`).

use super::bounce_cells::{AXIS, FAMILIES, Finder, Seen};
use super::bounce_lines::{LaneSurface, Line, Lobe};
use super::bounce_search::{PROBES, PROBES_OF_PART, Way};
use super::random::Stream;
use super::rays::lane_of;
use crate::lanes::LANES;
use crate::trace::geometry::NO_TRIANGLE;

/// Streams of paths that look beside silhouettes are kept apart from all others by this dimension offset.
const PROBE_INDEX: u32 = 0x4000_0000;

impl Finder<'_> {
    /// Lines among reflecting surfaces. A line costs many rays: mostly that of one lane stands for all. But where narrow lobes
    /// of a packet see different meshes, a silhouette is near, and all its lanes look for it.
    pub(super) fn surfaces(
        &mut self,
        seen: Seen,
        depth: u32,
        stream: &Stream,
        index: &[u32; LANES],
    ) {
        let environment = &self.tracer.scene.environment;
        let has_even_sky = environment.as_ref().is_some_and(|e| e.map.is_none());
        let [mut narrow, mut others] = [0u32; 2];
        let looks = self.vertices.line_survival.to_array();
        for lane in (0..LANES).filter(|&l| looks[l] > 0.0) {
            match Lobe::of_lane(self.vertices, lane) {
                None => {}
                Some(lobe) if self.is_narrow(lobe, lane) => narrow |= 1 << lane,
                // What light samples find at the last vertex has lines of its own, on the lights.
                Some(_) if self.at_last && !has_even_sky => {}
                Some(_) => others |= 1 << lane,
            }
        }
        for (group, lanes) in [narrow, others].into_iter().enumerate() {
            let count = lanes.count_ones();
            if count == 0 {
                continue;
            }
            let all = group == 0 && self.sees_several(seen, lanes & self.rays.active);
            let dimension = AXIS + index[0] * 128 + depth * 2 + group as u32;
            let chosen = (stream.uniform(dimension) * count as f32) as u32;
            let lanes = (0..LANES).filter(|&l| lanes >> l & 1 == 1);
            for (number, lane) in lanes.enumerate() {
                if all {
                    self.line_of_lane(lane, 1.0, seen, depth, stream, index[lane]);
                } else if number as u32 == chosen.min(count - 1) {
                    self.line_of_lane(lane, count as f64, seen, depth, stream, index[lane]);
                }
            }
        }
    }

    /// Whether light samples are of no use to a lobe.
    fn is_narrow(&self, lobe: Lobe, lane: usize) -> bool {
        lobe != Lobe::Diffuse && self.vertices.kinds.wide >> lane & 1 == 0
    }

    /// Whether these lanes' bounces end on different meshes.
    fn sees_several(&self, seen: Seen, lanes: u32) -> bool {
        match seen {
            Seen::Environment(free) => free & lanes != 0 && free & lanes != lanes,
            Seen::Triangles(triangles) => {
                let lanes = (0..LANES).filter(|&l| lanes >> l & 1 == 1);
                let mesh = |triangle: u32| {
                    (triangle != NO_TRIANGLE)
                        .then(|| self.tracer.geometry.mesh_of_triangle[triangle as usize])
                };
                let mut meshes = lanes.map(|l| mesh(triangles[l]));
                let first = meshes.next();
                meshes.any(|m| Some(m) != first)
            }
        }
    }

    /// A line for one lane of the packet, which stands for as many as `weight`.
    fn line_of_lane(
        &mut self,
        lane: usize,
        weight: f64,
        seen: Seen,
        depth: u32,
        stream: &Stream,
        index: u32,
    ) {
        let Some(lobe) = Lobe::of_lane(self.vertices, lane) else {
            return;
        };
        let is_narrow = self.is_narrow(lobe, lane);
        let number = index.wrapping_mul(8).wrapping_add(depth);
        let choice = |salt: u32| stream.uniform(AXIS + number * 16 + salt) as f64;
        let mut at = LaneSurface::new(self.vertices, self.surface, lane, lobe);
        let jitter = self.jitter[lane] as f64;
        let line = if lobe == Lobe::Diffuse {
            let bounce = lane_of(self.rays.direction, lane).as_dvec3().normalize();
            let is_known = matches!(seen, Seen::Triangles(_));
            Some(Line::diffuse(&at, bounce, self.axis, jitter, is_known))
        } else {
            Line::lobe(&at, (choice(1) * FAMILIES) as usize, choice(2), jitter)
        };
        let Some(line) = line else { return };
        if !self.moves(lane, &line, &at) {
            return;
        }
        // Both sides of a crossing share their random numbers, and nothing else does.
        let probes = |number: u32| PROBE_INDEX + (index * PROBES + number) * LANES as u32;
        let way = Way {
            lane,
            weight,
            is_narrow,
            depth,
            stream,
        };
        let geometric = lane_of(self.surface.geometric, lane).as_dvec3();
        let Some((psi, [before, beyond])) = line.cut(geometric) else {
            self.part(&line, &mut at, &way, seen, &|i| choice(3 + i), probes);
            return;
        };
        let cells = before.psi.len() as u32 - 1;
        self.part(&before, &mut at, &way, seen, &|i| choice(3 + i), probes);
        self.part(
            &beyond,
            &mut at,
            &way,
            seen,
            &|i| choice(3 + cells + i),
            |number| probes(PROBES_OF_PART + number),
        );
        self.own_plane(
            &before,
            &beyond,
            psi,
            &mut at,
            &way,
            probes(2 * PROBES_OF_PART),
        );
    }
}
