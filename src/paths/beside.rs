//! What is seen beside silhouettes, and on the two sides of edges within what is seen.

use super::random::Stream;
use super::rays::RayPacket;
use super::store::{TileStore, Vertices};
use super::surface::Surface;
use super::tracer::{Counts, Tracer};
use crate::lanes::{LANES, Lane, V3};
use crate::trace::Coherence;
use crate::trace::geometry::NO_TRIANGLE;

/// What is asked of the lanes of a packet, two of which look on either side of one thing.
#[derive(Clone, Copy, Debug, Default)]
pub struct Beside {
    /// Lanes that look.
    pub active: u32,
    /// Of these, those of which the radiance is wanted; of others only what they see.
    pub wanted: u32,
    /// Lanes beside edges at which only the plane bends (`crate::warp::crossing`).
    pub bends: u32,
}

impl Beside {
    /// The sides of the thing with this number.
    pub fn add(&mut self, number: usize, is_wanted: bool, is_bend: bool) {
        let sides = 0b11 << (2 * number);
        self.active |= sides;
        self.wanted |= sides * is_wanted as u32;
        self.bends |= sides * is_bend as u32;
    }
}

/// The part of the directions that diffuse lobes draw in which the two sides of a bend can see different things; 1 in lanes that are
/// beside none.
///
/// Over a bend the shading normal n goes on, and with common random numbers both sides draw one direction d. It is hidden on one
/// side only if it lies between the planes of the two triangles, whose normals are g: then n·d ≤ |n × g| for one
/// of them. The square of n·d is uniform under cosine-distributed directions, so that is |n × g|² of them; the rest brings
/// nothing to the difference, which would otherwise be rare and large.
pub(super) fn rim(bends: u32, vertices: &Vertices, surface: &Surface) -> Lane {
    let one = Lane::splat(1.0);
    let bends = bends & !vertices.kinds.special();
    if bends == 0 {
        return one;
    }
    let cos = surface.n.dot(surface.geometric);
    let sine2 = (one - cos * cos).to_array();
    Lane::new(std::array::from_fn(|lane| {
        if bends >> lane & 1 == 0 {
            return 1.0;
        }
        // The two sides' normals differ a little.
        (sine2[lane].max(sine2[lane ^ 1]) * 1.01 + ROUNDING).min(1.0)
    }))
}

/// Of the square of a sine.
const ROUNDING: f32 = 1e-5;

impl Tracer<'_> {
    /// Radiance along those rays of which it is wanted, and the triangles that all that look meet. They lead to vertex `depth` of a
    /// path, with what they find emitting there or without it. No silhouettes are sought.
    #[allow(clippy::too_many_arguments)]
    pub fn radiance_along(
        &self,
        rays: RayPacket,
        Beside {
            active,
            wanted,
            bends,
        }: Beside,
        depth: u32,
        with_emission: bool,
        stream: &Stream,
        index: &[u32; LANES],
        counts: &mut Counts,
    ) -> (V3<Lane>, [u32; LANES]) {
        let others = RayPacket {
            active: active & !wanted,
            ..rays
        };
        counts.probe += others.active.count_ones() as u64;
        let seen = match others.active {
            0 => [NO_TRIANGLE; LANES],
            _ => self.intersect(&others, Coherence::Incoherent),
        };
        let rays = RayPacket {
            active: wanted,
            ..rays
        };
        if rays.active == 0 {
            return (V3::splat(0.0), seen);
        }
        let plain = Tracer {
            adjacency: None,
            ..*self
        };
        let mut store = TileStore::default();
        let mut probed = Counts::default();
        plain.trace_vertices(
            rays,
            depth,
            with_emission,
            bends,
            stream,
            index,
            &mut probed,
            &mut store,
        );
        counts.probe += probed.rays();
        let first = store.vertices.first();
        (
            plain.radiance(&store, &store.vertices),
            std::array::from_fn(|l| match (rays.active >> l & 1, first) {
                (1, Some(v)) => v.triangle[l],
                _ => seen[l],
            }),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paths::bounce::cosine_direction;
    use crate::paths::rays::from_lanes;
    use glam::{Vec3, vec3};

    /// No direction between the planes of two triangles is left out, and of the others most are.
    #[test]
    fn what_lies_between_two_planes_is_drawn() {
        let mut state = 1u32;
        let mut random = move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / (1 << 24) as f32
        };
        for _ in 0..100 {
            let tilt = 0.5 * random();
            let mut tilted =
                || (Vec3::Z + tilt * vec3(random() - 0.5, random() - 0.5, 0.0)).normalize();
            let sides = [tilted(), tilted()];
            let zero = V3::splat(0.0);
            let surface = Surface {
                x: zero,
                n: from_lanes(&[Vec3::Z; LANES]),
                geometric: from_lanes(&std::array::from_fn(|l| sides[l % 2])),
                b: [Lane::splat(0.0); 2],
                interface: None,
            };
            let rim = rim(0b11, &Vertices::default(), &surface).to_array();
            assert_eq!(rim[0], rim[1]);
            assert_eq!(rim[2], 1.0, "this lane is beside no bend");
            let largest = sides.map(|g| Vec3::Z.cross(g).length_squared());
            assert!(rim[0] < 1.1 * largest[0].max(largest[1]) + 1e-4);
            for _ in 0..1000 {
                let (u, v) = (random(), random());
                let local = cosine_direction(Lane::splat(u), Lane::splat(v));
                let d = Vec3::from(local.map(|x| x.to_array()[0]));
                let is_between = (d.dot(sides[0]) > 0.0) != (d.dot(sides[1]) > 0.0);
                assert!(!is_between || 1.0 - u <= rim[0]);
            }
        }
    }
}
