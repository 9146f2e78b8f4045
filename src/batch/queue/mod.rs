//! Which jobs are done here, and in which order.

pub mod intake;
pub mod register;
pub mod scheduler;
pub mod shard;
pub mod stream;
