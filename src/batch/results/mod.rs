//! What a batch writes, and what survives when it is cut off.

pub mod folder;
pub mod journal;
pub mod line;
pub mod manifest;
pub mod summary;
pub mod tally;
