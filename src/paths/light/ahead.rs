//! The lights that rays lead to.
//!
//! At the end of the longest path only what shines matters. Where lights are few they are
//! intersected here, and whether anything hides them, or the environment behind them, is a question
//! of occlusion, which costs about half of a first hit.

use crate::kernels::triangle::triangle_hit;
use crate::lanes::{LANES, Lane, Real, V3};
use crate::paths::leaving::SHADOW_FAR;
use crate::paths::light::patches::Lights;
use crate::paths::rays::{RayPacket, lane_mask, splat};
use crate::paths::scene_view::SceneView;
use crate::paths::store::Vertices;
use crate::trace::geometry::NO_TRIANGLE;

/// So many patches are intersected one by one.
const FEW: usize = 16;

impl Lights {
    /// Whether [`SceneView::ends`] is for them.
    pub fn are_few(&self) -> bool {
        self.patches.len() <= FEW
    }
}

impl SceneView<'_> {
    /// The ends of paths that go no further, of which only the light is of interest that shines
    /// there. The rays that have to be traced for it are added to `count`.
    pub fn ends(&self, rays: &RayPacket, throughput: V3<Lane>, count: &mut u64) -> Vertices {
        let mut triangle = [NO_TRIANGLE; LANES];
        let mut distance = Lane::splat(f32::INFINITY);
        for patch in &self.lights.patches {
            let [q, a, b] = [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)].map(|(s, r)| patch.point(s, r));
            let (t, s, r) = triangle_hit(rays.origin, rays.direction, splat(q), splat(a), splat(b));
            let [zero, one] = [0.0, 1.0].map(Lane::splat);
            let on_patch = match patch.upper {
                Some(_) => s.le(one) & r.le(one),
                None => (s + r).le(one),
            };
            let met = zero.le(s) & zero.le(r) & on_patch & t.gt(zero) & t.lt(distance);
            distance = <Lane as Real>::select(met, t, distance);
            let (met, s, r) = (met.to_bits() & rays.active, s.to_array(), r.to_array());
            for lane in (0..LANES).filter(|l| met >> l & 1 == 1) {
                triangle[lane] = patch.triangle_at(s[lane], r[lane]).0;
            }
        }
        let lights = (0..LANES).filter(|&l| triangle[l] != NO_TRIANGLE);
        let lit = lights.fold(0, |lanes, l| lanes | 1 << l);
        let wanted = match self.scene.environment {
            Some(_) => rays.active,
            None => lit,
        };
        let far = <Lane as Real>::select(lane_mask(lit), distance * SHADOW_FAR, distance);
        let rays = RayPacket {
            active: wanted,
            ..*rays
        };
        let open = self.unoccluded_before(far, &rays, count);
        let seen = |lane: usize| match open >> lane & 1 {
            1 => triangle[lane],
            _ => NO_TRIANGLE,
        };
        Vertices {
            origin: rays.origin,
            direction: rays.direction,
            throughput,
            hit: lit & open,
            triangle: std::array::from_fn(seen),
            escaped: open & !lit,
            ..Vertices::default()
        }
    }
}
