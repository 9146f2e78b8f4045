//! What of the edges the camera would see in a tile, if nothing stood before them.

use super::set::EdgeSet;
use crate::paths::estimator::FilmTile;
use crate::paths::film::camera::Camera;
use crate::paths::film::lattice::Tile;
use glam::{DVec2, DVec3};

/// The edges that the camera would see in a tile.
pub struct TileEdges {
    pub edges: Vec<FilmEdge>,
    /// Sum of the weighed lengths up to and including each.
    pub cumulative: Vec<f64>,
}

/// What of an edge lies in a tile.
pub struct FilmEdge {
    pub edge: u32,
    /// Film positions.
    pub ends: [DVec2; 2],
    /// How often it is drawn, for its length.
    pub importance: f64,
    /// The sign of F where its surface does not lie; `None` if that goes on.
    pub open_side: Option<f64>,
}

impl TileEdges {
    pub fn new(set: &EdgeSet, film: &FilmTile) -> Self {
        let (view, tile) = (film.view, film.tile);
        let origin = view.camera.origin.as_dvec3();
        let frame = ToFilm::new(&view.camera);
        let mut edges = Vec::new();
        let mut cumulative = Vec::new();
        let mut sum = 0.0;
        for (number, edge) in set.edges.edges.iter().enumerate() {
            let ends = edge
                .ends
                .map(|v| view.geometry.positions[v as usize].as_dvec3() - origin);
            let Some(ends) = frame.clip(ends, view.camera.near_clip, tile) else {
                continue;
            };
            let open_side = set.edges.side(view.geometry, edge, origin).map(|s| -s);
            let importance = match open_side {
                Some(_) => 1.0,
                None => edge.shading.importance(),
            };
            let length = importance * ends[0].distance(ends[1]);
            if length > 0.0 {
                sum += length;
                cumulative.push(sum);
                edges.push(FilmEdge {
                    edge: number as u32,
                    ends,
                    importance,
                    open_side,
                });
            }
        }
        Self { edges, cumulative }
    }
}

/// From the camera's origin to film positions.
struct ToFilm {
    /// Across the film, down it, and ahead; film positions are quotients by the third.
    rows: [DVec3; 3],
}

impl ToFilm {
    fn new(camera: &Camera) -> Self {
        let [x, y, z] = camera.axes.map(|axis| axis.as_dvec3());
        let at = |u, v| DVec2::from(camera.film_to_camera::<f64>(u, v));
        let zero = at(0.0, 0.0);
        let scale = at(1.0, 1.0) - zero;
        let zero = zero - DVec2::from(camera.focus_shift());
        let row = |axis: DVec3, i: usize| (axis / camera.tan_half_x_fov - z * zero[i]) / scale[i];
        Self {
            rows: [row(x, 0), row(y, 1), z],
        }
    }

    /// The film positions of the part of an edge that a tile may see; `None` if there is none.
    fn clip(&self, ends: [DVec3; 2], near: f32, tile: &Tile) -> Option<[DVec2; 2]> {
        let [a, b] = ends.map(|p| DVec3::from(self.rows.map(|row| row.dot(p))));
        let (mut from, mut to) = (0.0f64, 1.0f64);
        let mut keep = |at_a: f64, at_b: f64| {
            if at_a < 0.0 && at_b < 0.0 {
                (from, to) = (1.0, 0.0);
            } else if at_a < 0.0 {
                from = from.max(at_a / (at_a - at_b));
            } else if at_b < 0.0 {
                to = to.min(at_a / (at_a - at_b));
            }
        };
        let nearest = f64::from(near).max(f64::MIN_POSITIVE);
        keep(a.z - nearest, b.z - nearest);
        for i in 0..2 {
            let [low, high] = [tile.start[i], tile.end[i]].map(f64::from);
            keep(a[i] - low * a.z, b[i] - low * b.z);
            keep(high * a.z - a[i], high * b.z - b[i]);
        }
        let part = [from, to].map(|t| a.lerp(b, t));
        let ends = part.map(|p| DVec2::new(p.x, p.y) / p.z);
        (from < to && ends.iter().all(|p| p.is_finite())).then_some(ends)
    }
}
