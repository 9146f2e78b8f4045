//! Rays that leave surfaces.

use crate::lanes::{Lane, V3};
use crate::paths::rays::RayPacket;
use crate::paths::scene_view::SceneView;
use crate::scene::RAY_OFFSET;

/// Shadow rays stop a little before the light.
pub const SHADOW_FAR: f32 = 1.0 - 1e-4;

/// Distance from a surface at which rays leave it, per unit of `Geometry::room`.
pub const OFFSET: f32 = RAY_OFFSET;

impl SceneView<'_> {
    /// The rays of `active` lanes that leave surfaces at `x` along `direction`, as far as they get.
    pub fn leaving(
        &self,
        x: V3<Lane>,
        geometric: V3<Lane>,
        direction: V3<Lane>,
        active: u32,
    ) -> RayPacket {
        RayPacket {
            active,
            origin: leave(self.geometry.unit, x, geometric, direction),
            direction,
            near: 0.0,
            far: f32::INFINITY,
        }
    }

    /// Those that leave toward the points `y`, and stop a little before them.
    pub fn toward(&self, x: V3<Lane>, geometric: V3<Lane>, y: V3<Lane>, active: u32) -> RayPacket {
        let origin = leave(self.geometry.unit, x, geometric, y - x);
        RayPacket {
            active,
            origin,
            direction: y - origin,
            near: 0.0,
            far: SHADOW_FAR,
        }
    }
}

/// Points just off surfaces, on the side that `direction` leaves to.
fn leave(unit: f32, x: V3<Lane>, geometric: V3<Lane>, direction: V3<Lane>) -> V3<Lane> {
    let size = x.x.abs().max(x.y.abs()).max(x.z.abs()) + Lane::splat(unit);
    let step = size * Lane::splat(OFFSET) * geometric.dot(direction).signum();
    x + geometric * step
}
