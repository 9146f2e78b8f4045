//! The environment map: what shines from each direction, and how that changes with the direction.
//!
//! With +y up, u = atan2(x, −z)/2π and v = acos(y)/π. Columns have their centres at (x + ½)/width
//! and repeat; rows lie at v = y/(height − 1), the first and the last at the poles. So Mitsuba 3.9
//! has it.

use crate::lanes::{LANES, Lane, V3};
use crate::paths::rays::{from_lanes, lane_of};
use crate::scene::{EnvironmentMap, Layout, Texture};
use glam::Vec3;
use std::f32::consts::{FRAC_1_PI, TAU};

/// The map along one direction.
#[derive(Clone, Copy, Debug)]
pub struct MapLookup {
    pub value: Vec3,
    pub texels: [u32; 4],
    pub weights: [f32; 4],
    /// The slopes of the value over u and v, and those of u and v over the (unnormalised) world
    /// direction.
    pub by_uv: [Vec3; 2],
    pub by_direction: [Vec3; 2],
}

/// The radiance, not scaled, at `place` of a bitmap: columns from the left edge and rows from the
/// top, in texels.
pub fn value_at(texture: &Texture, [width, height]: [u32; 2], place: [f64; 2]) -> Vec3 {
    let x = place[0] - 0.5;
    let y = place[1].min(f64::from(height - 1));
    let (low_x, low_y) = (x.floor(), y.floor().min(f64::from(height) - 2.0).max(0.0));
    let (part_x, part_y) = ((x - low_x) as f32, (y - low_y) as f32);
    let columns = [0, 1].map(|dx| (low_x as i64 + dx).rem_euclid(i64::from(width)) as usize);
    let row = |dy: u32| {
        let first = (low_y as u32 + dy).min(height - 1) as usize * width as usize;
        // A constant has one texel for all places.
        let last = texture.texels.len() - 1;
        let texel = |column| Vec3::from(texture.texels[last.min(first + column)]);
        let [a, b] = columns.map(texel);
        a * (1.0 - part_x) + b * part_x
    };
    row(0) * (1.0 - part_y) + row(1) * part_y
}

/// The scaled radiance along a world direction of any length.
pub fn lookup(texture: &Texture, map: &EnvironmentMap, direction: Vec3) -> MapLookup {
    let Layout::Bitmap { width, height, .. } = texture.layout else {
        return MapLookup {
            value: Vec3::from(texture.texels[0]) * map.scale,
            texels: [0; 4],
            weights: [map.scale, 0.0, 0.0, 0.0],
            by_uv: [Vec3::ZERO; 2],
            by_direction: [Vec3::ZERO; 2],
        };
    };
    let length = direction.length();
    let d = map.to_world.transpose() * (direction / length);
    let u = d.x.atan2(-d.z) / TAU;
    let v = d.y.clamp(-1.0, 1.0).acos() * FRAC_1_PI;
    let x = (u - u.floor()) * width as f32 - 0.5;
    let y = v * (height - 1) as f32;
    let (low_x, low_y) = (x.floor(), y.floor().min(height as f32 - 2.0).max(0.0));
    let (part_x, part_y) = (x - low_x, y - low_y);
    let column = |dx: i64| (low_x as i64 + dx).rem_euclid(width as i64) as u32;
    let row = |dy: u32| (low_y as u32 + dy).min(height - 1);
    let index = |dx: i64, dy: u32| column(dx) + row(dy) * width;
    let texels = [index(0, 0), index(1, 0), index(0, 1), index(1, 1)];
    let weights = [
        (1.0 - part_x) * (1.0 - part_y),
        part_x * (1.0 - part_y),
        (1.0 - part_x) * part_y,
        part_x * part_y,
    ]
    .map(|w| w * map.scale);
    let [a, b, c, e] = texels.map(|t| Vec3::from(texture.texels[t as usize]));
    let by_u = ((b - a) * (1.0 - part_y) + (e - c) * part_y) * (width as f32 * map.scale);
    let by_v = ((c - a) * (1.0 - part_x) + (e - b) * part_x) * ((height - 1) as f32 * map.scale);
    // ∇u = (−z, 0, x)/(2π(x² + z²)) and ∇v = −ŷ/(π√(1 − y²)), the latter across d.
    let flat2 = (d.x * d.x + d.z * d.z).max(1e-12);
    let along_u = Vec3::new(-d.z, 0.0, d.x) / (TAU * flat2);
    let along_v = -(Vec3::Y - d * d.y) * (FRAC_1_PI / flat2.sqrt());
    MapLookup {
        value: a * weights[0] + b * weights[1] + c * weights[2] + e * weights[3],
        texels,
        weights,
        by_uv: [by_u, by_v],
        by_direction: [along_u, along_v].map(|g| map.to_world * g / length),
    }
}

/// The radiance along each lane's direction.
pub fn radiance(texture: &Texture, map: &EnvironmentMap, direction: V3<Lane>) -> V3<Lane> {
    let all: [Vec3; LANES] =
        std::array::from_fn(|l| lookup(texture, map, lane_of(direction, l)).value);
    from_lanes(&all)
}
