//! Generated meshes of three classes that trouble a tree differently, all within the unit ball.

use glam::Vec3;
use std::f32::consts::TAU;

/// What kind of mesh.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Class {
    /// A closed, knotted tube of even triangles.
    Smooth,
    /// Small leaves, two triangles each, everywhere in the ball.
    Leafy,
    /// Needles fifty times as long as wide, in all directions: boxes fit them badly.
    Thin,
}

impl Class {
    pub const ALL: [(Self, &'static str); 3] = [
        (Self::Smooth, "smooth"),
        (Self::Leafy, "leafy"),
        (Self::Thin, "thin"),
    ];
}

/// Positions and triangles.
pub type Shape = (Vec<Vec3>, Vec<[u32; 3]>);

/// Area of all leaves, or of all needles: half a dozen of the ball's shadows.
const TOTAL_AREA: f32 = 20.0;

/// A mesh of about `count` triangles, the same every time.
pub fn generate(class: Class, count: usize) -> Shape {
    match class {
        Class::Smooth => tube(count),
        Class::Leafy => leaves(count / 2),
        Class::Thin => needles(count),
    }
}

/// A (2, 3) torus knot; quadrilaterals are about as long as wide.
fn tube(count: usize) -> Shape {
    const THICKNESS: f32 = 0.14;
    const LENGTH_BY_GIRTH: f32 = 12.0;
    let around = ((count as f32 / 2.0 / LENGTH_BY_GIRTH).sqrt() as usize).max(3);
    let along = (count / 2 / around).max(8);
    let curve = |t: f32| {
        let radius = 2.0 + (3.0 * t).cos();
        Vec3::new(
            radius * (2.0 * t).cos(),
            radius * (2.0 * t).sin(),
            (3.0 * t).sin(),
        ) / 3.6
    };
    let mut positions = Vec::with_capacity(along * around);
    for i in 0..along {
        let t = TAU * i as f32 / along as f32;
        let centre = curve(t);
        let ahead = (curve(t + 1e-3) - curve(t - 1e-3)).normalize();
        // Across the ahead and from the axis: closes where the curve does.
        let out = Vec3::new(centre.x, centre.y, 0.3 * centre.z)
            .reject_from(ahead)
            .normalize();
        let side = ahead.cross(out);
        for k in 0..around {
            let (sin, cos) = (TAU * k as f32 / around as f32).sin_cos();
            positions.push(centre + THICKNESS * (cos * out + sin * side));
        }
    }
    let at = |i: usize, k: usize| ((i % along) * around + k % around) as u32;
    let mut triangles = Vec::with_capacity(2 * along * around);
    for i in 0..along {
        for k in 0..around {
            let [a, b, c, d] = [at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)];
            triangles.extend([[a, c, b], [a, d, c]]);
        }
    }
    (positions, triangles)
}

fn leaves(count: usize) -> Shape {
    let mut random = Random(1);
    let length = (TOTAL_AREA / count as f32).sqrt();
    let mut shape = (Vec::new(), Vec::new());
    for i in 0..count as u32 {
        let stem = random.in_ball() * (1.0 - length);
        let ahead = random.in_ball().normalize_or(Vec3::X);
        let side = random
            .in_ball()
            .reject_from(ahead)
            .normalize_or(ahead.any_orthonormal_vector());
        // Folded a little along the middle.
        let fold = 0.2 * ahead.cross(side);
        shape.0.extend([
            stem,
            stem + length * (0.5 * (ahead + side) + fold),
            stem + length * ahead,
            stem + length * (0.5 * (ahead - side) + fold),
        ]);
        shape
            .1
            .extend([[0, 1, 2], [0, 2, 3]].map(|t| t.map(|v| 4 * i + v)));
    }
    shape
}

fn needles(count: usize) -> Shape {
    let mut random = Random(2);
    const LENGTH_BY_WIDTH: f32 = 50.0;
    let length = (2.0 * LENGTH_BY_WIDTH * TOTAL_AREA / count as f32)
        .sqrt()
        .min(0.6);
    let width = length / LENGTH_BY_WIDTH;
    let mut shape = (Vec::new(), Vec::new());
    for i in 0..count as u32 {
        let middle = (1.0 - 0.5 * length) * random.in_ball();
        let ahead = random.in_ball().normalize_or(Vec3::X);
        let side = random
            .in_ball()
            .reject_from(ahead)
            .normalize_or(ahead.any_orthonormal_vector());
        shape.0.extend([
            middle - 0.5 * length * ahead - 0.5 * width * side,
            middle - 0.5 * length * ahead + 0.5 * width * side,
            middle + 0.5 * length * ahead,
        ]);
        shape.1.push([3 * i, 3 * i + 1, 3 * i + 2]);
    }
    shape
}

/// SplitMix64.
// [Steele2014]
pub struct Random(pub u64);

impl Random {
    /// Uniform in [0, 1).
    pub fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1u32 << 24) as f32
    }

    /// Uniform in the unit ball.
    pub fn in_ball(&mut self) -> Vec3 {
        loop {
            let p = 2.0 * Vec3::new(self.unit(), self.unit(), self.unit()) - Vec3::ONE;
            if p.length_squared() < 1.0 {
                return p;
            }
        }
    }

    /// Uniform on the unit sphere.
    pub fn direction(&mut self) -> Vec3 {
        self.in_ball().normalize_or(Vec3::Z)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_have_their_size_and_place() {
        for (class, name) in Class::ALL {
            for count in [1_000, 20_000] {
                let (positions, triangles) = generate(class, count);
                let off = triangles.len() as f64 / count as f64 - 1.0;
                assert!(off.abs() < 0.1, "{name}: {} of {count}", triangles.len());
                assert!(positions.iter().all(|p| p.length() < 1.05), "{name}");
            }
        }
    }
}
