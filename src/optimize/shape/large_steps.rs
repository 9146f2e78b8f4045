//! Large steps: vertices as a smooth function of what the optimiser moves \[Nicolet2021\].
//!
//! u = (I + λL)v with the uniform Laplacian L of the welded mesh: its diagonal has the number of
//! neighbours, and −1 stands for each neighbour. The optimiser moves u, and the gradient by it is
//! (I + λL)⁻¹ times that by v, since the matrix is symmetric. One sparse Cholesky factorisation
//! serves all steps.

use super::weld::Weld;
use faer::Mat;
use faer::linalg::solvers::Solve;
use faer::sparse::linalg::solvers::Llt;
use faer::sparse::{SparseColMat, Triplet};
use glam::Vec3;

/// The map between vertices and what the optimiser moves.
pub struct LargeSteps {
    weld: Weld,
    lambda: f64,
    neighbours: Vec<Vec<usize>>,
    factor: Llt<usize, f64>,
}

impl LargeSteps {
    /// Factorises the matrix of a mesh.
    pub fn new(positions: &[Vec3], triangles: &[[u32; 3]], lambda: f64) -> Result<Self, String> {
        let weld = Weld::new(positions);
        let neighbours = neighbours(&weld, triangles);
        let mut entries = Vec::new();
        for (i, around) in neighbours.iter().enumerate() {
            entries.push(Triplet::new(i, i, 1.0 + lambda * around.len() as f64));
            entries.extend(around.iter().map(|&j| Triplet::new(i, j, -lambda)));
        }
        let n = weld.places;
        let factor = SparseColMat::<usize, f64>::try_new_from_triplets(n, n, &entries)
            .map_err(|error| format!("{error:?}"))
            .and_then(|matrix| {
                let factor = matrix.sp_cholesky(faer::Side::Lower);
                factor.map_err(|error| format!("{error:?}"))
            })
            .map_err(|error| format!("the matrix of large_steps cannot be factorised: {error}"))?;
        Ok(Self {
            weld,
            lambda,
            neighbours,
            factor,
        })
    }

    /// What the optimiser moves, of three coordinates a vertex.
    pub fn latent(&self, values: &[f64]) -> Vec<f64> {
        let v = self.weld.pick(values);
        let of = |i: usize| {
            let around = &self.neighbours[i];
            [0, 1, 2].map(|c| {
                let sum: f64 = around.iter().map(|&j| v[j][c]).sum();
                v[i][c] + self.lambda * (around.len() as f64 * v[i][c] - sum)
            })
        };
        (0..v.len()).flat_map(of).collect()
    }

    /// Three coordinates a vertex.
    pub fn values(&self, latent: &[f64]) -> Vec<f64> {
        self.weld.spread(&self.solve(latent.as_chunks::<3>().0))
    }

    /// The gradient by what the optimiser moves, of that by the vertices.
    pub fn pull_back(&self, gradient: &[f64]) -> Vec<f64> {
        let gathered = self.weld.gather(gradient);
        self.solve(&gathered).into_iter().flatten().collect()
    }

    fn solve(&self, right: &[[f64; 3]]) -> Vec<[f64; 3]> {
        let columns = Mat::from_fn(right.len(), 3, |i, c| right[i][c]);
        let solved = self.factor.solve(&columns);
        (0..right.len())
            .map(|i| [0, 1, 2].map(|c| solved[(i, c)]))
            .collect()
    }
}

/// Places that share an edge, each list in order.
fn neighbours(weld: &Weld, triangles: &[[u32; 3]]) -> Vec<Vec<usize>> {
    let mut lists = vec![Vec::new(); weld.places];
    for [a, b, c] in weld.triangles(triangles) {
        for (i, j) in [(a, b), (b, c), (c, a)] {
            lists[i].push(j);
            lists[j].push(i);
        }
    }
    for list in &mut lists {
        list.sort_unstable();
        list.dedup();
    }
    lists
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An octahedron, one corner of which is two vertices at one place.
    fn mesh() -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let positions = vec![
            Vec3::X,
            Vec3::NEG_X,
            Vec3::Y,
            Vec3::NEG_Y,
            Vec3::Z,
            Vec3::NEG_Z,
            Vec3::Z,
        ];
        let triangles = vec![
            [0, 2, 4],
            [2, 1, 4],
            [1, 3, 6],
            [3, 0, 6],
            [2, 0, 5],
            [1, 2, 5],
            [3, 1, 5],
            [0, 3, 5],
        ];
        (positions, triangles)
    }

    /// Gaussian elimination with pivots.
    fn dense(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
        let n = rows.len();
        for k in 0..n {
            let pivot = (k..n)
                .max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs()))
                .unwrap();
            rows.swap(k, pivot);
            for i in 0..n {
                if i != k {
                    let f = rows[i][k] / rows[k][k];
                    let pivot = rows[k].clone();
                    for (x, y) in rows[i].iter_mut().zip(pivot) {
                        *x -= f * y;
                    }
                }
            }
        }
        (0..n).map(|i| rows[i][n] / rows[i][i]).collect()
    }

    #[test]
    fn the_sparse_solve_is_the_dense_one() {
        let (positions, triangles) = mesh();
        let map = LargeSteps::new(&positions, &triangles, 19.0).unwrap();
        assert_eq!(map.weld.places, 6);
        let gradient: Vec<f64> = (0..21).map(|i| (f64::from(i) * 0.7).sin()).collect();
        let found = map.pull_back(&gradient);
        let gathered = map.weld.gather(&gradient);
        // Every corner of an octahedron has four neighbours: all but itself and the opposite one.
        for c in 0..3 {
            let row = |i: usize| {
                let entry = |j: usize| match j {
                    j if j == i => 1.0 + 4.0 * 19.0,
                    j if j == (i ^ 1) => 0.0,
                    _ => -19.0,
                };
                let mut row: Vec<f64> = (0..6).map(entry).collect();
                row.push(gathered[i][c]);
                row
            };
            let wanted = dense((0..6).map(row).collect());
            for (i, wanted) in wanted.iter().enumerate() {
                assert!((found[3 * i + c] - wanted).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn there_and_back_again_without_ripping_seams() {
        let (positions, triangles) = mesh();
        let map = LargeSteps::new(&positions, &triangles, 30.0).unwrap();
        let values: Vec<f64> = positions
            .iter()
            .flat_map(|p| p.as_dvec3().to_array())
            .collect();
        let mut latent = map.latent(&values);
        for (a, b) in map.values(&latent).iter().zip(&values) {
            assert!((a - b).abs() < 1e-12);
        }
        latent[13] += 1.0;
        let moved = map.values(&latent);
        assert_eq!(moved[12..15], moved[18..21]);
        // ⟨g, dv⟩ = ⟨gradient by u, du⟩.
        let gradient: Vec<f64> = (0..21).map(f64::from).collect();
        let pulled = map.pull_back(&gradient)[13];
        let pushed: f64 = moved
            .iter()
            .zip(&values)
            .zip(&gradient)
            .map(|((a, b), g)| (a - b) * g)
            .sum();
        assert!((pulled - pushed).abs() < 1e-9);
    }
}
