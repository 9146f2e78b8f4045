//! From a line to a job. What is wrong is said with the field.

use super::check::check;
use super::failure::Failure;
use super::job::Job;

/// Reads a line.
pub fn job(line: &str) -> Result<Job, Failure> {
    // An array of all fields in their order would do for serde.
    if line.trim_start().starts_with('[') {
        return Err(Failure::Input(
            "a job is a JSON object, {…}, not an array".into(),
        ));
    }
    let mut reader = serde_json::Deserializer::from_str(line);
    let job: Job = serde_path_to_error::deserialize(&mut reader).map_err(|error| {
        let path = error.path().to_string();
        let field = match path.as_str() {
            "." if error.inner().is_syntax() => "not JSON: ".into(),
            "." => String::new(),
            path => format!("{path}: "),
        };
        Failure::Input(format!("{field}{}", without_line(error.inner())))
    })?;
    reader
        .end()
        .map_err(|error| Failure::Input(without_line(&error)))?;
    check(&job)?;
    Ok(job)
}

/// The error without "at line 1 column 7": the line is told by its own number.
pub fn without_line(error: &serde_json::Error) -> String {
    let text = error.to_string();
    match text.rfind(" at line 1 column ") {
        Some(at) => {
            let column = &text[at + " at line 1 column ".len()..];
            format!("{} (column {column})", &text[..at])
        }
        None => text,
    }
}
