//! Relays: vertices that move so fast that what arrives from there is differentiated over a step.
//!
//! Behind small curved mirrors and lenses, at grazing bounces and in creases a vertex moves
//! thousands of times as fast as what moves it. The derivative of all that is seen from there is
//! multiplied with that speed, so that single paths have most of the variance. Let T be the
//! throughput with which a path arrives at a vertex, ξ where on its triangle and from where it
//! arrives, and L(ξ, θ) the radiance that leaves the vertex. Then
//!
//!   ∂(T L) = ∂T L + T (∂L/∂ξ · ∂ξ + ∂L),
//!
//! and nothing has to find ∂L/∂ξ in the same way as ∂L. At a relay it is found by differences of
//! paths that leave from both sides of ξ with the same random numbers. A step is as long as ξ moves
//! if the film moves by a part of a pixel ([`Spread`]), so that the noise is that of differences of
//! images by such a motion. ∂L is found as everywhere, along the path and at its borders, with a ξ
//! that rests on its triangle.
//!
//! Both parts are linear in what moves, so that the backward sweep can hand cotangents on. Whether
//! a vertex is a relay depends on the path up to there, and on nothing that moves: that makes no
//! border. Borders of what comes before keep their weights, since steps end on the surface or in
//! the triangle's plane, and not on what else a path would meet there; nor do they end beyond what
//! ends the surface. Emission, and delta lights with the borders of their shadows, belong to what
//! arrives. That a step is no derivative is a bias: a part of what relays bring, which is the less
//! the shorter steps are.

use crate::lanes::{LANES, Lane, Real, V3};
use crate::paths::at::{At, Numbers};
use crate::paths::rays::{RayPacket, from_lanes, lane_of, to_rgb};
use crate::paths::relayed::Relay;
use crate::paths::scene_view::SceneView;
use crate::paths::spread::Spread;
use crate::paths::start::Start;
use crate::paths::store::{TileStore, Vertices};
use crate::paths::surface::vertex::Surface;
use crate::trace::Coherence;
use crate::trace::geometry::NO_TRIANGLE;
use glam::Vec3;
use std::array::from_fn;

/// A step is as long as a vertex moves if the film moves by so many pixels. Images are compared
/// over four times that. Here a long step costs more: on a film that drifts relays take off again
/// what an exact term adds, and what a long step misses of that does not cancel.
const STEP_PIXELS: f32 = 0.04;
/// Steps are shorter where an angle at a bend before changes over them by more than this part of
/// its cosine, as close to the rims of balls: what lies beyond does not move in proportion there,
const BEND: f32 = 0.04;
/// but not shorter than this, or they would be as noisy as derivatives.
const LEAST_STEP_PIXELS: f32 = 0.01;
/// Vertices are relays for which a step is longer than this part of the path up to there (or where
/// paths leave the scene for another direction by as many radians),
const FAR: f32 = 0.025;
/// of flat things that the camera sees than this part (elsewhere the film has other means),
const FAR_SEEN: f32 = 0.1;
/// or over which a lobe turns by more than this part of its width.
const TURN: f32 = 0.125;
/// Steps are looked at no farther away than this part of the path up to there, and from directions
/// that are turned by no more than this part of the cosine: what is seen is taken to change by no
/// more over the rest of the step.
const FARTHEST: f32 = 0.5;
const MOST_OF_COSINE: f32 = 0.5;

/// Traces the paths of a packet with the random numbers of these indices.
type Trace<'a> = &'a dyn Fn(&Start, &[u32; LANES], &mut TileStore);

impl SceneView<'_> {
    /// Follows how the paths spread to a vertex, and finds what differences come to at those of
    /// its lanes that are relays; `trace` traces paths of which nothing else is asked.
    pub fn relay(
        &self,
        spread: &mut Spread,
        (vertices, surface, numbers): (&mut Vertices, &Surface, Numbers),
        trace: Trace,
        store: &mut TileStore,
    ) {
        spread.arrive(self, vertices, surface);
        let mut lanes = relays(self, spread, vertices, surface);
        if numbers.depth == 0 {
            lanes &= seen_edge_on(spread);
            vertices.relays = [store.relays.len() as u32; 2];
        } else {
            self.relay_escaped(spread, vertices, store);
        }
        let at = At {
            view: self,
            vertices,
            surface,
            numbers,
        };
        for packet in packets(&at, lanes, spread) {
            relay_packet(&at, packet, (spread, trace), store);
        }
        vertices.relays[1] = store.relays.len() as u32;
    }

    /// The same where paths leave the scene: the map is compared over a step of their directions.
    pub fn relay_escaped(&self, spread: &Spread, vertices: &mut Vertices, store: &mut TileStore) {
        vertices.relays = [store.relays.len() as u32; 2];
        let environment = self.scene.environment.as_ref();
        let Some(environment) = environment.filter(|e| e.map.is_some()) else {
            return;
        };
        let turn = spread.ray_rad * step_pixels(spread);
        let turns = turn.gt(Lane::splat(FAR)).to_bits();
        let lanes = turns & vertices.escaped & vertices.moves & !vertices.sampled;
        for lane in (0..LANES).filter(|&l| lanes >> l & 1 == 1) {
            let direction = lane_of(vertices.direction, lane);
            let length = turn.to_array()[lane];
            let looks = length.min(MOST_OF_COSINE);
            let beside = direction.any_orthonormal_vector();
            let ways = [beside, direction.cross(beside)];
            let seen = from_lanes(&from_fn(|l| {
                let side = if l % 2 == 0 { looks } else { -looks };
                (direction + ways[l / 2 % 2] * side).normalize()
            }));
            let radiance = to_rgb(self.environment_radiance(environment, seen)).map(Vec3::from);
            let throughput = lane_of(vertices.arriving_throughput(), lane);
            let slopes =
                [0, 2].map(|l| throughput * (radiance[l] - radiance[l + 1]) / (2.0 * length));
            let along = |axis: Vec3| slopes[0] * ways[0].dot(axis) + slopes[1] * ways[1].dot(axis);
            store.relays.push(Relay {
                lane: lane as u8,
                by_b: [Vec3::ZERO; 2],
                by_direction: Vec3::AXES.map(along),
            });
        }
        vertices.relays[1] = store.relays.len() as u32;
    }
}

/// The lanes that are relays. Chains end at one, but it is none of their bends. Where a picture
/// jumps that is a border before them.
fn relays(view: &SceneView, spread: &Spread, vertices: &Vertices, surface: &Surface) -> u32 {
    let kinds = &vertices.kinds;
    let is_far = (spread.at * step_pixels(spread)).gt(spread.length * FAR);
    let mut lanes = is_far.to_bits();
    if let Some(interface) = &surface.interface {
        let turns = (spread.normal_rad + spread.ray_rad) * step_pixels(spread);
        lanes |= kinds.special() & turns.gt(interface.alpha * TURN).to_bits();
    }
    lanes &= vertices.hit & vertices.moves & !kinds.in_chains();
    let jumps = |lane: &usize| {
        let pattern = view.geometry.pattern(vertices.triangle[*lane]);
        pattern.is_some_and(|pattern| !pattern.rulings.is_empty())
    };
    let jumping = (0..LANES).filter(|l| lanes >> l & 1 == 1).filter(jumps);
    jumping.fold(lanes, |lanes, lane| lanes & !(1 << lane))
}

/// Of what the camera sees only what is flat and nearly edge-on moves much faster than the film.
/// Where much lies in a pixel the film follows something else, and such a leaf slides under it.
fn seen_edge_on(spread: &Spread) -> u32 {
    let is_far = (spread.at * step_pixels(spread)).gt(spread.length * FAR_SEEN);
    is_far.to_bits() & !spread.normal_rad.gt(Lane::splat(0.0)).to_bits()
}

/// How far the film moves, in pixels, over a step.
fn step_pixels(spread: &Spread) -> Lane {
    let in_proportion = Lane::splat(BEND) / spread.bends;
    Lane::splat(STEP_PIXELS).min(in_proportion.max(Lane::splat(LEAST_STEP_PIXELS)))
}

/// A step, and what arrives at both of its ends.
struct Step {
    lane: usize,
    changes: Changed,
    way: Vec3,
    length: f32,
    ends: [End; 2],
}

/// What a step changes.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Changed {
    /// Where on its triangle a vertex is.
    Place,
    /// The direction from which the path arrives.
    Direction,
}

#[derive(Clone, Copy)]
struct End {
    origin: Vec3,
    direction: Vec3,
    triangle: u32,
    /// Whether this is where the vertex itself is.
    stays: bool,
}

/// The steps of these lanes, with as many lanes in a packet as their ends leave room for.
fn packets(at: &At, lanes: u32, spread: &Spread) -> Vec<Vec<Step>> {
    let mut packets: Vec<Vec<Step>> = Vec::new();
    for lane in (0..LANES).filter(|&l| lanes >> l & 1 == 1) {
        let turns = turns(at, lane, spread).into_iter().flatten();
        let steps: Vec<Step> = slides(at, lane, spread).into_iter().chain(turns).collect();
        match packets.last_mut() {
            Some(last) if 2 * (last.len() + steps.len()) <= LANES => last.extend(steps),
            _ => packets.push(steps),
        }
    }
    packets
}

/// Over the triangle, in two directions.
fn slides(at: &At, lane: usize, spread: &Spread) -> [Step; 2] {
    let triangle = at.vertices.triangle[lane];
    let corners = at.view.geometry.triangles[triangle as usize];
    let [p, q, _] = corners.map(|v| at.view.geometry.positions[v as usize]);
    let along = (q - p).normalize();
    let [origin, direction] = arriving(at, lane);
    let length = step_pixels(spread).to_array()[lane] * spread.at.to_array()[lane];
    let looks = length.min(FARTHEST * spread.length.to_array()[lane]);
    let normal = lane_of(at.surface.geometric, lane);
    [along, normal.cross(along)].map(|way| Step {
        lane,
        changes: Changed::Place,
        way,
        length,
        ends: [looks, -looks].map(|by| End {
            origin: origin + way * by,
            direction,
            triangle,
            stays: false,
        }),
    })
}

/// Of the direction, in two others; none where no lobe depends on it.
fn turns(at: &At, lane: usize, spread: &Spread) -> Option<[Step; 2]> {
    if at.vertices.kinds.special() >> lane & 1 == 0 {
        return None;
    }
    let length = step_pixels(spread).to_array()[lane] * spread.looks_rad.to_array()[lane];
    let x = lane_of(at.surface.x, lane);
    let [origin, direction] = arriving(at, lane);
    let unit = direction.normalize();
    let cos = lane_of(at.surface.geometric, lane).dot(unit).abs();
    let looks = length.min(MOST_OF_COSINE * cos);
    let beside = unit.any_orthonormal_vector();
    let turned = |to: Vec3| {
        let unit = (unit + to).normalize();
        End {
            origin: x - unit * x.distance(origin),
            direction: unit * direction.length(),
            triangle: at.vertices.triangle[lane],
            stays: false,
        }
    };
    let steps = [beside, unit.cross(beside)].map(|way| Step {
        lane,
        changes: Changed::Direction,
        way,
        length: length * direction.length(),
        ends: [looks, -looks].map(|by| turned(way * by)),
    });
    Some(steps)
}

/// Origin and direction of the ray that a path arrives by.
fn arriving(at: &At, lane: usize) -> [Vec3; 2] {
    [at.vertices.origin, at.vertices.direction].map(|v| lane_of(v, lane))
}

/// One ray for each end of these steps.
fn rays(steps: &[Step], ray: impl Fn(usize, &End) -> [Vec3; 2]) -> RayPacket {
    let ends = |step: &Step| [0, 1].map(|end| ray(step.lane, &step.ends[end]));
    let rays: Vec<_> = steps.iter().flat_map(ends).collect();
    let part = |of: usize| from_lanes(&from_fn(|l| rays[l.min(rays.len() - 1)][of]));
    RayPacket {
        active: (1 << rays.len()) - 1,
        origin: part(0),
        direction: part(1),
        near: 0.0,
        far: f32::INFINITY,
    }
}

/// The ends of these steps, two bits for each.
fn ends_of(steps: &[Step], which: impl Fn(&Step) -> bool) -> u32 {
    let chosen = steps.iter().enumerate().filter(|(_, step)| which(step));
    chosen.fold(0, |bits, (i, _)| bits | 0b11 << (2 * i))
}

/// Has slides over curved surfaces end on the surface. Where that does not go on, no farther from
/// the triangle's plane than a slide is long, they end in the plane. Tells which end on it, and
/// which ends in the plane are those of lenses.
fn meet(at: &At, spread: &Spread, steps: &mut [Step], store: &mut TileStore) -> [u32; 2] {
    let geometry = at.view.geometry;
    let curved = spread.normal_rad.gt(Lane::splat(0.0)).to_bits();
    let active = ends_of(steps, |step| {
        step.changes == Changed::Place && curved >> step.lane & 1 == 1
    });
    if active == 0 {
        return [0, 0];
    }
    store.counts.relay += u64::from(active.count_ones());
    let through = |lane: usize, end: &End| {
        let by = end.origin - arriving(at, lane)[0];
        let reach = end.direction.normalize() * by.length();
        [lane_of(at.surface.x, lane) + by - reach, reach]
    };
    let rays = RayPacket {
        active,
        far: 2.0,
        ..rays(steps, through)
    };
    let met = at.view.intersect(&rays, Coherence::Incoherent);
    let mesh = |t: u32| geometry.mesh_of_triangle[t as usize];
    let is_seen_from_front = |t: u32, direction: Vec3| {
        let [p, q, r] = geometry.triangles[t as usize].map(|v| geometry.positions[v as usize]);
        (q - p).cross(r - p).dot(direction) < 0.0
    };
    let ends = steps.iter_mut().flat_map(|step| &mut step.ends);
    let mut found = 0;
    for ((i, end), t) in ends.enumerate().zip(met) {
        let sides = |t: u32| (mesh(t), is_seen_from_front(t, end.direction));
        if t != NO_TRIANGLE && sides(t) == sides(end.triangle) {
            end.triangle = t;
            found |= 1 << i;
        }
    }
    let lets_through = at.vertices.kinds.dielectric | at.vertices.kinds.transmits;
    let lens = ends_of(steps, |step| lets_through >> step.lane & 1 == 1);
    [active & found, active & !found & lens]
}

/// Has slides stay where they begin if they lead into something, or if a lens does not go on:
/// differences are of one side then.
///
/// What is seen of a floor ends where a wall begins, and that is a border, with what the floor is
/// there. Beyond it the plane is dark. Differences across the wall would take off a half of the
/// border, however short they are. From beyond its rim a path would enter a lens twice, likewise.
/// What scatters goes on smoothly in the plane; toward its rim differences of one side lack more.
fn stay_before_walls(
    at: &At,
    [found, beyond]: [u32; 2],
    steps: &mut [Step],
    store: &mut TileStore,
) {
    let slides = ends_of(steps, |step| step.changes == Changed::Place);
    let active = slides & !found & !beyond;
    let of_lane = |of: V3<Lane>| {
        from_lanes(&from_fn(|l| {
            lane_of(of, steps[(l / 2).min(steps.len() - 1)].lane)
        }))
    };
    let [x, geometric] = [at.surface.x, at.surface.geometric].map(of_lane);
    let back = -of_lane(at.vertices.direction);
    let away = rays(steps, |lane, end| {
        let start = arriving(at, lane)[0];
        [start, end.origin - start]
    });
    let along = RayPacket {
        active,
        direction: away.direction,
        far: 1.0,
        ..at.view.leaving(x, geometric, back, active)
    };
    let free = at.view.unoccluded(&along, &mut store.counts.relay);
    let blocked = active & !free | beyond;
    for (i, step) in steps.iter_mut().enumerate() {
        let [origin, _] = arriving(at, step.lane);
        for (side, end) in step.ends.iter_mut().enumerate() {
            if blocked >> (2 * i + side) & 1 == 1 {
                end.origin = origin;
                end.stays = true;
            }
        }
    }
}

/// Adds what differences come to over the steps of some lanes.
fn relay_packet(
    at: &At,
    mut steps: Vec<Step>,
    (spread, trace): (&Spread, Trace),
    store: &mut TileStore,
) {
    let found = meet(at, spread, &mut steps, store);
    stay_before_walls(at, found, &mut steps, store);
    let radiance = radiance(at, &steps, trace, store);
    let slope = |(i, step): (usize, &Step)| {
        let sides = step.ends.iter().filter(|end| !end.stays).count() as f32;
        let slope = (radiance[2 * i] - radiance[2 * i + 1]) / (sides * step.length);
        if slope.is_finite() { slope } else { Vec3::ZERO }
    };
    let sloped = steps.iter().enumerate().map(|of| (of.1, slope(of)));
    let sloped: Vec<(&Step, Vec3)> = sloped.collect();
    for of_lane in sloped.chunk_by(|a, b| a.0.lane == b.0.lane) {
        let lane = of_lane[0].0.lane;
        let along = |changed: Changed, to: Vec3| -> Vec3 {
            let steps = of_lane.iter().filter(|(step, _)| step.changes == changed);
            steps.map(|(step, slope)| *slope * step.way.dot(to)).sum()
        };
        let corners = at.view.geometry.triangles[at.vertices.triangle[lane] as usize];
        let [p, q, r] = corners.map(|v| at.view.geometry.positions[v as usize]);
        store.relays.push(Relay {
            lane: lane as u8,
            by_b: [q - p, r - p].map(|to| along(Changed::Place, to)),
            by_direction: Vec3::AXES.map(|to| along(Changed::Direction, to)),
        });
    }
}

/// The radiance that paths bring from their vertices on, if they arrive there by these rays. The
/// ends of a lane's steps have its random numbers.
fn radiance(at: &At, steps: &[Step], trace: Trace, store: &mut TileStore) -> [Vec3; LANES] {
    let Numbers { index, depth, .. } = at.numbers;
    let end_of = |l: usize| {
        let step = &steps[(l / 2).min(steps.len() - 1)];
        (step.lane, step.ends[l % 2])
    };
    let throughput = at.vertices.arriving_throughput();
    let start = Start {
        seen: Some(from_fn(|l| end_of(l).1.triangle)),
        with_emission: false,
        with_delta_lights: false,
        throughput: from_lanes(&from_fn(|l| lane_of(throughput, end_of(l).0))),
        ..Start::of_rays(rays(steps, |_, end| [end.origin, end.direction]), depth)
    };
    let mut own = TileStore::default();
    trace(&start, &from_fn(|l| index[end_of(l).0]), &mut own);
    store.counts.relay += own.counts.rays();
    to_rgb(at.view.radiance(&own, &own.vertices)).map(Vec3::from)
}
