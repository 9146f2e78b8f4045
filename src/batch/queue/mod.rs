//! Which jobs are done here, and in which order.

pub mod intake;
pub mod shard;
pub mod stream;
