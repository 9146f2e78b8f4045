//! What a pilot of `auto` may come to.

use super::estimators::Method;
use super::settings::Settings;
use crate::boundary::mixture::{Mixture, OnFilm, OverLobes};

/// A way to come by a gradient.
#[derive(Clone, Copy, PartialEq)]
pub enum Contender {
    Mixture(Mixture),
    /// Of samples that are carried, if they can be.
    Differences {
        carried: bool,
    },
}

impl Contender {
    /// The settings with which it is gone.
    pub fn settle(self, settings: &Settings) -> Settings {
        let mut settled = settings.clone();
        let (method, mixture) = match self {
            Contender::Mixture(mixture) => (settings.method, mixture),
            Contender::Differences { .. } => (Method::CarriedFd, Mixture::default()),
        };
        settled.method = method;
        settled.constants.mixture = Some(mixture);
        settled
    }

    /// Whether it compares images.
    pub fn is_difference(self) -> bool {
        !matches!(self, Contender::Mixture(_))
    }

    /// In words.
    pub fn name(self) -> String {
        match self {
            Contender::Mixture(Mixture { film, lobes }) => {
                let film = match film {
                    OnFilm::Drifting => "cells on the film",
                    OnFilm::Resting => "cells on a film at rest",
                    OnFilm::WithAll => "cells on a film that follows all it sees",
                    OnFilm::Edges => "edges on the film",
                };
                let lobes = match lobes {
                    OverLobes::Cells => "cells over lobes",
                    OverLobes::SeldomCells => "cells on few lines over lobes",
                    OverLobes::EdgesFromRest => "edges over lobes of points at rest",
                };
                format!("{film}, {lobes}")
            }
            Contender::Differences { carried: true } => Method::CarriedFd.title().into(),
            Contender::Differences { carried: false } => Method::Fd.title().into(),
        }
    }
}
