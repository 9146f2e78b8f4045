//! The command line: arguments apart from work, one file per command.

pub mod arguments;
mod backward;
mod batch;
mod batch_progress;
mod bench;
mod check;
mod completions;
mod exit;
mod forward;
mod log;
mod merge;
mod optimize;
mod optimize_progress;
mod pace;
mod params;
mod progress;
mod render;
mod report;
mod session;
mod signals;
mod study;
mod values;

use arguments::{Arguments, Command};
use clap::Parser;
use exit::Failure;
use log::{Log, harmless};
use std::ffi::OsString;
use std::io::Write;
use std::process::ExitCode;

/// Runs the program with its arguments, the program's name first.
pub fn run(typed: impl IntoIterator<Item = OsString>) -> ExitCode {
    let typed: Vec<OsString> = typed.into_iter().collect();
    match Arguments::try_parse_from(&typed) {
        Ok(arguments) => ended(log_of(&arguments), dispatch(&arguments, &typed)),
        Err(error) => not_parsed(&error, &typed),
    }
}

fn dispatch(arguments: &Arguments, typed: &[OsString]) -> Result<(), Failure> {
    match &arguments.command {
        Command::Render(render) => render::run(render, typed),
        Command::Params(params) => params::run(params),
        Command::Forward(forward) => forward::run(forward, typed),
        Command::Backward(backward) => backward::run(backward, typed),
        Command::Check(check) => check::run(check, typed),
        Command::Bench(bench) => bench::run(bench, typed),
        Command::Batch(batch) => batch::run(batch, typed),
        Command::Merge(merge) => merge::run(merge, typed),
        Command::Optimize(optimize) => optimize::run(optimize, typed),
        Command::Study(study) => study::run(study, typed),
        Command::Completions { shell } => completions::shell(*shell),
        Command::Man => completions::man(),
    }
}

fn ended(log: Log, done: Result<(), Failure>) -> ExitCode {
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            if !matches!(failure, Failure::BrokenPipe) {
                log.error(&failure.to_string());
            }
            ExitCode::from(&failure)
        }
    }
}

fn log_of(arguments: &Arguments) -> Log {
    match &arguments.command {
        Command::Render(a) => Log::new(&a.trace.talk),
        Command::Params(a) => Log::new(&a.talk),
        Command::Forward(a) => Log::new(&a.trace.talk),
        Command::Backward(a) => Log::new(&a.trace.talk),
        Command::Check(a) => Log::new(&a.trace.talk),
        Command::Bench(a) => Log::new(&a.talk),
        Command::Batch(a) => Log::new(&a.talk),
        Command::Merge(a) => Log::new(&a.talk),
        Command::Optimize(a) => Log::new(&a.talk),
        Command::Study(a) => Log::new(&a.talk),
        Command::Completions { .. } | Command::Man => Log::plain(),
    }
}

/// Help and the version count as success; everything else clap stops at is wrong usage.
fn not_parsed(error: &clap::Error, typed: &[OsString]) -> ExitCode {
    let is_plain = |argument: &OsString| argument.to_str().is_some_and(|a| a == harmless(a));
    let printed = match error.use_stderr() && !typed.iter().all(is_plain) {
        true => writeln!(
            std::io::stderr(),
            "{}",
            harmless(&error.render().to_string())
        ),
        false => error.print(),
    };
    if error.use_stderr() {
        // Nobody is left to tell when stderr is gone.
        return ExitCode::from(&Failure::Usage(String::new()));
    }
    let done = printed.and_then(|()| std::io::stdout().flush());
    ended(Log::plain(), done.map_err(Failure::from))
}
