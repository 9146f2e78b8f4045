//! How far a batch is: a bar on a terminal, JSON events on request, else nothing.

use super::log::Log;
use super::progress::INTERVAL;
use super::signals::Signals;
use crate::batch::options::Watch;
use crate::batch::results::line::ResultLine;
use crate::batch::results::tally::Tally;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use std::collections::BTreeSet;
use std::io::IsTerminal;
use std::sync::{Mutex, PoisonError};
use std::time::Instant;

/// The progress of a batch.
pub struct BatchProgress {
    log: Log,
    signals: Signals,
    bar: Option<ProgressBar>,
    last: Mutex<Instant>,
    /// Warnings that were shown: of a thousand jobs that have one, the first is enough.
    warned: Mutex<BTreeSet<String>>,
}

impl BatchProgress {
    /// Shows nothing yet.
    pub fn new(log: Log, signals: Signals) -> Self {
        let is_seen = !log.is_quiet() && !log.is_json() && std::io::stderr().is_terminal();
        Self {
            log,
            signals,
            bar: is_seen.then(bar),
            last: Mutex::new(Instant::now()),
            warned: Mutex::default(),
        }
    }

    /// Takes the bar away, leaving the terminal to the messages that follow.
    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }

    fn warn(&self, result: &ResultLine, what: &str) {
        let id = result.id.as_deref().unwrap_or("a job without an id");
        let show = || self.log.warning(&format!("{id}: {what}"));
        match &self.bar {
            Some(bar) => bar.suspend(show),
            None => show(),
        }
    }

    fn event(&self, tally: &Tally) {
        self.log.event(&json!({
            "event": "progress", "stage": "batch", "done": tally.done(), "failed": tally.failed(),
            "total": tally.total, "seconds": tally.started.elapsed().as_secs_f64(),
            "jobs_per_second": tally.jobs_rate(), "rays_per_second": tally.rays_rate(),
            "seconds_left": tally.seconds_left(),
        }));
    }
}

impl Watch for BatchProgress {
    fn begin(&self, total: Option<usize>, skipped: usize) {
        if skipped > 0 {
            self.log.note(&format!("{skipped} jobs are done already"));
        }
        if let (Some(bar), Some(total)) = (&self.bar, total) {
            bar.set_length(total as u64);
        }
    }

    fn advance(&self, tally: &Tally) {
        // A thread that finds another one reporting has nothing to add.
        let Ok(mut last) = self.last.try_lock() else {
            return;
        };
        let is_last = tally.total == Some(tally.done() as usize);
        if last.elapsed() < INTERVAL && !is_last {
            return;
        }
        *last = Instant::now();
        if self.log.is_json() && !self.log.is_quiet() {
            self.event(tally);
        }
        if let Some(bar) = &self.bar {
            bar.set_position(tally.done());
            let left = match tally.seconds_left() {
                Some(seconds) => format!(
                    "{} left",
                    indicatif::HumanDuration(std::time::Duration::from_secs_f64(seconds))
                ),
                None => String::new(),
            };
            bar.set_message(format!(
                "{:.2} jobs/s  {:.2} Mrays/s  {left}",
                tally.jobs_rate(),
                tally.rays_rate() * 1e-6
            ));
        }
    }

    fn ended(&self, result: &ResultLine, tally: &Tally) {
        if !result.is_ok() {
            self.warn(result, result.message.as_deref().unwrap_or_default());
        }
        for warning in &result.warnings {
            let mut warned = self.warned.lock().unwrap_or_else(PoisonError::into_inner);
            if warned.insert(warning.clone()) {
                self.warn(result, warning);
            }
        }
        self.advance(tally);
    }

    fn signal(&self) -> Option<u8> {
        self.signals.received()
    }
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(0), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template("{wide_bar} {pos}/{len}  {msg}") {
        bar.set_style(style);
    }
    bar
}
