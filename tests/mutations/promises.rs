//! What the program promises of every run, whatever it was given.

use super::process::Ended;
use super::results;
use serde_json::Value;
use std::path::Path;

const CODES: [i32; 7] = [0, 1, 2, 3, 4, 5, 6];
/// Scenes, images and arrays here are small.
const MOST_BYTES: u64 = 400 << 20;
/// What a batch may hold beside what `--memory` counts: the program itself, and what the allocator
/// keeps.
const SLACK_BYTES: u64 = 64 << 20;
const MOST_LINES: usize = 12;
const MOST_MESSAGE_BYTES: usize = 8000;

/// A promise that was not kept: what it is called, whatever the case, and how it showed.
#[derive(Clone, Debug)]
pub struct Violation {
    pub kind: String,
    pub detail: String,
}

impl Violation {
    pub fn new(kind: impl Into<String>, detail: impl Into<String>) -> Self {
        Self {
            kind: kind.into(),
            detail: detail.into(),
        }
    }
}

/// The first promise that a run did not keep. Where it went on with files that were `damaged` since
/// they were written it need not know.
pub fn broken(
    directory: &Path,
    arguments: &[String],
    ended: &Ended,
    damaged: bool,
) -> Option<Violation> {
    let command = arguments.first().map_or("", String::as_str);
    let stderr = String::from_utf8_lossy(&ended.stderr).into_owned();
    if let Some(why) = ended.killed {
        return Some(Violation::new(format!("{command}: {why}"), stderr));
    }
    if let Some(line) = stderr.lines().find(|line| line.contains("panicked at")) {
        let place = line.split("panicked at").last().unwrap_or_default().trim();
        return Some(Violation::new(format!("panic at {place}"), stderr));
    }
    let Some(code) = ended.code.filter(|code| CODES.contains(code)) else {
        let how = ended.signal.map_or_else(
            || format!("exit code {:?}", ended.code),
            |signal| format!("signal {signal}"),
        );
        // Where an assertion of a library failed, if it tells.
        let is_place = |word: &&str| {
            [".cpp:", ".h:", ".rs:"]
                .iter()
                .any(|end| word.contains(end))
        };
        let place = stderr.split_whitespace().find(is_place).unwrap_or_default();
        return Some(Violation::new(format!("{how} {place}"), stderr));
    };
    let told = talk(command, code, ended, &stderr);
    let found = told
        .or_else(|| memory(command, arguments, ended))
        .or_else(|| json_lines(command, arguments, &stderr));
    let found = match damaged {
        true => found,
        false => found.or_else(|| results::broken(directory, arguments, code, &ended.stdout)),
    };
    found.map(|violation| Violation {
        detail: format!("{}\nexit code {code}\n{stderr}", violation.detail),
        ..violation
    })
}

fn talk(command: &str, code: i32, ended: &Ended, stderr: &str) -> Option<Violation> {
    let is_control = |c: &u8| (*c < 0x20 && *c != b'\n' && *c != b'\t') || *c == 0x7f;
    for (name, bytes) in [("stdout", &ended.stdout), ("stderr", &ended.stderr)] {
        if let Some(byte) = bytes.iter().find(|b| is_control(b)) {
            let kind = format!("{command}: control characters on {name}");
            return Some(Violation::new(kind, format!("{byte:#04x}")));
        }
        if std::str::from_utf8(bytes).is_err() {
            let kind = format!("{command}: {name} is not UTF-8");
            return Some(Violation::new(kind, ""));
        }
    }
    if stderr.contains("RUST_BACKTRACE") || stderr.contains("stack backtrace") {
        return Some(Violation::new(format!("{command}: a backtrace"), ""));
    }
    if code != 0 && stderr.trim().is_empty() {
        let kind = format!("{command}: code {code} without a message");
        return Some(Violation::new(kind, ""));
    }
    let is_long = stderr.lines().count() > MOST_LINES || stderr.len() > MOST_MESSAGE_BYTES;
    // A batch tells of each of its jobs.
    if is_long && !matches!(command, "batch" | "check") {
        let what = format!("{} lines, {} bytes", stderr.lines().count(), stderr.len());
        return Some(Violation::new(format!("{command}: long messages"), what));
    }
    None
}

fn memory(command: &str, arguments: &[String], ended: &Ended) -> Option<Violation> {
    let limit = value(arguments, "--memory").and_then(|text| {
        let megabytes = text.strip_suffix('M')?.parse::<u64>().ok()?;
        Some((megabytes << 20) + SLACK_BYTES)
    });
    let limit = limit.unwrap_or(MOST_BYTES).min(MOST_BYTES);
    let megabytes = ended.peak_bytes >> 20;
    (ended.peak_bytes > limit).then(|| {
        let what = format!("{megabytes} MiB where {} are the limit", limit >> 20);
        Violation::new(format!("{command}: memory"), what)
    })
}

/// With `--log-format json` every message is an object.
fn json_lines(command: &str, arguments: &[String], stderr: &str) -> Option<Violation> {
    let asked = arguments.iter().any(|a| a == "--log-format=json");
    // Twice, or before what cannot be parsed, it means nothing.
    if !asked || arguments.iter().any(|a| a == "--log-format") || stderr.starts_with("error: ") {
        return None;
    }
    let is_object = |line: &str| matches!(serde_json::from_str(line), Ok(Value::Object(_)));
    let bad = stderr.lines().find(|line| !is_object(line))?;
    Some(Violation::new(
        format!("{command}: a message that is no JSON"),
        bad,
    ))
}

/// What follows an option.
pub fn value<'a>(arguments: &'a [String], option: &str) -> Option<&'a str> {
    let at = arguments.iter().rposition(|a| a == option)?;
    arguments.get(at + 1).map(String::as_str)
}
