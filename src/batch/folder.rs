//! A job's folder: there with all its files, or not at all.

use super::failure::Failure;
use super::journal::RESULTS;
use super::manifest::{MANIFEST, REPORT};
use crate::output::results::ResultFile;
use crate::output::{FileError, atomic};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::{Path, PathBuf};

/// Ends the names of folders that are not complete.
const UNFINISHED: &str = ".unfinished";

/// The batch's own files, which are written under temporary names too, and the probe of its folder.
const OWN_FILES: [&str; 4] = [RESULTS, MANIFEST, REPORT, "probe"];

/// Writes the files into `directory/id`, and returns their paths from `directory` by their keys once they would
/// survive a power cut.
pub fn write(
    directory: &Path,
    id: &str,
    files: &[ResultFile],
) -> Result<BTreeMap<String, String>, Failure> {
    let unfinished = unfinished(directory, id);
    let named: Vec<_> = files
        .iter()
        .map(|file| (PathBuf::from(file.name), file))
        .collect();
    let put = |file: &&ResultFile, path: &Path| Ok(file.write(path)?);
    let written = fill(directory, id, &unfinished, &named, put);
    if written.is_err() {
        // What made the writing fail may make this fail too; the next run takes it away.
        let _ = fs::remove_dir_all(&unfinished);
    }
    written?;
    Ok(files
        .iter()
        .map(|file| (file.key.to_string(), format!("{id}/{}", file.name)))
        .collect())
}

/// Makes the folder of a job that another batch has written: its files under their names.
pub fn copy(directory: &Path, id: &str, files: &[PathBuf]) -> Result<(), Failure> {
    let names = |path: &PathBuf| path.file_name().map(PathBuf::from).unwrap_or_default();
    let put = |from: &&PathBuf, to: &Path| -> Result<(), Failure> {
        fs::copy(from, to).map(drop).map_err(failed(from))
    };
    let files: Vec<_> = files.iter().map(|path| (names(path), path)).collect();
    fill(directory, id, &unfinished(directory, id), &files, put)
}

/// Puts every file into the unfinished folder, then gives that its name.
fn fill<T>(
    directory: &Path,
    id: &str,
    unfinished: &Path,
    files: &[(PathBuf, T)],
    put: impl Fn(&T, &Path) -> Result<(), Failure>,
) -> Result<(), Failure> {
    remove(unfinished)?;
    fs::create_dir(unfinished).map_err(failed(unfinished))?;
    for (name, file) in files {
        let path = unfinished.join(name);
        put(file, &path)?;
        let open = File::open(&path);
        open.and_then(|file| file.sync_data())
            .map_err(failed(&path))?;
    }
    atomic::sync_directory(unfinished)?;
    // Without a line in the results, files of this name are not a job's.
    let folder = directory.join(id);
    remove(&folder)?;
    fs::rename(unfinished, &folder).map_err(failed(&folder))?;
    Ok(atomic::sync_directory(directory)?)
}

/// Takes away what a batch that was killed was writing.
pub fn sweep(directory: &Path) -> Result<(), Failure> {
    let entries = fs::read_dir(directory).map_err(failed(directory))?;
    for entry in entries {
        let entry = entry.map_err(failed(directory))?;
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let begins = |file: &str| name.starts_with(&format!(".{file}."));
        if name.starts_with('.') && name.ends_with(UNFINISHED) {
            remove(&entry.path())?;
        } else if OWN_FILES.into_iter().any(begins) && name.ends_with(".tmp") {
            fs::remove_file(entry.path()).map_err(failed(&entry.path()))?;
        }
    }
    Ok(())
}

/// An id never starts with a dot.
fn unfinished(directory: &Path, id: &str) -> PathBuf {
    directory.join(format!(".{id}{UNFINISHED}"))
}

fn remove(folder: &Path) -> Result<(), Failure> {
    match fs::remove_dir_all(folder) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(failed(folder)(error)),
        _ => Ok(()),
    }
}

fn failed(path: &Path) -> impl Fn(std::io::Error) -> Failure + '_ {
    move |error| {
        let what = format!("cannot be written: {}", atomic::plain(&error));
        FileError::io(path, what).into()
    }
}
