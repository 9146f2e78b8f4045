//! What a vertex sees through smooth surfaces: lines over lobes whose points meet one.

use super::follow::{FirstRays, Followed};
use super::look::jumps;
use super::search::{ChainSearch, Found};
use crate::boundary::cells::lobe::line::{LaneSurface, Line};
use crate::boundary::cells::lobe::vertex::{Border, LobeSearch};
use crate::boundary::occlusion::SurfacePoint;
use crate::lanes::LANES;
use crate::paths::dimensions::Single;
use crate::paths::random::Stream;
use glam::DVec3;

/// Points on each part of a line that sees one smooth surface: what is seen through that is as
/// large as the world.
const NEW_POINTS: u32 = 16;

/// How paths go on from what is found on a line, and what that stands for.
pub struct Probes<'a> {
    pub stream: &'a Stream,
    pub index: u32,
    pub weight: f64,
}

/// The rays of a line over a lobe, by ψ.
struct LineRays<'a> {
    line: &'a Line,
    point: &'a SurfacePoint,
    lane_moves: bool,
}

impl FirstRays for LineRays<'_> {
    fn ray(&self, s: f64) -> (DVec3, DVec3) {
        let direction = self.line.direction(s);
        (self.point.leave(direction).as_dvec3(), direction)
    }

    fn chance_between(&self, places: [f64; 2]) -> f64 {
        self.line.chance_between(places)
    }

    fn place(&self, s: f64) -> f64 {
        self.line.place(s)
    }

    fn at_place(&self, place: f64) -> f64 {
        self.line.at_place(place)
    }

    fn moves(&self, _: f64) -> bool {
        self.lane_moves
    }

    fn reach(&self) -> [f32; 2] {
        [0.0, f32::INFINITY]
    }
}

/// Finds what jumps behind smooth surfaces on a part of a line, whose points see these triangles.
pub fn find(
    search: &mut LobeSearch,
    at: &mut LaneSurface,
    (line, seen): (&Line, &[u32]),
    probes: &Probes,
) {
    let (scene, here, lane) = (search.scene, search.at, at.lane());
    let is_smooth = |&t: &u32| Followed::is_smooth(scene.view, t);
    if !scene.view.materials.any_chains || !seen.iter().any(is_smooth) {
        return;
    }
    let depth = here.numbers.depth + 1;
    let point = SurfacePoint::of_lane(here, lane);
    let rays = LineRays {
        line,
        point: &point,
        lane_moves: search.lane_moves(lane),
    };
    let random = |name| {
        let name = [probes.index, depth, name];
        f64::from(here.numbers.stream.single(Single::LobeChain, name))
    };
    let mut chains = ChainSearch {
        scene,
        rays: &rays,
        counts: &mut search.out.counts,
        random: &random,
        drawn: 0,
        depth,
        splits_first: false,
        new_points: Some(NEW_POINTS),

        waiting: Vec::new(),
        found: Vec::new(),
    };
    let points = line.psi.iter().zip(seen);
    chains.search(
        points
            .map(|(&psi, &seen)| Followed::first(&rays, psi, seen))
            .collect(),
    );
    let mut found = chains.found;
    found.sort_by_key(Found::kind);
    for group in found.chunk_by(|a, b| a.kind() == b.kind()) {
        for group in group.chunks(LANES / 2) {
            let all: Vec<&Found> = group.iter().collect();
            let numbers = (probes.stream, &[probes.index; LANES]);
            let jumps = jumps(scene, &all, depth, numbers, &mut search.out.counts);
            for (border, jump) in group.iter().zip(jumps) {
                let direction = line.direction(border.s);
                if jump != DVec3::ZERO {
                    let kept = Border {
                        boundary: border.boundary,
                        beside: None,
                        shadow: border.shadow,
                        chain: &border.chain,
                    };
                    let times = border.times();
                    let jump = (jump / times, times * probes.weight);
                    search.push(at, line, kept, direction, jump);
                }
            }
        }
    }
}
