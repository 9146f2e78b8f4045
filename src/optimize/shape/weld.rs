//! Vertices at one place are one vertex: seams of texture coordinates or normals must not rip.

use glam::Vec3;
use std::collections::HashMap;

/// Which vertices are at one place.
#[derive(Clone, Debug, PartialEq)]
pub struct Weld {
    /// Of each vertex, the place it is at.
    pub place: Vec<usize>,
    /// How many places there are.
    pub places: usize,
}

impl Weld {
    /// By bitwise equal positions; zero has one sign.
    pub fn new(positions: &[Vec3]) -> Self {
        let mut known = HashMap::new();
        let key = |p: &Vec3| (*p + Vec3::ZERO).to_array().map(f32::to_bits);
        let place = positions
            .iter()
            .map(|p| {
                let next = known.len();
                *known.entry(key(p)).or_insert(next)
            })
            .collect();
        Self {
            place,
            places: known.len(),
        }
    }

    /// The triangles of places; those that meet one place twice are none.
    pub fn triangles(&self, triangles: &[[u32; 3]]) -> Vec<[usize; 3]> {
        let welded = triangles.iter().map(|t| t.map(|i| self.place[i as usize]));
        welded
            .filter(|[a, b, c]| a != b && b != c && c != a)
            .collect()
    }

    /// Of three numbers a vertex, the sum at each place.
    pub fn gather(&self, numbers: &[f64]) -> Vec<[f64; 3]> {
        let mut sums = vec![[0.0; 3]; self.places];
        for (place, number) in self.place.iter().zip(numbers.as_chunks::<3>().0) {
            for c in 0..3 {
                sums[*place][c] += number[c];
            }
        }
        sums
    }

    /// Of each place, that of its first vertex.
    pub fn pick(&self, numbers: &[f64]) -> Vec<[f64; 3]> {
        let mut picked = vec![[0.0; 3]; self.places];
        for (place, number) in self.place.iter().zip(numbers.as_chunks::<3>().0).rev() {
            picked[*place] = *number;
        }
        picked
    }

    /// Three numbers of each vertex, which are those of its place.
    pub fn spread(&self, numbers: &[[f64; 3]]) -> Vec<f64> {
        self.place
            .iter()
            .flat_map(|&place| numbers[place])
            .collect()
    }
}
