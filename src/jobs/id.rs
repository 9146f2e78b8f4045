//! Names of jobs: each names a folder of the batch's results, beside the batch's own files.

use super::failure::Failure;

/// One line a job that has ended.
pub const RESULTS: &str = "results.jsonl";

/// What a folder holds the results of.
pub const MANIFEST: &str = "batch.json";

/// How the batch went.
pub const REPORT: &str = "report.json";

/// Longest id, in bytes: with what is put around it, it is a file name.
const LONGEST_ID: usize = 128;

/// An id is a folder's name wherever the results are copied to.
pub fn check_id(id: &str) -> Result<(), Failure> {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    if [RESULTS, MANIFEST, REPORT].contains(&id) {
        return Err(Failure::Input(format!(
            "id: {id} is the name of the batch's own file"
        )));
    }
    let fits = !id.is_empty() && id.len() <= LONGEST_ID;
    if fits && id.chars().all(is_plain) && !id.starts_with('.') {
        return Ok(());
    }
    let shown: String = id.chars().take(40).collect();
    Err(Failure::Input(format!(
        "id: {shown:?} cannot name a folder; use up to {LONGEST_ID} letters, digits, '-', '_' and '.', the first no '.'"
    )))
}
