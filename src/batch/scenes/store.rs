//! Scenes in memory, each loaded once and shared by its jobs, and the memory that scenes and jobs may take.
//!
//! A job is admitted when its estimate fits beside what is there. Scenes that no job is using are dropped for it, the
//! longest unused first; else it waits until others have ended. Only one scene loads at a time, and only a job that no
//! other holds up may fail for want of memory: whoever waits holds nothing that another could need.

use super::loaded::Loaded;
use crate::jobs::failure::Failure;
use crate::jobs::machine;
use crate::jobs::shown;
use crate::methods::Workers;
use crate::room::{self, Cancelled};
use crate::trace::Backend;
use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Between two looks at whether the user wants to stop.
const PATIENCE: Duration = Duration::from_millis(100);

/// Which scene: its file and the values of its `$name`s.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct SceneKey {
    pub path: PathBuf,
    pub defines: Vec<(String, String)>,
}

/// The scenes and the memory of one batch.
pub struct Store {
    ledger: Arc<Ledger>,
    workers: Workers,
    backend: Backend,
}

/// Who holds how much.
pub struct Ledger {
    limit: u64,
    state: Mutex<State>,
    changed: Condvar,
}

#[derive(Default)]
struct State {
    used: u64,
    /// Jobs that run.
    active: usize,
    loading: bool,
    /// The job that is next, if one waits for memory: smaller ones do not overtake it for ever.
    next_in_line: Option<u64>,
    tickets: u64,
    scenes: HashMap<SceneKey, Slot>,
    loads: usize,
}

struct Slot {
    loaded: Arc<Loaded>,
    used_at: u64,
}

/// Memory that is counted as used until this is dropped.
pub struct Reservation {
    ledger: Arc<Ledger>,
    bytes: u64,
}

/// A job that may run.
pub struct Admission {
    // In this order they go: whoever sees that no job is active must find the scenes idle and the memory free.
    pub loaded: Arc<Loaded>,
    _release: Release,
    /// Whether this job's coming made the scene load.
    pub was_loaded: bool,
}

/// The memory of a job that runs.
struct Release {
    ledger: Arc<Ledger>,
    bytes: u64,
}

impl Store {
    /// An empty store; what the process has taken up to now counts as used.
    pub fn new(limit_bytes: u64, workers: Workers, backend: Backend) -> Self {
        let state = State {
            used: machine::resident().unwrap_or(0),
            ..State::default()
        };
        Self {
            ledger: Arc::new(Ledger {
                limit: machine::of_address_space()
                    .map_or(limit_bytes, |most| limit_bytes.min(most)),
                state: Mutex::new(state),
                changed: Condvar::new(),
            }),
            workers,
            backend,
        }
    }

    /// Scenes loaded so far.
    pub fn loads(&self) -> usize {
        self.ledger.lock().loads
    }

    /// Waits until the scene is there and the job fits. `bytes` estimates what the job takes beside it.
    pub fn admit(
        &self,
        key: &SceneKey,
        bytes: impl Fn(&Loaded) -> Result<u64, Failure>,
        cancelled: Cancelled,
    ) -> Result<Admission, Failure> {
        let ledger = &self.ledger;
        let mut was_loaded = false;
        let mut state = ledger.lock();
        state.tickets += 1;
        let ticket = state.tickets;
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
                let turn = LoadingTurn(ledger);
                let loaded = Loaded::load(
                    key,
                    &self.workers,
                    self.backend,
                    Reservation::none(ledger),
                    cancelled,
                );
                was_loaded = true;
                // Before the turn ends: else another job would load the same scene.
                let there = loaded.map(|loaded| ledger.lock().put(key, Arc::new(loaded)));
                drop(turn);
                state = ledger.lock();
                match there {
                    Ok(()) => continue,
                    Err(failure) => break Err(failure),
                }
            };
            if !slot.loaded.is_fresh() {
                let stale = state.scenes.remove(key);
                drop(state);
                drop(stale);
                state = ledger.lock();
                continue;
            }
            let need = match bytes(&slot.loaded) {
                Ok(need) => need,
                Err(failure) => break Err(failure),
            };
            let is_next = state.next_in_line.is_none_or(|next| next == ticket);
            if is_next && ledger.has_room(&state, need) {
                let loaded = state.take(key, need);
                break Ok(loaded.map(|loaded| (loaded, need)));
            }
            if let Some(idle) = state.idle_scene(Some(key)).filter(|_| is_next) {
                let victim = state.scenes.remove(&idle);
                drop(state);
                drop(victim);
                state = ledger.lock();
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
            ledger.changed.notify_all();
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
}

/// Only one scene loads at a time. The turn ends however the loading does.
struct LoadingTurn<'a>(&'a Ledger);

impl Drop for LoadingTurn<'_> {
    fn drop(&mut self) {
        self.0.lock().loading = false;
        self.0.changed.notify_all();
    }
}

impl Drop for Release {
    fn drop(&mut self) {
        let mut state = self.ledger.lock();
        state.active -= 1;
        state.used -= self.bytes;
        drop(state);
        self.ledger.changed.notify_all();
    }
}

impl State {
    fn put(&mut self, key: &SceneKey, loaded: Arc<Loaded>) {
        self.loads += 1;
        let used_at = self.tickets;
        self.scenes.insert(key.clone(), Slot { loaded, used_at });
    }

    fn take(&mut self, key: &SceneKey, bytes: u64) -> Option<Arc<Loaded>> {
        let used_at = self.tickets;
        let slot = self.scenes.get_mut(key)?;
        slot.used_at = used_at;
        self.used += bytes;
        self.active += 1;
        Some(slot.loaded.clone())
    }

    /// The scene that no job is using, the longest unused.
    fn idle_scene(&self, but: Option<&SceneKey>) -> Option<SceneKey> {
        let scenes = self.scenes.iter();
        scenes
            .filter(|(key, slot)| Some(*key) != but && Arc::strong_count(&slot.loaded) == 1)
            .min_by_key(|(_, slot)| slot.used_at)
            .map(|(key, _)| key.clone())
    }
}

impl Ledger {
    fn lock(&self) -> MutexGuard<'_, State> {
        // Every change is complete before anything could panic.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn wait<'a>(&self, state: MutexGuard<'a, State>) -> MutexGuard<'a, State> {
        let waited = self.changed.wait_timeout(state, PATIENCE);
        waited.unwrap_or_else(PoisonError::into_inner).0
    }

    /// Whether so many bytes more are allowed, and the system would give them now: it may have limits of its own.
    fn has_room(&self, state: &State, bytes: u64) -> bool {
        state.used + bytes <= self.limit && room::look_for(bytes).is_ok()
    }

    fn too_large(&self, what: &str, bytes: u64, state: &State) -> Failure {
        if state.used + bytes <= self.limit {
            return Failure::System(format!(
                "{what} needs about {}, which the system does not give: see `ulimit -v`",
                shown::bytes(bytes)
            ));
        }
        Failure::System(format!(
            "{what} needs about {} beside {} in use, more than --memory {} has",
            shown::bytes(bytes),
            shown::bytes(state.used),
            shown::bytes(self.limit)
        ))
    }
}

impl Reservation {
    fn none(ledger: &Arc<Ledger>) -> Self {
        Self {
            ledger: ledger.clone(),
            bytes: 0,
        }
    }

    /// Counts more, or less, as soon as it fits; only for a scene that loads.
    pub fn become_bytes(&mut self, bytes: u64, cancelled: Cancelled) -> Result<(), Failure> {
        let ledger = self.ledger.clone();
        let mut state = ledger.lock();
        loop {
            let more = bytes.saturating_sub(self.bytes);
            if bytes <= self.bytes || ledger.has_room(&state, more) {
                state.used = state.used - self.bytes + bytes;
                self.bytes = bytes;
                return Ok(());
            }
            if cancelled() {
                return Err(Failure::Interrupted(2));
            }
            if let Some(idle) = state.idle_scene(None) {
                let victim = state.scenes.remove(&idle);
                drop(state);
                drop(victim);
                state = ledger.lock();
                continue;
            }
            if state.active == 0 {
                return Err(ledger.too_large("the scene", more, &state));
            }
            state = ledger.wait(state);
        }
    }

    /// Another one of so many bytes, if they are free now.
    pub fn another(&self, bytes: u64) -> Option<Self> {
        let mut state = self.ledger.lock();
        (state.used + bytes <= self.ledger.limit).then(|| {
            state.used += bytes;
            Self {
                ledger: self.ledger.clone(),
                bytes,
            }
        })
    }
}

impl Drop for Reservation {
    fn drop(&mut self) {
        self.ledger.lock().used -= self.bytes;
        self.ledger.changed.notify_all();
    }
}

#[cfg(test)]
#[path = "store_tests.rs"]
mod tests;
