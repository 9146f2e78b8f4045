//! What estimators of boundary terms leave behind: where something jumps, and what that brings.

use crate::discontinuity::boundary::Boundary;
use crate::paths::chain_vertex::ChainVertex;
use crate::paths::counts::Counts;
use crate::paths::integral::Integral;
use crate::scene::Rgb;

/// A place where an integrand jumps, in one of the integrals along a path.
///
/// With F the boundary's function (`discontinuity::boundary`) and Ḟ its derivative at the fixed
/// coordinate `at`, the sample adds `weight`·Ḟ to the gradient.
#[derive(Clone, Copy, Debug)]
pub struct BoundarySample {
    pub boundary: Boundary,
    /// Given if the boundary is that of a delta light's shadow.
    pub shadow: Option<Shadow>,
    /// Of the packet whose vertex it belongs to; of no meaning on the film.
    pub lane: u8,
    pub at: Coordinate,
    /// The smooth surfaces through which it is seen, as a range of [`Found::chains`].
    pub chain: [u32; 2],
    /// Radiance per unit of Ḟ, all at θ₀; on the film in radiance times pixels.
    pub weight: Rgb,
    /// About what the radiance of a path jumps by from one side to the other, as the length of
    /// its channels.
    pub jump: f32,
}

/// A boundary that is seen toward a delta light, from where the ray at the coordinate meets a
/// triangle.
#[derive(Clone, Copy, Debug)]
pub struct Shadow {
    /// Among the scene's delta lights.
    pub light: u32,
    /// The triangle that the shadow falls on.
    pub receiver: u32,
}

/// The chain of what is seen directly.
pub const NO_CHAIN: [u32; 2] = [0; 2];

/// A straight piece of a border on the film. All those of one crossing have a length of two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// A length of one along it, in pixels; zero for a point.
    pub half: [f64; 2],
    /// From where to where it reaches from its place, in such lengths.
    pub part: [f64; 2],
}

impl Piece {
    /// The point alone.
    pub const POINT: Self = Self {
        half: [0.0; 2],
        part: [-1.0, 1.0],
    };
}

/// What stays fixed while the boundary moves.
#[derive(Clone, Copy, Debug)]
pub enum Coordinate {
    /// Film position in pixels, and the piece of border for which the sample stands, from there.
    Film { at: [f64; 2], piece: Piece },
    /// A point in the square of a light's patch.
    Light { patch: u32, at: [f64; 2] },
    /// A world direction (unit) that keeps its place on the environment map.
    Environment([f64; 3]),
    /// The lobe's coordinate in the frame of the shading normal (`kernels::bsdf`).
    Lobe([f64; 3]),
}

impl Coordinate {
    /// The integral that it is a coordinate of.
    pub fn integral(&self) -> Integral {
        match self {
            Coordinate::Film { .. } => Integral::Film,
            Coordinate::Light { .. } => Integral::Lights,
            Coordinate::Environment(_) => Integral::Environment,
            Coordinate::Lobe(_) => Integral::Lobes,
        }
    }
}

/// What an estimator found, and what that took.
#[derive(Default)]
pub struct Found {
    pub samples: Vec<BoundarySample>,
    /// Of all samples, one after another.
    pub chains: Vec<ChainVertex>,
    pub counts: Counts,
}

impl Found {
    /// Keeps a chain for the samples that are seen through it.
    pub fn add_chain(&mut self, chain: &[ChainVertex]) -> [u32; 2] {
        let first = self.chains.len() as u32;
        self.chains.extend_from_slice(chain);
        [first, self.chains.len() as u32]
    }

    /// The smooth surfaces through which a sample is seen.
    pub fn chain(&self, sample: &BoundarySample) -> &[ChainVertex] {
        let [from, to] = sample.chain.map(|i| i as usize);
        &self.chains[from..to]
    }

    /// Looks for the borders of an integral, and counts them.
    pub fn search(&mut self, integral: Integral, search: impl FnOnce(&mut Self)) {
        let (samples, lost) = (self.samples.len(), self.counts.unresolved);
        search(self);
        let borders = &mut self.counts.borders[integral];
        borders.found += (self.samples.len() - samples) as u64;
        borders.lost += self.counts.unresolved - lost;
    }

    /// Forgets everything, and keeps the memory.
    pub fn clear(&mut self) {
        self.samples.clear();
        self.chains.clear();
        self.counts = Counts::default();
    }
}
