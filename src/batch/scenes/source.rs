//! Files of a scene, whose memory is counted before they are read.

use super::ledger::Reservation;
use crate::jobs::failure::Failure;
use crate::jobs::shown;
use crate::picture;
use crate::room::Cancelled;
use crate::scene::source::{Disk, FileSource};
use std::cell::RefCell;
use std::io;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Bytes in memory for each byte of a mesh or scene file while it is being read: the file, what is
/// parsed of it, and the mesh.
const GROWTH: u64 = 4;

/// When a file was last changed, and its length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stamp {
    modified: Option<SystemTime>,
    length: u64,
}

impl Stamp {
    /// Of the file as it is now.
    pub fn of(path: &Path) -> Option<Self> {
        let metadata = std::fs::metadata(path).ok()?;
        Some(Self {
            modified: metadata.modified().ok(),
            length: metadata.len(),
        })
    }
}

/// The disk; what is read from it is counted and remembered.
pub struct Counted<'a, S> {
    inner: RefCell<Inner<'a, S>>,
    cancelled: Cancelled<'a>,
}

struct Inner<'a, S> {
    reservation: &'a mut Reservation<S>,
    bytes: u64,
    files: Vec<(PathBuf, Stamp)>,
    refusal: Option<Failure>,
}

impl<'a, S> Counted<'a, S> {
    pub fn new(reservation: &'a mut Reservation<S>, cancelled: Cancelled<'a>) -> Self {
        Self {
            inner: RefCell::new(Inner {
                reservation,
                bytes: 0,
                files: Vec::new(),
                refusal: None,
            }),
            cancelled,
        }
    }

    /// The files that were read, and why one was not if memory did not let it.
    pub fn finish(self) -> (Vec<(PathBuf, Stamp)>, Option<Failure>) {
        let inner = self.inner.into_inner();
        (inner.files, inner.refusal)
    }

    fn count(&self, path: &Path, bytes: u64) -> io::Result<()> {
        let mut inner = self.inner.borrow_mut();
        let total = inner.bytes + bytes;
        match inner.reservation.become_bytes(total, self.cancelled) {
            Ok(()) => {
                inner.bytes = total;
                Ok(())
            }
            Err(failure) => {
                inner.refusal = Some(match failure {
                    Failure::System(what) => Failure::System(format!(
                        "{}: reading it takes about {}: {what}",
                        path.display(),
                        shown::bytes(bytes)
                    )),
                    other => other,
                });
                Err(io::ErrorKind::OutOfMemory.into())
            }
        }
    }
}

impl<S> FileSource for Counted<'_, S> {
    fn read(&self, path: &Path) -> io::Result<Vec<u8>> {
        if (self.cancelled)() {
            self.inner.borrow_mut().refusal = Some(Failure::Interrupted(2));
            return Err(io::ErrorKind::Interrupted.into());
        }
        let stamp = Stamp::of(path);
        if let Ok(metadata) = std::fs::metadata(path) {
            self.count(path, GROWTH * metadata.len())?;
        }
        let bytes = Disk.read(path)?;
        // A compressed picture says how large it gets.
        if let Some([width, height]) = picture::size_of(&bytes) {
            self.count(path, 2 * 12 * u64::from(width) * u64::from(height))?;
        }
        if let Some(stamp) = stamp {
            self.inner.borrow_mut().files.push((path.into(), stamp));
        }
        Ok(bytes)
    }

    fn exists(&self, path: &Path) -> bool {
        Disk.exists(path)
    }

    fn canonical(&self, path: &Path) -> PathBuf {
        Disk.canonical(path)
    }
}
