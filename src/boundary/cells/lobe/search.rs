//! What lies on one line over the hemisphere of a vertex: searched for, and looked at from both
//! sides.

use super::cell::LobeCell;
use super::line::{LaneSurface, Line};
use super::shadows;
use super::vertex::{Border, FAMILIES, LobeSearch};
use crate::boundary::cells::chain::{self, lobe::Probes};
use crate::boundary::cells::line_search::{Cell, LineSearch, Look};
use crate::boundary::inclusion_by_walks::{InclusionByWalks, RayLine};
use crate::boundary::occlusion::SurfacePoint;
use crate::boundary::probe::Sides;
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::arc::Arc;
use crate::discontinuity::boundary::Boundary;
use crate::lanes::{LANES, Lane, V3};
use crate::paths::at::At;
use crate::paths::bounce::BounceEnd;
use crate::paths::counts::Counts;
use crate::paths::random::Stream;
use crate::paths::rays::{RayPacket, from_lanes, lane_of};
use crate::paths::start::Start;
use crate::trace::Coherence;
use glam::DVec3;

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
        shadows::find(search, at, (way.weight, &point), line, &cells);
    }
    let first = cells.first().map(|cell| cell.triangles()[0]);
    let after = cells.iter().map(|cell| cell.triangles()[1]);
    let seen: Vec<u32> = first.into_iter().chain(after).collect();
    let probes = Probes {
        stream: way.stream,
        index: way.index,
        weight: FAMILIES * way.weight,
    };
    chain::lobe::find(search, at, (line, &seen), &probes);
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
        found = on_line.see(&found, |directions, active| {
            let rays = leaving(scene, point, directions, active);
            scene.view.intersect(&rays, Coherence::Incoherent)
        });
        if found.is_empty() {
            break;
        }
    }
    let once = vec![0..1; on_line.met.len()];
    on_line.look(&once, |beside, counts| {
        look(scene, here, point, way, beside, counts)
    });
    let LineSearch {
        met, mut borders, ..
    } = on_line;
    let borders = borders.remove(&()).unwrap_or_default();
    let mut intervals =
        InclusionByWalks::new(scene, &from_here, borders, |psi| line.intervals(&psi));
    for met in met.into_iter().filter(|met| met.jump != DVec3::ZERO) {
        let psi = met.at.coordinate();
        let chance = if met.at.crossing.is_silhouette() {
            intervals.inclusion_of_border(psi, met.at.cell.ends)
        } else {
            intervals.inclusion_of_ridge(psi)
        };
        let times = FAMILIES * way.weight / chance;
        let border = Border::seen(met.at.crossing.boundary, Some(met.seen));
        search.push(at, line, border, line.direction(psi), (met.jump, times));
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
    if !search.lane_moves(way.lane) {
        return;
    }
    let point = SurfacePoint::of_lane(here, way.lane);
    let [a, b] = [end, start].map(|psi| before.direction(psi));
    let directions = std::array::from_fn(|l| if l == 0 { a } else { b });
    let mut sides = Sides::default();
    sides.add(0, false);
    let (scene, counts) = (search.scene, &mut search.out.counts);
    let rays = leaving(scene, &point, &directions, sides.active);
    let beside = Look {
        directions,
        sides,
        seen: scene.view.intersect(&rays, Coherence::Incoherent),
        numbers: [0; LANES],
    };
    counts.probe += 2;
    let radiance = look(scene, here, &point, way, &beside, counts);
    let [before_it, beyond_it] = [0, 1].map(|l| lane_of(radiance, l).as_dvec3());
    let jump = before_it - beyond_it;
    if jump != DVec3::ZERO {
        let border = Border::seen(Boundary::Edge(point.plane_edge(scene.view)), None);
        let times = FAMILIES * way.weight;
        search.push(at, before, border, before.direction(psi), (jump, times));
    }
}

/// Rays from a point in these directions.
fn leaving(
    scene: &SearchScene,
    point: &SurfacePoint,
    directions: &[DVec3; LANES],
    active: u32,
) -> RayPacket {
    let normal = from_lanes(&[point.geometric; LANES]);
    let x = from_lanes(&[point.x; LANES]);
    let directions = from_lanes(&directions.map(|d| d.as_vec3()));
    scene.view.leaving(x, normal, directions, active)
}

/// Radiance from the directions of a look.
fn look(
    scene: &SearchScene,
    here: &At,
    point: &SurfacePoint,
    way: &Way,
    beside: &Look,
    counts: &mut Counts,
) -> V3<Lane> {
    let rays = leaving(scene, point, &beside.directions, beside.sides.active);
    let start = Start {
        seen: Some(beside.seen),
        with_emission: way.is_narrow,
        ..Start::of_rays(rays, here.numbers.depth + 1)
    };
    let index = [way.index; LANES];
    scene
        .probe(start, beside.sides, way.stream, &index, counts)
        .0
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
        lane_moves: search.lane_moves(lane),
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
