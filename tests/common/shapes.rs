//! Meshes and random numbers for tests and benches.

use glam::Vec3;
use std::collections::HashMap;

/// Positions and triangles.
pub type Shape = (Vec<Vec3>, Vec<[u32; 3]>);

/// A small repeatable generator (PCG-XSH-RR 64/32).
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Random(seed.wrapping_mul(2).wrapping_add(0x9e37_79b9_7f4a_7c15))
    }
    pub fn bits(&mut self) -> u32 {
        let s = self.0;
        self.0 = s
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        ((((s >> 18) ^ s) >> 27) as u32).rotate_right((s >> 59) as u32)
    }
    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / 16_777_216.0
    }
    /// Uniform in the cube from −1 to 1.
    pub fn cube(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.cube();
            if (1e-3..1.0).contains(&v.length_squared()) {
                return v.normalize();
            }
        }
    }
    /// Standard normal.
    pub fn normal(&mut self) -> f32 {
        let radius = (-2.0 * (1.0 - self.unit()).ln()).sqrt();
        radius * (std::f32::consts::TAU * self.unit()).cos()
    }
}

/// `count` triangles of edge about `size`, at random in the cube from −1 to 1.
pub fn soup(random: &mut Random, count: usize, size: f32) -> Shape {
    let mut positions = Vec::new();
    let mut triangles = Vec::new();
    for i in 0..count as u32 {
        let centre = random.cube();
        positions.extend([0; 3].map(|_| centre + size * random.cube()));
        triangles.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    (positions, triangles)
}

/// A closed sphere of `20 · 4^levels` triangles.
pub fn icosphere(levels: u32, centre: Vec3, radius: f32) -> Shape {
    let g = (1.0 + 5.0_f32.sqrt()) / 2.0;
    let mut points = Vec::new();
    for (a, b) in [(1.0, g), (1.0, -g), (-1.0, g), (-1.0, -g)] {
        points.extend([
            Vec3::new(0.0, a, b),
            Vec3::new(a, b, 0.0),
            Vec3::new(b, 0.0, a),
        ]);
    }
    points.iter_mut().for_each(|p| *p = p.normalize());
    let mut triangles = Vec::new();
    let near = |a: usize, b: usize, p: &[Vec3]| p[a].distance(p[b]) < 1.1;
    for a in 0..12 {
        for b in a + 1..12 {
            for c in b + 1..12 {
                if near(a, b, &points) && near(b, c, &points) && near(a, c, &points) {
                    let n = (points[b] - points[a]).cross(points[c] - points[a]);
                    let outward = n.dot(points[a]) > 0.0;
                    let (b, c) = if outward { (b, c) } else { (c, b) };
                    triangles.push([a as u32, b as u32, c as u32]);
                }
            }
        }
    }
    for _ in 0..levels {
        let mut middles = HashMap::new();
        let mut finer = Vec::with_capacity(4 * triangles.len());
        for &[a, b, c] in &triangles {
            let mut middle = |a: u32, b: u32| {
                *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                    points.push((points[a as usize] + points[b as usize]).normalize());
                    points.len() as u32 - 1
                })
            };
            let (ab, bc, ca) = (middle(a, b), middle(b, c), middle(c, a));
            finer.extend([[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]);
        }
        triangles = finer;
    }
    (
        points.iter().map(|p| centre + radius * *p).collect(),
        triangles,
    )
}
