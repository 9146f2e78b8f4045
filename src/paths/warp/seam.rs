//! What is asked of a method that moves samples.

use crate::lanes::{LANES, Lane, V3};
use crate::paths::at::At;
use crate::paths::bounce::Bounce;
use crate::paths::counts::Counts;
use crate::paths::random::Stream;
use crate::paths::scene_view::SceneView;
use crate::paths::warp::follow::Follow;
use crate::paths::warp::kernel::LobeKernel;

/// A lattice point of the film in each lane.
pub struct FilmPoints<'a> {
    pub view: &'a SceneView<'a>,
    pub u: Lane,
    pub v: Lane,
    pub active: u32,
    pub stream: &'a Stream,
    pub index: &'a [u32; LANES],
}

/// A path through a lattice point of the film, in each lane.
pub struct FilmPath {
    /// The film point that it goes through.
    pub at: [Lane; 2],
    /// What that follows.
    pub follows: Vec<Follow>,
}

/// The bounces of a packet.
pub struct WarpedBounce<'a> {
    pub bounce: Bounce<'a>,
    /// The directions that the kernel is around; the bounce's own where there is none.
    pub axis: V3<Lane>,
    /// Lanes with a kernel.
    pub convolved: u32,
    /// Which of two paths that share their random numbers.
    pub twin: u32,
}

/// What moves the samples.
pub trait Warp: Sync {
    /// The paths through a packet of lattice points: one, or two that share all random numbers but
    /// those of kernels.
    fn film(&self, points: &FilmPoints, counts: &mut Counts) -> Vec<FilmPath>;

    /// Whether a pixel's filter is taken where the film point is. Otherwise at the lattice point
    /// around which that was drawn.
    fn filter_follows(&self) -> bool;

    /// Around what lobes draw.
    fn lobe_kernel(&self) -> Option<LobeKernel>;

    /// Concentration of the kernel around samples of the environment map.
    fn environment_kernel(&self) -> Option<f64>;

    /// Adds what each lane's light sample follows; returns the lanes that do.
    fn light(&self, at: &At, out: &mut Vec<Follow>, counts: &mut Counts) -> u32;

    /// Adds what samples of the environment map follow that were drawn around `axis`.
    fn environment(&self, samples: &MapSamples, out: &mut Vec<Follow>, counts: &mut Counts);

    /// Adds what bounces follow.
    fn bounce(&self, at: &At, bounce: &WarpedBounce, out: &mut Vec<Follow>, counts: &mut Counts);
}

/// Samples of an environment map that are seen.
pub struct MapSamples<'a> {
    pub at: &'a At<'a>,
    pub direction: V3<Lane>,
    /// What the kernel is around.
    pub axis: V3<Lane>,
    /// Lanes that draw one, and those whose sample is seen.
    pub active: u32,
    pub seen: u32,
}
