//! Chains: rays through smooth surfaces, along which the world is seen by a deterministic map.
//!
//! A chain begins with a ray from the camera or from a vertex. At each smooth surface it is
//! reflected, refracted or goes straight on, and which of these is decided before. Then its last
//! ray is a function of the first one and of the surfaces ([`through`]), which is smooth as long as
//! the surfaces are.

use crate::discontinuity::boundary::{dvec3, vector};
use crate::kernels::bsdf::consistent_normal;
use crate::kernels::bsdf::{Interface, LobeMasks, RoughTransmission, bsdf_sample};
use crate::kernels::smooth::smooth_ray;
use crate::lanes::{Real, V3};
use crate::paths::chain_vertex::{Bend, ChainVertex};
use crate::paths::leaving::OFFSET;
use crate::paths::scene_view::SceneView;
use crate::paths::surface::interface::texture_at;
use crate::paths::surface::kinds::Kinds;
use crate::paths::surface::materials::{ETA, OPACITY, SLOTS};
use crate::trace::geometry::{Geometry, NO_TRIANGLE};
use glam::{DVec3, Vec3};

/// The texture of a vertex's index of refraction, if it has one.
pub fn eta_texture(vertex: &ChainVertex, view: &SceneView) -> Option<usize> {
    let mesh = view.geometry.mesh_of_triangle[vertex.triangle as usize] as usize;
    let entry = view.materials.of_mesh(view.scene, mesh);
    let eta = entry.slots.iter().find(|(slot, _)| *slot == ETA);
    eta.filter(|_| vertex.is_refracted())
        .map(|&(_, texture)| texture)
}

/// Whether a triangle has shading normals of its own.
pub fn is_shaded(geometry: &Geometry, triangle: u32) -> bool {
    geometry.smooth[geometry.mesh_of_triangle[triangle as usize] as usize]
}

/// The shading normals of a triangle's vertices; harmless ones where it has none.
pub fn vertex_normals(geometry: &Geometry, triangle: u32) -> [DVec3; 3] {
    if !is_shaded(geometry, triangle) {
        return [DVec3::Z; 3];
    }
    geometry.triangles[triangle as usize].map(|v| geometry.normals[v as usize].as_dvec3())
}

/// The last ray of a chain whose first ray starts at `o` along `d`: where it starts, and its unit
/// direction. `point` and `normal` give vertices and their shading normals, `eta` the index of a
/// texture, all over any lane type, tangents and all. They are applied to every vertex in turn.
pub fn through<F: Real<Mask = bool>>(
    view: &SceneView,
    chain: &[ChainVertex],
    (o, d): (V3<F>, V3<F>),
    point: impl Fn(u32) -> V3<F>,
    normal: impl Fn(u32) -> V3<F>,
    eta: impl Fn(usize) -> F,
) -> (V3<F>, V3<F>) {
    chain.iter().fold((o, d), |(o, d), vertex| {
        let corners = view.geometry.triangles[vertex.triangle as usize];
        let is_shaded = is_shaded(view.geometry, vertex.triangle);
        let normals = if is_shaded {
            corners.map(&normal)
        } else {
            [V3::new(F::splat(0.0), F::splat(0.0), F::splat(1.0)); 3]
        };
        let eta = eta_texture(vertex, view).map_or(F::splat(1.0), &eta);
        smooth_ray(
            o,
            d,
            corners.map(&point),
            normals,
            F::splat(vertex.facing()),
            vertex.ratio(eta),
            is_shaded,
            vertex.is_reflected(),
            vertex.is_refracted(),
        )
    })
}

/// Where a ray meets a surface, in f64.
pub struct Meeting<'a> {
    view: &'a SceneView<'a>,
    triangle: u32,
    direction: DVec3,
    kinds: Kinds,
    from_front: bool,
    pub x: DVec3,
    n: DVec3,
    geometric: DVec3,
    b: [f64; 2],
}

impl<'a> Meeting<'a> {
    /// `None` where the ray meets nothing.
    pub fn new(view: &'a SceneView<'a>, o: DVec3, d: DVec3, triangle: u32) -> Option<Self> {
        if triangle == NO_TRIANGLE {
            return None;
        }
        let geometry = view.geometry;
        let [p, q, r] = geometry.triangles[triangle as usize]
            .map(|v| geometry.positions[v as usize].as_dvec3());
        let (e1, e2) = (q - p, r - p);
        let across = d.cross(e2);
        let s = o - p;
        let inverse = 1.0 / e1.dot(across);
        let b = [s.dot(across) * inverse, d.dot(s.cross(e1)) * inverse];
        let geometric = e1.cross(e2).normalize();
        let mut n = geometric;
        if is_shaded(geometry, triangle) {
            let [n0, n1, n2] = vertex_normals(geometry, triangle);
            n = (n0 * (1.0 - b[0] - b[1]) + n1 * b[0] + n2 * b[1]).normalize();
        }
        let side = -geometric.dot(d).signum();
        let facing = side * n.dot(geometric).signum();
        n *= facing;
        if is_shaded(geometry, triangle) {
            n = dvec3(consistent_normal(vector(n), vector(d)));
        }
        let mesh = geometry.mesh_of_triangle[triangle as usize] as usize;
        let entry = view.materials.of_mesh(view.scene, mesh);
        let mut kinds = entry.kinds;
        let is_back = facing < 0.0;
        if is_back && !entry.two_sided && (kinds.dielectric | kinds.null | kinds.masked) == 0 {
            kinds = Kinds {
                black: 1,
                ..Kinds::default()
            };
        }
        if is_back && kinds.dielectric != 0 && kinds.thin == 0 {
            kinds.inside = u32::MAX;
        }
        Some(Self {
            view,
            triangle,
            direction: d,
            kinds,
            from_front: !is_back,
            x: p + e1 * b[0] + e2 * b[1],
            n,
            geometric,
            b,
        })
    }

    /// Whether a chain goes on from here.
    pub fn is_smooth(&self) -> bool {
        self.kinds.in_chains() != 0
    }

    /// What it may do with the ray, with the chance of each, which add up to one at most; `None` if
    /// the path may end here, too, and light is scattered diffusely. A mean over places is taken of
    /// chances, so they need not be those with which paths choose.
    pub fn chances(&self) -> [(Bend, f64); 2] {
        let none = |bend| [(bend, 1.0), (Bend::Refracted, 0.0)];
        if self.kinds.null != 0 {
            return none(Bend::Straight);
        }
        if self.kinds.masked != 0 {
            // Between the rays may be holes, where they see none.
            let passing = (1.0 - self.opacity()).max(LEAST_CHANCE);
            return [(Bend::Straight, passing), (Bend::Reflected, 0.0)];
        }
        if self.kinds.conductor != 0 {
            return none(Bend::Reflected);
        }
        let onward = self.onward();
        let reflected = self
            .bent(Bend::Reflected)
            .map_or(0.0, |(_, w)| w.max_element());
        let refracted = if self.kinds.dielectric != 0 {
            self.bent(onward).map_or(0.0, |(_, w)| w.max_element())
        } else {
            // A plastic's diffuse part.
            1.0 - reflected
        };
        let sum = (reflected + refracted).max(1e-9);
        let [a, b] = [reflected, refracted].map(|w| w / sum);
        if self.kinds.plastic != 0 {
            return [
                (Bend::Reflected, a.max(LEAST_CHANCE)),
                (Bend::Refracted, 0.0),
            ];
        }
        [(Bend::Reflected, a), (onward, b)]
    }

    /// What glass does with the ray that it does not reflect.
    fn onward(&self) -> Bend {
        if self.kinds.thin != 0 {
            Bend::Straight
        } else {
            Bend::Refracted
        }
    }

    /// The unit direction in which it goes on, and what the radiance from there is multiplied with;
    /// `None` where nothing is refracted.
    pub fn bent(&self, bend: Bend) -> Option<(DVec3, DVec3)> {
        let does = match bend {
            Bend::Reflected => self.kinds.conductor | self.kinds.dielectric | self.kinds.plastic,
            Bend::Refracted => self.kinds.dielectric & !self.kinds.thin,
            Bend::Straight => self.kinds.null | self.kinds.thin | self.kinds.masked,
        };
        if does == 0 || !self.is_smooth() {
            return None;
        }
        if self.kinds.masked != 0 {
            let passing = DVec3::splat(1.0 - self.opacity());
            return Some((self.direction.normalize(), passing));
        }
        let lobes = LobeMasks {
            is_diffuse: false,
            is_reflected: bend == Bend::Reflected,
            // The kernel knows what a pane lets through as refracted.
            is_refracted: bend == Bend::Refracted
                || (bend == Bend::Straight && self.kinds.thin != 0),
            is_coat: false,
        };
        let (next, weight) = bsdf_sample::<f64>(
            vector(self.n),
            vector(self.direction),
            vector(DVec3::Z),
            self.interface(),
            RoughTransmission::none(),
            lobes,
            self.kinds.masks_of_lane(0),
        );
        let (next, weight) = (dvec3(next), dvec3(weight));
        let passes = bend != Bend::Refracted || weight != DVec3::ZERO;
        (passes && next.is_finite() && weight.is_finite()).then_some((next, weight))
    }

    /// Whether a ray that goes on along `direction` starts on the other side of the triangle's plane
    /// than it should: shading normals send it there.
    pub fn leaks(&self, bend: Bend, direction: DVec3) -> bool {
        let goes_through = self.geometric.dot(direction) * self.geometric.dot(self.direction) > 0.0;
        match bend {
            Bend::Reflected => goes_through,
            Bend::Refracted => !goes_through,
            Bend::Straight => false,
        }
    }

    /// As it stands in a chain.
    pub fn vertex(&self, bend: Bend) -> ChainVertex {
        ChainVertex {
            triangle: self.triangle,
            bend,
            from_front: self.from_front,
        }
    }

    /// From where a ray starts that goes on along `direction`, as `rays::leave` has it.
    pub fn leave(&self, direction: DVec3) -> DVec3 {
        let step = f64::from(OFFSET) * self.view.geometry.room(self.x);
        self.x + self.geometric * (step * self.geometric.dot(direction).signum())
    }

    /// How much of a mask is there.
    fn opacity(&self) -> f64 {
        let mut opacity = 1.0;
        self.for_each_slot(|slot, value| {
            if slot == OPACITY {
                opacity = f64::from(value.x);
            }
        });
        opacity
    }

    fn for_each_slot(&self, mut each: impl FnMut(usize, Vec3)) {
        let b = self.b.map(|b| b as f32);
        let (scene, geometry) = (self.view.scene, self.view.geometry);
        let mesh = geometry.mesh_of_triangle[self.triangle as usize] as usize;
        for &(slot, texture) in &self.view.materials.of_mesh(scene, mesh).slots {
            let (lookup, _) = texture_at(scene, geometry, texture, self.triangle, b);
            each(slot, lookup.value);
        }
    }

    fn interface(&self) -> Interface<f64> {
        let mut slots = [Vec3::ZERO; SLOTS];
        slots[ETA] = Vec3::splat(1.5);
        self.for_each_slot(|slot, value| {
            if slot < SLOTS {
                slots[slot] = value;
            }
        });
        let [reflectance, second_reflectance, eta, k, alpha] = slots.map(|v| v.as_dvec3());
        Interface {
            reflectance: vector(reflectance),
            second_reflectance: vector(second_reflectance),
            eta: vector(eta),
            k: vector(k),
            alpha: alpha.x,
        }
    }
}

/// Neither way of a chain is chosen more rarely than this where it matters.
pub const LEAST_CHANCE: f64 = 0.1;
