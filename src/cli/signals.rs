//! Ctrl-C and SIGTERM: the first asks the engine to stop, a second ends the program at once.

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

/// Which signal has come, if any. Clones watch the same one.
#[derive(Clone, Debug, Default)]
pub struct Signals {
    number: Arc<AtomicUsize>,
}

impl Signals {
    /// Starts watching. A system that refuses keeps its default: the signal then simply ends the program.
    pub fn watch() -> Self {
        let signals = Self::default();
        let came = Arc::new(AtomicBool::new(false));
        for signal in [SIGINT, SIGTERM] {
            // In this order: the exit must see the flag of an earlier signal, not of its own.
            let _ = flag::register_conditional_shutdown(signal, 128 + signal, came.clone());
            let _ = flag::register(signal, came.clone());
            let _ = flag::register_usize(signal, signals.number.clone(), signal as usize);
        }
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
