//! Drawing an edge that matters to a point: a tree over edges, descended at random.
//!
//! After the edge sampling of \[Li2018\], section 5.2: at each node one of the two children is
//! taken with a chance that goes with a guess of what its edges bring. The guess is the angle under
//! which the node's edges would be seen if all were, times what the query says of that part of the
//! directions. Edges of surfaces that look all one way as seen from the point are no silhouettes,
//! which a cone around their normals tells. A guess may be wrong at the cost of noise; it is zero
//! only where nothing can be found.

use super::scene_edges::{SceneEdge, SceneEdges};
use crate::trace::geometry::Geometry;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};

/// Edges of a leaf.
const LEAF: usize = 4;
/// Where the point is within or near to a node its edges may be seen under any angle: distances are
/// taken for this part of its radius at least.
const NEAR: f64 = 0.5;

/// What of the directions around a point matters.
pub trait Query {
    /// The point.
    fn origin(&self) -> DVec3;

    /// How much what lies within `spread` of the unit direction `d`, from `distance` on, may matter
    /// at most. A spread of π is any direction.
    fn weight(&self, d: DVec3, spread_rad: f64, distance: f64) -> f64;

    /// The same of an edge between two points, given from the origin; about its mean.
    fn edge_weight(&self, ends: [DVec3; 2]) -> f64;

    /// Whether edges count at which only shading jumps.
    fn wants_shading(&self) -> bool;
}

/// An edge that was drawn.
pub struct Drawn {
    pub edge: u32,
    pub chance: f64,
}

/// A tree over edges.
pub struct EdgeTree {
    nodes: Vec<Node>,
    /// Edges in the order of the leaves.
    order: Vec<u32>,
}

struct Node {
    centre: DVec3,
    radius: f64,
    /// Around the normals: an axis and a half angle.
    axis: DVec3,
    spread_rad: f64,
    /// Lengths of edges that may be silhouettes from some side, from any side, and of those at
    /// which shading jumps.
    folds: f64,
    borders: f64,
    shading: f64,
    content: Content,
}

enum Content {
    Leaf {
        first: u32,
        count: u32,
    },
    /// The first child follows its parent.
    Inner {
        second: u32,
    },
}

/// An edge as the tree is built from it.
struct Item {
    edge: u32,
    ends: [DVec3; 2],
    middle: DVec3,
    normals: [DVec3; 2],
    shading: f64,
}

impl EdgeTree {
    pub fn new(geometry: &Geometry, edges: &SceneEdges) -> Self {
        let item = |(edge, e): (usize, &SceneEdge)| {
            let ends = e.ends.map(|v| geometry.positions[v as usize].as_dvec3());
            Item {
                edge: edge as u32,
                ends,
                middle: ends[0].midpoint(ends[1]),
                normals: e.normals,
                shading: e.shading.importance(),
            }
        };
        let mut items: Vec<Item> = edges.edges.iter().enumerate().map(item).collect();
        let mut tree = Self {
            nodes: Vec::with_capacity(items.len()),
            order: Vec::with_capacity(items.len()),
        };
        if !items.is_empty() {
            tree.build(&mut items);
        }
        tree
    }

    fn build(&mut self, items: &mut [Item]) {
        let at = self.nodes.len();
        let mut node = Node::around(items);
        if items.len() <= LEAF {
            node.content = Content::Leaf {
                first: self.order.len() as u32,
                count: items.len() as u32,
            };
            self.order.extend(items.iter().map(|item| item.edge));
            self.nodes.push(node);
            return;
        }
        let key = widest(items, node.radius);
        let half = items.len() / 2;
        items.select_nth_unstable_by(half, |a, b| {
            key(a).total_cmp(&key(b)).then(a.edge.cmp(&b.edge))
        });
        self.nodes.push(node);
        let (first, second) = items.split_at_mut(half);
        self.build(first);
        let place = self.nodes.len() as u32;
        self.nodes[at].content = Content::Inner { second: place };
        self.build(second);
    }

    /// Draws an edge by a uniform number; `None` where none matters.
    pub fn draw(
        &self,
        geometry: &Geometry,
        edges: &SceneEdges,
        query: &impl Query,
        mut u: f64,
    ) -> Option<Drawn> {
        let mut at = 0;
        let mut chance = 1.0;
        loop {
            match self.nodes.get(at)?.content {
                Content::Inner { second } => {
                    let children = [at + 1, second as usize];
                    let [a, b] = children.map(|c| self.nodes[c].importance(query));
                    let sum = a + b;
                    if sum.is_nan() || sum <= 0.0 {
                        return None;
                    }
                    let first = a / sum;
                    if u < first {
                        (at, u, chance) = (children[0], u / first, chance * first);
                    } else {
                        let rest = 1.0 - first;
                        (at, u, chance) = (children[1], (u - first) / rest, chance * rest);
                    }
                }
                Content::Leaf { first, count } => {
                    let own = &self.order[first as usize..(first + count) as usize];
                    let weights: Vec<f64> = own
                        .iter()
                        .map(|&e| importance(geometry, edges, e, query))
                        .collect();
                    let sum: f64 = weights.iter().sum();
                    if sum.is_nan() || sum <= 0.0 {
                        return None;
                    }
                    let mut rest = u * sum;
                    let last = weights.iter().rposition(|&w| w > 0.0)?;
                    for (i, &weight) in weights.iter().enumerate() {
                        if weight > 0.0 && (rest < weight || i == last) {
                            return Some(Drawn {
                                edge: own[i],
                                chance: chance * weight / sum,
                            });
                        }
                        rest -= weight;
                    }
                    return None;
                }
            }
        }
    }
}

/// The coordinate in which edges differ most, of places and normals, as \[Li2018\]'s six.
fn widest(items: &[Item], radius: f64) -> impl Fn(&Item) -> f64 + use<> {
    let place = move |item: &Item, axis: usize| {
        if axis < 3 {
            item.middle[axis]
        } else {
            (item.normals[0] + item.normals[1])[axis - 3] * (0.5 * radius)
        }
    };
    let extent = |axis: usize| {
        let all = items.iter().map(|item| place(item, axis));
        let low = all.clone().fold(f64::INFINITY, f64::min);
        all.fold(f64::NEG_INFINITY, f64::max) - low
    };
    let axis = (0..6).max_by(|&a, &b| extent(a).total_cmp(&extent(b)));
    let axis = axis.unwrap_or(0);
    move |item: &Item| place(item, axis)
}

impl Node {
    fn around(items: &[Item]) -> Self {
        let ends = || items.iter().flat_map(|item| item.ends);
        let low = ends().fold(DVec3::INFINITY, DVec3::min);
        let high = ends().fold(DVec3::NEG_INFINITY, DVec3::max);
        let centre = low.midpoint(high);
        let radius = ends().map(|p| p.distance(centre)).fold(0.0, f64::max);
        let normals = || items.iter().flat_map(|item| item.normals);
        let axis = normals().sum::<DVec3>().normalize_or_zero();
        // Borders have no normals, and count whatever these say.
        let angles = normals()
            .filter(|n| *n != DVec3::ZERO)
            .map(|n| n.dot(axis).clamp(-1.0, 1.0).acos());
        let mut node = Self {
            centre,
            radius,
            axis,
            spread_rad: angles.fold(0.0, f64::max),
            folds: 0.0,
            borders: 0.0,
            shading: 0.0,
            content: Content::Leaf { first: 0, count: 0 },
        };
        for item in items {
            let length = item.ends[0].distance(item.ends[1]);
            *(if item.normals[0] == DVec3::ZERO {
                &mut node.borders
            } else {
                &mut node.folds
            }) += length;
            node.shading += length * item.shading;
        }
        node
    }

    fn importance(&self, query: &impl Query) -> f64 {
        let way = self.centre - query.origin();
        let distance = way.length();
        let (d, spread) = if distance > self.radius {
            (way / distance, (self.radius / distance).asin())
        } else {
            (DVec3::Z, PI)
        };
        let weight = query.weight(d, spread, (distance - self.radius).max(0.0));
        if weight <= 0.0 {
            return 0.0;
        }
        let wide = self.spread_rad + spread;
        let folds = if wide < FRAC_PI_2 && self.axis.dot(d).abs() > wide.sin() {
            0.0
        } else {
            self.folds
        };
        let shading = if query.wants_shading() {
            self.shading
        } else {
            0.0
        };
        let length = self.borders + folds.max(shading);
        weight * length / distance.max(NEAR * self.radius).max(f64::MIN_POSITIVE)
    }
}

/// What an edge may bring at most: the angle under which it is seen, times the query's weight.
fn importance(geometry: &Geometry, edges: &SceneEdges, edge: u32, query: &impl Query) -> f64 {
    let edge = &edges.edges[edge as usize];
    let o = query.origin();
    let kind = match edges.side(geometry, edge, o) {
        Some(_) => 1.0,
        None if query.wants_shading() => edge.shading.importance(),
        None => 0.0,
    };
    if kind <= 0.0 {
        return 0.0;
    }
    let [a, b] = edge
        .ends
        .map(|v| geometry.positions[v as usize].as_dvec3() - o);
    let angle = a.angle_between(b);
    let weight = query.edge_weight([a, b]);
    let found = kind * angle * weight;
    if found.is_finite() { found } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::discontinuity::adjacency::Adjacency;

    struct Everything(DVec3);

    impl Query for Everything {
        fn origin(&self) -> DVec3 {
            self.0
        }

        fn weight(&self, _: DVec3, _: f64, _: f64) -> f64 {
            1.0
        }

        fn edge_weight(&self, _: [DVec3; 2]) -> f64 {
            1.0
        }

        fn wants_shading(&self) -> bool {
            false
        }
    }

    /// A grid of bumps: some of its folds are silhouettes from above, most are not.
    fn bumps() -> Geometry {
        const SIDE: usize = 12;
        let at = |i: usize, j: usize| {
            let (x, y) = (i as f32, j as f32);
            glam::vec3(x, y, 1.5 * (1.3 * x).sin() * (0.9 * y).cos())
        };
        let positions = (0..SIDE * SIDE).map(|v| at(v % SIDE, v / SIDE)).collect();
        let mut triangles = Vec::new();
        for j in 0..SIDE - 1 {
            for i in 0..SIDE - 1 {
                let v = (j * SIDE + i) as u32;
                let up = v + SIDE as u32;
                triangles.extend([[v, v + 1, up + 1], [v, up + 1, up]]);
            }
        }
        let count = triangles.len();
        Geometry {
            origin: glam::Vec3::ZERO,
            positions,
            mesh_of_triangle: vec![0; count],
            first_vertex: vec![0, (SIDE * SIDE) as u32],
            first_triangle: vec![0, count as u32],
            triangles,
            normals: Vec::new(),
            uvs: Vec::new(),
            smooth: vec![false],
            patterns: vec![None],
            unit: 1.0,
        }
    }

    /// The chances that are told are those with which edges are drawn, and every silhouette has
    /// one.
    #[test]
    fn chances_are_kept() {
        const DRAWS: usize = 200_000;
        let geometry = bumps();
        let adjacency = Adjacency::new(&geometry);
        let edges = SceneEdges::new(&geometry, &adjacency, |_| true);
        let tree = EdgeTree::new(&geometry, &edges);
        let query = Everything(DVec3::new(3.0, -2.0, 2.5));
        let mut met = vec![(0usize, 0.0f64); edges.edges.len()];
        for i in 0..DRAWS {
            let u = (i as f64 + 0.5) / DRAWS as f64;
            if let Some(drawn) = tree.draw(&geometry, &edges, &query, u) {
                let found = &mut met[drawn.edge as usize];
                assert!(found.0 == 0 || (found.1 - drawn.chance).abs() < 1e-12);
                *found = (found.0 + 1, drawn.chance);
            }
        }
        let mut silhouettes = 0;
        for (edge, &(count, chance)) in edges.edges.iter().zip(&met) {
            let is_silhouette = edges.side(&geometry, edge, query.0).is_some();
            silhouettes += usize::from(is_silhouette);
            assert_eq!(is_silhouette, count > 0, "{edge:?}");
            // Numbers at equal distances fall into an interval as often as it is long.
            let expected = chance * DRAWS as f64;
            assert!((count as f64 - expected).abs() <= 2.0, "{count} {expected}");
        }
        assert!(silhouettes > 50 && silhouettes < edges.edges.len());
    }
}
