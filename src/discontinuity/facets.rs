//! What an arc passes over on one surface, triangle by triangle.

use crate::discontinuity::adjacency::Adjacency;
use crate::discontinuity::arc::Arc;
use crate::discontinuity::exit::{Exit, Gauge};
use crate::discontinuity::texture_edges;
use crate::discontinuity::walk::is_torn;
use crate::trace::geometry::Geometry;

/// Triangles crossed before the rest is given up.
const MAX_FACETS: usize = 512;

/// A triangle, the parameter of the arc at which it is left, and the corner at which the edge
/// starts over which it is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Facet {
    pub triangle: u32,
    pub to: f64,
    pub corner: usize,
}

impl Facet {
    /// The edge over which it is left, if shading goes on over it though the plane does not.
    pub fn bend(&self, geometry: &Geometry, adjacency: &Adjacency) -> Option<[u32; 2]> {
        let &Self {
            triangle, corner, ..
        } = self;
        let vertices = geometry.triangles[triangle as usize];
        let across = adjacency.across(triangle, corner)?;
        let is_smooth = geometry.smooth[geometry.mesh_of_triangle[triangle as usize] as usize];
        let is_seam = geometry.pattern(triangle).is_some()
            && texture_edges::is_seam(geometry, triangle, corner, &across);
        let goes_on = is_smooth && !is_seam && !is_torn(geometry, triangle, corner, &across);
        goes_on.then(|| [vertices[corner], vertices[(corner + 1) % 3]])
    }
}

/// The triangles of one surface that an arc passes over, from `start`, which the ray along `arc.a`
/// meets, up to parameter `limit` or the surface's border.
pub fn facets(
    geometry: &Geometry,
    adjacency: &Adjacency,
    arc: &Arc,
    start: u32,
    limit: f64,
) -> Vec<Facet> {
    let gauge = Gauge::new(arc);
    let mut found: Vec<Facet> = Vec::new();
    let mut triangle = start;
    let mut entered_by = None;
    let mut from = 0.0;
    while found.len() < MAX_FACETS {
        let at = geometry.triangles[triangle as usize]
            .map(|v| gauge.of(geometry.positions[v as usize].as_dvec3() - arc.origin));
        let crossings = (0..3).filter_map(|corner| {
            let ends = [at[corner], at[(corner + 1) % 3]];
            let is_way_out = Some(corner) != entered_by && !ends[0].is_on_side_of(ends[1]);
            let exit = is_way_out.then(|| Exit::new(ends[0], ends[1]))?;
            Some((corner, exit.toward_b(), exit.s()))
        });
        let Some((corner, _, to)) = crossings.max_by(|a, b| a.1.total_cmp(&b.1)) else {
            break;
        };
        from = to.clamp(from, limit);
        found.push(Facet {
            triangle,
            to: from,
            corner,
        });
        if to >= limit {
            break;
        }
        let Some(across) = adjacency.across(triangle, corner) else {
            break;
        };
        triangle = across.triangle;
        entered_by = Some(across.corner);
    }
    found
}
