//! Where rays meet surfaces that may bend them, and what becomes of them there, in f64.

use crate::discontinuity::boundary::{dvec3, vector};
use crate::kernels::bsdf::consistent_normal;
use crate::kernels::bsdf::{Interface, LobeMasks, RoughTransmission, bsdf_sample};
use crate::kernels::relief::relief_shadow;
use crate::paths::chain::{is_shaded, vertex_normals};
use crate::paths::chain_relief::ReliefPlace;
use crate::paths::chain_vertex::{Bend, ChainVertex, Turn};
use crate::paths::leaving::OFFSET;
use crate::paths::scene_view::SceneView;
use crate::paths::surface::interface::texture_at;
use crate::paths::surface::kinds::Kinds;
use crate::paths::surface::materials::{ETA, Entry, SLOTS};
use crate::paths::surface::parts::{Fraction, Part};
use crate::paths::surface::texture::Lookup;
use crate::trace::geometry::NO_TRIANGLE;
use glam::{DVec3, Vec3};

/// Where a ray meets a surface, in f64.
pub struct Meeting<'a> {
    view: &'a SceneView<'a>,
    triangle: u32,
    direction: DVec3,
    from_front: bool,
    pub x: DVec3,
    /// Before pictures turn it.
    n: DVec3,
    geometric: DVec3,
    corners: [DVec3; 3],
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
        Some(Self {
            view,
            triangle,
            direction: d,
            from_front: facing > 0.0,
            x: p + e1 * b[0] + e2 * b[1],
            n,
            geometric,
            corners: [p, q, r],
            b,
        })
    }

    /// The materials that are met, if they are several.
    fn parts(&self) -> &[Part] {
        self.view.materials.parts(self.material())
    }

    fn material(&self) -> usize {
        let mesh = self.view.geometry.mesh_of_triangle[self.triangle as usize] as usize;
        self.view.scene.meshes[mesh].material
    }

    fn entry(&self, part: u16) -> &Entry {
        let materials = self.view.materials;
        materials.entry_of_part(self.material(), part)
    }

    /// What kind it is on this side.
    fn kinds(&self, part: u16) -> Kinds {
        let entry = self.entry(part);
        let mut kinds = entry.kinds;
        if !self.from_front && !entry.two_sided && (kinds.dielectric | kinds.null) == 0 {
            kinds = Kinds {
                black: 1,
                ..Kinds::default()
            };
        }
        if !self.from_front && kinds.dielectric != 0 && kinds.thin == 0 {
            kinds.inside = u32::MAX;
        }
        kinds
    }

    /// Whether a chain goes on from here.
    pub fn is_smooth(&self) -> bool {
        let is_seen_in = |part: u16| self.kinds(part).in_chains() != 0;
        match self.parts().len() {
            0 => is_seen_in(0),
            count => (0..count as u16).any(is_seen_in),
        }
    }

    /// Calls `each` with what may become of the ray, and about the chance of it; these add up to
    /// less than one where light is scattered otherwise, too. A mean over places is taken of
    /// chances, so they need not be those with which paths choose.
    pub fn for_each_turn(&self, mut each: impl FnMut(Turn, f64)) {
        let mut of_part = |part: u16, met: f64| {
            for (bend, chance) in self.bends(part).into_iter().flatten() {
                each(Turn { part, bend }, met * chance);
            }
        };
        if self.parts().is_empty() {
            of_part(0, 1.0);
        }
        for (number, part) in self.parts().iter().enumerate() {
            if part.is_there {
                // Between the rays a mixture may be another, of which they see nothing.
                let fraction = self.fraction(number as u16);
                of_part(number as u16, fraction.max(LEAST_CHANCE));
            }
        }
    }

    /// What one of the materials may do with it, with the chance of each.
    fn bends(&self, part: u16) -> [Option<(Bend, f64)>; 2] {
        let kinds = self.kinds(part);
        if kinds.in_chains() == 0 {
            return [None; 2];
        }
        if kinds.null != 0 {
            return [Some((Bend::Straight, 1.0)), None];
        }
        if kinds.conductor != 0 {
            return [Some((Bend::Reflected, 1.0)), None];
        }
        let onward = if kinds.thin != 0 {
            Bend::Straight
        } else {
            Bend::Refracted
        };
        let weight = |bend| {
            self.scattered(part, bend)
                .map_or(0.0, |(_, w)| w.max_element())
        };
        let reflected = weight(Bend::Reflected);
        let other = if kinds.dielectric != 0 {
            weight(onward)
        } else {
            // A plastic's diffuse part.
            1.0 - reflected
        };
        let sum = (reflected + other).max(1e-9);
        let [a, b] = [reflected, other].map(|w| w / sum);
        if kinds.plastic != 0 {
            return [Some((Bend::Reflected, a.max(LEAST_CHANCE))), None];
        }
        [Some((Bend::Reflected, a)), Some((onward, b))]
    }

    /// The unit direction in which it goes on, and what the radiance from there is multiplied with;
    /// `None` where nothing does so.
    pub fn bent(&self, turn: Turn) -> Option<(DVec3, DVec3)> {
        let (next, weight) = self.scattered(turn.part, turn.bend)?;
        Some((next, weight * self.fraction(turn.part)))
    }

    /// The same if all of the surface were that material.
    fn scattered(&self, part: u16, bend: Bend) -> Option<(DVec3, DVec3)> {
        let kinds = self.kinds(part);
        let does = match bend {
            Bend::Reflected => kinds.conductor | kinds.dielectric | kinds.plastic,
            Bend::Refracted => kinds.dielectric & !kinds.thin,
            Bend::Straight => kinds.null | kinds.thin,
        };
        if does == 0 || kinds.in_chains() == 0 {
            return None;
        }
        let lobes = LobeMasks {
            is_diffuse: false,
            is_reflected: bend == Bend::Reflected,
            // The kernel knows what a pane lets through as refracted.
            is_refracted: bend == Bend::Refracted || (bend == Bend::Straight && kinds.thin != 0),
            is_coat: false,
        };
        let n = self.normal(part);
        let (next, weight) = bsdf_sample::<f64>(
            vector(n),
            vector(self.direction),
            vector(DVec3::Z),
            self.interface(part),
            RoughTransmission::none(),
            lobes,
            kinds.masks_of_lane(0),
        );
        let (next, weight) = (dvec3(next), dvec3(weight));
        let passes = bend != Bend::Refracted || weight != DVec3::ZERO;
        let shown = match self.entry(part).relief {
            Some(_) => relief_shadow(vector(self.n), vector(n), vector(next)),
            None => 1.0,
        };
        // Nothing is seen behind the horizon below a relief, up to which it fades.
        let passes = passes && shown > 0.0;
        (passes && next.is_finite() && weight.is_finite()).then_some((next, weight * shown))
    }

    /// The unit normal of one of the materials.
    fn normal(&self, part: u16) -> DVec3 {
        let Some(relief) = &self.entry(part).relief else {
            return self.n;
        };
        let facing = if self.from_front { 1.0 } else { -1.0 };
        let place = ReliefPlace::new(relief, self.view, (self.triangle, self.b), facing);
        let numbers = place.numbers(self.b, Vec3::ZERO);
        let corners = self.corners.map(vector);
        dvec3(place.turn(vector(self.n), vector(self.direction), corners, numbers))
    }

    /// Whether a ray that goes on along `direction` starts on the other side of the triangle's
    /// plane than it should: shading normals send it there.
    pub fn leaks(&self, bend: Bend, direction: DVec3) -> bool {
        let goes_through = self.geometric.dot(direction) * self.geometric.dot(self.direction) > 0.0;
        match bend {
            Bend::Reflected => goes_through,
            Bend::Refracted => !goes_through,
            Bend::Straight => false,
        }
    }

    /// As it stands in a chain.
    pub fn vertex(&self, turn: Turn) -> ChainVertex {
        ChainVertex {
            triangle: self.triangle,
            turn,
            from_front: self.from_front,
        }
    }

    /// From where a ray starts that goes on along `direction`, as `rays::leave` has it.
    pub fn leave(&self, direction: DVec3) -> DVec3 {
        let step = f64::from(OFFSET) * self.view.geometry.room(self.x);
        self.x + self.geometric * (step * self.geometric.dot(direction).signum())
    }

    /// How much of the surface is that material here.
    fn fraction(&self, part: u16) -> f64 {
        let value = |f: &Fraction| f64::from(f.value(&self.look_up(f.texture)));
        let part = self.parts().get(usize::from(part));
        part.map_or(1.0, |part| part.fractions.iter().map(value).product())
    }

    fn look_up(&self, texture: usize) -> Lookup {
        let b = self.b.map(|b| b as f32);
        texture_at(
            self.view.scene,
            self.view.geometry,
            texture,
            self.triangle,
            b,
        )
        .0
    }

    fn interface(&self, part: u16) -> Interface<f64> {
        let mut slots = [Vec3::ZERO; SLOTS];
        slots[ETA] = Vec3::splat(1.5);
        for &(slot, texture) in &self.entry(part).slots {
            if slot < SLOTS {
                slots[slot] = self.look_up(texture).value;
            }
        }
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
