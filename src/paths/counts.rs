//! What was done while tiles were traced.

use crate::discontinuity::between::Unresolved;
use crate::paths::integral::{Borders, ByIntegral};

/// What was done: rays traced by kind, and silhouettes that could not be found.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Counts {
    pub camera: u64,
    pub shadow: u64,
    pub bounce: u64,
    /// Shadow rays to a light's rim: they only find silhouettes.
    pub light_cell: u64,
    /// Rays to the points of lines over lobes: they only find silhouettes.
    pub bounce_cell: u64,
    /// Rays to the environment map: they only find silhouettes.
    pub environment_cell: u64,
    /// Rays to points that were drawn on edges: they only find silhouettes.
    pub edge: u64,
    /// Rays that look for and beside silhouettes, and those of the paths that go on from there.
    pub probe: u64,
    /// Rays of the paths that are compared at relays (`paths::relay`).
    pub relay: u64,
    /// Borders that were looked for, by the integral.
    pub borders: ByIntegral<Borders>,
    /// Cells whose ends differ though no silhouette was found between them: all that are lost.
    pub unresolved: u64,
    /// Cells whose ends see surfaces that coincide.
    pub coincident: u64,
    /// Borders at which something that moves stands on something else.
    pub standing: u64,
    /// Places that move where a picture's normal looked away and was turned round.
    pub turned_round: u64,
    /// Samples of the image left out because they were not finite.
    pub not_finite: u64,
    /// Borders left out because what jumps there was not finite.
    pub boundary_not_finite: u64,
    /// Terms of the gradient left out because they were not finite.
    pub gradient_not_finite: u64,
}

impl Counts {
    /// Counts a cell between whose ends no silhouette was found.
    pub fn miss(&mut self, why: Unresolved) {
        match why {
            Unresolved::Lost => self.unresolved += 1,
            Unresolved::Coincident => self.coincident += 1,
        }
    }

    /// All rays.
    pub fn rays(&self) -> u64 {
        self.camera
            + self.shadow
            + self.bounce
            + self.light_cell
            + self.bounce_cell
            + self.environment_cell
            + self.edge
            + self.probe
            + self.relay
    }
}

impl std::ops::AddAssign for Counts {
    fn add_assign(&mut self, o: Self) {
        self.camera += o.camera;
        self.shadow += o.shadow;
        self.bounce += o.bounce;
        self.light_cell += o.light_cell;
        self.bounce_cell += o.bounce_cell;
        self.environment_cell += o.environment_cell;
        self.edge += o.edge;
        self.probe += o.probe;
        self.relay += o.relay;
        self.borders += o.borders;
        self.unresolved += o.unresolved;
        self.coincident += o.coincident;
        self.standing += o.standing;
        self.turned_round += o.turned_round;
        self.not_finite += o.not_finite;
        self.boundary_not_finite += o.boundary_not_finite;
        self.gradient_not_finite += o.gradient_not_finite;
    }
}
