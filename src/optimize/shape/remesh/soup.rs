//! Points and triangles while they are changed.

use glam::DVec3;
use std::collections::BTreeMap;

/// Points and triangles. Points that no triangle uses may be among them.
pub struct Soup {
    pub points: Vec<DVec3>,
    pub triangles: Vec<[usize; 3]>,
}

/// By edge, its smaller end first: the triangles that have it.
pub type Edges = BTreeMap<(usize, usize), Vec<usize>>;

impl Soup {
    pub fn edges(&self) -> Edges {
        let mut edges = Edges::new();
        for (i, [a, b, c]) in self.triangles.iter().enumerate() {
            for (u, v) in [(a, b), (b, c), (c, a)] {
                edges.entry((*u.min(v), *u.max(v))).or_default().push(i);
            }
        }
        edges
    }

    pub fn length(&self, (a, b): (usize, usize)) -> f64 {
        self.points[a].distance(self.points[b])
    }

    pub fn mean_edge(&self) -> f64 {
        let edges = self.edges();
        let sum: f64 = edges.keys().map(|edge| self.length(*edge)).sum();
        sum / edges.len().max(1) as f64
    }

    /// Along the normal, twice as long as the triangle is large.
    pub fn normal(&self, [a, b, c]: [usize; 3]) -> DVec3 {
        let p = &self.points;
        (p[b] - p[a]).cross(p[c] - p[a])
    }

    /// The corner of a triangle that an edge has not.
    pub fn opposite(&self, triangle: usize, edge: (usize, usize)) -> usize {
        let corners = self.triangles[triangle];
        let other = corners.into_iter().find(|&c| c != edge.0 && c != edge.1);
        other.unwrap_or(corners[0])
    }

    /// By point, its triangles.
    pub fn around(&self) -> Vec<Vec<usize>> {
        let mut around = vec![Vec::new(); self.points.len()];
        for (i, triangle) in self.triangles.iter().enumerate() {
            for &corner in triangle {
                around[corner].push(i);
            }
        }
        around
    }

    /// By point, whether it is on a border, or where more than two triangles meet.
    pub fn on_border(&self, edges: &Edges) -> Vec<bool> {
        let mut border = vec![false; self.points.len()];
        for ((a, b), triangles) in edges {
            if triangles.len() != 2 {
                (border[*a], border[*b]) = (true, true);
            }
        }
        border
    }

    /// Drops points that no triangle uses.
    pub fn compact(&mut self) {
        let mut new = vec![usize::MAX; self.points.len()];
        let mut kept = Vec::new();
        for corner in self.triangles.iter_mut().flatten() {
            if new[*corner] == usize::MAX {
                new[*corner] = kept.len();
                kept.push(self.points[*corner]);
            }
            *corner = new[*corner];
        }
        self.points = kept;
    }
}
