//! How long the runs of a check will take, by what has been seen of them.

use indicatif::HumanDuration;
use std::time::Duration;

/// Runs of one kind cost the same.
#[derive(Clone, Copy, Debug)]
pub enum Kind {
    Forward,
    Backward,
    Differences,
}

/// Runs that are done and runs that are to come.
#[derive(Clone, Debug, Default)]
pub struct Pace {
    kinds: [Runs; 3],
}

#[derive(Clone, Copy, Debug, Default)]
struct Runs {
    done: usize,
    seconds: f64,
    left: usize,
}

impl Runs {
    /// Of one run, if there was any.
    fn cost(&self) -> Option<f64> {
        (self.done > 0).then(|| self.seconds / self.done as f64)
    }
}

impl Pace {
    /// There will be so many runs more.
    pub fn plan(&mut self, kind: Kind, runs: usize) {
        self.kinds[kind as usize].left += runs;
    }

    /// How many.
    pub fn left(&self, kind: Kind) -> usize {
        self.kinds[kind as usize].left
    }

    /// One of them begins: it is no longer to come.
    pub fn begin(&mut self, kind: Kind) {
        let runs = &mut self.kinds[kind as usize];
        runs.left = runs.left.saturating_sub(1);
    }

    /// It has ended.
    pub fn end(&mut self, kind: Kind, seconds: f64) {
        let runs = &mut self.kinds[kind as usize];
        runs.done += 1;
        runs.seconds += seconds;
    }

    /// Of the runs to come, once any has ended; kinds that have not been seen are taken for the
    /// slowest that was.
    pub fn seconds_left(&self) -> Option<f64> {
        let slowest = self.kinds.iter().filter_map(Runs::cost).reduce(f64::max)?;
        let costs = self.kinds.iter();
        Some(
            costs
                .map(|runs| runs.left as f64 * runs.cost().unwrap_or(slowest))
                .sum(),
        )
    }

    /// The same for people.
    pub fn time_left(&self) -> Option<String> {
        let seconds = self.seconds_left()?;
        Some(format!("about {}", shown(seconds)))
    }
}

/// A time for people.
pub fn shown(seconds: f64) -> String {
    HumanDuration(Duration::from_secs_f64(seconds.max(1.0))).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_seen_tells_what_is_to_come() {
        let mut pace = Pace::default();
        pace.plan(Kind::Forward, 8);
        pace.plan(Kind::Backward, 1);
        pace.plan(Kind::Differences, 8);
        assert_eq!(pace.seconds_left(), None);
        pace.begin(Kind::Forward);
        pace.end(Kind::Forward, 2.0);
        assert_eq!(pace.seconds_left(), Some(2.0 * 16.0));
        pace.begin(Kind::Differences);
        assert_eq!(pace.seconds_left(), Some(2.0 * 15.0));
        pace.end(Kind::Differences, 4.0);
        assert_eq!(pace.seconds_left(), Some(7.0 * 2.0 + 4.0 + 7.0 * 4.0));
        assert_eq!(pace.time_left().unwrap(), "about 46 seconds");
    }
}
