//! What a traversal still has to visit.

use glam::UVec2;
use obvhs::faststack::FastStack;

/// Entries kept without allocating: as many as compressed trees over real scenes need.
const INLINE: usize = 24;

/// A stack that no tree overflows: obvhs's own overwrites its last entry where a degenerate scene's
/// tree is too deep.
pub struct Stack {
    entries: [UVec2; INLINE],
    length: usize,
    more: Vec<UVec2>,
}

impl Default for Stack {
    #[inline(always)]
    fn default() -> Self {
        Self {
            entries: [UVec2::ZERO; INLINE],
            length: 0,
            more: Vec::new(),
        }
    }
}

impl FastStack<UVec2> for Stack {
    #[inline(always)]
    fn push(&mut self, entry: UVec2) {
        match self.entries.get_mut(self.length) {
            Some(place) => *place = entry,
            None => self.more.push(entry),
        }
        self.length += 1;
    }

    #[inline(always)]
    fn pop_fast(&mut self) -> UVec2 {
        self.pop().unwrap_or_default()
    }

    #[inline(always)]
    fn pop(&mut self) -> Option<UVec2> {
        self.length = self.length.checked_sub(1)?;
        match self.entries.get(self.length) {
            Some(entry) => Some(*entry),
            None => self.more.pop(),
        }
    }

    #[inline(always)]
    fn len(&self) -> usize {
        self.length
    }

    #[inline(always)]
    fn is_empty(&self) -> bool {
        self.length == 0
    }

    fn clear(&mut self) {
        self.length = 0;
        self.more.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn entries_come_back_last_first_however_many() {
        let mut stack = Stack::default();
        for i in 0..3 * INLINE as u32 {
            stack.push(UVec2::new(i, 7));
        }
        for i in (0..3 * INLINE as u32).rev() {
            assert_eq!(stack.pop(), Some(UVec2::new(i, 7)));
        }
        assert!(stack.is_empty() && stack.pop().is_none());
    }
}
