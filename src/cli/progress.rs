//! How far a run is: a bar on a terminal, JSON events on request, else nothing.

use super::log::Log;
use super::pace;
use super::signals::Signals;
use crate::methods::Progress;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde_json::json;
use std::io::IsTerminal;
use std::sync::{Mutex, OnceLock};
use std::time::{Duration, Instant};

/// Between two JSON events.
pub const INTERVAL: Duration = Duration::from_secs(1);

/// The progress of one stage.
pub struct StageProgress {
    stage: &'static str,
    signals: Signals,
    show: Show,
    started: Instant,
    /// What is expected to come after this stage.
    rest_seconds: f64,
}

enum Show {
    Nothing,
    /// Once it is known how much there is to do: a bar of no length is a full one.
    Bar(OnceLock<ProgressBar>),
    Events(Log, Mutex<Instant>),
}

impl StageProgress {
    /// Begins to show `stage`, after which so many seconds of others are expected.
    pub fn start(stage: &'static str, log: Log, signals: &Signals, rest_seconds: f64) -> Self {
        let show = if log.is_quiet() {
            Show::Nothing
        } else if log.is_json() {
            Show::Events(log, Mutex::new(Instant::now()))
        } else if std::io::stderr().is_terminal() {
            Show::Bar(OnceLock::new())
        } else {
            Show::Nothing
        };
        Self {
            stage,
            signals: signals.clone(),
            show,
            started: Instant::now(),
            rest_seconds,
        }
    }

    /// Shows something else while the bar is out of the way.
    pub fn beside(&self, show: impl FnOnce()) {
        match self.bar() {
            Some(bar) => bar.suspend(show),
            None => show(),
        }
    }

    /// Takes the bar away, leaving the terminal to the messages that follow.
    pub fn finish(self) {
        self.clear();
    }

    fn clear(&self) {
        if let Some(bar) = self.bar() {
            bar.finish_and_clear();
        }
    }

    /// The bar, if one is to be seen.
    fn bar(&self) -> Option<&ProgressBar> {
        match &self.show {
            Show::Bar(bar) => bar.get(),
            _ => None,
        }
    }

    fn event(&self, log: Log, done: u64, total: u64) {
        let seconds = self.started.elapsed().as_secs_f64();
        let rate = done as f64 / seconds.max(1e-9);
        let left = if done > 0 {
            Some((total.saturating_sub(done)) as f64 / rate)
        } else {
            None
        };
        log.event(&json!({
            "event": "progress", "stage": self.stage, "done": done, "total": total,
            "seconds": seconds, "rate": rate, "seconds_left": left,
            "seconds_left_in_all": left.map(|left| left + self.rest_seconds),
        }));
    }
}

impl Progress for StageProgress {
    fn advance(&self, done: u64, total: u64) {
        match &self.show {
            Show::Nothing => {}
            Show::Bar(bar) => {
                let bar = bar.get_or_init(|| self::bar(self.stage, total, self.rest_seconds));
                bar.set_length(total);
                bar.set_position(done);
            }
            Show::Events(log, last) => {
                // A thread that finds another one reporting has nothing to add.
                let Ok(mut last) = last.try_lock() else {
                    return;
                };
                if last.elapsed() >= INTERVAL {
                    *last = Instant::now();
                    self.event(*log, done, total);
                }
            }
        }
    }

    fn cancelled(&self) -> bool {
        self.signals.received().is_some()
    }
}

impl Drop for StageProgress {
    /// An error on the way must not leave half a bar under its message.
    fn drop(&mut self) {
        self.clear();
    }
}

fn bar(stage: &'static str, total: u64, rest_seconds: f64) -> ProgressBar {
    let bar = ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr());
    let template = "{msg:>9} {wide_bar} {percent:>3} %  {per_sec}  {eta} left{prefix}";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.set_message(stage);
    if rest_seconds > 0.0 {
        bar.set_prefix(format!(", then {}", pace::shown(rest_seconds)));
    }
    bar
}
