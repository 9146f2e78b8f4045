//! What lies on one line over the hemisphere of a vertex: searched for, and looked at from both
//! sides.

use super::line::{LaneSurface, Line};
use super::shadows;
use super::vertex::{Border, FAMILIES, LobeSearch};
use crate::boundary::cells::line_search::{Cell, LineSearch};
use crate::boundary::inclusion_by_walks::{InclusionByWalks, RayLine};
use crate::boundary::occlusion::{NEAREST, PROBE, SurfacePoint, probe_angle};
use crate::boundary::probe::{Probed, Sides};
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::arc::Arc;
use crate::discontinuity::boundary::Boundary;
use crate::discontinuity::crossing::Crossing;
use crate::lanes::LANES;
use crate::paths::at::At;
use crate::paths::counts::Counts;
use crate::paths::estimator::BounceEnd;
use crate::paths::integrator::Start;
use crate::paths::random::Stream;
use crate::paths::rays::{RayPacket, from_lanes, lane_of};
use glam::{DVec3, Vec3};

/// Silhouettes behind one another that are looked for in one cell.
const ROUNDS: u32 = 8;
/// Whose line it is, how much that stands for, and how paths go on from what is found on it.
pub struct Way<'a> {
    pub lane: usize,
    pub weight: f64,
    pub is_narrow: bool,
    /// Whether something that moves may be seen on it.
    pub sees_silhouettes: bool,
    /// Of what probes see: their sample index, and the stream.
    pub index: u32,
    pub stream: &'a Stream,
}

/// A line, or a part of one, all of which lies on one side of the triangle it starts on; and its
/// random numbers.
pub struct LinePart<'a> {
    pub line: &'a Line,
    /// Uniform, for each cell.
    pub choice: &'a dyn Fn(u32) -> f64,
}

/// Finds what jumps on a part of a line.
pub fn on_part(search: &mut LobeSearch, at: &mut LaneSurface, way: &Way, part: &LinePart) {
    let line = part.line;
    let point = SurfacePoint::of_lane(search.at, way.lane);
    let cells = cells(search, &point, way, line);
    if way.sees_silhouettes {
        silhouettes(search, at, (way, &point), part, &cells);
    }
    if search.has_sharp_shadows() {
        shadows::find(search, at, (way, &point), line, &cells);
    }
}

/// Finds what ends or bends in the cells of a part of a line.
fn silhouettes(
    search: &mut LobeSearch,
    at: &mut LaneSurface,
    (way, point): (&Way, &SurfacePoint),
    part: &LinePart,
    cells: &[LobeCell],
) {
    let (scene, here, line) = (search.scene, search.at, part.line);
    let from_here = FromHere { line, point };
    let mut on_line = LineSearch::new(scene, &mut search.out.counts);
    let mut found = Vec::new();
    for (i, cell) in cells.iter().enumerate() {
        found.extend(on_line.candidates(cell, Some((part.choice)(i as u32))));
    }
    for _ in 0..ROUNDS {
        found = on_line.probe(&found, |_, directions, sides, counts| {
            look(scene, here, point, way, (directions, sides), counts)
        });
        if found.is_empty() {
            break;
        }
    }
    let LineSearch {
        met, mut borders, ..
    } = on_line;
    let borders = borders.remove(&()).unwrap_or_default();
    let mut intervals =
        InclusionByWalks::new(scene, &from_here, borders, |psi| line.intervals(&psi));
    for met in met {
        let psi = met.cell.coordinate(met.s);
        let chance = if met.is_silhouette {
            intervals.inclusion_of_border(psi, met.cell.ends)
        } else {
            intervals.inclusion_of_ridge(psi)
        };
        let jump = met.jump * (FAMILIES * way.weight / chance);
        let border = Border::seen(met.boundary);
        search.push(at, line, border, line.direction(psi), jump);
    }
}

/// The jump where a line crosses the plane of the triangle it starts on, which turns with the
/// triangle: at `psi`, between the two parts of the line.
pub fn on_own_plane(
    search: &mut LobeSearch,
    at: &mut LaneSurface,
    way: &Way,
    [before, beyond]: [&Line; 2],
    psi: f64,
) {
    let here = search.at;
    let (Some(&end), Some(&start)) = (before.psi.last(), beyond.psi.first()) else {
        return;
    };
    if here.vertices.moves >> way.lane & 1 == 0 {
        return;
    }
    let point = SurfacePoint::of_lane(here, way.lane);
    let [a, b] = [end, start].map(|psi| before.direction(psi).as_vec3());
    let directions = std::array::from_fn(|l| if l == 0 { a } else { b });
    let mut sides = Sides::default();
    sides.add(0, true, false);
    let (scene, counts) = (search.scene, &mut search.out.counts);
    let asked = (&directions, sides);
    let (radiance, _) = look(scene, here, &point, way, asked, counts);
    let [before_it, beyond_it] = [0, 1].map(|l| lane_of(radiance, l).as_dvec3());
    let jump = (before_it - beyond_it) * (FAMILIES * way.weight);
    if jump != DVec3::ZERO {
        let border = Border::seen(Boundary::Edge(point.plane_edge(scene.view)));
        search.push(at, before, border, before.direction(psi), jump);
    }
}

/// Radiance from these directions, and the triangles that all sides see.
fn look(
    scene: &SearchScene,
    here: &At,
    point: &SurfacePoint,
    way: &Way,
    (directions, sides): (&[Vec3; LANES], Sides),
    counts: &mut Counts,
) -> Probed {
    let normal = from_lanes(&[point.geometric; LANES]);
    let x = from_lanes(&[point.x; LANES]);
    let start = Start {
        rays: RayPacket::leaving(x, normal, from_lanes(directions), sides.active),
        depth: here.numbers.depth + 1,
        drifts: 0,
        with_emission: way.is_narrow,
        between_planes: 0,
    };
    scene.probe(start, sides, way.stream, &[way.index; LANES], counts)
}

/// The cells of a line: the intervals between its points, of which is seen what lies there.
fn cells<'a, 'b: 'a>(
    search: &mut LobeSearch<'b>,
    point: &'a SurfacePoint,
    way: &Way,
    line: &'a Line,
) -> Vec<LobeCell<'a>> {
    let lane = way.lane;
    let points: Vec<(DVec3, u32)> = line
        .psi
        .iter()
        .enumerate()
        .map(|(i, &psi)| {
            let d = line.direction(psi);
            if let (true, BounceEnd::Triangles(triangles)) =
                (line.bounce == Some(i), search.bounce.seen)
            {
                return (d, triangles[lane]);
            }
            search.out.counts.bounce_cell += 1;
            (d, point.first_hit(search.scene.view, d, f32::INFINITY))
        })
        .collect();
    let cell = |(i, pair): (usize, &[(DVec3, u32)])| LobeCell {
        scene: search.scene,
        line,
        point,
        lane_moves: search.at.vertices.moves >> lane & 1 == 1,
        arc: Arc {
            origin: point.leave(pair[0].0 + pair[1].0).as_dvec3(),
            a: pair[0].0,
            b: pair[1].0,
        },
        ends: [line.psi[i], line.psi[i + 1]],
        triangles: [pair[0].1, pair[1].1],
    };
    points.windows(2).enumerate().map(cell).collect()
}

/// The interval between two points of a line over a lobe, or a part of it.
#[derive(Clone, Copy)]
pub struct LobeCell<'a> {
    scene: &'a SearchScene<'a>,
    line: &'a Line,
    point: &'a SurfacePoint,
    /// Whether all that is seen moves as seen from here.
    lane_moves: bool,
    arc: Arc,
    /// Of the whole interval.
    ends: [f64; 2],
    triangles: [u32; 2],
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
        let [angle, most] = probe_angle(geometry, crossing, arc.origin, direction);
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

/// A line, and where its rays start.
struct FromHere<'a> {
    line: &'a Line,
    point: &'a SurfacePoint,
}

impl RayLine for FromHere<'_> {
    const ROUNDS: u32 = ROUNDS;

    fn arc(&self, ends: [f64; 2]) -> Arc {
        let [a, b] = ends.map(|psi| self.line.direction(psi));
        Arc {
            origin: self.point.leave(a + b).as_dvec3(),
            a,
            b,
        }
    }

    fn coordinate(&self, arc: &Arc, _: [f64; 2], s: f64) -> f64 {
        self.line.psi_of(arc.direction(s))
    }
}
