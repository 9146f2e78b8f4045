//! Scenes in memory, each loaded once and shared by its jobs, and the memory that scenes and jobs
//! may take.
//!
//! A job is admitted when its estimate fits beside what is there. Scenes that no job is using are
//! dropped for it, the longest unused first; else it waits until others have ended. Only one scene
//! loads at a time, and only a job that no other holds up may fail for want of memory: whoever
//! waits holds nothing that another could need.

use super::key::SceneKey;
use super::ledger::{Ledger, Reservation};
use super::loaded::Loaded;
use crate::jobs::failure::Failure;
use crate::jobs::machine;
use crate::methods::Workers;
use crate::room::Cancelled;
use crate::trace::Backend;
use std::sync::Arc;

/// The scenes and the memory of one batch.
pub struct Store {
    ledger: Arc<Ledger<Loaded>>,
    workers: Workers,
    backend: Backend,
}

/// A job that may run.
pub struct Admission {
    // In this order they go: whoever sees that no job is active must find the scenes idle and the
    // memory free.
    pub loaded: Arc<Loaded>,
    _release: Release,
    /// Whether this job's coming made the scene load.
    pub was_loaded: bool,
}

/// The memory of a job that runs.
struct Release {
    ledger: Arc<Ledger<Loaded>>,
    bytes: u64,
}

impl Store {
    /// An empty store; what the process has taken up to now counts as used.
    pub fn new(limit_bytes: u64, workers: Workers, backend: Backend) -> Self {
        let limit = machine::of_address_space().map_or(limit_bytes, |most| limit_bytes.min(most));
        let used = machine::resident().unwrap_or(0);
        Self {
            ledger: Arc::new(Ledger::new(limit, used)),
            workers,
            backend,
        }
    }

    /// Scenes loaded so far.
    pub fn loads(&self) -> usize {
        self.ledger.lock().loads
    }

    /// Waits until the scene is there and the job fits. `bytes` estimates what the job takes beside
    /// it.
    pub fn admit(
        &self,
        key: &SceneKey,
        bytes: impl Fn(&Loaded) -> Result<u64, Failure>,
        cancelled: Cancelled,
    ) -> Result<Admission, Failure> {
        let ledger = &self.ledger;
        let mut was_loaded = false;
        let mut state = ledger.lock();
        let ticket = state.next_ticket();
        let admitted = loop {
            if cancelled() {
                break Err(Failure::Interrupted(2));
            }
            let Some(slot) = state.scenes.get(key) else {
                if state.loading {
                    state = ledger.wait(state);
                    continue;
                }
                state.loading = true;
                drop(state);
                was_loaded = true;
                let there = self.load(key, cancelled);
                state = ledger.lock();
                match there {
                    Ok(()) => continue,
                    Err(failure) => break Err(failure),
                }
            };
            if !slot.scene.is_fresh() {
                state = ledger.without(state, key);
                continue;
            }
            let need = match bytes(&slot.scene) {
                Ok(need) => need,
                Err(failure) => break Err(failure),
            };
            let is_next = state.next_in_line.is_none_or(|next| next == ticket);
            if is_next && ledger.has_room(&state, need) {
                let loaded = state.take(key, need);
                break Ok(loaded.map(|loaded| (loaded, need)));
            }
            if let Some(idle) = state.idle_scene(Some(key)).filter(|_| is_next) {
                state = ledger.without(state, &idle);
                continue;
            }
            if is_next && state.active == 0 && !state.loading {
                break Err(ledger.too_large("the job", need, &state));
            }
            state.next_in_line.get_or_insert(ticket);
            state = ledger.wait(state);
        };
        if state.next_in_line == Some(ticket) {
            state.next_in_line = None;
            ledger.tell();
        }
        drop(state);
        match admitted? {
            Some((loaded, bytes)) => Ok(Admission {
                loaded,
                _release: Release {
                    ledger: ledger.clone(),
                    bytes,
                },
                was_loaded,
            }),
            None => Err(Failure::System(
                "a scene was lost between two looks at it".into(),
            )),
        }
    }

    /// Loads a scene, for a job whose turn it is.
    fn load(&self, key: &SceneKey, cancelled: Cancelled) -> Result<(), Failure> {
        let ledger = &self.ledger;
        let turn = LoadingTurn(ledger);
        let reservation = Reservation::none(ledger);
        let loaded = Loaded::load(key, &self.workers, self.backend, reservation, cancelled);
        // Before the turn ends: else another job would load the same scene.
        let there = loaded.map(|loaded| ledger.lock().put(key, Arc::new(loaded)));
        drop(turn);
        there
    }
}

/// Only one scene loads at a time. The turn ends however the loading does.
struct LoadingTurn<'a>(&'a Ledger<Loaded>);

impl Drop for LoadingTurn<'_> {
    fn drop(&mut self) {
        self.0.lock().loading = false;
        self.0.tell();
    }
}

impl Drop for Release {
    fn drop(&mut self) {
        self.ledger.release(self.bytes);
    }
}

#[cfg(test)]
mod tests;
