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

    /// For a process beside one that speaks.
    pub fn silent() -> Self {
        Self {
            quiet: true,
            ..Self::plain()
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
        if self.json {
            return self.line("error", "", text);
        }
        // A scene can have several.
        for one in text.lines() {
            self.line("error", "\x1b[1;31m", one);
        }
    }

    /// A JSON line of any other kind.
    pub fn event(&self, event: &serde_json::Value) {
        self.put(&json_line(event));
    }

    fn line(&self, level: &str, colour: &str, text: &str) {
        let line = match (self.json, colour) {
            (true, _) => {
                return self.event(&json!({"event": "message", "level": level, "message": text}));
            }
            (false, "") => harmless(text),
            (false, colour) if self.colour => {
                format!("{colour}{level}:\x1b[0m {}", harmless(text))
            }
            (false, _) => format!("{level}: {}", harmless(text)),
        };
        self.put(&format!("{line}\n"));
    }

    fn put(&self, text: &str) {
        // Nothing is left to complain to when stderr is gone.
        let _ = std::io::stderr().lock().write_all(text.as_bytes());
    }
}

/// Text with the names of control characters in their place, and of those that turn the direction
/// of writing: files and their names hold whatever others have put there, and a terminal obeys.
/// Further lines stand out from messages.
pub fn harmless(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\n' => out.push_str("\n  "),
            c if commands(c) => out.extend(c.escape_unicode()),
            c => out.push(c),
        }
    }
    out
}

fn commands(c: char) -> bool {
    c.is_control()
        || matches!(c, '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// JSON leaves some control characters as they are. They stand in texts only.
fn json_line(value: &serde_json::Value) -> String {
    let mut out = String::new();
    for c in value.to_string().chars() {
        match commands(c) {
            true => out.push_str(&format!("\\u{:04x}", u32::from(c))),
            false => out.push(c),
        }
    }
    out + "\n"
}

fn colour_wanted() -> bool {
    let no_color = std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty());
    let dumb = std::env::var_os("TERM").is_some_and(|value| value == "dumb");
    !no_color && !dumb && std::io::stderr().is_terminal()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_terminal_obeys_nothing_in_a_text() {
        let text = "a\x1b[31mé\u{9b}2J\r\u{202e}b\x7f\nerror: c";
        let shown = harmless(text);
        assert_eq!(
            shown,
            "a\\u{1b}[31mé\\u{9b}2J\\u{d}\\u{202e}b\\u{7f}\n  error: c"
        );
        let line = json_line(&json!({"message": text}));
        assert!(!line.trim_end_matches('\n').chars().any(commands), "{line}");
        let read: serde_json::Value = serde_json::from_str(&line).unwrap();
        assert_eq!(read["message"], text);
    }
}
