//! A job's folder: there with all its files, or not at all.

use crate::batch::samples::share::PARTIAL;
use crate::files;
use crate::jobs::failure::Failure;
use crate::jobs::id::{MANIFEST, REPORT, RESULTS};
use crate::output::results::{BACKWARD, FORWARD, RENDER, ResultFile};
use crate::output::unfinished::Unfinished;
use crate::output::{FileError, atomic, plain};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::{self, ErrorKind};
use std::path::{Path, PathBuf};

/// Ends the names of folders that are not complete.
const UNFINISHED: &str = ".unfinished";

/// The batch's own files, which are written under temporary names too, and the probe of its folder.
const OWN_FILES: [&str; 4] = [RESULTS, MANIFEST, REPORT, "probe"];

/// Writes the files into `directory/id`, and returns their paths from `directory` by their keys
/// once they would survive a power cut.
pub fn write(
    directory: &Path,
    id: &str,
    files: &[ResultFile],
) -> Result<BTreeMap<String, String>, Failure> {
    let named: Vec<_> = files
        .iter()
        .map(|file| (PathBuf::from(file.name), file))
        .collect();
    let put = |file: &&ResultFile, path: &Path| Ok(file.write(path)?);
    fill(directory, id, &named, put)?;
    Ok(files
        .iter()
        .map(|file| (file.key.to_string(), format!("{id}/{}", file.name)))
        .collect())
}

/// Makes the folder of a job that another batch has written: its files under their names.
pub fn copy(directory: &Path, id: &str, files: &[PathBuf]) -> Result<(), Failure> {
    let names = |path: &PathBuf| path.file_name().map(PathBuf::from).unwrap_or_default();
    let put = |from: &&PathBuf, to: &Path| -> Result<(), Failure> {
        let bytes = files::read(from).map_err(|error| FileError::unread(*from, &error))?;
        fs::write(to, bytes).map_err(failed(to))
    };
    let files: Vec<_> = files.iter().map(|path| (names(path), path)).collect();
    fill(directory, id, &files, put)
}

/// Puts every file into an unfinished folder, then gives that its name.
fn fill<T>(
    directory: &Path,
    id: &str,
    files: &[(PathBuf, T)],
    put: impl Fn(&T, &Path) -> Result<(), Failure>,
) -> Result<(), Failure> {
    refuse_taken(directory, id)?;
    let folder = directory.join(id);
    // An id never starts with a dot.
    let path = directory.join(format!(".{id}{UNFINISHED}"));
    let unfinished = Unfinished::folder(path.clone()).map_err(failed(&path))?;
    for (name, file) in files {
        let path = unfinished.path().join(name);
        put(file, &path)?;
        let open = File::open(&path);
        open.and_then(|file| file.sync_data())
            .map_err(failed(&path))?;
    }
    atomic::sync_directory(unfinished.path())?;
    // Without a line in the results, they are what a run that was killed has left.
    clear(&folder)?;
    unfinished.becomes(&folder).map_err(failed(&folder))?;
    Ok(atomic::sync_directory(directory)?)
}

/// Refuses a job whose folder's name is taken: by a link, or by a folder with anything in it that
/// no job writes. What is in there is the user's own.
pub fn refuse_taken(directory: &Path, id: &str) -> Result<(), Failure> {
    let folder = directory.join(id);
    refuse_link(&folder)?;
    let entries = match fs::read_dir(&folder) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        entries => entries.map_err(failed(&folder))?,
    };
    for entry in entries {
        let entry = entry.map_err(failed(&folder))?;
        let name = entry.file_name();
        let is_file = entry.file_type().is_ok_and(|kind| kind.is_file());
        if !is_file || !of_jobs().any(|of_job| name == *of_job) {
            return Err(Failure::Input(format!(
                "{}: this folder holds {}, which is no job's: move it away, or choose another -o",
                folder.display(),
                name.display()
            )));
        }
    }
    Ok(())
}

/// Names of all files that a job writes.
fn of_jobs() -> impl Iterator<Item = &'static str> {
    let all = RENDER.iter().chain(&FORWARD).chain(&BACKWARD);
    all.copied().chain([PARTIAL])
}

/// Takes away a job's folder with its files. One with anything else in it stays, which is an error.
fn clear(folder: &Path) -> Result<(), Failure> {
    for name in of_jobs() {
        let path = folder.join(name);
        absent_or(fs::remove_file(&path)).map_err(failed(&path))?;
    }
    absent_or(fs::remove_dir(folder)).map_err(failed(folder))
}

fn absent_or(removed: io::Result<()>) -> io::Result<()> {
    match removed {
        Err(error) if error.kind() == ErrorKind::NotFound => Ok(()),
        other => other,
    }
}

/// Refuses a folder in which symbolic links stand where the batch itself writes or takes away: what
/// they lead to is none of its business.
pub fn refuse_links(directory: &Path) -> Result<(), Failure> {
    for own in OWN_FILES {
        refuse_link(&directory.join(own))?;
    }
    for path in unfinished(directory)? {
        refuse_link(&path)?;
    }
    Ok(())
}

fn refuse_link(path: &Path) -> Result<(), Failure> {
    match fs::symlink_metadata(path) {
        Ok(what) if what.is_symlink() => Err(Failure::Input(format!(
            "{}: a symbolic link, which a batch does not write through: move it away, or choose another -o",
            path.display()
        ))),
        _ => Ok(()),
    }
}

/// Takes away what a batch that was killed was writing.
pub fn sweep(directory: &Path) -> Result<(), Failure> {
    for path in unfinished(directory)? {
        match path.is_dir() {
            true => fs::remove_dir_all(&path),
            false => fs::remove_file(&path),
        }
        .map_err(failed(&path))?;
    }
    Ok(())
}

/// Everything under a temporary name.
fn unfinished(directory: &Path) -> Result<Vec<PathBuf>, Failure> {
    let mut found = Vec::new();
    for entry in fs::read_dir(directory).map_err(failed(directory))? {
        let entry = entry.map_err(failed(directory))?;
        let name = entry.file_name();
        let name = name.to_string_lossy();
        let begins = |file: &str| name.starts_with(&format!(".{file}."));
        let is_folder = name.starts_with('.') && name.ends_with(UNFINISHED);
        if is_folder || OWN_FILES.into_iter().any(begins) && name.ends_with(".tmp") {
            found.push(entry.path());
        }
    }
    Ok(found)
}

fn failed(path: &Path) -> impl Fn(io::Error) -> Failure + '_ {
    move |error| {
        let what = format!("cannot be written: {}", plain(&error));
        FileError::io(path, what).into()
    }
}
