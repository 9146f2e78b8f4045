//! Packets of rays and of hits, laid out as the shim takes them (`ffi/embree_shim.h`).

use glam::Vec3;

/// The mesh and triangle of a ray that met nothing.
pub const MISS: u32 = u32::MAX;

/// Whether the rays of a packet go much the same way. It changes speed, never the answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Coherence {
    /// One origin or nearly, and directions within about 0.03 rad: the packet descends as one.
    Coherent,
    /// Anything else.
    Incoherent,
}

/// The mask in which each of `N` lanes is active.
pub const fn all_lanes<const N: usize>() -> u32 {
    if N >= 32 { u32::MAX } else { (1 << N) - 1 }
}

/// Larger components (other than `tfar`) are beyond what Embree can be asked about.
pub const LARGEST: f32 = 1.8e18;

/// `N` rays. Distances are in units of the direction's length, which need not be 1.
///
/// A lane with a component (other than `tfar`) that is beyond 1.8e18 or no number, or with `tfar <
/// tnear`, meets nothing.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct Rays<const N: usize> {
    pub org_x: [f32; N],
    pub org_y: [f32; N],
    pub org_z: [f32; N],
    /// Hits nearer than this do not count; at least 0.
    pub tnear: [f32; N],
    pub dir_x: [f32; N],
    pub dir_y: [f32; N],
    pub dir_z: [f32; N],
    /// Hits farther than this do not count; may be infinite.
    pub tfar: [f32; N],
}

impl<const N: usize> Default for Rays<N> {
    /// Rays from the origin, without direction and of any length.
    fn default() -> Self {
        Self {
            org_x: [0.0; N],
            org_y: [0.0; N],
            org_z: [0.0; N],
            tnear: [0.0; N],
            dir_x: [0.0; N],
            dir_y: [0.0; N],
            dir_z: [0.0; N],
            tfar: [f32::INFINITY; N],
        }
    }
}

impl<const N: usize> Rays<N> {
    /// Sets one lane.
    pub fn set(&mut self, lane: usize, origin: Vec3, direction: Vec3, tnear: f32, tfar: f32) {
        (self.org_x[lane], self.org_y[lane], self.org_z[lane]) = origin.into();
        (self.dir_x[lane], self.dir_y[lane], self.dir_z[lane]) = direction.into();
        self.tnear[lane] = tnear;
        self.tfar[lane] = tfar;
    }

    /// The origin of one lane.
    pub fn origin(&self, lane: usize) -> Vec3 {
        Vec3::new(self.org_x[lane], self.org_y[lane], self.org_z[lane])
    }

    /// The direction of one lane.
    pub fn direction(&self, lane: usize) -> Vec3 {
        Vec3::new(self.dir_x[lane], self.dir_y[lane], self.dir_z[lane])
    }
}

/// Where `N` rays first meet a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C, align(64))]
pub struct Hits<const N: usize> {
    /// Distance in units of the direction's length; infinite where the ray met nothing.
    pub t: [f32; N],
    /// Weight of the triangle's second vertex; 0 where the ray met nothing.
    pub u: [f32; N],
    /// Weight of the triangle's third vertex; 0 where the ray met nothing.
    pub v: [f32; N],
    /// Index of the mesh, or [`MISS`].
    pub mesh: [u32; N],
    /// Index of the triangle in its mesh, or [`MISS`].
    pub triangle: [u32; N],
}

impl<const N: usize> Default for Hits<N> {
    /// Misses.
    fn default() -> Self {
        Self {
            t: [f32::INFINITY; N],
            u: [0.0; N],
            v: [0.0; N],
            mesh: [MISS; N],
            triangle: [MISS; N],
        }
    }
}
