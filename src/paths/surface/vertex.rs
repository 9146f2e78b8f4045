//! Where rays end: positions, normals, and what is there.

use crate::kernels::bsdf::{Interface, bsdf_evaluate, bsdf_evaluate_glass, consistent_normal};
use crate::kernels::layered::{Layers, layered_evaluate, layered_sent};
use crate::kernels::normal::{face_normal, shading_normal};
use crate::kernels::triangle::triangle_hit;
use crate::lanes::{LANES, Lane, Real, V3};
use crate::paths::counts::Counts;
use crate::paths::rays::{lane_mask, lane_of, masked};
use crate::paths::scene_view::SceneView;
use crate::paths::store::Vertices;
use crate::paths::surface::kinds::LightKind;
use crate::paths::surface::layers::tangent;
use crate::paths::surface::relief::{shown, turned};
use crate::scene::Rgb;
use crate::trace::geometry::NO_TRIANGLE;

/// Where a packet ended, seen from the next ray to leave.
pub struct Surface {
    pub x: V3<Lane>,
    /// Unit shading normal, on the side the ray came from.
    pub n: V3<Lane>,
    /// The same before a picture turned it.
    pub base_n: V3<Lane>,
    /// Unit geometric normal, as the triangle is wound.
    pub geometric: V3<Lane>,
    pub b: [Lane; 2],
    /// Given if any lane is more than diffuse.
    pub interface: Option<Interface<Lane>>,
    /// Given if any lane has layers or a grain.
    pub layers: Option<Layers<Lane>>,
    /// Whether someone asks about what is not there at present, so that it is drawn all the same.
    pub black_goes_on: bool,
}

impl Surface {
    /// The part of what is sent toward or from `w` that turned surfaces do not hide.
    pub fn shown(&self, vertices: &Vertices, w: V3<Lane>, value: V3<Lane>) -> V3<Lane> {
        if vertices.kinds.relief == 0 {
            return value;
        }
        value * shown(vertices, self.base_n, self.n, w)
    }

    /// Counts where what moves has a relief's normal that was turned round.
    pub fn count_turned_round(&self, view: &SceneView, vertices: &Vertices, counts: &mut Counts) {
        view.count_turned_round(vertices, self.b, self.base_n, counts);
    }
}

impl SceneView<'_> {
    /// Position, normals and materials where the rays end; sets `facing`, `kinds` and `colour`.
    pub fn surface(&self, vertices: &mut Vertices) -> Surface {
        let corners = self.geometry.corners(&vertices.triangle);
        let [v0, v1, v2] = self.geometry.gather_positions(&corners);
        let (o, d) = (vertices.origin, vertices.direction);
        let (_, b1, b2) = triangle_hit(o, d, v0, v1, v2);
        let geometric = face_normal(v0, v1, v2);
        let mut n = geometric;
        let smooth = self.smooth_lanes(&vertices.triangle);
        if smooth != 0 {
            let [n0, n1, n2] = self.geometry.gather_normals(&corners);
            n = V3::select(lane_mask(smooth), shading_normal(n0, n1, n2, b1, b2), n);
        }
        // The side that is seen is the triangle's, not the shading normal's: where that turns away
        // at grazing angles a one-sided surface would be black in a rim whose border is no edge of
        // any mesh.
        let side = -(geometric.dot(d).signum());
        vertices.facing = side * (n.dot(geometric).signum());
        n = n * vertices.facing;
        vertices.kinds = self.kinds(vertices);
        let special = vertices.kinds.special();
        let kept_above = (special | vertices.kinds.relief) & smooth;
        if kept_above != 0 {
            n = V3::select(lane_mask(kept_above), consistent_normal(n, d), n);
        }
        let b = [b1, b2];
        let base_n = n;
        if let Some(maps) = self.relief_maps(vertices, b) {
            n = turned(vertices, n, [v0, v1, v2], &maps);
        }
        let special = special | vertices.kinds.relief;
        let interface = if special != 0 || self.materials.any_texture || vertices.choice.is_some() {
            let interface = self.interface(vertices, b);
            vertices.diffuse_reflectance = interface.reflectance;
            (special != 0).then_some(interface)
        } else {
            let black = vertices.kinds.black;
            vertices.diffuse_reflectance = self.per_lane(&vertices.triangle, |mesh, lane| {
                let bsdf = &self.scene.materials[self.scene.meshes[mesh].material].bsdf;
                match bsdf.colour() {
                    Some(t) if black >> lane & 1 == 0 => self.scene.constant(t),
                    _ => [0.0; 3],
                }
            });
            None
        };
        let layers = if vertices.kinds.layered() == 0 {
            None
        } else {
            let grain = self.grain(&vertices.triangle);
            self.layers(vertices, b, tangent([v0, v1, v2], grain))
        };
        Surface {
            // In slender triangles the distance along the ray is not good enough for a point of the
            // plane, and rays that leave would meet their own surface.
            x: v0 + (v1 - v0) * b1 + (v2 - v0) * b2,
            n,
            base_n,
            geometric,
            b,
            interface,
            layers,
            black_goes_on: self.limits.black_goes_on,
        }
    }

    /// Lanes whose triangle is shaded smoothly.
    pub fn smooth_lanes(&self, triangle: &[u32; LANES]) -> u32 {
        if self.geometry.normals.is_empty() {
            return 0;
        }
        (0..LANES).fold(0, |bits, l| {
            let t = triangle[l];
            let smooth = t != NO_TRIANGLE
                && self.geometry.smooth[self.geometry.mesh_of_triangle[t as usize] as usize];
            bits | (smooth as u32) << l
        })
    }

    /// A colour of each lane's mesh; zero where there is none.
    pub fn per_lane(&self, triangle: &[u32; LANES], of: impl Fn(usize, usize) -> Rgb) -> V3<Lane> {
        let mut rgb = [[0.0; LANES]; 3];
        for lane in 0..LANES {
            if triangle[lane] != NO_TRIANGLE {
                let value = of(
                    self.geometry.mesh_of_triangle[triangle[lane] as usize] as usize,
                    lane,
                );
                for c in 0..3 {
                    rgb[c][lane] = value[c];
                }
            }
        }
        let [x, y, z] = rgb.map(Lane::new);
        V3 { x, y, z }
    }

    /// Whether a lane's ray meets the side of the triangle from which it is wound
    /// counter-clockwise.
    pub fn sees_front(&self, vertices: &Vertices, lane: usize) -> bool {
        let [p, q, r] = self.geometry.triangles[vertices.triangle[lane] as usize]
            .map(|v| self.geometry.positions[v as usize]);
        lane_of(vertices.direction, lane).dot((q - p).cross(r - p)) < 0.0
    }

    /// π times the BSDF for light of this kind that arrives along `w`.
    pub fn bsdf_evaluate(
        &self,
        vertices: &Vertices,
        surface: &Surface,
        w: V3<Lane>,
        light: LightKind,
    ) -> V3<Lane> {
        let Some(interface) = &surface.interface else {
            return vertices.diffuse_reflectance;
        };
        let cos_out = surface.n.dot(w.normalize());
        let [lit, lobes] = vertices.kinds.lit_by(light);
        let value = bsdf_evaluate(
            surface.n,
            vertices.direction,
            w,
            *interface,
            self.transmission(vertices, surface.n, cos_out),
            vertices.kinds.masks(),
            lane_mask(lobes),
        );
        let value = match &surface.layers {
            None => value,
            Some(layers) => {
                let layered = layered_evaluate(
                    surface.n,
                    vertices.direction,
                    w,
                    *interface,
                    *layers,
                    vertices.kinds.masks(),
                    vertices.kinds.lit_masks(light),
                );
                V3::select(lane_mask(vertices.kinds.layered()), layered, value)
            }
        };
        masked(lit, surface.shown(vertices, w, value))
    }

    /// What is sent of a beam of unit irradiance (across it) that comes from `w`, on either side,
    /// in lanes of `glass`: the BSDF times the cosine.
    pub fn bsdf_sent(
        &self,
        vertices: &Vertices,
        surface: &Surface,
        w: V3<Lane>,
        glass: u32,
    ) -> V3<Lane> {
        let Some(interface) = surface.interface else {
            return V3::splat(0.0);
        };
        let (n, direction, kinds) = (surface.n, vertices.direction, vertices.kinds.masks());
        let sent = bsdf_evaluate_glass(n, direction, w, interface, lane_mask(glass), kinds);
        let sent = match surface.layers {
            None => sent,
            Some(layers) => {
                let layered = glass & vertices.kinds.layered();
                let is_layered = lane_mask(layered);
                let own = layered_sent(n, direction, w, interface, layers, kinds, is_layered);
                V3::select(is_layered, own, sent)
            }
        };
        surface.shown(vertices, w, sent)
    }

    /// Lanes of diffuse surfaces that are black, unless someone asks what would change if they were
    /// not.
    pub fn reflects_nothing(&self, vertices: &Vertices) -> u32 {
        if self.limits.black_goes_on {
            return vertices.kinds.black;
        }
        let c = vertices.diffuse_reflectance;
        let is_black = c.x.max(c.y).max(c.z).le(Lane::splat(0.0));
        is_black.to_bits() & !vertices.kinds.special()
    }
}
