//! Where one thing stands on another.
//!
//! The lower edge of a block lies in the plane of the floor that it stands on. If the two move
//! against each other what is seen changes otherwise up than down: lifted, the edge rises, and
//! what lies under the block comes to light; pressed in, the floor cuts the block along a line that
//! only moves if one of the two planes does. No derivative is both. The line in which the planes
//! meet is that of what is pressed in, and of what slides. The edge is neither: it rises with the
//! block, as if the floor *before* the block were seen under it.
//!
//! What is nearer than rays start off a surface touches it: no ray tells more.

use crate::discontinuity::boundary::Boundary;
use crate::scene::RAY_OFFSET;
use crate::trace::geometry::Geometry;
use glam::DVec3;

/// What lies flatter than this, by the sine of the angle to what it touches, lies on it.
const UPRIGHT: f64 = 0.1;

impl Boundary {
    /// An edge beside which these triangles are seen, one of which stands with it on the other, as
    /// the line in which their planes meet. Others are left as they are.
    pub fn standing(self, geometry: &Geometry, seen: [u32; 2]) -> Self {
        let Boundary::Edge(edge) = self else {
            return self;
        };
        let position = |v: u32| geometry.positions[v as usize];
        // Of what has hard edges each triangle has vertices of its own.
        let has_edge = |corners: [u32; 3]| {
            let is_corner = |v: &u32| corners.iter().any(|&c| position(c) == position(*v));
            edge.iter().all(is_corner)
        };
        let mesh = |t: u32| geometry.mesh_of_triangle[t as usize];
        let stands = |[near, other]: [u32; 2]| {
            let [near_corners, corners] = [near, other].map(|t| geometry.triangles.get(t as usize));
            let (&near_corners, &corners) = (near_corners?, corners?);
            // Both sides of an edge of one body have it.
            let is_own =
                has_edge(near_corners) && (mesh(near) != mesh(other) || !has_edge(corners));
            let touches = is_own && geometry.lie_in_plane(&edge, other, f64::from(RAY_OFFSET));
            let normal = |[p, q, r]: [u32; 3]| {
                let [p, q, r] = [p, q, r].map(|v| position(v).as_dvec3());
                (q - p).cross(r - p).normalize()
            };
            let sine = normal(near_corners).cross(normal(corners)).length();
            (touches && sine > UPRIGHT).then_some(Boundary::Crease([near_corners, corners]))
        };
        let [a, b] = seen;
        stands([a, b]).or_else(|| stands([b, a])).unwrap_or(self)
    }

    /// The same, and what F of the edge, as seen from `o`, is times that of the line. Both vanish
    /// in the same directions.
    pub fn standing_seen_from(self, geometry: &Geometry, o: DVec3, seen: [u32; 2]) -> (Self, f64) {
        let stands = self.standing(geometry, seen);
        let [edge, line] = [self, stands].map(|boundary| boundary.normal(geometry, o));
        (stands, edge.dot(line) / line.length_squared())
    }
}
