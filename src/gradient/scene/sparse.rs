//! Sums of which most stay zero.

use glam::Vec3;

/// A vector a vertex, most of which stay zero.
#[derive(Default)]
pub struct SparseVectors {
    values: Vec<Vec3>,
    is_touched: Vec<bool>,
    touched: Vec<u32>,
}

impl SparseVectors {
    pub fn new(len: usize) -> Self {
        Self {
            values: vec![Vec3::ZERO; len],
            is_touched: vec![false; len],
            touched: Vec::new(),
        }
    }

    #[inline]
    pub fn add(&mut self, vertex: u32, value: Vec3) {
        let at = vertex as usize;
        if !self.is_touched[at] {
            self.is_touched[at] = true;
            self.touched.push(vertex);
        }
        self.values[at] += value;
    }

    /// Takes what was added, leaving nothing.
    pub fn drain(&mut self) -> Vec<(u32, Vec3)> {
        let touched = std::mem::take(&mut self.touched);
        touched
            .into_iter()
            .map(|v| {
                self.is_touched[v as usize] = false;
                (v, std::mem::take(&mut self.values[v as usize]))
            })
            .collect()
    }
}
