//! Which part of a batch this process does.

use std::fmt;

/// One of several processes that share a batch.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// From 1 to `count`.
    pub index: u32,
    pub count: u32,
}

/// What processes share out.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Split {
    /// The jobs: each is done by one process.
    #[default]
    Jobs,
    /// The groups of samples of every job.
    Samples,
}

impl Split {
    /// As it is typed.
    pub fn name(self) -> &'static str {
        match self {
            Split::Jobs => "jobs",
            Split::Samples => "samples",
        }
    }
}

impl Shard {
    /// Whether the item of this number, from 0, is this shard's.
    pub fn has(self, number: usize) -> bool {
        number as u64 % u64::from(self.count) == u64::from(self.index - 1)
    }

    /// The shard of this number, if there is one.
    pub fn new(index: u64, count: u64) -> Option<Self> {
        let (index, count) = (u32::try_from(index).ok()?, u32::try_from(count).ok()?);
        (1..=count)
            .contains(&index)
            .then_some(Self { index, count })
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}/{}", self.index, self.count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_item_is_one_shards() {
        for count in [1, 2, 5, 16] {
            for item in 0..100 {
                let owners = (1..=count).filter(|&index| Shard { index, count }.has(item));
                assert_eq!(owners.count(), 1);
            }
        }
    }
}
