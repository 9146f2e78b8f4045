//! One step: the loss of some views, its gradient, and how sure both are.

pub mod evaluate;
pub mod ranks;
pub mod total_variation;
mod unit;

pub use evaluate::{Evaluation, Look, Sampling, evaluate};
pub use ranks::{Alone, Ranks};
