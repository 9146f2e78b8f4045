//! Ray queries over obvhs's trees, in Rust alone.
//!
//! The library builds the trees and says in which order to visit them; what is met is decided here,
//! by conservative boxes ([`boxes`]) and watertight triangles ([`triangle`]), because its own tests
//! leak at edges. Without [`AccelOptions::robust`] it is the library's own traversal ([`shipped`]).

mod boxes;
mod eight;
mod lanes;
mod ray;
mod shipped;
mod single;
mod stack;
mod tree;
mod triangle;

use super::{
    AccelOptions, Coherence, Hits, MISS, MeshView, ObvhsPreset, ObvhsTree, Rays, TraceError,
};
use eight::Eight;
use lanes::lanes_of;
use obvhs::rt_triangle::RtTriangle;
use ray::Ray;
use single::{NOWHERE, Nearest};
use tree::Tree;
use triangle::Triangle;

/// The version of the library; a test compares it with `Cargo.lock`.
pub const VERSION: &str = "0.4.0";

/// Triangles with a coordinate beyond this are left out, as Embree leaves them out: squares of
/// distances between others are finite.
const LARGEST_COORDINATE: f32 = 1.844e18;

/// A tree and its triangles.
pub struct ObvhsScene {
    tree: Tree,
    /// In the order of the tree's leaves.
    triangles: Vec<Triangle>,
    /// The library's own, if leaks do not matter.
    shipped: Option<Vec<RtTriangle>>,
    kind: ObvhsTree,
    preset: ObvhsPreset,
    threads: usize,
    /// Whether triangles were left out.
    is_partial: bool,
}

impl std::fmt::Debug for ObvhsScene {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "ObvhsScene({} triangles)", self.triangles.len())
    }
}

impl ObvhsScene {
    /// Builds over meshes that [`super::Accel`] has checked.
    pub fn build(
        meshes: &[MeshView],
        options: AccelOptions,
        kind: ObvhsTree,
        preset: ObvhsPreset,
    ) -> Result<Self, TraceError> {
        let triangles = gather(meshes)?;
        let total: usize = meshes.iter().map(|m| m.triangles.len()).sum();
        let is_partial = triangles.len() < total;
        // A pool of its own, or one thread would become all of the machine's. The caller waits
        // meanwhile.
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(options.threads)
            .build()
            .map_err(|e| TraceError::Threads(e.to_string()))?;
        let tree = pool.install(|| Tree::build(&triangles, kind, preset));
        let triangles: Vec<Triangle> = tree
            .order()
            .iter()
            .map(|&i| triangles[i as usize])
            .collect();
        Ok(Self {
            shipped: (!options.robust).then(|| shipped::triangles(&triangles)),
            tree,
            triangles,
            kind,
            preset,
            threads: options.threads,
            is_partial,
        })
    }

    /// Follows moved vertices of the meshes it was built with.
    pub fn refit(&mut self, meshes: &[MeshView]) -> Result<(), TraceError> {
        for triangle in &mut self.triangles {
            triangle.corners = corners(meshes, triangle.mesh, triangle.triangle);
        }
        if self.is_partial || !self.triangles.iter().all(is_near) {
            // Which triangles are left out may have changed.
            let options = AccelOptions::new(self.shipped.is_none(), self.threads);
            *self = Self::build(meshes, options, self.kind, self.preset)?;
            return Ok(());
        }
        self.tree.refit(&self.triangles);
        if let Some(shipped) = &mut self.shipped {
            *shipped = shipped::triangles(&self.triangles);
        }
        Ok(())
    }

    /// First hits, as [`super::Accel::intersect`] promises them.
    #[inline]
    pub fn intersect<const N: usize>(
        &self,
        rays: &Rays<N>,
        active: u32,
        hits: &mut Hits<N>,
        coherence: Coherence,
    ) {
        let asked = active & super::all_lanes::<N>();
        for at in (0..N).step_by(8) {
            let part = asked >> at & 0xff;
            if coherence == Coherence::Coherent
                && let Some(bvh) = self.packets(N)
                && let Some(eight) = Eight::new(rays, at, part)
            {
                let nearest = eight.first(bvh, &self.triangles);
                for lane in lanes_of(part) {
                    self.write(hits, at + lane, nearest[lane]);
                }
                continue;
            }
            for lane in lanes_of(part) {
                let nearest = match Ray::of(rays, at + lane) {
                    Some((ray, tfar)) => self.first(&ray, tfar),
                    None => Nearest::nothing(0.0),
                };
                self.write(hits, at + lane, nearest);
            }
        }
    }

    /// Occlusion, one bit a lane.
    #[inline]
    pub fn occluded<const N: usize>(
        &self,
        rays: &Rays<N>,
        active: u32,
        coherence: Coherence,
    ) -> u32 {
        let asked = active & super::all_lanes::<N>();
        let mut blocked = 0;
        for at in (0..N).step_by(8) {
            let part = asked >> at & 0xff;
            if coherence == Coherence::Coherent
                && let Some(bvh) = self.packets(N)
                && let Some(eight) = Eight::new(rays, at, part)
            {
                blocked |= eight.any(bvh, &self.triangles) << at;
                continue;
            }
            for lane in lanes_of(part) {
                if let Some((ray, tfar)) = Ray::of(rays, at + lane) {
                    blocked |= u32::from(self.any(&ray, tfar)) << (at + lane);
                }
            }
        }
        blocked
    }

    /// The tree, if packets of `n` rays go through it together.
    #[inline]
    fn packets(&self, n: usize) -> Option<&obvhs::cwbvh::CwBvh> {
        match &self.tree {
            Tree::Wide(bvh) if n >= 8 && self.shipped.is_none() && !bvh.nodes.is_empty() => {
                Some(bvh)
            }
            _ => None,
        }
    }

    #[inline]
    fn first(&self, ray: &Ray, tfar: f32) -> Nearest {
        match &self.shipped {
            None => single::first(&self.tree, &self.triangles, ray, tfar),
            Some(triangles) => shipped::first(&self.tree, triangles, shipped::ray(ray, tfar)),
        }
    }

    #[inline]
    fn any(&self, ray: &Ray, tfar: f32) -> bool {
        match &self.shipped {
            None => single::any(&self.tree, &self.triangles, ray, tfar),
            Some(triangles) => shipped::any(&self.tree, triangles, shipped::ray(ray, tfar)),
        }
    }

    #[inline]
    fn write<const N: usize>(&self, hits: &mut Hits<N>, lane: usize, nearest: Nearest) {
        let triangle = (nearest.place != NOWHERE).then(|| &self.triangles[nearest.place as usize]);
        let [u, v] = nearest.meeting.uv;
        (hits.t[lane], hits.u[lane], hits.v[lane]) = match triangle {
            Some(_) => (nearest.meeting.t, u, v),
            None => (f32::INFINITY, 0.0, 0.0),
        };
        (hits.mesh[lane], hits.triangle[lane]) =
            triangle.map_or((MISS, MISS), |t| (t.mesh, t.triangle));
    }

    /// Bytes of tree and triangles.
    pub fn memory_bytes(&self) -> u64 {
        let shipped = self.shipped.as_deref().map_or(0, size_of_val);
        (self.tree.memory_bytes() + size_of_val(&self.triangles[..]) + shipped) as u64
    }

    /// Rays that go through the tree together.
    pub fn native_width(&self) -> usize {
        let together = matches!(self.tree, Tree::Wide(_)) && self.shipped.is_none();
        if together { 8 } else { 1 }
    }
}

fn corners(meshes: &[MeshView], mesh: u32, triangle: u32) -> [[f32; 3]; 3] {
    let view = &meshes[mesh as usize];
    view.triangles[triangle as usize].map(|v| view.positions[v as usize].to_array())
}

fn is_near(triangle: &Triangle) -> bool {
    let coordinates = triangle.corners.as_flattened();
    coordinates.iter().all(|x| x.abs() <= LARGEST_COORDINATE)
}

/// The triangles of all meshes, but for those too far away.
fn gather(meshes: &[MeshView]) -> Result<Vec<Triangle>, TraceError> {
    let total: usize = meshes.iter().map(|m| m.triangles.len()).sum();
    // The last number stands for no triangle, and a tree numbers twice as many nodes.
    if total >= (u32::MAX / 2) as usize || u32::try_from(meshes.len()).is_err() {
        return Err(TraceError::TooLarge {
            mesh: meshes.len() - 1,
            count: total,
        });
    }
    let mut all = Vec::with_capacity(total);
    for (mesh, view) in meshes.iter().enumerate() {
        for triangle in 0..view.triangles.len() as u32 {
            let (mesh, corners) = (mesh as u32, corners(meshes, mesh as u32, triangle));
            all.push(Triangle {
                corners,
                mesh,
                triangle,
            });
        }
    }
    all.retain(is_near);
    Ok(all)
}

#[cfg(test)]
mod tests {
    #[test]
    fn the_version_is_that_of_the_library() {
        let lock = include_str!("../../../Cargo.lock");
        let entry = lock
            .split("[[package]]")
            .find(|p| p.contains("name = \"obvhs\""));
        let version = format!("version = \"{}\"", super::VERSION);
        assert!(entry.is_some_and(|p| p.contains(&version)));
    }
}
