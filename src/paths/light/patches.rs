//! Area lights as patches: parallelograms where two triangles make one, else single triangles.
//!
//! A patch is parametrised by the unit square: y(s, r) = q + s·e1 + r·e2. A parallelogram covers
//! it, a single triangle its half s + r ≤ 1. Light samples and shadow cells live in this square
//! (`boundary::cells::light`), and a point keeps its (s, r) when the light moves.

use crate::lanes::{LANES, Lane};
use crate::paths::light::lamp::Lamp;
use crate::paths::light::twins::{NONE, twins};
use crate::scene::{Layout, Rgb, Scene};
use crate::trace::geometry::Geometry;
use glam::Vec3;

/// A part of an area light.
#[derive(Clone, Copy, Debug)]
pub struct Patch {
    /// Vertices of the triangle that holds s + r ≤ 1: corner q, then at s = 1, then at r = 1.
    pub lower: [u32; 3],
    /// Vertices of the triangle that holds s + r > 1: the far corner, then at r = 1 (s = 0), then
    /// at s = 1 (r = 0).
    pub upper: Option<[u32; 3]>,
    /// The far corner is where its first vertex lies; the edges from q.
    pub corner: Vec3,
    pub edges: [Vec3; 2],
    /// Index into [`Scene::area_lights`].
    pub light: u32,
    /// Chance of being picked.
    pub probability: f32,
    /// The triangles whose corners `lower` and `upper` are.
    triangles: [u32; 2],
    /// By how much these are turned.
    turns: [u8; 2],
}

/// Of the mean radiance: a light that is asked about is sampled as if it were at least this bright.
const LEAST_LEVEL: f64 = 0.1;

/// All area lights of a scene.
pub struct Lights {
    pub patches: Vec<Patch>,
    /// Sum of the probabilities up to and including each patch.
    cumulative: Vec<f32>,
    /// Light and density (per solid angle needs the distance; this is per area) of each emitting
    /// triangle.
    pub of_mesh: Vec<Option<u32>>,
    /// Whether any light's radiance is not constant.
    pub any_texture: bool,
    /// The lights that are one thing from outside.
    pub lamps: Vec<Option<Lamp>>,
    /// Probability over area of picking a point on a light: the same everywhere on it.
    pub pdf_area: Vec<f32>,
}

impl Lights {
    /// `black_too`: lights that are dark at present are sampled as well.
    pub fn new(scene: &Scene, geometry: &Geometry, black_too: bool) -> Self {
        let mut patches = Vec::new();
        let mut power = Vec::new();
        let mut lamps = Vec::new();
        for (index, light) in scene.area_lights.iter().enumerate() {
            let texels = &scene.textures[light.radiance].texels;
            let all: f64 = texels.iter().map(|&t| luminance(t)).sum();
            let level = all / texels.len() as f64;
            let twins = twins(geometry, light.mesh);
            let own = pair_triangles(geometry, light.mesh, &twins);
            let triangles: Vec<_> = own.iter().map(|patch| patch.triangles).collect();
            let numbered = (patches.len(), triangles.as_slice());
            lamps.push(Lamp::new(geometry, light.mesh, &twins, numbered));
            for mut patch in own {
                patch.light = index as u32;
                let halves = if patch.upper.is_some() { 1.0 } else { 0.5 };
                let area = patch.edges[0].cross(patch.edges[1]).length() as f64 * halves;
                power.push((area, area * level));
                patches.push(patch);
            }
        }
        let mut total: f64 = power.iter().map(|p| p.1).sum();
        if black_too && total > 0.0 {
            let area: f64 = power.iter().map(|p| p.0).sum();
            let least = LEAST_LEVEL * total / area;
            power.iter_mut().for_each(|p| p.1 = p.1.max(p.0 * least));
            total = power.iter().map(|p| p.1).sum();
        }
        if total <= 0.0 {
            // Every light is black now; a gradient by its radiance still wants samples of it.
            power.iter_mut().for_each(|p| p.1 = p.0);
            total = power.iter().map(|p| p.1).sum();
        }
        let mut pdf_area = vec![0.0; scene.area_lights.len()];
        let mut cumulative = Vec::with_capacity(patches.len());
        let mut sum = 0.0;
        for (patch, (area, share)) in patches.iter_mut().zip(&power) {
            let probability = share / total;
            patch.probability = probability as f32;
            pdf_area[patch.light as usize] = (probability / area) as f32;
            if let Some(lamp) = &mut lamps[patch.light as usize] {
                lamp.chance += probability;
            }
            sum += probability;
            cumulative.push(sum as f32);
        }
        let of_mesh = scene
            .meshes
            .iter()
            .map(|m| m.area_light.map(|l| l as u32))
            .collect();
        let is_constant = |t: usize| scene.textures[t].layout == Layout::Constant;
        Self {
            any_texture: !scene.area_lights.iter().all(|l| is_constant(l.radiance)),
            patches,
            cumulative,
            lamps,
            of_mesh,
            pdf_area,
        }
    }

    /// Whether there is nothing to sample.
    pub fn is_empty(&self) -> bool {
        self.patches.is_empty()
    }

    /// Picks a patch in each lane by a uniform number, which is stretched to be used again.
    pub fn pick(&self, u: Lane) -> ([u32; LANES], Lane) {
        if self.patches.len() == 1 {
            return ([0; LANES], u);
        }
        let mut patch = [0; LANES];
        let mut rest = u.to_array();
        for lane in 0..LANES {
            let at = self
                .cumulative
                .partition_point(|&c| c <= rest[lane])
                .min(self.patches.len() - 1);
            let below = if at == 0 {
                0.0
            } else {
                self.cumulative[at - 1]
            };
            patch[lane] = at as u32;
            rest[lane] =
                ((rest[lane] - below) / self.patches[at].probability).clamp(0.0, 1.0 - 6e-8);
        }
        (patch, Lane::new(rest))
    }
}

impl Patch {
    /// Vertices and barycentrics (of the second and third vertex) of the point (`s`, `r`).
    #[inline]
    pub fn vertices_at(&self, s: f32, r: f32) -> ([u32; 3], [f32; 2]) {
        match self.upper {
            Some(upper) if s + r > 1.0 => (upper, [1.0 - s, 1.0 - r]),
            _ => (self.lower, [s, r]),
        }
    }

    /// Triangle and barycentrics (of its own second and third vertex) of the point (`s`, `r`).
    pub fn triangle_at(&self, s: f32, r: f32) -> (u32, [f32; 2]) {
        let is_upper = self.upper.is_some() && s + r > 1.0;
        let (_, [b1, b2]) = self.vertices_at(s, r);
        let triangle = self.triangles[is_upper as usize];
        let turn = usize::from(self.turns[is_upper as usize]);
        // Corner k of the patch's order is the triangle's corner k + turn.
        let of_patch = [1.0 - b1 - b2, b1, b2];
        let own = |corner: usize| of_patch[(corner + 3 - turn) % 3];
        (triangle, [own(1), own(2)])
    }

    /// Its triangles: one or two.
    pub fn triangles(&self) -> impl Iterator<Item = u32> + use<> {
        let [lower, upper] = self.triangles;
        let upper = self.upper.map(|_| upper);
        [Some(lower), upper].into_iter().flatten()
    }

    /// The (s, r) of a point of one of its triangles, from the triangle's own barycentrics: the
    /// inverse of [`Patch::triangle_at`].
    pub fn place_on(&self, triangle: u32, [b1, b2]: [f64; 2]) -> [f64; 2] {
        let is_upper = self.upper.is_some() && triangle == self.triangles[1];
        let turn = usize::from(self.turns[is_upper as usize]);
        let own = [1.0 - b1 - b2, b1, b2];
        let of_patch = |corner: usize| own[(corner + turn) % 3];
        let [s, r] = [of_patch(1), of_patch(2)];
        if is_upper { [1.0 - s, 1.0 - r] } else { [s, r] }
    }

    /// World position of (`s`, `r`), as it is now.
    pub fn point(&self, s: f32, r: f32) -> Vec3 {
        self.corner + self.edges[0] * s + self.edges[1] * r
    }

    /// How far the line through (`s`, `r`) along axis 0 or 1 reaches: from 0 up to this.
    pub fn line_end(&self, fixed: f32) -> f32 {
        if self.upper.is_some() {
            1.0
        } else {
            1.0 - fixed
        }
    }
}

/// Rec. 709 luminance: what lights are picked by.
pub fn luminance(c: Rgb) -> f64 {
    0.2126 * c[0] as f64 + 0.7152 * c[1] as f64 + 0.0722 * c[2] as f64
}

/// Joins triangles of a mesh that share a diagonal into parallelograms, each triangle at most once,
/// in order.
fn pair_triangles(geometry: &Geometry, mesh: usize, twins: &[u32]) -> Vec<Patch> {
    let position = |v: u32| geometry.positions[v as usize];
    let [first, end] = [mesh, mesh + 1].map(|m| geometry.first_triangle[m]);
    let triangles = &geometry.triangles[first as usize..end as usize];
    // The diagonals of each pair, both as half-edges, the first under its own triangle.
    let mut partner = vec![None; triangles.len()];
    let mut taken = vec![false; triangles.len()];
    for (half_edge, &twin) in twins.iter().enumerate() {
        let (t, c) = (half_edge / 3, half_edge % 3);
        let (other, k) = (twin as usize / 3, twin as usize % 3);
        if twin == NONE || taken[t] || taken[other] {
            continue;
        }
        let (v, w) = (triangles[t], triangles[other]);
        let (from, to) = (v[(c + 1) % 3], v[(c + 2) % 3]);
        let far = position(from) + position(to) - position(v[c]);
        let scale = (position(from) - position(to)).length();
        if (position(w[k]) - far).length() <= 1e-5 * scale {
            (taken[t], taken[other]) = (true, true);
            partner[other] = Some((k, t, c));
        }
    }
    let rotated = |t: usize, c: usize| [0, 1, 2].map(|i| triangles[t][(c + i) % 3]);
    let mut patches = Vec::new();
    for t in 0..triangles.len() {
        let (k, upper) = match partner[t] {
            Some((k, other, c)) => (k, Some((other, c))),
            None if taken[t] => continue,
            None => (0, None),
        };
        let lower = rotated(t, k);
        let [q, a, b] = lower.map(position);
        let (other, c) = upper.unwrap_or((t, k));
        patches.push(Patch {
            lower,
            upper: upper.map(|(other, c)| rotated(other, c)),
            corner: q,
            edges: [a - q, b - q],
            light: 0,
            probability: 0.0,
            triangles: [t, other].map(|t| first + t as u32),
            turns: [k, c].map(|turn| turn as u8),
        });
    }
    patches
}
