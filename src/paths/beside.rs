//! What is seen beside silhouettes, and on the two sides of edges within what is seen.

use super::delta_lights::toward;
use super::random::Stream;
use super::rays::RayPacket;
use super::store::{TileStore, Vertices, lane_mask};
use super::surface::Surface;
use super::tracer::{Counts, Tracer};
use crate::lanes::{LANES, Lane, Real, V3};
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

/// Lanes on the two sides of bends, and the planes of the triangles there.
///
/// Over a bend the shading normal n goes on, and what arrives from a direction d is reflected alike on both sides. It is hidden on one
/// side only if d lies between the planes of the two triangles. All else is left out: it would bring what the radiance
/// changes by from one probe to the other, which is no jump, and for each of the many edges in a cell.
pub(super) struct Bends {
    lanes: u32,
    /// Geometric normals on the side of n, of each lane's triangle and of that on the other side of the edge.
    planes: [V3<Lane>; 2],
}

impl Bends {
    pub fn new(lanes: u32, surface: &Surface) -> Self {
        let own = surface.geometric * surface.geometric.dot(surface.n).signum();
        let swapped = |v: Lane| {
            let v = v.to_array();
            Lane::new(std::array::from_fn(|lane| v[lane ^ 1]))
        };
        let other = V3::new(swapped(own.x), swapped(own.y), swapped(own.z));
        Self {
            lanes,
            planes: [own, other],
        }
    }

    /// Lanes in which what arrives from these directions counts.
    pub fn count(&self, directions: V3<Lane>) -> u32 {
        let [own, other] = self
            .planes
            .map(|g| g.dot(directions).gt(Lane::splat(0.0)).to_bits());
        !self.lanes | (own ^ other)
    }

    /// The part of the directions that diffuse lobes draw that can lie between the planes, nearest to the horizon; 1 in lanes that are
    /// beside no bend.
    ///
    /// Such a direction has n·d ≤ |n × g| for the normal g of one of the planes. The square of n·d is uniform under
    /// cosine-distributed directions, so that is |n × g|² of them. If all were drawn, the jump would be rare and large.
    pub fn rim(&self, vertices: &Vertices, surface: &Surface) -> Lane {
        let lanes = self.lanes & !vertices.kinds.special();
        let sine2 = self.planes.map(|g| {
            let cos = surface.n.dot(g);
            (Lane::splat(1.0) - cos * cos).to_array()
        });
        Lane::new(std::array::from_fn(|lane| {
            if lanes >> lane & 1 == 0 {
                return 1.0;
            }
            // The two sides' normals differ a little.
            (sine2[0][lane].max(sine2[1][lane]) * 1.01 + ROUNDING).min(1.0)
        }))
    }
}

/// Of the square of a sine.
const ROUNDING: f32 = 1e-5;

impl Tracer<'_> {
    /// Leaves out what is alike on both sides of bends: emission, and light samples from elsewhere than between the planes.
    pub(super) fn keep_between(
        &self,
        bends: &Bends,
        vertices: &mut Vertices,
        surface: &Surface,
        store: &mut TileStore,
    ) {
        let keep = |counts: u32, weight: Lane| {
            <Lane as Real>::select(lane_mask(counts), weight, Lane::splat(0.0))
        };
        vertices.emission_weight = keep(!bends.lanes, vertices.emission_weight);
        if !self.lights.is_empty() {
            let light = &mut vertices.light;
            let [s, r] = [light.s, light.r].map(Lane::to_array);
            let toward = self.patch_points(&light.patch, &s, &r) - surface.x;
            light.weight = keep(bends.count(toward), light.weight);
        }
        let [from, to] = vertices.sky.map(|i| i as usize);
        for sample in &mut store.sky_samples[from..to] {
            sample.weight = keep(bends.count(sample.direction), sample.weight);
        }
        let [from, to] = vertices.delta_lights.map(|i| i as usize);
        let seen = &mut store.delta_visible[from..to];
        for (light, seen) in self.scene.delta_lights.iter().zip(seen) {
            *seen &= bends.count(toward(light, surface.x).0);
        }
    }

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
            let bends = Bends::new(0b11, &surface);
            let rim = bends.rim(&Vertices::default(), &surface).to_array();
            assert!((rim[0] - rim[1]).abs() < 1e-6);
            assert_eq!(rim[2], 1.0, "this lane is beside no bend");
            assert_eq!(bends.count(from_lanes(&[Vec3::Z; LANES])), !0b11);
            let largest = sides.map(|g| Vec3::Z.cross(g).length_squared());
            assert!(rim[0] < 1.1 * largest[0].max(largest[1]) + 1e-4);
            for _ in 0..1000 {
                let (u, v) = (random(), random());
                let local = cosine_direction(Lane::splat(u), Lane::splat(v));
                let d = Vec3::from(local.map(|x| x.to_array()[0]));
                let is_between = (d.dot(sides[0]) > 0.0) != (d.dot(sides[1]) > 0.0);
                assert!(!is_between || 1.0 - u <= rim[0]);
                let counts = bends.count(from_lanes(&[d; LANES]));
                assert_eq!(counts & 0b11 == 0b11, is_between);
            }
        }
    }
}
