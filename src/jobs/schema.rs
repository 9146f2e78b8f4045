//! The JSON schema of a job, made from the types that read it.

use super::job::Job;

/// The schema, indented, with a newline at its end.
pub fn text() -> String {
    let schema = schemars::schema_for!(Job);
    serde_json::to_string_pretty(&schema).unwrap_or_default() + "\n"
}
