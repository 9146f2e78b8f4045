//! Scenes in memory, shared by jobs, and what they may take of it.

pub mod estimate;
pub mod key;
pub mod ledger;
pub mod loaded;
pub mod source;
pub mod store;
