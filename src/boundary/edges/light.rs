//! Edges that stand before a light, or before the environment map: what their shadows bring, in the
//! coordinates of the light or of the map.

use super::directions::{Directions, Part};
use super::point::EdgePoint;
use super::sources::Edges;
use super::surface::{EdgePoints, beside};
use crate::boundary::light_samples;
use crate::discontinuity::boundary::vector;
use crate::kernels::triangle::triangle_hit;
use crate::lanes::LANES;
use crate::paths::at::At;
use crate::paths::boundary_sample::{BoundarySample, Coordinate, Found, NO_CHAIN};
use crate::paths::dimensions::Single;
use crate::paths::estimator::LightDraw;
use crate::paths::rays::{from_lanes, lane_of};
use crate::paths::surface::kinds::LightKind;
use crate::trace::Coherence;
use crate::trace::geometry::NO_TRIANGLE;
use glam::{DVec3, Vec3};
use std::f64::consts::{FRAC_1_PI, PI};

/// Finds what hides the lights of which the lanes have drawn samples.
pub fn find(edges: &Edges, at: &At, draw: &LightDraw, out: &mut Found) {
    let At {
        view,
        vertices,
        surface,
        ..
    } = *at;
    let lit = vertices.hit & vertices.kinds.lit_by_samples() & !view.reflects_nothing(vertices);
    let lights = edges.lights(view);
    let light_of = |lane: usize| view.lights.patches[draw.patch[lane] as usize].light;
    let directions = |lane: usize| {
        (lit >> lane & 1 == 1).then(|| {
            let x = vertices.position(view.geometry, lane);
            let up = lane_of(surface.n, lane).as_dvec3();
            let part = lights.around[light_of(lane) as usize].cone(x);
            Directions { x, up, part }
        })
    };
    // What rests hides another part of a light that moves.
    let moves = |lane: &usize| {
        let patch = &view.lights.patches[draw.patch[*lane] as usize];
        edges.moving.vertex(view.geometry, patch.lower[0])
    };
    let moves = (0..LANES)
        .filter(moves)
        .fold(vertices.moves, |bits, lane| bits | 1 << lane);
    let points = edges.draw(
        at,
        Single::LightEdgePoint,
        moves,
        directions,
        &mut out.counts,
    );
    let points = points.map(|point| point.filter(|p| p.open_side.is_some()));
    let seen = beyond(at, &points, out);
    let below = below_horizons(&points);
    let seen_below = beyond(at, &below, out);
    for lane in 0..LANES {
        let light = light_of(lane);
        let chance = lights.around[light as usize].chance;
        let met = |triangle: u32| {
            let mesh = view.geometry.mesh_of_triangle.get(triangle as usize)?;
            let is_own = view.lights.of_mesh[*mesh as usize] == Some(light);
            let patch = is_own.then(|| lights.patch_of.get(&triangle))??;
            Some((triangle, *patch, chance))
        };
        // A light that is seen on both sides of a horizon is not hidden by it.
        match [(points[lane], seen[lane]), (below[lane], seen_below[lane])]
            .map(|(point, triangle)| Some((point?, met(triangle)?)))
        {
            [Some((point, lit)), None] | [None, Some((point, lit))] => {
                push_light(at, lane, &point, lit, out);
            }
            _ => {}
        }
    }
}

/// What is seen from the lanes on the open sides of the points; [`NO_TRIANGLE`] in others.
fn beyond(at: &At, points: &EdgePoints, out: &mut Found) -> [u32; LANES] {
    let (active, directions) = beside(points, |p| p.open_side.unwrap_or(1.0));
    if active == 0 {
        return [NO_TRIANGLE; LANES];
    }
    let surface = at.surface;
    let toward = from_lanes(&directions);
    let rays = at
        .view
        .leaving(surface.x, surface.geometric, toward, active);
    out.counts.light_cell += u64::from(active.count_ones());
    let seen = at.view.intersect(&rays, Coherence::Incoherent);
    std::array::from_fn(|lane| match active >> lane & 1 {
        1 => seen[lane],
        _ => NO_TRIANGLE,
    })
}

/// The points of horizons, with what lies below in the place of what lies above.
fn below_horizons(points: &EdgePoints) -> EdgePoints {
    std::array::from_fn(|lane| {
        let point = points[lane].filter(|point| point.is_horizon)?;
        Some(EdgePoint {
            open_side: point.open_side.map(|side| -side),
            ..point
        })
    })
}

fn push_light(
    at: &At,
    lane: usize,
    point: &EdgePoint,
    (triangle, patch, chance): (u32, u32, f64),
    out: &mut Found,
) {
    let At { view, vertices, .. } = *at;
    let geometry = view.geometry;
    let x = vertices.position(geometry, lane);
    let d = point.direction;
    let corners = geometry.triangles[triangle as usize];
    let [v0, v1, v2] = corners.map(|v| vector(geometry.positions[v as usize].as_dvec3()));
    let (t, b1, b2) = triangle_hit(vector(x), vector(d), v0, v1, v2);
    let own = &view.lights.patches[patch as usize];
    // Only the side of the normal shines.
    if own.edges[0].cross(own.edges[1]).as_dvec3().dot(d) >= 0.0 {
        return;
    }
    let place = own.place_on(triangle, [b1, b2]);
    let [s, r] = place.map(|p| p as f32);
    let radiance = Vec3::from(view.patch_radiance(patch, s, r));
    // F is linear in the direction, which is of length t where the sweeps evaluate it.
    let scale = 1.0 / (t * chance);
    let at_place = Coordinate::Light { patch, at: place };
    push(
        at,
        lane,
        point,
        (radiance.as_dvec3() * scale, at_place),
        out,
    );
}

/// Finds what hides the environment map.
pub fn find_before_map(edges: &Edges, at: &At, out: &mut Found) {
    let At {
        view,
        vertices,
        surface,
        ..
    } = *at;
    let Some(environment) = &view.scene.environment else {
        return;
    };
    let lit = view.lit_by_map(vertices);
    let directions = |lane: usize| {
        (lit >> lane & 1 == 1).then(|| Directions {
            x: vertices.position(view.geometry, lane),
            up: lane_of(surface.n, lane).as_dvec3(),
            part: Part::Cone {
                axis: lane_of(surface.n, lane).as_dvec3(),
                half_rad: PI,
                far: f64::INFINITY,
            },
        })
    };
    let points = edges.draw(
        at,
        Single::MapEdgePoint,
        vertices.moves,
        directions,
        &mut out.counts,
    );
    let points = points.map(|point| point.filter(|p| p.open_side.is_some()));
    let below = below_horizons(&points);
    let [free, free_below] = [&points, &below].map(|points| {
        let (active, directions) = beside(points, |p| p.open_side.unwrap_or(1.0));
        if active == 0 {
            return 0;
        }
        let toward = from_lanes(&directions);
        let rays = view.leaving(surface.x, surface.geometric, toward, active);
        view.unoccluded(&rays, &mut out.counts.environment_cell)
    });
    for lane in 0..LANES {
        let point = match [free, free_below].map(|free| free >> lane & 1 == 1) {
            [true, false] => points[lane],
            [false, true] => below[lane],
            _ => None,
        };
        if let Some(point) = point {
            let d = from_lanes(&[point.direction.as_vec3(); LANES]);
            let radiance = lane_of(view.environment_radiance(environment, d), lane);
            let place = Coordinate::Environment(point.direction.to_array());
            push(at, lane, &point, (radiance.as_dvec3(), place), out);
        }
    }
}

/// Keeps what a shadow's edge brings before this much light.
fn push(
    at: &At,
    lane: usize,
    point: &EdgePoint,
    (radiance, place): (DVec3, Coordinate),
    out: &mut Found,
) {
    let At {
        view,
        vertices,
        surface,
        ..
    } = *at;
    let d = point.direction;
    let cos = lane_of(surface.n, lane).as_dvec3().dot(d).max(0.0);
    let toward = from_lanes(&[d.as_vec3(); LANES]);
    let value = view.bsdf_evaluate(vertices, surface, toward, LightKind::Sampled);
    let colour = (lane_of(vertices.throughput, lane) * lane_of(value, lane)).as_dvec3() * radiance;
    // Open beyond the edge and hidden before it, or the other way round.
    let jump = point.open_side.unwrap_or(0.0);
    let colour = colour * (cos * FRAC_1_PI);
    let brings = colour * (jump * point.per_side);
    let of_path = match (place, view.map_distribution) {
        (Coordinate::Light { patch, at: place }, _) => {
            light_samples::of_patch(at, lane, patch, place)
        }
        (_, Some(map)) => colour / f64::from(map.pdf(d.as_vec3())),
        (_, None) => DVec3::ZERO,
    };
    if !brings.is_finite() {
        out.counts.boundary_not_finite += 1;
    } else if brings != DVec3::ZERO {
        out.samples.push(BoundarySample {
            chain: NO_CHAIN,
            boundary: point.boundary,
            lane: lane as u8,
            at: place,
            weight: brings.as_vec3().to_array(),
            jump: of_path.length() as f32,
            shadow: None,
        });
    }
}
