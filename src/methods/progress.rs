//! How far a run is.

/// How the engine says how far it is, and learns that it should stop.
pub trait Progress: Sync {
    /// `done` of `total` units of work are finished.
    fn advance(&self, done: u64, total: u64);
    /// Whether the user wants it to stop.
    fn cancelled(&self) -> bool;
}

/// Says nothing of how far it is.
pub struct Quietly<'a>(pub &'a dyn Progress);

impl Progress for Quietly<'_> {
    fn advance(&self, _: u64, _: u64) {}
    fn cancelled(&self) -> bool {
        self.0.cancelled()
    }
}
