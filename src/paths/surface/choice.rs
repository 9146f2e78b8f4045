//! Surfaces made of several materials (`mask`, `blendbsdf`): each path meets one of them.
//!
//! A mixture Σ fₖ·Mₖ of materials is met as Mₖ with chance pₖ, and what comes of it is multiplied
//! by fₖ/pₖ: all that follows knows only Mₖ. The chances are numbers at θ₀, so that the factor is
//! what is differentiated. They are the fractions themselves, and the factor is 1, except where a
//! fraction of nothing is asked about.

use crate::lanes::{LANES, Lane};
use crate::paths::at::Numbers;
use crate::paths::dimensions::Single;
use crate::paths::scene_view::SceneView;
use crate::paths::store::{Choice, Vertices};
use crate::paths::surface::interface::texture_at;
use crate::paths::surface::materials::Entry;
use crate::paths::surface::texture::Lookup;
use crate::trace::geometry::NO_TRIANGLE;
use glam::Vec3;

/// The least chance of a material whose fraction is asked about.
const LEAST_CHANCE: f32 = 0.1;

/// One factor of a lane's fraction over its chance.
pub struct ChoiceSlope {
    pub lane: usize,
    pub texture: usize,
    pub lookup: Lookup,
    /// Along the barycentrics of the second and third vertex.
    pub by_barycentric: [Vec3; 2],
    /// Of the whole over the chance, by the texture's value.
    pub slope: f32,
}

impl SceneView<'_> {
    /// The material that a lane has met.
    pub fn entry(&self, vertices: &Vertices, lane: usize) -> &Entry {
        let material = self.material_of(vertices.triangle[lane]);
        match &vertices.choice {
            Some(choice) => match self.materials.parts(material) {
                [] => self.materials.entry(material),
                parts => self
                    .materials
                    .entry(parts[choice.part[lane] as usize].entry),
            },
            None => self.materials.entry(material),
        }
    }

    fn material_of(&self, triangle: u32) -> usize {
        let mesh = self.geometry.mesh_of_triangle[triangle as usize] as usize;
        self.scene.meshes[mesh].material
    }

    /// Chooses among the materials of surfaces that are made of several.
    pub fn choose(&self, vertices: &mut Vertices, numbers: &Numbers) {
        if !vertices.triangle.iter().any(|&t| self.is_mixed(t)) {
            return;
        }
        let b = self.barycentrics(vertices).map(Lane::to_array);
        let mut part = [0; LANES];
        let mut inverse_chance = [1.0; LANES];
        let mut factor = [1.0; LANES];
        for lane in (0..LANES).filter(|&l| self.is_mixed(vertices.triangle[l])) {
            let name = [numbers.index[lane], numbers.depth, 0];
            let mut left = numbers.stream.single(Single::Choice, name);
            let parts = self
                .materials
                .parts(self.material_of(vertices.triangle[lane]));
            for (number, candidate) in parts.iter().enumerate() {
                let mut fraction = 1.0;
                let mut chance = 1.0;
                for &f in &candidate.fractions {
                    let at = [b[0][lane], b[1][lane]];
                    let triangle = vertices.triangle[lane];
                    let (found, _) = texture_at(self.scene, self.geometry, f.texture, triangle, at);
                    let value = f.value(&found);
                    fraction *= value;
                    chance *= if self.limits.black_goes_on {
                        value.clamp(LEAST_CHANCE, 1.0 - LEAST_CHANCE)
                    } else {
                        value
                    };
                }
                if chance > 0.0 {
                    part[lane] = number as u16;
                    inverse_chance[lane] = 1.0 / chance;
                    factor[lane] = fraction / chance;
                    if left < chance {
                        break;
                    }
                }
                left -= chance;
            }
        }
        let arriving = vertices.throughput;
        vertices.throughput = arriving * Lane::new(factor);
        vertices.choice = Some(Box::new(Choice {
            part,
            inverse_chance: Lane::new(inverse_chance),
            arriving,
        }));
    }

    /// Whether a triangle's surface is made of several materials.
    pub fn is_mixed(&self, triangle: u32) -> bool {
        self.materials.any_choice
            && triangle != NO_TRIANGLE
            && !self.materials.parts(self.material_of(triangle)).is_empty()
    }

    /// Meets everywhere the material number `part` of those that surfaces are made of, and returns
    /// their fractions; `None` if no lane has so many.
    pub fn made_of(&self, vertices: &mut Vertices, part: usize) -> Option<Lane> {
        let counts: [usize; LANES] = std::array::from_fn(|lane| match vertices.triangle[lane] {
            NO_TRIANGLE => 1,
            triangle => self
                .materials
                .parts(self.material_of(triangle))
                .len()
                .max(1),
        });
        let has_it = counts.map(|count| part < count);
        if !has_it.contains(&true) {
            return None;
        }
        if counts == [1; LANES] {
            return Some(Lane::splat(1.0));
        }
        let choice = Choice {
            part: counts.map(|count| part.min(count - 1) as u16),
            inverse_chance: Lane::splat(1.0),
            arriving: vertices.throughput,
        };
        let b = self.barycentrics(vertices);
        let fractions = self.choice_factors(vertices, &choice, b).to_array();
        vertices.choice = Some(Box::new(choice));
        Some(Lane::new(std::array::from_fn(|lane| {
            if has_it[lane] { fractions[lane] } else { 0.0 }
        })))
    }

    /// Calls `each` with every factor of each lane's fraction; `b` are the barycentrics of the
    /// second and third vertex.
    pub fn for_each_choice(
        &self,
        vertices: &Vertices,
        choice: &Choice,
        b: [Lane; 2],
        mut each: impl FnMut(ChoiceSlope),
    ) {
        let b = b.map(Lane::to_array);
        let inverse_chance = choice.inverse_chance.to_array();
        for lane in (0..LANES).filter(|&l| vertices.hit >> l & 1 == 1) {
            let triangle = vertices.triangle[lane];
            let parts = self.materials.parts(self.material_of(triangle));
            let Some(part) = parts.get(choice.part[lane] as usize) else {
                continue;
            };
            let at = [b[0][lane], b[1][lane]];
            let found: Vec<_> = part
                .fractions
                .iter()
                .map(|f| texture_at(self.scene, self.geometry, f.texture, triangle, at))
                .collect();
            for (k, (f, (lookup, by_barycentric))) in part.fractions.iter().zip(&found).enumerate()
            {
                let others = part.fractions.iter().zip(&found).enumerate();
                let others: f32 = others
                    .filter(|(j, _)| *j != k)
                    .map(|(_, (f, (lookup, _)))| f.value(lookup))
                    .product();
                let sign = if f.is_rest { -1.0 } else { 1.0 };
                each(ChoiceSlope {
                    lane,
                    texture: f.texture,
                    lookup: *lookup,
                    by_barycentric: *by_barycentric,
                    slope: sign * others * inverse_chance[lane],
                });
            }
        }
    }

    /// Each lane's fraction over its chance.
    pub fn choice_factors(&self, vertices: &Vertices, choice: &Choice, b: [Lane; 2]) -> Lane {
        let b = b.map(Lane::to_array);
        let inverse_chance = choice.inverse_chance.to_array();
        Lane::new(std::array::from_fn(|lane| {
            let triangle = vertices.triangle[lane];
            if triangle == NO_TRIANGLE {
                return 1.0;
            }
            let parts = self.materials.parts(self.material_of(triangle));
            let Some(part) = parts.get(choice.part[lane] as usize) else {
                return 1.0;
            };
            let at = [b[0][lane], b[1][lane]];
            let fractions = part.fractions.iter().map(|f| {
                f.value(&texture_at(self.scene, self.geometry, f.texture, triangle, at).0)
            });
            fractions.product::<f32>() * inverse_chance[lane]
        }))
    }

    /// The change of [`Self::choice_factors`] as textures change by `change(texture, where)` and
    /// the barycentrics by `db`.
    pub fn choice_change(
        &self,
        vertices: &Vertices,
        choice: &Choice,
        b: [Lane; 2],
        db: [Lane; 2],
        change: impl Fn(usize, &Lookup) -> Vec3,
    ) -> Lane {
        let db = db.map(Lane::to_array);
        let mut sum = [0.0; LANES];
        self.for_each_choice(vertices, choice, b, |s| {
            let [by_b1, by_b2] = s.by_barycentric;
            let moved = by_b1.x * db[0][s.lane] + by_b2.x * db[1][s.lane];
            sum[s.lane] += s.slope * (change(s.texture, &s.lookup).x + moved);
        });
        Lane::new(sum)
    }
}
