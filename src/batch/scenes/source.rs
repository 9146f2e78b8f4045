//! Files of a scene, whose memory is counted before they are read.

use super::loaded::Stamp;
use super::store::Reservation;
use crate::jobs::failure::Failure;
use crate::jobs::shown;
use crate::picture;
use crate::room::Cancelled;
use crate::scene::source::{Disk, FileSource};
use std::cell::RefCell;
use std::io;
use std::path::{Path, PathBuf};

/// Bytes in memory for each byte of a mesh or scene file while it is being read: the file, what is parsed of it, and
/// the mesh.
const GROWTH: u64 = 4;

/// The disk; what is read from it is counted and remembered.
pub struct Counted<'a> {
    inner: RefCell<Inner<'a>>,
    cancelled: Cancelled<'a>,
}

struct Inner<'a> {
    reservation: &'a mut Reservation,
    bytes: u64,
    files: Vec<(PathBuf, Stamp)>,
    refusal: Option<Failure>,
}

impl<'a> Counted<'a> {
    pub fn new(reservation: &'a mut Reservation, cancelled: Cancelled<'a>) -> Self {
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

impl FileSource for Counted<'_> {
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
