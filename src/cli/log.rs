//! Messages: all of them on stderr, for people or as JSON lines.

use super::arguments::{LogFormat, TalkArguments};
use serde_json::json;
use std::io::{IsTerminal, Write};

/// Where a command's messages go.
#[derive(Clone, Copy, Debug)]
pub struct Log {
    quiet: bool,
    json: bool,
    colour: bool,
}

impl Log {
    /// As the options say. `NO_COLOR` is honoured, and what is not a terminal gets no colour.
    pub fn new(talk: &TalkArguments) -> Self {
        Self {
            quiet: talk.quiet,
            json: talk.log_format == LogFormat::Json,
            colour: colour_wanted(),
        }
    }

    /// For what goes wrong before the options are known.
    pub fn plain() -> Self {
        Self {
            quiet: false,
            json: false,
            colour: colour_wanted(),
        }
    }

    /// Whether nothing but errors is wanted.
    pub fn is_quiet(&self) -> bool {
        self.quiet
    }

    /// Whether stderr is JSON lines.
    pub fn is_json(&self) -> bool {
        self.json
    }

    /// Something the user may want to know.
    pub fn note(&self, text: &str) {
        if !self.quiet {
            self.line("note", "", text);
        }
    }

    /// Something the user should know.
    pub fn warning(&self, text: &str) {
        if !self.quiet {
            self.line("warning", "\x1b[1;33m", text);
        }
    }

    /// Why it did not work.
    pub fn error(&self, text: &str) {
        self.line("error", "\x1b[1;31m", text);
    }

    /// A JSON line of any other kind.
    pub fn event(&self, event: &serde_json::Value) {
        self.put(&format!("{event}\n"));
    }

    fn line(&self, level: &str, colour: &str, text: &str) {
        let line = match (self.json, colour) {
            (true, _) => json!({"event": "message", "level": level, "message": text}).to_string(),
            (false, "") => text.to_string(),
            (false, colour) if self.colour => format!("{colour}{level}:\x1b[0m {text}"),
            (false, _) => format!("{level}: {text}"),
        };
        self.put(&format!("{line}\n"));
    }

    fn put(&self, text: &str) {
        // Nothing is left to complain to when stderr is gone.
        let _ = std::io::stderr().lock().write_all(text.as_bytes());
    }
}

fn colour_wanted() -> bool {
    let no_color = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    let dumb = std::env::var_os("TERM").is_some_and(|value| value == "dumb");
    !no_color && !dumb && std::io::stderr().is_terminal()
}
