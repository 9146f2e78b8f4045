//! How far an optimisation is: a bar with the loss on a terminal, JSON events on request.

use super::log::Log;
use super::progress::INTERVAL;
use super::signals::Signals;
use crate::optimize::run::Watch;
use crate::optimize::run::record::Record;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use std::io::IsTerminal;
use std::sync::{Mutex, OnceLock};
use std::time::Instant;

/// The progress of an optimisation.
pub struct OptimizeProgress {
    log: Log,
    signals: Signals,
    is_seen: bool,
    /// Once it is known how much there is to do: a bar of no length is a full one.
    bar: OnceLock<ProgressBar>,
    started: Instant,
    last: Mutex<Option<Instant>>,
}

impl OptimizeProgress {
    /// Shows nothing yet.
    pub fn new(log: Log, signals: Signals) -> Self {
        let is_seen = !log.is_quiet() && !log.is_json() && std::io::stderr().is_terminal();
        Self {
            log,
            signals,
            is_seen,
            bar: OnceLock::new(),
            started: Instant::now(),
            last: Mutex::new(None),
        }
    }

    /// Takes the bar away, leaving the terminal to the messages that follow.
    pub fn finish(&self) {
        if let Some(bar) = self.bar.get() {
            bar.finish_and_clear();
        }
    }
}

impl Watch for OptimizeProgress {
    fn begin(&self, done: u64, total: u64) {
        if done > 0 {
            self.log
                .note(&format!("going on after step {done} of {total}"));
        }
        if self.is_seen {
            let bar = self.bar.get_or_init(|| bar(total));
            bar.set_position(done);
            bar.reset_eta();
        }
    }

    fn stepped(&self, record: &Record, total: u64) {
        let done = record.step + 1;
        if let Some(bar) = self.bar.get() {
            let loss = record
                .loss
                .map_or("not finite".into(), |v| format!("{v:.3e}"));
            let error = record
                .error
                .map_or(String::new(), |v| format!(" ± {v:.0e}"));
            bar.set_message(format!("loss {loss}{error}  {} spp", record.spp));
            bar.set_position(done);
        }
        if !self.log.is_json() || self.log.is_quiet() {
            return;
        }
        let Ok(mut last) = self.last.lock() else {
            return;
        };
        if done == total || last.is_none_or(|at| at.elapsed() >= INTERVAL) {
            *last = Some(Instant::now());
            self.log.event(&json!({
                "event": "progress", "stage": "optimize", "done": done, "total": total,
                "seconds": self.started.elapsed().as_secs_f64(), "loss": record.loss,
                "loss_se": record.error, "noise_floor": record.floor, "spp": record.spp,
            }));
        }
    }

    fn warn(&self, text: &str) {
        let show = || self.log.warning(text);
        match self.bar.get() {
            Some(bar) => bar.suspend(show),
            None => show(),
        }
    }

    fn signal(&self) -> Option<u8> {
        self.signals.received()
    }
}

fn bar(total: u64) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len}  {msg}  {eta} left") {
        bar.set_style(style);
    }
    bar
}
