//! A batch: several jobs at a time, all on the same threads, until there are no more.

use super::one_job::Shared;
use super::options::{Options, Watch};
use super::queue::intake::JobFile;
use super::queue::register::{Entry, Line, Register};
use super::queue::stream::{Next, Stream};
use super::results::folder;
use super::results::journal::Journal;
use super::results::line::ResultLine;
use super::results::summary::Summary;
use super::results::tally::Tally;
use super::scenes::store::Store;
use crate::jobs::failure::Failure;
use crate::jobs::machine;
use crate::methods::{Progress, Workers};
use std::io::{BufRead, Write};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Instant;

/// Jobs in hand beyond the threads: while one loads, adds up or writes, the others keep the threads
/// busy.
const SPARE_JOBS: usize = 2;

/// Runs the jobs of a file.
pub fn of_file(path: &Path, options: &Options, watch: &dyn Watch) -> Result<Summary, Failure> {
    // Before the folder is made: where there are no jobs there is nothing to leave.
    JobFile::check(path)?;
    let (found, earlier) = Journal::look(&options.directory, options.resume)?;
    // Those who share samples all do all jobs.
    let file = JobFile::read(path, options.shard_of_jobs(), earlier)?;
    let manifest = options.manifest(file.hash, file.done + file.lines.len());
    manifest.write(&options.directory, options.resume)?;
    // Nothing was changed before all was known to be in order.
    folder::sweep(&options.directory)?;
    let journal = found.begin()?;
    watch.begin(Some(file.lines.len()), file.done);
    let total = file.lines.len();
    let lines = Mutex::new(file.lines);
    let next = || locked(&lines).pop_front();
    let batch = Batch::new(options, watch, journal, None, Some(total))?;
    batch.run(&next, file.done)
}

/// Answers the lines of a stream one by one until it ends, each with a line on `output` as soon as
/// it is done.
pub fn of_stream(
    input: impl BufRead + Send + 'static,
    output: Box<dyn Write + Send>,
    options: &Options,
    watch: &dyn Watch,
) -> Result<Summary, Failure> {
    let (found, earlier) = Journal::look(&options.directory, options.resume)?;
    folder::sweep(&options.directory)?;
    let journal = found.begin()?;
    watch.begin(None, 0);
    let lines = Mutex::new(Stream::new(input, Register::new(earlier)));
    let batch = Batch::new(options, watch, journal, Some(output), None)?;
    let skipped = AtomicU64::new(0);
    let next = || {
        while !batch.is_stopped() {
            match locked(&lines).wait() {
                // Another job of an id that is done ends a batch of a file; here it is an answer
                // like others.
                Next::Line(Entry::Run(line) | Entry::Unlike(line)) => return Some(line),
                Next::Line(Entry::Done(text)) => {
                    skipped.fetch_add(1, Ordering::Relaxed);
                    batch.answer(&text);
                }
                Next::NotYet => {}
                Next::End => return None,
                Next::Failed(failure) => batch.stop(failure),
            }
        }
        None
    };
    let mut summary = batch.run(&next, 0)?;
    summary.skipped = skipped.into_inner() as usize;
    Ok(summary)
}

struct Batch<'a> {
    shared: Shared<'a>,
    watch: &'a dyn Watch,
    journal: Mutex<Journal>,
    output: Option<Mutex<Box<dyn Write + Send>>>,
    tally: Tally,
    /// What ends the whole batch.
    fatal: Mutex<Option<Failure>>,
    stopped: AtomicBool,
}

fn locked<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    // Jobs that panic do it outside of these locks; what they guard is whole.
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl<'a> Batch<'a> {
    fn new(
        options: &'a Options,
        watch: &'a dyn Watch,
        journal: Journal,
        output: Option<Box<dyn Write + Send>>,
        total: Option<usize>,
    ) -> Result<Self, Failure> {
        let workers =
            Workers::new(options.threads).map_err(|error| Failure::from_engine(error, None))?;
        Ok(Self {
            shared: Shared {
                options,
                store: Store::new(options.memory_bytes, workers.clone(), options.backend),
                workers,
            },
            watch,
            journal: Mutex::new(journal),
            output: output.map(Mutex::new),
            tally: Tally::start(total),
            fatal: Mutex::new(None),
            stopped: AtomicBool::new(false),
        })
    }

    /// Runs lines until there are none.
    fn run(
        &self,
        next: &(dyn Fn() -> Option<Line> + Sync),
        skipped: usize,
    ) -> Result<Summary, Failure> {
        let started = Instant::now();
        let processor = machine::processor_seconds();
        let summary = Mutex::new(Summary::default());
        std::thread::scope(|scope| {
            for started in 0..self.shared.options.threads + SPARE_JOBS {
                let work = || {
                    while !self.is_stopped() {
                        let Some(line) = next() else { return };
                        let Some(result) = self.result_of(line) else {
                            return;
                        };
                        if let Err(failure) = self.record(&result) {
                            self.stop(failure);
                            return;
                        }
                        locked(&summary).add(&result);
                        self.tally.end(&result);
                        self.watch.ended(&result, &self.tally);
                    }
                };
                // One is enough, where there is no memory for more.
                match std::thread::Builder::new().spawn_scoped(scope, work) {
                    Err(error) if started == 0 => {
                        self.stop(Failure::System(format!("no thread for jobs: {error}")));
                    }
                    _ => {}
                }
            }
        });
        if let Some(failure) = locked(&self.fatal).take() {
            return Err(failure);
        }
        if let Some(signal) = self.watch.signal() {
            return Err(Failure::Interrupted(signal));
        }
        let mut summary = summary.into_inner().unwrap_or_else(PoisonError::into_inner);
        summary.skipped = skipped;
        summary.seconds = started.elapsed().as_secs_f64();
        summary.threads = self.shared.options.threads;
        summary.scene_loads = self.shared.store.loads();
        summary.memory_bytes = self.shared.options.memory_bytes;
        summary.peak_memory_bytes = machine::peak();
        let used = machine::processor_seconds().zip(processor);
        summary.processor_seconds = used.map(|(now, then)| now - then);
        Ok(summary)
    }

    fn stop(&self, failure: Failure) {
        self.stopped.store(true, Ordering::Relaxed);
        locked(&self.fatal).get_or_insert(failure);
    }

    fn is_stopped(&self) -> bool {
        self.stopped.load(Ordering::Relaxed) || self.watch.signal().is_some()
    }

    /// The line is on the disk before anyone is told of it.
    fn record(&self, result: &ResultLine) -> Result<(), Failure> {
        let text = result.text();
        locked(&self.journal).append(&text)?;
        self.answer(&text);
        Ok(())
    }

    fn answer(&self, text: &str) {
        let Some(output) = &self.output else { return };
        let mut output = locked(output);
        let told = writeln!(output, "{text}").and_then(|()| output.flush());
        if let Err(error) = told {
            self.stop(match error.into() {
                // Jobs are left undone: unlike at the end of a report, that is a failure.
                Failure::BrokenPipe => Failure::System(format!(
                    "stdout was closed: nobody reads the answers; --resume goes on with {}",
                    self.shared.options.directory.display()
                )),
                other => other,
            });
        }
    }

    /// Runs a job; `None` if it was interrupted.
    fn result_of(&self, line: Line) -> Option<ResultLine> {
        let run = || {
            let progress = JobProgress {
                batch: self,
                told: AtomicU64::new(0),
            };
            self.shared.run(&line, &progress)
        };
        let ended = catch_unwind(AssertUnwindSafe(run)).unwrap_or_else(|_| {
            // The panic has told its place on stderr. The other jobs have nothing to do with it.
            Err(Failure::System(
                "a fault in warpath ended this job; please report it".into(),
            ))
        });
        match ended {
            Ok(result) => Some(result),
            Err(Failure::Interrupted(_)) if self.is_stopped() => None,
            Err(failure) => {
                let mut failure = ResultLine::failed(line.id, line.number, line.hash, &failure);
                let message = failure.message.take().unwrap_or_default();
                failure.message = Some(format!("line {}: {message}", line.number));
                Some(failure)
            }
        }
    }
}

/// How far one job is, as a part of the batch.
struct JobProgress<'a, 'b> {
    batch: &'b Batch<'a>,
    /// Millionths of this job that the tally knows of.
    told: AtomicU64,
}

impl Progress for JobProgress<'_, '_> {
    fn advance(&self, done: u64, total: u64) {
        let now = 1_000_000 * done / total.max(1);
        let before = self.told.fetch_max(now, Ordering::Relaxed);
        self.batch.tally.go_on(now.saturating_sub(before));
        self.batch.watch.advance(&self.batch.tally);
    }

    fn cancelled(&self) -> bool {
        self.batch.is_stopped()
    }
}

impl Drop for JobProgress<'_, '_> {
    /// The whole job is told when it has ended.
    fn drop(&mut self) {
        self.batch.tally.take_back(*self.told.get_mut());
    }
}
