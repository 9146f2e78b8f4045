//! A run, from its configuration to its files.

pub mod advance;
pub mod checkpoint;
mod folder;
mod order;
pub mod record;
pub mod state;
pub mod stop;
mod work;

pub use work::{Options, Summary, Watch, run};
