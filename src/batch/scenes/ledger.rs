//! Who holds how much memory: scenes and jobs.
//!
//! Scenes go when nobody uses them and others need the room. What a scene is made of is nothing to
//! the ledger: it counts its bytes and knows whether it is in use.

use super::key::SceneKey;
use crate::jobs::failure::Failure;
use crate::jobs::shown;
use crate::room::{self, Cancelled};
use std::collections::HashMap;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// Between two looks at whether the user wants to stop.
const PATIENCE: Duration = Duration::from_millis(100);

/// The memory that scenes `S` and jobs share.
pub struct Ledger<S> {
    limit: u64,
    state: Mutex<State<S>>,
    changed: Condvar,
}

/// What is counted.
pub struct State<S> {
    pub used: u64,
    /// Jobs that run.
    pub active: usize,
    pub loading: bool,
    /// The job that is next, if one waits for memory: smaller ones do not overtake it for ever.
    pub next_in_line: Option<u64>,
    tickets: u64,
    pub scenes: HashMap<SceneKey, Slot<S>>,
    pub loads: usize,
}

/// A scene that is there.
pub struct Slot<S> {
    pub scene: Arc<S>,
    used_at: u64,
}

/// Memory that is counted as used until this is dropped.
pub struct Reservation<S> {
    ledger: Arc<Ledger<S>>,
    bytes: u64,
}

impl<S> State<S> {
    /// A number for a job that comes; those of later ones are larger.
    pub fn next_ticket(&mut self) -> u64 {
        self.tickets += 1;
        self.tickets
    }

    /// A scene has been loaded.
    pub fn put(&mut self, key: &SceneKey, scene: Arc<S>) {
        self.loads += 1;
        let used_at = self.tickets;
        self.scenes.insert(key.clone(), Slot { scene, used_at });
    }

    /// A job of this scene begins, which takes so much beside it.
    pub fn take(&mut self, key: &SceneKey, bytes: u64) -> Option<Arc<S>> {
        let used_at = self.tickets;
        let slot = self.scenes.get_mut(key)?;
        slot.used_at = used_at;
        self.used += bytes;
        self.active += 1;
        Some(slot.scene.clone())
    }

    /// The scene that no job is using, the longest unused.
    pub fn idle_scene(&self, but: Option<&SceneKey>) -> Option<SceneKey> {
        let scenes = self.scenes.iter();
        scenes
            .filter(|(key, slot)| Some(*key) != but && Arc::strong_count(&slot.scene) == 1)
            .min_by_key(|(_, slot)| slot.used_at)
            .map(|(key, _)| key.clone())
    }
}

impl<S> Ledger<S> {
    /// With `used` bytes in use by what is not counted here.
    pub fn new(limit: u64, used: u64) -> Self {
        let state = State {
            used,
            active: 0,
            loading: false,
            next_in_line: None,
            tickets: 0,
            scenes: HashMap::new(),
            loads: 0,
        };
        Self {
            limit,
            state: Mutex::new(state),
            changed: Condvar::new(),
        }
    }

    pub fn lock(&self) -> MutexGuard<'_, State<S>> {
        // Every change is complete before anything could panic.
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Waits for a change, but not for long.
    pub fn wait<'a>(&self, state: MutexGuard<'a, State<S>>) -> MutexGuard<'a, State<S>> {
        let waited = self.changed.wait_timeout(state, PATIENCE);
        waited.unwrap_or_else(PoisonError::into_inner).0
    }

    /// Wakes those who wait.
    pub fn tell(&self) {
        self.changed.notify_all();
    }

    /// Drops a scene, which takes its memory off the count: unlocked, since that locks.
    pub fn without<'a>(
        &'a self,
        mut state: MutexGuard<'a, State<S>>,
        key: &SceneKey,
    ) -> MutexGuard<'a, State<S>> {
        let victim = state.scenes.remove(key);
        drop(state);
        drop(victim);
        self.lock()
    }

    /// Whether so many bytes more are allowed, and the system would give them now: it may have
    /// limits of its own.
    pub fn has_room(&self, state: &State<S>, bytes: u64) -> bool {
        state.used + bytes <= self.limit && room::look_for(bytes).is_ok()
    }

    /// Why `what` can never be had.
    pub fn too_large(&self, what: &str, bytes: u64, state: &State<S>) -> Failure {
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

    /// A job that [`State::take`] let begin has ended.
    pub fn release(&self, bytes: u64) {
        let mut state = self.lock();
        state.active -= 1;
        state.used -= bytes;
        drop(state);
        self.tell();
    }
}

impl<S> Reservation<S> {
    /// Of nothing yet.
    pub fn none(ledger: &Arc<Ledger<S>>) -> Self {
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
                state = ledger.without(state, &idle);
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

impl<S> Drop for Reservation<S> {
    fn drop(&mut self) {
        self.ledger.lock().used -= self.bytes;
        self.ledger.tell();
    }
}
