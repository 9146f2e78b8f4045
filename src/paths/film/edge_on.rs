//! Facets that the camera sees edge-on, which have samples of their own.
//!
//! Differentiated at a film point, what is seen of a facet slides over it by one over the cosine c
//! at which it is seen, and a smooth normal turns by as much. A facet of the area A across the view
//! would have A c on the film, so the mean square of what it brings goes with A/c. A lattice seldom
//! hits facets that are seen edge-on, and then finds much: of a ball of 1280 facets 13 had a c
//! below 0.01, 0.06 pixels together, and half of the variance.
//!
//! So points are drawn on the facets with c < C, with the lattice's density times C/c, and only
//! they bring the derivative of the radiance there: the lattice's samples leave it out. The mean
//! square is A/C then. A point through which something else is seen brings nothing. Which facets
//! these are depends on geometry alone, so that the mean is right whatever C is.

use crate::paths::dimensions::Single;
use crate::paths::film::camera::Camera;
use crate::paths::film::lattice::Tile;
use crate::scene::Lens;
use crate::trace::geometry::Geometry;
use rayon::prelude::*;

/// Of a ball they are the part C² on the film, and have 2 C² times its samples; its far side as
/// many.
const MOST_COSINE: f64 = 0.05;
/// Below it single precision does not hit what it aims at.
const LEAST_COSINE: f64 = 2e-4;
/// In pixels. Larger facets are hit often enough, and curve little.
const MOST_AREA: f64 = 1.0;

/// The facets of a film.
pub struct EdgeOnFacets {
    facets: Vec<Facet>,
    /// By triangle.
    is_edge_on: Vec<bool>,
}

/// As it lies on the film.
struct Facet {
    triangle: u32,
    corners: [[f64; 2]; 3],
    /// In pixels.
    area: f64,
    /// Over the lattice's.
    density: f64,
}

/// A point of a facet.
pub struct FacetPoint {
    pub triangle: u32,
    /// On the film.
    pub at: [f64; 2],
    /// One over the density, in pixels.
    pub area: f64,
}

impl EdgeOnFacets {
    /// Of the smooth meshes that move against the camera. `None` if there are none, or if the
    /// camera is no pinhole.
    pub fn new(
        geometry: &Geometry,
        camera: &Camera,
        moves_mesh: impl Fn(usize) -> bool + Sync,
    ) -> Option<Self> {
        if !matches!(camera.lens, Lens::Pinhole) {
            return None;
        }
        let is_smooth = |mesh: usize| geometry.smooth[mesh] && moves_mesh(mesh);
        let triangles = (0..geometry.smooth.len())
            .filter(|&mesh| is_smooth(mesh))
            .map(|mesh| geometry.first_triangle[mesh]..geometry.first_triangle[mesh + 1]);
        let facets: Vec<Facet> = triangles
            .flat_map(|of_mesh| {
                let all = of_mesh.into_par_iter();
                all.filter_map(|t| Facet::new(geometry, camera, t))
                    .collect::<Vec<_>>()
            })
            .collect();
        if facets.is_empty() {
            return None;
        }
        let mut is_edge_on = vec![false; geometry.triangles.len()];
        for facet in &facets {
            is_edge_on[facet.triangle as usize] = true;
        }
        Some(Self { facets, is_edge_on })
    }

    /// Whether a triangle, if it is one, is among them.
    pub fn contains(&self, triangle: u32) -> bool {
        self.is_edge_on.get(triangle as usize) == Some(&true)
    }

    /// Their points in a tile. What falls into others is drawn there as well, and kept there.
    pub fn points<'a>(&'a self, tile: &'a Tile) -> impl Iterator<Item = FacetPoint> + 'a {
        let facets = self.facets.iter().filter(|facet| facet.meets(tile));
        facets
            .flat_map(move |facet| facet.points(tile))
            .filter(|point| tile.contains(point.at))
    }
}

impl Facet {
    fn new(geometry: &Geometry, camera: &Camera, triangle: u32) -> Option<Self> {
        let [eye, forward] = [camera.origin, camera.axes[2]].map(|v| v.as_dvec3());
        let vertices = geometry.triangles[triangle as usize];
        let to = vertices.map(|v| geometry.positions[v as usize].as_dvec3() - eye);
        let [a, b, c] = to;
        let normal = (b - a).cross(c - a);
        let cosine = 3.0 * normal.dot(a).abs() / (normal.length() * (a + b + c).length());
        if !(LEAST_COSINE..MOST_COSINE).contains(&cosine)
            || to
                .iter()
                .any(|v| v.dot(forward) < f64::from(camera.near_clip))
        {
            return None;
        }
        let corners = to.map(|v| camera.film_point(v + eye));
        let [p, q, r] = corners;
        let [s, t] = [q, r].map(|end| [0, 1].map(|i| end[i] - p[i]));
        let area = 0.5 * (s[0] * t[1] - s[1] * t[0]).abs();
        (area > 0.0 && area < MOST_AREA).then_some(Self {
            triangle,
            corners,
            area,
            density: MOST_COSINE / cosine,
        })
    }

    /// Whether it may lie in a tile.
    fn meets(&self, tile: &Tile) -> bool {
        (0..2).all(|i| {
            let along = self.corners.map(|corner| corner[i]);
            let [low, high] = [f64::min, f64::max].map(|of| along.into_iter().reduce(of));
            low < Some(f64::from(tile.end[i])) && high >= Some(f64::from(tile.start[i]))
        })
    }

    /// Uniform over it.
    fn points<'a>(&'a self, tile: &'a Tile) -> impl Iterator<Item = FacetPoint> + 'a {
        let area = tile.step[0] * tile.step[1] / self.density;
        let number = |k, axis| {
            let whole = &tile.whole;
            f64::from(whole.single(Single::FacetPoint, [self.triangle, k, axis]))
        };
        // As many as there would be in the mean, or one more.
        let rounding = number(0, 2);
        let count = (self.area / area + rounding) as u32;
        (0..count).map(move |k| {
            let [mut s, mut t] = [number(k, 0), number(k, 1)];
            if s + t > 1.0 {
                (s, t) = (1.0 - s, 1.0 - t);
            }
            let [p, q, r] = self.corners;
            FacetPoint {
                triangle: self.triangle,
                at: [0, 1].map(|i| p[i] + s * (q[i] - p[i]) + t * (r[i] - p[i])),
                area,
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::paths::film::lattice::Lattice;

    const SPP: u32 = 16;

    fn facet(density: f64) -> Facet {
        let corners = [[1.2, 0.7], [2.9, 0.75], [2.1, 0.8]];
        let area = 0.5 * (1.7 * 0.1 - 0.05 * 0.9);
        Facet {
            triangle: 5,
            corners,
            area,
            density,
        }
    }

    /// Of 4000 films the areas that points stand for add up to the facet's, though there are less
    /// than one in the mean, or a few; and their mean is its middle.
    #[test]
    fn points_stand_for_the_facet() {
        let lattice = Lattice::new(SPP, [4, 4], 0);
        for density in [0.5, 3.0] {
            let facet = facet(density);
            let films = 4000;
            let mut sums = [0.0; 3];
            for seed in 0..films {
                let tile = lattice.tile(0, 0, seed);
                for point in facet.points(&tile) {
                    assert!(tile.contains(point.at));
                    sums[0] += point.area;
                    sums[1] += point.area * point.at[0];
                    sums[2] += point.area * point.at[1];
                }
            }
            let [area, x, y] = sums.map(|sum| sum / films as f64);
            let points = facet.area * density * f64::from(SPP);
            // The scatter of the rounded count is at most a half.
            let error = 0.5 / points / (films as f64).sqrt();
            assert!((area / facet.area - 1.0).abs() < 4.0 * error, "{area}");
            let scatter = 0.4 / (points * films as f64).sqrt();
            let middle = [0, 1].map(|i| facet.corners.iter().map(|c| c[i]).sum::<f64>() / 3.0);
            assert!((x / area - middle[0]).abs() < 4.0 * scatter, "{x}");
            assert!((y / area - middle[1]).abs() < 4.0 * 0.1 * scatter, "{y}");
        }
    }
}
