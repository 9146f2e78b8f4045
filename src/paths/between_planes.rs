//! What arrives at a surface between the planes of two triangles.

use crate::lanes::{Lane, Real, V3};
use crate::paths::light::delta::toward;
use crate::paths::rays::lane_mask;
use crate::paths::scene_view::SceneView;
use crate::paths::store::{TileStore, Vertices};
use crate::paths::surface::vertex::Surface;

/// Lanes on the two sides of bends, and the planes of the triangles there.
///
/// Over a bend the shading normal n goes on, and what arrives from a direction d is reflected alike
/// on both sides. It is hidden on one side only if d lies between the planes of the two triangles.
/// All else is left out: it would bring what the radiance changes by from one probe to the other,
/// which is no jump, and for each of the many edges in a cell.
pub struct BetweenPlanes {
    lanes: u32,
    /// Geometric normals on the side of n, of each lane's triangle and of that on the other side of
    /// the edge.
    planes: [V3<Lane>; 2],
}

impl BetweenPlanes {
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

    /// The part of the directions that diffuse lobes draw that can lie between the planes, nearest
    /// to the horizon; 1 in lanes that are beside no bend.
    ///
    /// Such a direction has n·d ≤ |n × g| for the normal g of one of the planes. The square of n·d
    /// is uniform under cosine-distributed directions, so that is |n × g|² of them. If all were
    /// drawn, the jump would be rare and large.
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

impl SceneView<'_> {
    /// Leaves out what is alike on both sides of bends: emission, and light samples from elsewhere
    /// than between the planes. Where somebody else looks for the edges at which a surface turns
    /// away from delta lights, these are left out altogether.
    pub fn keep_between(
        &self,
        between: &BetweenPlanes,
        vertices: &mut Vertices,
        surface: &Surface,
        with_delta_lights: bool,
        store: &mut TileStore,
    ) {
        let keep = |counts: u32, weight: Lane| {
            <Lane as Real>::select(lane_mask(counts), weight, Lane::splat(0.0))
        };
        vertices.emission_weight = keep(!between.lanes, vertices.emission_weight);
        if !self.lights.is_empty() {
            let light = &mut vertices.light;
            let [s, r] = [light.s, light.r].map(Lane::to_array);
            let toward = self.patch_points(&light.patch, &s, &r) - surface.x;
            light.weight = keep(between.count(toward), light.weight);
        }
        let [from, to] = vertices.environment.map(|i| i as usize);
        for sample in &mut store.environment_samples[from..to] {
            sample.weight = keep(between.count(sample.direction), sample.weight);
        }
        let [from, to] = vertices.delta_lights.map(|i| i as usize);
        let sights = &mut store.delta_visible[from..to];
        for (light, sight) in self.delta_lights.iter().zip(sights) {
            let counts = if with_delta_lights {
                between.count(toward(light, surface.x).0)
            } else {
                !between.lanes
            };
            sight.seen &= counts;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lanes::LANES;
    use crate::paths::rays::{from_lanes, lane_of};
    use crate::paths::surface::lobe_sample::cosine_direction;
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
                base_n: from_lanes(&[Vec3::Z; LANES]),
                layers: None,
                black_goes_on: false,
            };
            let between = BetweenPlanes::new(0b11, &surface);
            let rim = between.rim(&Vertices::default(), &surface).to_array();
            assert!((rim[0] - rim[1]).abs() < 1e-6);
            assert_eq!(rim[2], 1.0, "this lane is beside no bend");
            assert_eq!(between.count(from_lanes(&[Vec3::Z; LANES])), !0b11);
            let largest = sides.map(|g| Vec3::Z.cross(g).length_squared());
            assert!(rim[0] < 1.1 * largest[0].max(largest[1]) + 1e-4);
            for _ in 0..1000 {
                let (u, v) = (random(), random());
                let local = cosine_direction(Lane::splat(u), Lane::splat(v));
                let d = lane_of(local, 0);
                let is_between = (d.dot(sides[0]) > 0.0) != (d.dot(sides[1]) > 0.0);
                assert!(!is_between || 1.0 - u <= rim[0]);
                let counts = between.count(from_lanes(&[d; LANES]));
                assert_eq!(counts & 0b11 == 0b11, is_between);
            }
        }
    }
}
