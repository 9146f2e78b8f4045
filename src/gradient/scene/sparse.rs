//! Sums of which most stay zero.

use glam::Vec3;

/// A vector a vertex, most of which stay zero.
#[derive(Default)]
pub struct SparseVectors {
    /// Of each vertex, its place in `touched`, counted from one; zero if it has none.
    places: Vec<u32>,
    touched: Vec<(u32, Vec3)>,
}

impl SparseVectors {
    /// Bytes for each vertex, touched or not.
    pub const BYTES: u64 = size_of::<u32>() as u64;

    pub fn new(len: usize) -> Self {
        Self {
            places: vec![0; len],
            touched: Vec::new(),
        }
    }

    #[inline]
    pub fn add(&mut self, vertex: u32, value: Vec3) {
        let place = &mut self.places[vertex as usize];
        if *place == 0 {
            self.touched.push((vertex, Vec3::ZERO));
            *place = self.touched.len() as u32;
        }
        self.touched[*place as usize - 1].1 += value;
    }

    /// Takes what was added, leaving nothing.
    pub fn drain(&mut self) -> Vec<(u32, Vec3)> {
        for (vertex, _) in &self.touched {
            self.places[*vertex as usize] = 0;
        }
        std::mem::take(&mut self.touched)
    }
}
