//! What is being written under a temporary name: it gets its own name when it is whole, or goes,
//! even if the process must end in the middle.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// All that this process is writing. Held while one of them is made or gets its name, so that
/// [`remove_all`] never takes away what has just been finished.
static UNFINISHED: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// A file may be made in a folder just while it is taken away.
const ATTEMPTS: u32 = 5;
const BETWEEN_ATTEMPTS: Duration = Duration::from_millis(10);

/// A file or folder under a temporary name. Dropped, it is taken away.
#[derive(Debug)]
pub struct Unfinished {
    path: PathBuf,
}

impl Unfinished {
    /// Makes a new file, in place of what a process that was killed has left there.
    pub fn file(path: PathBuf) -> io::Result<(Self, File)> {
        let mut all = locked();
        let _ = fs::remove_file(&path);
        let file = File::create_new(&path)?;
        all.insert(path.clone());
        Ok((Self { path }, file))
    }

    /// Makes a new folder, in place of what a process that was killed has left there.
    pub fn folder(path: PathBuf) -> io::Result<Self> {
        let mut all = locked();
        match fs::remove_dir_all(&path) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(error),
            _ => fs::create_dir(&path)?,
        }
        all.insert(path.clone());
        Ok(Self { path })
    }

    /// Where it is until then.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Gives it its name.
    pub fn becomes(self, name: &Path) -> io::Result<()> {
        let mut all = locked();
        fs::rename(&self.path, name)?;
        all.remove(&self.path);
        Ok(())
    }
}

impl Drop for Unfinished {
    fn drop(&mut self) {
        if locked().remove(&self.path) {
            // What made the writing fail may make this fail too; the error of the writing is the
            // one that tells.
            let _ = remove(&self.path);
        }
    }
}

/// For a process that is about to end: takes away all that is unfinished. Whoever wants to begin or
/// to finish anything from now on waits until the process ends.
pub fn remove_all() {
    let all = locked();
    for path in all.iter() {
        for _ in 0..ATTEMPTS {
            match remove(path) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => {
                    std::thread::sleep(BETWEEN_ATTEMPTS);
                }
                _ => break,
            }
        }
    }
    std::mem::forget(all);
}

fn remove(path: &Path) -> io::Result<()> {
    match fs::symlink_metadata(path)?.is_dir() {
        true => fs::remove_dir_all(path),
        false => fs::remove_file(path),
    }
}

fn locked() -> MutexGuard<'static, BTreeSet<PathBuf>> {
    // Nothing panics in between.
    UNFINISHED.lock().unwrap_or_else(PoisonError::into_inner)
}
