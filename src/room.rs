//! Room in memory for what may be large: where there is none, an error and not the end of the
//! process.

use std::io;

/// So many bytes could not be had.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("no memory for it: {} MB are needed", .bytes.div_ceil(1 << 20))]
pub struct NoRoom {
    /// How many were asked for at once.
    pub bytes: u64,
}

impl From<NoRoom> for io::Error {
    fn from(error: NoRoom) -> Self {
        io::Error::new(io::ErrorKind::OutOfMemory, error)
    }
}

/// Why something large was not made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Unfinished {
    #[error(transparent)]
    NoRoom(#[from] NoRoom),
    /// The user wants to stop.
    #[error("interrupted")]
    Interrupted,
}

/// Asks whether the user wants to stop.
pub type Cancelled<'a> = &'a (dyn Fn() -> bool + Sync);

/// An empty vector that `count` items fit into.
pub fn empty<T>(count: usize) -> Result<Vec<T>, NoRoom> {
    let mut items = Vec::new();
    let bytes = (count as u64).saturating_mul(size_of::<T>() as u64);
    let reserved = items.try_reserve_exact(count);
    reserved.map(|()| items).map_err(|_| NoRoom { bytes })
}

/// `count` times the same.
pub fn filled<T: Clone>(item: T, count: usize) -> Result<Vec<T>, NoRoom> {
    let mut items = empty(count)?;
    items.resize(count, item);
    Ok(items)
}

/// A copy.
pub fn copy<T: Copy>(of: &[T]) -> Result<Vec<T>, NoRoom> {
    let mut items = empty(of.len())?;
    items.extend_from_slice(of);
    Ok(items)
}

/// Asks for room that a library is going to take and would not do without. Another thread may be
/// faster.
pub fn look_for(bytes: u64) -> Result<(), NoRoom> {
    let count = usize::try_from(bytes).map_err(|_| NoRoom { bytes })?;
    empty::<u8>(count).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_more_than_any_memory_is_an_error() {
        for count in [usize::MAX, usize::MAX / 16] {
            assert!(empty::<[f32; 3]>(count).is_err());
            assert!(look_for(count as u64).is_err());
        }
        assert_eq!(filled(7u8, 3), Ok(vec![7; 3]));
        let bytes = 5 << 20;
        assert!(NoRoom { bytes }.to_string().contains("5 MB"));
    }
}
