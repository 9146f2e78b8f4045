//! The table of random dimensions: what every random number is for. Whoever draws one has a row
//! here, and no two share one.
//!
//! There are three kinds. *Pairs* are points of well spread sets, one a vertex and lane
//! (`Numbers::pair`). *Singles* are numbers of their own, named by what they are for and up to
//! three numbers more. *Branches* are streams of their own, for those that draw as many numbers as
//! they happen to need. `tests/architecture` holds each row to one user.

use crate::paths::random::Stream;

/// Pairs of numbers that a vertex of a path draws.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pair {
    /// A light sample's place in the square of its patch.
    LightPoint,
    /// First: which patch.
    LightPatch,
    /// The next direction in its lobe.
    LobeDirection,
    /// First: which lobe.
    LobeChoice,
    /// First: whether the path goes on, and whether its lobe is searched.
    Roulette,
    /// A direction of the environment map.
    EnvironmentDirection,
    /// First: where the points lie on a line over a light. Second: where one more of them lies.
    LightLineAlongS,
    /// The same of the line along the patch's other axis.
    LightLineAlongR,
    /// Which line over the environment map, and where its points lie.
    EnvironmentLine,
    /// First: where one more point of that line lies.
    EnvironmentPoint,
    /// First: where the points lie on a line over a lobe.
    LobeLine,
}

/// Pairs that a vertex draws.
const PAIRS_PER_VERTEX: u32 = Pair::LobeLine as u32 + 1;

impl Pair {
    /// Its dimension in the point sets of a stream, at vertex `depth` of a path.
    pub fn dimension(self, depth: u32) -> u32 {
        depth
            .wrapping_mul(PAIRS_PER_VERTEX)
            .wrapping_add(self as u32)
    }
}

/// Single numbers, with what tells several of them apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Single {
    /// How far a tile's lattice is shifted: axis.
    LatticeShift,
    /// Where a camera ray leaves the lens: sample, axis.
    LensPoint,
    /// Where a point of the pilot lies that says with what the film drifts: node, point, axis.
    DriftPoint,
    /// Where a line of the pilot lies that looks for crowds on the film: block, line, axis.
    CrowdLine,
    /// Which of several edges in a cell of the film: cell.
    FilmEdge,
    /// Whether a cell of the film is searched both of whose ends a delta light's shadow hides:
    /// cell, light.
    FilmShadow,
    /// What smooth surfaces do with the rays of a line of the film's lattice, and what is looked at
    /// there: line, its first point, place in the search.
    FilmChain,
    /// Which family of lines over the environment map, for a packet: index, depth.
    EnvironmentFamily,
    /// Which family of lines over diffuse lobes, for a packet: index, depth.
    DiffuseFamily,
    /// Which family of lines over a lane's narrow lobe: index, depth.
    LobeFamily,
    /// Where among that family: index, depth.
    LobePlace,
    /// Which lane of a packet has a line over its lobe: index, depth, group of lanes.
    LobeLane,
    /// Which of several edges in a cell of a line over a lobe: index, depth, cell.
    LobeEdge,
    /// Where on the edges of a tile of the film a point lies: number of the point.
    FilmEdgePoint,
    /// Which edge over a lobe, and where on it: index, depth, which of the two.
    LobeEdgePoint,
    /// The same of edges before a light.
    LightEdgePoint,
    /// The same of edges before the environment map.
    MapEdgePoint,
    /// Which of the materials that a surface is made of a path meets: index, depth.
    Choice,
    /// What smooth surfaces do with the rays of a line over a lobe, and what is looked at there:
    /// index, depth, place in the search.
    LobeChain,
    /// Whether a sample's velocity is told by one batch of rays more: index, batch.
    Debias,
    /// Where all camera rays of a tile leave the lens: axis.
    TileLensPoint,
    /// Whether a vertex looks for borders: index, depth, over what.
    Looks,
    /// Where such a point of the pilot looks for what is near: node, number of the look, axis.
    DriftLook,
    /// Where a point lies on a facet that is seen edge-on: triangle, point, axis; and, as a third
    /// of the first, whether there is one more.
    FacetPoint,
    /// Whether a packet's diffuse and wide lobes are searched: index, depth.
    LobeLooks,
}

/// Streams of their own, with what tells several of them apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// Paths that begin beside what the camera sees.
    FilmProbe,
    /// Paths that begin beside what a lobe sees: depth.
    LobeProbe,
    /// Paths that begin beside an edge that the camera sees.
    FilmEdgeProbe,
    /// Paths that begin beside an edge that a lobe sees: depth.
    LobeEdgeProbe,
    /// Auxiliary rays that say what a sample follows: use, depth.
    Auxiliary,
    /// Where samples lie in kernels: use, depth, which of two twins.
    Kernel,
    /// Paths through facets that are seen edge-on.
    EdgeOn,
    /// Further paths that begin beside what the camera sees.
    FilmLook,
}

impl Stream {
    /// One uniform number in [0, 1).
    pub fn single(&self, user: Single, numbers: [u32; 3]) -> f32 {
        let [a, b, c] = numbers;
        self.keyed([0, user as u32, a, b, c])
    }

    /// A stream of its own.
    pub fn branch(&self, user: Branch, numbers: [u32; 3]) -> Self {
        let [a, b, c] = numbers;
        self.child([1, user as u32, a, b, c])
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    /// Packets at all vertices of a path, and all uses there, have dimensions of their own.
    #[test]
    fn pairs_do_not_meet() {
        let mut met = BTreeSet::new();
        for depth in 0..200 {
            for ordinal in [
                Pair::LightPoint,
                Pair::LightPatch,
                Pair::LobeDirection,
                Pair::LobeChoice,
                Pair::Roulette,
                Pair::EnvironmentDirection,
                Pair::LightLineAlongS,
                Pair::LightLineAlongR,
                Pair::EnvironmentLine,
                Pair::EnvironmentPoint,
                Pair::LobeLine,
            ] {
                assert!(
                    met.insert(ordinal.dimension(depth)),
                    "{ordinal:?} at {depth}"
                );
            }
        }
    }

    /// Numbers that differ in one word of their names are as good as independent: all pairs of
    /// words nearby are tried.
    #[test]
    fn singles_and_branches_do_not_meet() {
        let stream = Stream::new(11, [2, 3]);
        let users = [Single::LatticeShift, Single::LobeLane, Single::LobeEdge];
        let branches = [Branch::FilmProbe, Branch::LobeProbe];
        let mut met = BTreeSet::new();
        let mut names = 0;
        for a in 0..24 {
            for b in 0..12 {
                for c in 0..4 {
                    for user in users {
                        names += 1;
                        met.insert(stream.single(user, [a, b, c]).to_bits());
                    }
                    for branch in branches {
                        names += 1;
                        let own = stream.branch(branch, [a, b, c]);
                        met.insert(own.single(Single::FilmEdge, [0; 3]).to_bits());
                    }
                }
            }
        }
        // Of 5760 numbers of 24 bits, one meets another by chance: the number is Poisson's.
        assert!(
            names - met.len() < 8,
            "{} of {names} meet",
            names - met.len()
        );
    }
}
