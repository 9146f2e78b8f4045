//! Which methods there are, and what each can do.
//!
//! Everything else asks for an ability and never for a name. A method that is added here is known
//! to jobs, batches, refusals and the command line.
//!
//! What an estimator of boundaries declares of itself (the discontinuities it finds, and whether it
//! has a reverse mode) belongs in the rows of [`ESTIMATORS`], with the estimator itself beside it.

use crate::boundary::cells::Cells;
use crate::boundary::edges::Edges;
use crate::boundary::mixture::{Mixed, Mixture};
use crate::discontinuity::adjacency::Adjacency;
use crate::paths::estimator::BoundaryEstimator;
use crate::paths::moving::Moving;
use crate::scene::Film;
use crate::warp::options::WarpOptions;
use crate::warp::{loubet, warped_area};
use schemars::JsonSchema;
use serde::Deserialize;

// No comments on these: what is said of them stands once, in the table.
/// An estimator.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
#[schemars(rename = "MethodName")]
pub enum Method {
    Reparam,
    Edges,
    Loubet,
    WarpedArea,
    Interior,
    Fd,
    CarriedFd,
    #[default]
    Auto,
}

/// A method with what is said of it and what it can do.
#[derive(Debug)]
pub struct Estimator {
    pub method: Method,
    /// As it is typed, and as it stands in reports.
    pub name: &'static str,
    /// In words, where a sentence names it.
    pub title: &'static str,
    /// For those who choose.
    pub about: &'static str,
    pub discontinuities: Discontinuities,
    /// How it comes by a gradient.
    pub way: Way,
    /// What finds the boundary terms along its paths, if anything does.
    pub boundary: Option<MakeBoundary>,
    /// The film that it needs in place of the scene's, if it needs another.
    pub film: Option<MakeFilm>,
}

/// Makes an estimator of boundary terms, or what moves samples instead, from which triangles are
/// neighbours and what moves.
pub type MakeBoundary =
    for<'a> fn(&'a Adjacency, &'a Moving, &'a Constants) -> Box<dyn BoundaryEstimator + 'a>;

/// What some methods can be told.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Constants {
    /// Of those that move samples.
    pub warp: WarpOptions,
    /// Of `auto`: what its pilot has come to, if it has been asked.
    pub mixture: Option<Mixture>,
}

/// Changes a film, or says why it cannot be used.
pub type MakeFilm = fn(&WarpOptions, Film) -> Result<Film, String>;

/// What becomes of the discontinuities that parameters move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Discontinuities {
    /// Their part of the gradient is left out.
    Ignored,
    /// These are found and differentiated. Scenes with others are refused.
    Found(&'static [Discontinuity]),
    /// All of them count, and none is looked for.
    ByDefinition,
}

/// Kinds of discontinuities.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Discontinuity {
    /// Silhouettes that the camera sees, or that surfaces reflect or transmit.
    Silhouette,
    /// Shadows of lights with an extent, and of the environment.
    SoftShadow,
    /// Shadows of delta lights.
    SharpShadow,
    /// Where the picture of a projector ends, or the beam of a spot without a ramp.
    BeamBorder,
    /// Where a picture in a beam jumps.
    JumpInBeam,
    /// What is seen in perfectly smooth reflections and refractions.
    Mirrored,
    /// What is seen behind surfaces that do nothing to light, and behind masks.
    BehindNull,
    /// What is seen in rough glass, in materials of several layers, and in brushed ones.
    InLayers,
    /// Lines in which surfaces pass through one another.
    Intersection,
    /// Where a texture jumps.
    TextureEdge,
    /// What is seen through a lens with an aperture.
    ThroughLens,
    /// What a parallel projection sees.
    InParallel,
}

/// How a gradient is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Way {
    /// Stored paths are differentiated, forwards or backwards. Any of the samples can be
    /// differentiated apart.
    Paths,
    /// Images of scenes that are displaced along one direction are compared. In reverse that takes
    /// one difference for each number, and each image needs all the samples.
    Images {
        /// Whether the samples are carried along with what they see.
        are_carried: bool,
    },
}

const FOUND_BY_CELLS: Discontinuities = Discontinuities::Found(&[
    Discontinuity::Silhouette,
    Discontinuity::SoftShadow,
    Discontinuity::InLayers,
    Discontinuity::Intersection,
    Discontinuity::TextureEdge,
    Discontinuity::SharpShadow,
    Discontinuity::BeamBorder,
    Discontinuity::Mirrored,
    Discontinuity::BehindNull,
    Discontinuity::ThroughLens,
    Discontinuity::InParallel,
]);

/// All methods, the usual one first.
pub const ESTIMATORS: [Estimator; 8] = [
    Estimator {
        method: Method::Reparam,
        name: "reparam",
        title: "reparam",
        about: "Changes of variables that hold the discontinuities still",
        discontinuities: FOUND_BY_CELLS,
        way: Way::Paths,
        boundary: Some(|adjacency, moving, _| Box::new(Cells::new(adjacency, moving))),
        film: None,
    },
    Estimator {
        method: Method::Edges,
        name: "edges",
        title: "edges",
        about: "Points drawn on the edges of meshes",
        discontinuities: Discontinuities::Found(&[
            Discontinuity::Silhouette,
            Discontinuity::SoftShadow,
            Discontinuity::InLayers,
            Discontinuity::ThroughLens,
        ]),
        way: Way::Paths,
        boundary: Some(|adjacency, moving, _| Box::new(Edges::new(adjacency, moving))),
        film: None,
    },
    Estimator {
        method: Method::Loubet,
        name: "loubet",
        title: "Loubet et al. (2019)",
        about: "Bundles of rays that turn with what they see, as published in 2019: biased",
        discontinuities: Discontinuities::Found(&[
            Discontinuity::Silhouette,
            Discontinuity::SoftShadow,
            Discontinuity::Intersection,
        ]),
        way: Way::Paths,
        boundary: Some(|_, _, options| {
            Box::new(loubet::Loubet {
                options: &options.warp.loubet,
            })
        }),
        film: Some(loubet::film),
    },
    Estimator {
        method: Method::WarpedArea,
        name: "warped-area",
        title: "Bangaru et al. (2020)",
        about: "Velocities as harmonic means of what lies around, as published in 2020: biased",
        discontinuities: Discontinuities::Found(&[
            Discontinuity::Silhouette,
            Discontinuity::SoftShadow,
            Discontinuity::Intersection,
        ]),
        way: Way::Paths,
        boundary: Some(|adjacency, _, options| {
            let options = &options.warp.warped_area;
            Box::new(warped_area::WarpedArea::new(adjacency, options))
        }),
        film: Some(warped_area::film),
    },
    Estimator {
        method: Method::Interior,
        name: "interior",
        title: "interior",
        about: "Ignores visibility: wrong wherever an edge moves",
        discontinuities: Discontinuities::Ignored,
        way: Way::Paths,
        boundary: None,
        film: None,
    },
    Estimator {
        method: Method::Fd,
        name: "fd",
        title: "finite differences",
        about: "Finite differences: the reference",
        discontinuities: Discontinuities::ByDefinition,
        way: Way::Images { are_carried: false },
        boundary: None,
        film: None,
    },
    Estimator {
        method: Method::CarriedFd,
        name: "carried-fd",
        title: "carried finite differences",
        about: "Finite differences whose samples are carried along with what they see",
        discontinuities: Discontinuities::ByDefinition,
        way: Way::Images { are_carried: true },
        boundary: None,
        film: None,
    },
    Estimator {
        method: Method::Auto,
        name: "auto",
        title: "auto",
        about: "Of reparam, edges, mixtures of both and differences what a pilot finds the least noise in",
        discontinuities: FOUND_BY_CELLS,
        way: Way::Paths,
        boundary: Some(|adjacency, moving, constants| {
            let mixture = constants.mixture.unwrap_or_default();
            Box::new(Mixed::new(mixture, adjacency, moving))
        }),
        film: None,
    },
];

impl Method {
    /// What the others are checked against.
    pub const REFERENCE: Self = Method::Fd;

    /// The method of this name.
    pub fn named(name: &str) -> Option<Self> {
        let found = ESTIMATORS.iter().find(|e| e.name == name);
        found.map(|e| e.method)
    }

    /// Its row of the table.
    pub fn estimator(self) -> &'static Estimator {
        let [
            reparam,
            edges,
            loubet,
            warped_area,
            interior,
            fd,
            carried_fd,
            auto,
        ] = &ESTIMATORS;
        match self {
            Method::Reparam => reparam,
            Method::Edges => edges,
            Method::Loubet => loubet,
            Method::WarpedArea => warped_area,
            Method::Interior => interior,
            Method::Fd => fd,
            Method::CarriedFd => carried_fd,
            Method::Auto => auto,
        }
    }

    /// The name used on the command line and in reports.
    pub fn name(self) -> &'static str {
        self.estimator().name
    }

    /// In words.
    pub fn title(self) -> &'static str {
        self.estimator().title
    }

    /// Whether it gives the derivative of one number by many parameters in one pass, which is the
    /// transpose of what it does forward.
    pub fn has_reverse_mode(self) -> bool {
        self.estimator().way == Way::Paths
    }

    /// Whether groups of a job's samples can be done apart, by several processes.
    pub fn shares_samples(self) -> bool {
        self.estimator().way == Way::Paths
    }

    /// Whether it renders displaced scenes, and keeps whole images of every group of samples.
    pub fn displaces_scenes(self) -> bool {
        matches!(self.estimator().way, Way::Images { .. })
    }

    /// Whether the samples of such images are carried along with what they see.
    pub fn carries_samples(self) -> bool {
        self.estimator().way == Way::Images { are_carried: true }
    }

    /// Whether a pilot has to say what it comes to.
    pub fn asks_a_pilot(self) -> bool {
        self == Method::Auto
    }

    /// Whether the other methods are checked against it.
    pub fn is_reference(self) -> bool {
        self == Self::REFERENCE
    }

    /// Whether it leaves out what moving discontinuities bring.
    pub fn ignores_visibility(self) -> bool {
        self.estimator().discontinuities == Discontinuities::Ignored
    }

    /// What finds the boundary terms along its paths.
    pub fn boundary(self) -> Option<MakeBoundary> {
        self.estimator().boundary
    }

    /// Whether its gradients miss discontinuities of this kind though it looks for others.
    pub fn misses(self, kind: Discontinuity) -> bool {
        match self.estimator().discontinuities {
            Discontinuities::Found(kinds) => !kinds.contains(&kind),
            Discontinuities::Ignored | Discontinuities::ByDefinition => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_has_its_own_row() {
        for row in &ESTIMATORS {
            assert_eq!(row.method.estimator().name, row.name);
            assert_eq!(Method::named(row.name), Some(row.method));
            // As jobs spell it.
            let text = format!("\"{}\"", row.name);
            assert_eq!(serde_json::from_str::<Method>(&text).ok(), Some(row.method));
            let finds = matches!(row.discontinuities, Discontinuities::Found(_));
            assert_eq!(row.boundary.is_some(), finds, "{}", row.name);
        }
    }
}
