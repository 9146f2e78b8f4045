//! Looking on both sides of borders that are seen through chains.

use super::search::Found;
use crate::boundary::cells::delta::value::brought;
use crate::boundary::probe::Sides;
use crate::boundary::search_scene::SearchScene;
use crate::lanes::LANES;
use crate::paths::boundary_sample::Shadow;
use crate::paths::counts::Counts;
use crate::paths::random::Stream;
use crate::paths::rays::{RayPacket, from_lanes, lane_of};
use crate::paths::start::Start;
use glam::{DVec3, Vec3};

/// The jump at each of some borders, up to `LANES / 2` behind as many smooth surfaces each, whose
/// first rays lead to vertex `depth`. `index` are the sample indices of what looks there.
pub fn jumps(
    scene: &SearchScene,
    borders: &[&Found],
    depth: u32,
    (stream, index): (&Stream, &[u32; LANES]),
    counts: &mut Counts,
) -> Vec<DVec3> {
    if borders.iter().any(|border| border.shadow.is_some()) {
        return brought_at(scene, borders, counts);
    }
    let mut origins = [Vec3::ZERO; LANES];
    let mut directions = [Vec3::Z; LANES];
    let mut sides = Sides::default();
    for (i, border) in borders.iter().enumerate() {
        for (k, (origin, direction)) in border.sides.iter().enumerate() {
            origins[2 * i + k] = origin.as_vec3();
            directions[2 * i + k] = direction.as_vec3();
        }
        sides.add(i, false);
    }
    let rays = RayPacket {
        active: sides.active,
        origin: from_lanes(&origins),
        direction: from_lanes(&directions),
        near: 0.0,
        far: f32::INFINITY,
    };
    let bends = borders.first().map_or(0, |b| b.bends as u32);
    let start = Start::of_rays(rays, depth + bends);
    let (radiance, _) = scene.probe(start, sides, stream, index, counts);
    let jump = |(i, border): (usize, &&Found)| {
        let [before, after] = [2 * i, 2 * i + 1].map(|l| lane_of(radiance, l).as_dvec3());
        weighed(border, before - after, counts)
    };
    borders.iter().enumerate().map(jump).collect()
}

/// The same where all of them are the borders of shadows: what their lights bring.
fn brought_at(scene: &SearchScene, borders: &[&Found], counts: &mut Counts) -> Vec<DVec3> {
    let mut origins = [Vec3::ZERO; LANES];
    let mut directions = [Vec3::Z; LANES];
    let [mut receivers, mut lights] = [[0; LANES]; 2];
    for (lane, border) in borders.iter().enumerate() {
        let [(origin, direction), _] = border.sides;
        (origins[lane], directions[lane]) = (origin.as_vec3(), direction.as_vec3());
        if let Some(Shadow { light, receiver }) = border.shadow {
            (lights[lane], receivers[lane]) = (light, receiver);
        }
    }
    let rays = RayPacket {
        active: u32::MAX >> (32 - borders.len()),
        origin: from_lanes(&origins),
        direction: from_lanes(&directions),
        near: 0.0,
        far: f32::INFINITY,
    };
    let brought = brought(scene, &rays, &receivers, &lights, counts);
    let jump = |(border, brought): (&&Found, DVec3)| weighed(border, brought, counts);
    borders.iter().zip(brought).map(jump).collect()
}

fn weighed(border: &Found, jump: DVec3, counts: &mut Counts) -> DVec3 {
    let jump = jump * border.weight;
    if !jump.is_finite() {
        counts.boundary_not_finite += 1;
        return DVec3::ZERO;
    }
    jump
}
