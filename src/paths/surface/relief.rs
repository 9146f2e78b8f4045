//! Normals that a picture turns (`kernels::relief`), where rays meet surfaces.

use crate::kernels::relief::{bump, relief_normal, relief_shadow};
use crate::lanes::{LANES, Lane, Real, V3};
use crate::paths::rays::{from_lanes, lane_mask};
use crate::paths::scene_view::SceneView;
use crate::paths::store::Vertices;
use crate::paths::surface::interface::texture_at;
use crate::paths::surface::texture::{Lookup, Rise, rise};
use crate::scene::{Layout, Relief};
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

/// One texture of a lane's relief.
pub enum Turned {
    Map(Lookup),
    Bumps(Rise),
}

impl SceneView<'_> {
    /// Calls `each` with the relief of every lane that has one, its texture at barycentrics `b`,
    /// and the directions of the texture coordinates along these.
    pub fn for_each_relief(
        &self,
        vertices: &Vertices,
        b: [Lane; 2],
        mut each: impl FnMut(usize, &Relief, Turned, [Vec2; 2]),
    ) {
        let b = b.map(Lane::to_array);
        let lanes = vertices.kinds.relief;
        for lane in (0..LANES).filter(|&l| lanes >> l & 1 == 1) {
            let Some(relief) = &self.entry(vertices, lane).relief else {
                continue;
            };
            let at = [b[0][lane], b[1][lane]];
            let triangle = vertices.triangle[lane];
            let (scene, geometry) = (self.scene, self.geometry);
            let texture = &scene.textures[relief.texture];
            let is_flat = matches!(
                texture.layout,
                Layout::Constant | Layout::Vertices | Layout::Faces
            );
            let [p, q, r] = geometry.triangles[triangle as usize].map(|v| {
                let uv = geometry.uvs.get(v as usize);
                uv.copied().filter(|_| !is_flat).unwrap_or(Vec2::ZERO)
            });
            let along = [q - p, r - p];
            let turned = if relief.bumps.is_some() {
                Turned::Bumps(rise(texture, p + along[0] * at[0] + along[1] * at[1]))
            } else {
                Turned::Map(texture_at(scene, geometry, relief.texture, triangle, at).0)
            };
            each(lane, relief, turned, along);
        }
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
        self.for_each_relief(vertices, b, |lane, relief, turned, _| {
            match turned {
                Turned::Map(found) => map[lane] = found.value * 2.0 - 1.0,
                Turned::Bumps(rise) => {
                    bumps |= 1 << lane;
                    let scale = relief.bumps.unwrap_or(1.0);
                    rises[lane] = Vec3::new(rise.by_uv[0], rise.by_uv[1], 0.0) * scale;
                }
            }
            let side = if relief.is_mirrored {
                1.0
            } else {
                facing[lane]
            };
            (signs[0][lane], signs[1][lane]) = (side, side * facing[lane]);
        });
        Some(ReliefMaps {
            bumps,
            map: from_lanes(&map),
            rises: from_lanes(&rises),
            signs: signs.map(Lane::new),
            slopes: self.uv_slopes(vertices),
        })
    }

    /// The change of [`ReliefMaps::map`] and [`ReliefMaps::rises`] as textures change and the
    /// barycentrics by `db`: `change(texture, texels, weights)`.
    pub fn relief_change(
        &self,
        vertices: &Vertices,
        b: [Lane; 2],
        db: [Lane; 2],
        change: impl Fn(usize, &Lookup) -> Vec3,
        mixed: impl Fn(usize, &[u32; 4], &[f32; 4]) -> f32,
    ) -> [V3<Lane>; 2] {
        let db = db.map(Lane::to_array);
        let mut map = [Vec3::ZERO; LANES];
        let mut rises = [Vec3::ZERO; LANES];
        self.for_each_relief(vertices, b, |lane, relief, turned, along| {
            let moved = along[0] * db[0][lane] + along[1] * db[1][lane];
            match turned {
                Turned::Map(found) => {
                    let [by_u, by_v] = found.by_uv;
                    let slides = by_u * moved.x + by_v * moved.y;
                    map[lane] = (change(relief.texture, &found) + slides) * 2.0;
                }
                Turned::Bumps(rise) => {
                    let scale = relief.bumps.unwrap_or(1.0);
                    let of = |i: usize| {
                        let [by_u, by_v] = rise.bends[i];
                        mixed(relief.texture, &rise.texels, &rise.by_texels[i])
                            + by_u * moved.x
                            + by_v * moved.y
                    };
                    rises[lane] = Vec3::new(of(0), of(1), 0.0) * scale;
                }
            }
        });
        [from_lanes(&map), from_lanes(&rises)]
    }

    /// See [`Slopes`]. Without texture coordinates these are barycentric.
    fn uv_slopes(&self, vertices: &Vertices) -> Slopes {
        let mut parts = [[[1.0; LANES], [0.0; LANES]], [[0.0; LANES], [1.0; LANES]]];
        let lanes = vertices.kinds.relief;
        for lane in (0..LANES).filter(|&l| lanes >> l & 1 == 1) {
            let triangle = vertices.triangle[lane] as usize;
            let mesh = self.geometry.mesh_of_triangle[triangle] as usize;
            if self.scene.meshes[mesh].uvs.is_empty() {
                continue;
            }
            let [p, q, r] =
                self.geometry.triangles[triangle].map(|v| self.geometry.uvs[v as usize]);
            let (first, second) = (q - p, r - p);
            let area = first.perp_dot(second);
            if area != 0.0 {
                parts[0][0][lane] = second.y / area;
                parts[0][1][lane] = -first.y / area;
                parts[1][0][lane] = -second.x / area;
                parts[1][1][lane] = first.x / area;
            }
        }
        parts.map(|of| of.map(Lane::new))
    }
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

/// What lanes with a relief do not hide of themselves, toward `w`; one in others.
pub fn shown(vertices: &Vertices, n: V3<Lane>, turned: V3<Lane>, w: V3<Lane>) -> Lane {
    let kinds = &vertices.kinds;
    let shown = relief_shadow(n, turned, w);
    <Lane as Real>::select(lane_mask(kinds.relief), shown, Lane::splat(1.0))
}
