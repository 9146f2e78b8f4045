//! Memory that tiles need while they are worked on, kept for the next ones.

use std::sync::Mutex;

/// As many as there were tiles worked on at once.
pub struct Spare<T>(Mutex<Vec<T>>);

impl<T> Spare<T> {
    pub fn new() -> Self {
        Self(Mutex::new(Vec::new()))
    }

    /// One that was given back, or a new one.
    pub fn take(&self, new: impl FnOnce() -> T) -> T {
        let spare = self.0.lock().map_or(None, |mut spare| spare.pop());
        spare.unwrap_or_else(new)
    }

    pub fn give_back(&self, one: T) {
        if let Ok(mut spare) = self.0.lock() {
            spare.push(one);
        }
    }
}
