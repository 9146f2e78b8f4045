//! Lines that come one by one, for ever perhaps.

use super::register::{Entry, Register};
use crate::jobs::failure::Failure;
use crate::output::plain;
use std::io::BufRead;
use std::sync::mpsc::{Receiver, RecvTimeoutError, sync_channel};
use std::time::Duration;

/// Lines that are read ahead.
const READ_AHEAD: usize = 64;

/// How long a line is waited for before the user's wish to stop is looked at again.
const PATIENCE: Duration = Duration::from_millis(100);

/// A stream of lines, with what is known of their ids.
pub struct Stream {
    lines: Receiver<std::io::Result<Vec<u8>>>,
    register: Register,
    number: usize,
}

/// What waiting for a line has given.
pub enum Next {
    Line(Entry),
    NotYet,
    End,
    Failed(Failure),
}

impl Stream {
    /// Starts reading, on a thread that nobody waits for: it may wait for ever.
    pub fn new(input: impl BufRead + Send + 'static, register: Register) -> Self {
        let (send, lines) = sync_channel(READ_AHEAD);
        std::thread::spawn(move || {
            for line in input.split(b'\n') {
                if send.send(line).is_err() {
                    return;
                }
            }
        });
        Self {
            lines,
            register,
            number: 0,
        }
    }

    /// Waits for the next line for a while.
    pub fn wait(&mut self) -> Next {
        match self.lines.recv_timeout(PATIENCE) {
            Ok(Ok(bytes)) => {
                self.number += 1;
                let text = String::from_utf8_lossy(&bytes);
                match text.trim().is_empty() {
                    true => Next::NotYet,
                    false => Next::Line(self.enter(&text)),
                }
            }
            Ok(Err(error)) => {
                let what = plain(&error);
                Next::Failed(Failure::System(format!("standard input: {what}")))
            }
            Err(RecvTimeoutError::Timeout) => Next::NotYet,
            Err(RecvTimeoutError::Disconnected) => Next::End,
        }
    }

    fn enter(&mut self, text: &str) -> Entry {
        let mut entry = self.register.enter(self.number, text);
        if let Entry::Run(line) = &mut entry {
            line.scene_before = self.register.scene_before(text);
        }
        entry
    }
}
