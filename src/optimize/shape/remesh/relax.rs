//! Points move towards the middle of their neighbours, within the surface.

use super::soup::Soup;
use glam::DVec3;

/// Moves every point that is on no border by the tangential part of the way to the middle of the
/// points it shares a triangle with.
pub fn relax(soup: &mut Soup) {
    let border = soup.on_border(&soup.edges());
    let around = soup.around();
    let moved = |p: usize| -> DVec3 {
        let here = soup.points[p];
        let triangles = &around[p];
        if border[p] || triangles.is_empty() {
            return here;
        }
        let corners = triangles
            .iter()
            .flat_map(|&t| soup.triangles[t])
            .filter(|&q| q != p);
        let (sum, count) = corners.fold((DVec3::ZERO, 0.0), |(sum, count), q| {
            (sum + soup.points[q], count + 1.0)
        });
        let normal: DVec3 = triangles
            .iter()
            .map(|&t| soup.normal(soup.triangles[t]))
            .sum();
        let Some(normal) = normal.try_normalize() else {
            return here;
        };
        let way = sum / count - here;
        here + way - normal * normal.dot(way)
    };
    let points = (0..soup.points.len()).map(moved).collect();
    soup.points = points;
}
