//! Threads.

use super::error::EngineError;
use std::sync::Arc;

/// Threads that work through tiles. Clones share them.
#[derive(Clone)]
pub struct Workers {
    pub(super) pool: Arc<rayon::ThreadPool>,
    pub(super) threads: usize,
}

impl Workers {
    /// Starts `threads` threads.
    pub fn new(threads: usize) -> Result<Self, EngineError> {
        let threads = threads.max(1);
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .map_err(|error| EngineError::Failed(error.to_string()))?;
        Ok(Self {
            pool: Arc::new(pool),
            threads,
        })
    }
}
