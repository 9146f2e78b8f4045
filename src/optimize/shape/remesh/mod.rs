//! New triangles of even size over a surface: split, collapse, flip and relax \[Botsch2004\].
//!
//! Vertices are relaxed within their tangent planes; unlike in the paper they are not projected
//! back to the old surface, from which they stray by a second-order amount. Borders stay as they
//! are.

mod collapse;
mod flip;
mod relax;
mod soup;
mod split;

use super::weld::Weld;
use glam::{DVec3, Vec3};
use soup::Soup;

/// Rounds of all four.
const ROUNDS: usize = 5;
/// Edges longer and shorter than these factors of the length aimed at are split and collapsed.
const LONGEST: f64 = 4.0 / 3.0;
const SHORTEST: f64 = 4.0 / 5.0;

/// Remeshes; edges get about `factor` times the mean length of those that are there. Vertices at
/// one place become one.
pub fn remesh(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    factor: f64,
) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    let weld = Weld::new(positions);
    let numbers: Vec<f64> = positions
        .iter()
        .flat_map(|p| p.as_dvec3().to_array())
        .collect();
    let mut soup = Soup {
        points: weld.pick(&numbers).into_iter().map(DVec3::from).collect(),
        triangles: weld.triangles(triangles),
    };
    let length = factor * soup.mean_edge();
    for _ in 0..ROUNDS {
        split::split(&mut soup, LONGEST * length);
        collapse::collapse(&mut soup, SHORTEST * length, LONGEST * length);
        flip::flip(&mut soup);
        relax::relax(&mut soup);
    }
    soup.compact();
    let points = soup.points.iter().map(|p| p.as_vec3()).collect();
    let triangles = soup.triangles.iter().map(|t| t.map(|i| i as u32)).collect();
    (points, triangles)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    /// A unit sphere of rings, whose triangles are small at the poles.
    fn globe(rings: usize, sectors: usize) -> (Vec<Vec3>, Vec<[u32; 3]>) {
        let mut points = vec![Vec3::Z];
        for ring in 1..rings {
            let t = std::f32::consts::PI * ring as f32 / rings as f32;
            for sector in 0..sectors {
                let p = std::f32::consts::TAU * sector as f32 / sectors as f32;
                points.push(Vec3::new(t.sin() * p.cos(), t.sin() * p.sin(), t.cos()));
            }
        }
        points.push(Vec3::NEG_Z);
        let last = points.len() as u32 - 1;
        let at = |ring: usize, sector: usize| (1 + (ring - 1) * sectors + sector % sectors) as u32;
        let mut triangles = Vec::new();
        for s in 0..sectors {
            triangles.push([0, at(1, s), at(1, s + 1)]);
            triangles.push([last, at(rings - 1, s + 1), at(rings - 1, s)]);
            for ring in 1..rings - 1 {
                triangles.push([at(ring, s), at(ring + 1, s), at(ring + 1, s + 1)]);
                triangles.push([at(ring, s), at(ring + 1, s + 1), at(ring, s + 1)]);
            }
        }
        (points, triangles)
    }

    #[test]
    fn a_globe_stays_closed_round_and_gets_even() {
        let (points, triangles) = globe(12, 30);
        let (new, faces) = remesh(&points, &triangles, 0.8);
        // Closed, every edge twice and in both directions; Euler's number of a sphere.
        let mut edges: BTreeMap<(u32, u32), i32> = BTreeMap::new();
        for t in &faces {
            for i in 0..3 {
                *edges.entry((t[i], t[(i + 1) % 3])).or_default() += 1;
            }
        }
        assert!(
            edges
                .iter()
                .all(|(e, n)| *n == 1 && edges.contains_key(&(e.1, e.0)))
        );
        assert_eq!(
            new.len() as i64 - edges.len() as i64 / 2 + faces.len() as i64,
            2
        );
        let radii = new.iter().map(|p| p.length());
        let (low, high) = radii.fold((2.0f32, 0.0f32), |(a, b), r| (a.min(r), b.max(r)));
        assert!(low > 0.93 && high < 1.01, "{low} {high}");
        let spread = |points: &[Vec3], faces: &[[u32; 3]]| {
            let lengths: Vec<f32> = faces
                .iter()
                .flat_map(|t| {
                    (0..3)
                        .map(|i| (t[i] as usize, t[(i + 1) % 3] as usize))
                        .collect::<Vec<_>>()
                })
                .map(|(a, b)| points[a].distance(points[b]))
                .collect();
            let mean = lengths.iter().sum::<f32>() / lengths.len() as f32;
            let squares: f32 = lengths.iter().map(|l| (l / mean - 1.0).powi(2)).sum();
            (squares / lengths.len() as f32).sqrt()
        };
        let (before, after) = (spread(&points, &triangles), spread(&new, &faces));
        assert!(after < 0.5 * before, "{before} {after}");
    }

    #[test]
    fn borders_stay() {
        let points = vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::X + Vec3::Y];
        let (new, faces) = remesh(&points, &[[0, 1, 2], [1, 3, 2]], 0.4);
        assert!(points.iter().all(|p| new.contains(p)));
        assert!(!faces.is_empty());
    }
}
