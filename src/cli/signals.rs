//! Ctrl-C and SIGTERM: the first asks for a clean end and gets one all the same if that takes too
//! long (a pipe that nobody reads, a file that never comes, a long build); a second ends the
//! program at once.

use super::exit::Failure;
use super::log::Log;
use crate::output::unfinished;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::thread;
use std::time::Duration;

/// Between two looks at whether a signal has come.
const LOOK: Duration = Duration::from_millis(50);
/// For the clean end.
const GRACE: Duration = Duration::from_millis(1400);
/// For taking unfinished files away and saying so, which may itself wait for a disk or a pipe. All
/// three together are less than two seconds.
const TIDYING: Duration = Duration::from_millis(300);

/// Which signal has come, if any. Clones watch the same one.
#[derive(Clone, Debug, Default)]
pub struct Signals {
    number: Arc<AtomicUsize>,
}

impl Signals {
    /// Starts watching. A system that refuses keeps its default: the signal then simply ends the
    /// program.
    pub fn watch(log: Log) -> Self {
        let signals = Self::default();
        let came = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM] {
            // In this order: the exit must see the flag of an earlier signal, not of its own.
            let _ = flag::register_conditional_shutdown(signal, 128 + signal, came.clone());
            let _ = flag::register(signal, came.clone());
            let _ = flag::register_usize(signal, signals.number.clone(), signal as usize);
        }
        let watched = signals.clone();
        let late = move || end_late(&watched, log);
        // Without this thread the work still asks for itself.
        let _ = thread::Builder::new().name("signals".into()).spawn(late);
        signals
    }

    /// The signal's number.
    pub fn received(&self) -> Option<u8> {
        match self.number.load(Ordering::Relaxed) {
            0 => None,
            number => u8::try_from(number).ok(),
        }
    }
}

/// Waits for a signal, and ends the program if that has not ended itself a while later.
fn end_late(signals: &Signals, log: Log) {
    let signal = loop {
        match signals.received() {
            Some(signal) => break signal,
            None => thread::sleep(LOOK),
        }
    };
    thread::sleep(GRACE);
    let (done, tidied) = mpsc::channel();
    let tidy = move || {
        unfinished::remove_all();
        log.error(&Failure::Interrupted(signal).to_string());
        let _ = done.send(());
    };
    if thread::Builder::new().spawn(tidy).is_ok() {
        let _ = tidied.recv_timeout(TIDYING);
    }
    signal_hook::low_level::exit(Failure::Interrupted(signal).code().into());
}
