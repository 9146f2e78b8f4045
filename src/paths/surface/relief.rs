//! Normals that a picture turns (`kernels::relief`), where rays meet surfaces.

use crate::kernels::relief::{bump, relief_normal, relief_shadow};
use crate::lanes::{LANES, Lane, Real, V3};
use crate::paths::counts::Counts;
use crate::paths::rays::{from_lanes, lane_mask};
use crate::paths::scene_view::SceneView;
use crate::paths::store::Vertices;
use crate::paths::surface::interface::texture_at;
use crate::paths::surface::texture::{Lookup, Rise, rise};
use crate::scene::Relief;
use glam::{Vec2, Vec3};

/// How the derivatives of the position by u and by v are made of the edges from the first vertex to
/// the second and the third.
pub type Slopes = [[Lane; 2]; 2];

/// What turns the normals of a packet: pictures at present, and the lanes they are for.
pub struct ReliefMaps {
    /// Lanes with bumps.
    pub bumps: u32,
    /// Directions in the frames of the other lanes.
    pub map: V3<Lane>,
    /// Slopes of the bumps, in x and y.
    pub rises: V3<Lane>,
    /// Of the parts along the grain and across it, which sides say.
    pub signs: [Lane; 2],
    pub slopes: Slopes,
}

/// The picture of a relief at a place.
pub enum Turned {
    /// And its slopes along the barycentrics of the second and third vertex.
    Map(Lookup, [Vec3; 2]),
    /// And the directions of the texture coordinates along these.
    Bumps(Rise, [Vec2; 2]),
}

impl Turned {
    /// The slopes of what it turns normals by, along barycentrics: of the direction, or of the
    /// rises.
    pub fn slopes(&self, relief: &Relief) -> [Vec3; 2] {
        match self {
            Turned::Map(_, slopes) => slopes.map(|s| s * 2.0),
            Turned::Bumps(rise, along) => along.map(|along| {
                let [x, y] = rise
                    .bends
                    .map(|[by_u, by_v]| by_u * along.x + by_v * along.y);
                Vec3::new(x, y, 0.0) * relief.bumps.unwrap_or(1.0)
            }),
        }
    }
}

impl SceneView<'_> {
    /// Calls `each` with the relief of every lane that has one, and its picture at barycentrics
    /// `b`.
    pub fn for_each_relief(
        &self,
        vertices: &Vertices,
        b: [Lane; 2],
        mut each: impl FnMut(usize, &Relief, Turned),
    ) {
        let b = b.map(Lane::to_array);
        let lanes = vertices.kinds.relief;
        for lane in (0..LANES).filter(|&l| lanes >> l & 1 == 1) {
            let Some(relief) = &self.entry(vertices, lane).relief else {
                continue;
            };
            let at = [b[0][lane], b[1][lane]];
            each(
                lane,
                relief,
                self.relief_at(relief, vertices.triangle[lane], at),
            );
        }
    }

    /// The picture of a relief at barycentrics `b` of a triangle.
    pub fn relief_at(&self, relief: &Relief, triangle: u32, b: [f32; 2]) -> Turned {
        let (scene, geometry) = (self.scene, self.geometry);
        if relief.bumps.is_none() {
            let (found, slopes) = texture_at(scene, geometry, relief.texture, triangle, b);
            return Turned::Map(found, slopes);
        }
        let [p, q, r] = self.texture_coordinates(triangle);
        let along = [q - p, r - p];
        let uv = p + along[0] * b[0] + along[1] * b[1];
        Turned::Bumps(rise(&scene.textures[relief.texture], uv), along)
    }

    /// Texture coordinates of a triangle's vertices; zero where there are none.
    pub fn texture_coordinates(&self, triangle: u32) -> [Vec2; 3] {
        let uv = |v: u32| {
            self.geometry
                .uvs
                .get(v as usize)
                .copied()
                .unwrap_or_default()
        };
        self.geometry.triangles[triangle as usize].map(uv)
    }

    /// What turns the normals of a packet; `None` if nothing does.
    pub fn relief_maps(&self, vertices: &Vertices, b: [Lane; 2]) -> Option<ReliefMaps> {
        if vertices.kinds.relief == 0 {
            return None;
        }
        let facing = vertices.facing.to_array();
        let mut map = [Vec3::Z; LANES];
        let mut rises = [Vec3::ZERO; LANES];
        let mut signs = [[1.0; LANES]; 2];
        let mut bumps = 0;
        self.for_each_relief(vertices, b, |lane, relief, turned| {
            match turned {
                Turned::Map(found, _) => map[lane] = found.value * 2.0 - 1.0,
                Turned::Bumps(rise, _) => {
                    bumps |= 1 << lane;
                    let scale = relief.bumps.unwrap_or(1.0);
                    rises[lane] = Vec3::new(rise.by_uv[0], rise.by_uv[1], 0.0) * scale;
                }
            }
            let [along, across] = sides(relief, facing[lane]);
            (signs[0][lane], signs[1][lane]) = (along, across);
        });
        Some(ReliefMaps {
            bumps,
            map: from_lanes(&map),
            rises: from_lanes(&rises),
            signs: signs.map(Lane::new),
            slopes: self.uv_slopes(vertices),
        })
    }

    /// The change of [`ReliefMaps::map`] and [`ReliefMaps::rises`] as pictures change (`change`)
    /// and the barycentrics by `db`.
    pub fn relief_change(
        &self,
        vertices: &Vertices,
        b: [Lane; 2],
        db: [Lane; 2],
        change: impl Fn(&Relief, &Turned) -> Vec3,
    ) -> [V3<Lane>; 2] {
        let db = db.map(Lane::to_array);
        let mut map = [Vec3::ZERO; LANES];
        let mut rises = [Vec3::ZERO; LANES];
        self.for_each_relief(vertices, b, |lane, relief, turned| {
            let [by_b1, by_b2] = turned.slopes(relief);
            let slides = by_b1 * db[0][lane] + by_b2 * db[1][lane];
            let changed = change(relief, &turned) + slides;
            match turned {
                Turned::Map(..) => map[lane] = changed,
                Turned::Bumps(..) => rises[lane] = changed,
            }
        });
        [from_lanes(&map), from_lanes(&rises)]
    }

    /// See [`Slopes`]. Without texture coordinates these are barycentric.
    fn uv_slopes(&self, vertices: &Vertices) -> Slopes {
        let mut parts = [[[1.0; LANES], [0.0; LANES]], [[0.0; LANES], [1.0; LANES]]];
        let lanes = vertices.kinds.relief;
        for lane in (0..LANES).filter(|&l| lanes >> l & 1 == 1) {
            let of_lane = self.uv_slopes_of(vertices.triangle[lane]);
            for (part, slope) in parts.iter_mut().flatten().zip(of_lane.as_flattened()) {
                part[lane] = *slope;
            }
        }
        parts.map(|of| of.map(Lane::new))
    }

    /// The same of one triangle.
    pub fn uv_slopes_of(&self, triangle: u32) -> [[f32; 2]; 2] {
        let barycentric = [[1.0, 0.0], [0.0, 1.0]];
        let geometry = self.geometry;
        let mesh = geometry.mesh_of_triangle[triangle as usize] as usize;
        if self.scene.meshes[mesh].uvs.is_empty() {
            return barycentric;
        }
        let [p, q, r] = geometry.triangles[triangle as usize].map(|v| geometry.uvs[v as usize]);
        let (first, second) = (q - p, r - p);
        let area = first.perp_dot(second);
        if area == 0.0 {
            return barycentric;
        }
        [[second.y, -first.y], [-second.x, first.x]].map(|of| of.map(|x| x / area))
    }
}

/// What the parts of a relief's direction along the grain and across it are multiplied with where
/// it is seen from this side.
pub fn sides(relief: &Relief, facing: f32) -> [f32; 2] {
    let side = if relief.is_mirrored { 1.0 } else { facing };
    [side, side * facing]
}

/// The derivatives of the position by the two texture coordinates.
pub fn by_uv<F: Real>([v0, v1, v2]: [V3<F>; 3], slopes: [[F; 2]; 2]) -> [V3<F>; 2] {
    slopes.map(|[a, b]| (v1 - v0) * a + (v2 - v0) * b)
}

/// The direction in the frame of `n`, on the side that is seen: `map` or that of bumps.
pub fn local<F: Real>(
    (n, facing): (V3<F>, F),
    [du, dv]: [V3<F>; 2],
    [map, rises]: [V3<F>; 2],
    bumps: F::Mask,
    signs: [F; 2],
) -> V3<F> {
    let bumpy = bump(n * facing, du, dv, rises);
    let m = V3::select(bumps, bumpy, map);
    V3::new(m.x * signs[0], m.y * signs[1], m.z)
}

/// The normals `n` with those of the lanes of `relief` turned.
pub fn turned(
    vertices: &Vertices,
    n: V3<Lane>,
    corners: [V3<Lane>; 3],
    maps: &ReliefMaps,
) -> V3<Lane> {
    let [du, dv] = by_uv(corners, maps.slopes);
    let (map, bumps) = ([maps.map, maps.rises], lane_mask(maps.bumps));
    let local = local((n, vertices.facing), [du, dv], map, bumps, maps.signs);
    let turned = relief_normal(n, du, vertices.direction, local);
    V3::select(lane_mask(vertices.kinds.relief), turned, n)
}

impl SceneView<'_> {
    /// Counts the lanes that move and whose turned normals would look away from the ray that
    /// arrives: they have been turned round, and nobody follows the border of where that happens.
    /// `n`: the normals before, at barycentrics `b`.
    pub fn count_turned_round(
        &self,
        vertices: &Vertices,
        b: [Lane; 2],
        n: V3<Lane>,
        counts: &mut Counts,
    ) {
        let lanes = vertices.kinds.relief & vertices.moves & vertices.hit;
        if lanes == 0 {
            return;
        }
        let Some(maps) = self.relief_maps(vertices, b) else {
            return;
        };
        let corners = self.geometry.corners(&vertices.triangle);
        let corners = self.geometry.gather_positions(&corners);
        let seen_from_above = Vertices {
            direction: -n,
            ..vertices.clone()
        };
        let turned = turned(&seen_from_above, n, corners, &maps);
        let away = turned.dot(vertices.direction).to_array();
        let is_round = |l: &usize| lanes >> l & 1 == 1 && away[*l] >= 0.0;
        counts.turned_round += (0..LANES).filter(is_round).count() as u64;
    }
}

/// What lanes with a relief do not hide of themselves, toward `w`; one in others.
pub fn shown(vertices: &Vertices, n: V3<Lane>, turned: V3<Lane>, w: V3<Lane>) -> Lane {
    let kinds = &vertices.kinds;
    let shown = relief_shadow(n, turned, w);
    <Lane as Real>::select(lane_mask(kinds.relief), shown, Lane::splat(1.0))
}
