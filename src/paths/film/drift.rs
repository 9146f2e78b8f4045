//! The film's drift: a velocity field that carries the film's samples along with what they see.
//!
//! Differentiated at a fixed film point, what a sample sees slides over the surface: by one over
//! the sine of a grazing angle, and with its normal, along which a narrow lobe turns its light.
//! Over curved metal or glass this has a noise many times that of the image. For any smooth field V
//! over the film, with f the radiance and h a pixel's filter,
//!
//!   ∂∫h f = ∫ h (∂f + V·∇f + f ∇·V) + f V·∇h  +  Σ_borders h (V_b − V)·n (f₋ − f₊),
//!
//! because the integral of ∇·(h f V) over the film vanishes if V does at its rim. The first terms
//! are those of a sample whose film point moves by V. If V is about the velocity of the surface
//! that is seen, nothing slides: what is left of them is the noise of an image. The borders bring
//! what they do not share with V. This is the change of variables of Loubet et al. (2019) with
//! their choice of what to follow, points that were hit, but with a field that need not agree with
//! any border, because borders are found as everywhere else.
//!
//! V is fixed before any sample is drawn that it is applied to, so that the mean is right whatever
//! V is. It is interpolated between *nodes*, whose velocities are means of those of a few points
//! that a pilot has hit. So it is linear in the velocities of vertices and camera, and the backward
//! sweep can hand it on to them.

use crate::lanes::{LANES, Lane};
use crate::paths::film::camera::Camera;
use crate::paths::film::lattice::{Lattice, Tile};
use crate::trace::geometry::Geometry;
use glam::DVec3;

/// Pixels between nodes, about.
const SPACING: f64 = 2.0;
/// Along an axis there are no more intervals than this, whatever the film's size: it bounds the
/// memory, and on large films everything is large.
const MOST_INTERVALS: f64 = 256.0;

/// A point of a surface that a node follows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Followed {
    /// Vertices of its triangle, and its barycentrics.
    pub triangle: [u32; 3],
    pub barycentrics: [f64; 3],
    /// The film point at which it is seen.
    pub at: [f64; 2],
    /// What the node's velocity has of its own.
    pub share: f64,
}

/// The nodes of a film: a grid from rim to rim, on which it rests.
#[derive(Clone, Debug, PartialEq)]
pub struct DriftGrid {
    start: [f64; 2],
    /// Pixels between nodes.
    pub spacing: [f64; 2],
    /// Along x and y.
    pub nodes: [usize; 2],
}

/// What the nodes follow.
#[derive(PartialEq)]
pub struct Drift {
    pub grid: DriftGrid,
    pub followed: Vec<Vec<Followed>>,
    /// Whether nodes follow what lies flat upon something else: at rest a few samples that are
    /// hardly ever met would have most of the noise.
    pub holds_sheets: bool,
}

/// Velocities of all nodes along one direction of parameters, in pixels.
pub struct DriftVelocity {
    grid: DriftGrid,
    nodes: Vec<[f64; 2]>,
}

/// A node's share in the velocity at a point, and how that changes per pixel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Share {
    pub node: usize,
    pub weight: f64,
    pub gradient: [f64; 2],
}

impl DriftGrid {
    /// For the domain that a film's lattice samples.
    pub fn new(lattice: &Lattice) -> Self {
        let extent = [0, 1].map(|i| f64::from(lattice.end[i] - lattice.start[i]));
        let cells = extent.map(|e| (e / SPACING).round().clamp(1.0, MOST_INTERVALS));
        Self {
            start: lattice.start.map(f64::from),
            spacing: [0, 1].map(|i| extent[i] / cells[i]),
            nodes: cells.map(|c| c as usize + 1),
        }
    }

    /// The film point of a node.
    pub fn position(&self, node: usize) -> [f64; 2] {
        let at = [node % self.nodes[0], node / self.nodes[0]];
        [0, 1].map(|i| self.start[i] + at[i] as f64 * self.spacing[i])
    }

    /// Whether a node lies on the rim.
    pub fn is_rim(&self, node: usize) -> bool {
        let at = [node % self.nodes[0], node / self.nodes[0]];
        (0..2).any(|i| at[i] == 0 || at[i] + 1 == self.nodes[i])
    }

    /// Of the four nodes around a point, the first; the nearest four for points beyond the rim.
    fn cell(&self, at: [f64; 2]) -> [usize; 2] {
        [0, 1].map(|i| {
            let place = (at[i] - self.start[i]) / self.spacing[i];
            place.floor().clamp(0.0, self.nodes[i] as f64 - 2.0) as usize
        })
    }

    /// The shares of the nodes around a point; bilinear.
    pub fn shares(&self, at: [f64; 2]) -> [Share; 4] {
        let cell = self.cell(at);
        let axis = |i: usize| {
            let part = (at[i] - self.start[i]) / self.spacing[i] - cell[i] as f64;
            // Outer lattice points lie beyond the rim, where there is no drift.
            (cell[i], part, (0.0..=1.0).contains(&part))
        };
        let [(x, s, in_x), (y, t, in_y)] = [axis(0), axis(1)];
        if !(in_x && in_y) {
            return [Share::default(); 4];
        }
        [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[i, j]| {
            let (wx, gx) = if i == 0 { (1.0 - s, -1.0) } else { (s, 1.0) };
            let (wy, gy) = if j == 0 { (1.0 - t, -1.0) } else { (t, 1.0) };
            Share {
                node: (y + j) * self.nodes[0] + x + i,
                weight: wx * wy,
                gradient: [gx * wy / self.spacing[0], wx * gy / self.spacing[1]],
            }
        })
    }
}

/// A line through a followed point along one axis of the film, which tells of its motion along the
/// other: with F that of an edge (`kernels::silhouette`).
pub struct FilmLine {
    /// In the world.
    pub along: DVec3,
    /// Velocity in pixels per unit of Ḟ.
    pub velocity_per_side: f64,
}

impl Followed {
    /// The point in the world.
    pub fn point(&self, geometry: &Geometry) -> DVec3 {
        let corner = |(&v, b): (&u32, f64)| geometry.positions[v as usize].as_dvec3() * b;
        let corners = self.triangle.iter().zip(self.barycentrics);
        corners.map(corner).sum()
    }

    /// The lines that tell of its motion along the film's axes.
    pub fn lines(&self, camera: &Camera, geometry: &Geometry) -> [FilmLine; 2] {
        let per_pixel = camera.direction_per_pixel();
        let to = self.point(geometry) - camera.eye();
        [0, 1].map(|axis| {
            // Of any length; where directions hardly part it must be felt beside the point.
            let along = per_pixel[1 - axis] * camera.reach().max(1.0);
            FilmLine {
                along,
                velocity_per_side: -1.0 / to.cross(along).dot(per_pixel[axis]),
            }
        })
    }
}

impl Drift {
    /// Whether the film may drift at a point.
    pub fn moves(&self, at: [f64; 2]) -> bool {
        let shares = self.grid.shares(at);
        shares.iter().any(|s| !self.followed[s.node].is_empty())
    }

    /// The lanes of a row of film points at which it may.
    pub fn lanes(&self, u: Lane, v: Lane) -> u32 {
        let (u, v) = (u.to_array(), v.to_array());
        (0..LANES)
            .filter(|&l| self.moves([f64::from(u[l]), f64::from(v[l])]))
            .fold(0, |bits, l| bits | 1 << l)
    }

    /// The velocities of all nodes, given those of what is followed.
    pub fn velocity(&self, of: impl Fn(&Followed) -> [f64; 2]) -> DriftVelocity {
        let node = |followed: &Vec<Followed>| {
            followed.iter().fold([0.0; 2], |sum, f| {
                let own = of(f);
                [0, 1].map(|i| sum[i] + f.share * own[i])
            })
        };
        DriftVelocity {
            grid: self.grid.clone(),
            nodes: self.followed.iter().map(node).collect(),
        }
    }
}

impl DriftVelocity {
    /// Velocity in pixels, and its divergence, at a film point.
    pub fn at(&self, at: [f64; 2]) -> ([f64; 2], f64) {
        let (velocity, [[xx, _], [_, yy]]) = self.with_slopes(at);
        (velocity, xx + yy)
    }

    /// Where a film point is carried to in a time, and how many times as large the film is around
    /// it then.
    pub fn carry(&self, at: [f64; 2], time: f64) -> ([f64; 2], f64) {
        let (velocity, slopes) = self.with_slopes(at);
        let [[xx, xy], [yx, yy]] = slopes.map(|row| row.map(|slope| time * slope));
        let place = [0, 1].map(|i| at[i] + time * velocity[i]);
        (place, (1.0 + xx) * (1.0 + yy) - xy * yx)
    }

    /// Whether it is zero all over a tile.
    pub fn rests_over(&self, tile: &Tile) -> bool {
        let ends = [tile.start, tile.end].map(|at| at.map(f64::from));
        let [low, high] = ends.map(|at| self.grid.cell(at));
        let rows = low[1]..=high[1] + 1;
        rows.flat_map(|y| (low[0]..=high[0] + 1).map(move |x| (x, y)))
            .all(|(x, y)| self.nodes[y * self.grid.nodes[0] + x] == [0.0; 2])
    }

    /// Velocity in pixels, and how each of its components changes per pixel along both axes.
    fn with_slopes(&self, at: [f64; 2]) -> ([f64; 2], [[f64; 2]; 2]) {
        let mut velocity = [0.0; 2];
        let mut slopes = [[0.0; 2]; 2];
        for share in self.grid.shares(at) {
            let node = self.nodes[share.node];
            for (i, slope) in slopes.iter_mut().enumerate() {
                velocity[i] += share.weight * node[i];
                slope[0] += share.gradient[0] * node[i];
                slope[1] += share.gradient[1] * node[i];
            }
        }
        (velocity, slopes)
    }

    /// The same with no node faster than this, in pixels.
    pub fn no_faster_than(mut self, most: f64) -> Self {
        for node in &mut self.nodes {
            let speed = node[0].hypot(node[1]);
            if speed > most {
                *node = node.map(|v| v * most / speed);
            }
        }
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn swirl() -> DriftVelocity {
        let grid = DriftGrid::new(&Lattice::new(4, [7, 5], 2));
        let velocity = |node: usize| match grid.is_rim(node) {
            true => [0.0; 2],
            false => [(node as f64).sin(), (2.0 * node as f64).cos()],
        };
        let nodes = (0..grid.nodes[0] * grid.nodes[1]).map(velocity).collect();
        DriftVelocity { grid, nodes }
    }

    /// How much the film grows is the determinant of what points are carried to, and in sum the
    /// film is carried onto itself.
    #[test]
    fn a_film_is_carried_onto_itself() {
        let swirl = swirl().no_faster_than(0.9);
        let time = 0.3;
        let grid = &swirl.grid;
        let intervals = grid.nodes.map(|n| n - 1);
        // The growth is bilinear between nodes, so the mean of points that lie evenly is right.
        let per_interval = 7;
        let step = grid.spacing.map(|spacing| spacing / per_interval as f64);
        let mut area = 0.0;
        for i in 0..per_interval * intervals[0] {
            for j in 0..per_interval * intervals[1] {
                let at = [(0, i), (1, j)].map(|(k, n)| grid.start[k] + step[k] * (n as f64 + 0.5));
                let (_, growth) = swirl.carry(at, time);
                assert!(growth > 0.0, "{at:?}");
                area += growth * step[0] * step[1];
                let h = 1e-6;
                let [right, left, down, up] = [[h, 0.0], [-h, 0.0], [0.0, h], [0.0, -h]]
                    .map(|by| swirl.carry([at[0] + by[0], at[1] + by[1]], time).0);
                let [xx, yx] = [0, 1].map(|i| (right[i] - left[i]) / (2.0 * h));
                let [xy, yy] = [0, 1].map(|i| (down[i] - up[i]) / (2.0 * h));
                assert!((growth - (xx * yy - xy * yx)).abs() < 1e-6, "{at:?}");
            }
        }
        assert!((area - 99.0).abs() < 1e-6, "{area}");
    }

    #[test]
    fn a_tile_rests_if_all_its_nodes_do() {
        let lattice = Lattice::new(4, [64, 64], 2);
        let grid = DriftGrid::new(&lattice);
        let mut nodes = vec![[0.0; 2]; grid.nodes[0] * grid.nodes[1]];
        nodes[2 * grid.nodes[0] + 2] = [1.0, 0.0];
        let velocity = DriftVelocity { grid, nodes };
        for index in 0..lattice.tile_count() {
            let tile = lattice.tile(index, 0, 1);
            let is_first = tile.start == [-2; 2];
            assert_eq!(velocity.rests_over(&tile), !is_first, "{tile:?}");
        }
    }
}
