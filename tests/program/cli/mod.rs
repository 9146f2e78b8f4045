//! Commands and options: exit codes, messages, streams, files.

mod bad_input;
mod bench;
mod broken_scenes;
mod check;
mod earlier_runs;
mod irregular;
mod large_numbers;
mod large_scenes;
mod runs;
mod signals;
mod streams;
mod usage;
