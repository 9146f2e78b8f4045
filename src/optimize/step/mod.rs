//! One step: the loss of some views, its gradient, and how sure both are.

pub mod evaluate;
pub mod found;
mod join;
mod launch;
#[cfg(feature = "mpi")]
mod message_passing;
pub mod ranks;
pub mod total_variation;
mod unit;

pub use evaluate::evaluate;
pub use found::{Evaluation, Look, Sampling};
pub use join::join;
pub use ranks::{Ranks, outcome};
