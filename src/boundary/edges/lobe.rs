//! Edges over the lobes of a packet's vertices: what jumps in the radiance that arrives.

use super::directions::{Directions, Part};
use super::point::explains;
use super::sources::Edges;
use super::surface::{EdgePoints, beside};
use crate::boundary::cells::lobe::line::{LaneSurface, Lobe};
use crate::boundary::probe::{Probed, Sides};
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::crossing::Kind;
use crate::lanes::LANES;
use crate::paths::at::At;
use crate::paths::boundary_sample::{BoundarySample, Coordinate, Found, NO_CHAIN};
use crate::paths::counts::Counts;
use crate::paths::dimensions::{Branch, Single};
use crate::paths::rays::{from_lanes, lane_of};
use crate::paths::start::Start;

/// Finds what jumps over the lobes that paths of some lanes were drawn from.
pub fn find(edges: &Edges, scene: &SearchScene, (at, lanes): (&At, u32), out: &mut Found) {
    let At {
        view,
        vertices,
        numbers,
        ..
    } = *at;
    let at_last = numbers.depth + 2 >= view.limits.max_depth;
    let environment = view.scene.environment.as_ref();
    let has_constant_environment = environment.is_some_and(|e| e.map.is_none());
    let looks = vertices.line_survival.to_array();
    let mut lobes: [Option<Lobe>; LANES] = [None; LANES];
    let mut narrow = 0u32;
    let wanted = |&l: &usize| lanes >> l & 1 == 1 && looks[l] > 0.0;
    for lane in (0..LANES).filter(wanted) {
        let Some(lobe) = Lobe::of_lane(vertices, lane) else {
            continue;
        };
        let is_narrow = vertices.shares_lights() >> lane & 1 == 0;
        // What light samples find at the last vertex has edges of its own, before the lights.
        if is_narrow || !at_last || has_constant_environment {
            lobes[lane] = Some(lobe);
            narrow |= u32::from(is_narrow) << lane;
        }
    }
    let directions = |lane: usize| {
        let surface = LaneSurface::new(at, lane, lobes[lane]?);
        Some(directions(at, &surface))
    };
    let draws = edges.draws(view, vertices.moves, narrow);
    for part in 0..draws.into_iter().max().unwrap_or(1) {
        let points = edges.draw_part(
            at,
            (Single::LobeEdgePoint, draws, part),
            vertices.moves,
            directions,
            &mut out.counts,
        );
        keep(scene, at, (&lobes, narrow), points, out);
    }
}

/// Looks at what was drawn, and keeps what jumps.
fn keep(
    scene: &SearchScene,
    at: &At,
    (lobes, narrow): (&[Option<Lobe>; LANES], u32),
    points: EdgePoints,
    out: &mut Found,
) {
    for lanes in [narrow, !narrow] {
        let mut own: EdgePoints = points;
        for (lane, point) in own.iter_mut().enumerate() {
            if lanes >> lane & 1 == 0 {
                *point = None;
            }
        }
        if own.iter().all(Option::is_none) {
            continue;
        }
        let looked = [-1.0, 1.0].map(|side| {
            let with_emission = lanes == narrow;
            look(scene, at, &own, side, with_emission, &mut out.counts)
        });
        for (lane, lobe) in lobes.iter().enumerate() {
            if let Some(lobe) = lobe {
                push(at, &own, lane, *lobe, &looked, out);
            }
        }
    }
}

/// What of the directions around a lane's vertex its lobe makes matter.
fn directions(at: &At, surface: &LaneSurface) -> Directions {
    let lane = surface.lane();
    let x = at.vertices.position(at.view.geometry, lane);
    let up = match surface.lobe {
        Lobe::Refracted => -surface.n,
        Lobe::Diffuse | Lobe::Reflected => surface.n,
    };
    let part = match surface.lobe {
        Lobe::Diffuse => Part::Hemisphere,
        Lobe::Reflected | Lobe::Refracted => {
            let (main, width_rad) = surface.main_direction();
            Part::Lobe { main, width_rad }
        }
    };
    Directions { x, up, part }
}

/// The radiance that arrives from beside the points of the lanes.
fn look(
    scene: &SearchScene,
    at: &At,
    points: &EdgePoints,
    side: f64,
    with_emission: bool,
    counts: &mut Counts,
) -> Probed {
    let (active, directions) = beside(points, |_| side);
    let is_facet =
        |lane: &usize| points[*lane].is_some_and(|point| point.crossing.kind == Kind::FacetEdge);
    let facet_edges = (0..LANES)
        .filter(is_facet)
        .fold(0, |bits, lane| bits | 1 << lane);
    let sides = Sides {
        active,
        facet_edges,
    };
    let (surface, depth) = (at.surface, at.numbers.depth);
    let directions = from_lanes(&directions);
    let rays = (at.view).leaving(surface.x, surface.geometric, directions, active);
    let start = Start {
        with_emission,
        ..Start::of_rays(rays, depth + 1)
    };
    // Both sides share their random numbers.
    let stream = at
        .numbers
        .stream
        .branch(Branch::LobeEdgeProbe, [depth, 0, 0]);
    scene.probe(start, sides, &stream, at.numbers.index, counts)
}

fn push(
    at: &At,
    points: &EdgePoints,
    lane: usize,
    lobe: Lobe,
    [(before, seen_before), (after, seen_after)]: &[Probed; 2],
    out: &mut Found,
) {
    let Some(point) = points[lane] else { return };
    let seen = [seen_before[lane], seen_after[lane]];
    if point.crossing.is_hidden(seen) || !explains(at.view.geometry, &point.crossing, seen) {
        return;
    }
    let jump = (lane_of(*after, lane) - lane_of(*before, lane)).as_dvec3();
    let mut surface = LaneSurface::new(at, lane, lobe);
    let Some((local, value, density)) = surface.value(point.direction) else {
        return;
    };
    let vertices = at.vertices;
    let chance = f64::from(vertices.lobe_chance.to_array()[lane]);
    let survival = f64::from(vertices.line_survival.to_array()[lane]);
    let throughput = lane_of(vertices.throughput, lane).as_dvec3();
    let jump = throughput * jump / chance;
    let x = lane_of(at.surface.x, lane).as_dvec3();
    let (boundary, per_line) = (point.boundary).standing_seen_from(at.view.geometry, x, seen);
    let brings = value * jump * (density * point.per_side * per_line * survival);
    if !brings.is_finite() {
        out.counts.boundary_not_finite += 1;
    } else if brings != glam::DVec3::ZERO {
        out.samples.push(BoundarySample {
            chain: NO_CHAIN,
            boundary,
            lane: lane as u8,
            at: Coordinate::Lobe(local.to_array()),
            weight: brings.as_vec3().to_array(),
            jump: (surface.weight_of_path(local, value) * jump).length() as f32,
            shadow: None,
        });
    }
}
