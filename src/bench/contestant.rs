//! What is compared.

use crate::trace::{AccelOptions, Backend, EmbreeIsa, ObvhsTree};

/// One way of building and tracing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contestant {
    pub backend: Backend,
    pub robust: bool,
}

impl Contestant {
    /// Every backend as renderers use it, then those whose rays may leak, as the libraries ship.
    pub fn all() -> Vec<Self> {
        let built_in = Backend::built_in();
        let leaky = built_in.iter().filter(|b| is_first_of_library(**b));
        let leaky = leaky.map(|&backend| Self {
            backend,
            robust: false,
        });
        let robust = built_in.iter().map(|&backend| Self {
            backend,
            robust: true,
        });
        robust.chain(leaky).collect()
    }

    /// To build with.
    pub fn options(self, threads: usize) -> AccelOptions {
        AccelOptions::new(self.robust, threads).on(self.backend)
    }
}

/// Whether it is the way that a library is known for.
pub fn is_first_of_library(backend: Backend) -> bool {
    matches!(
        backend,
        Backend::Embree(EmbreeIsa::Best, _) | Backend::Obvhs(ObvhsTree::Cwbvh, _)
    )
}
