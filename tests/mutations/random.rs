//! Random draws that are the same on every machine.

/// SplitMix64: any two seeds give streams that have nothing in common.
#[derive(Clone)]
pub struct Random(u64);

impl Random {
    /// The stream of a place in a tree of streams, such as the third mutation of the tenth case.
    pub fn of(path: &[u64]) -> Self {
        let mut random = Self(0);
        for &step in path {
            random = Self(random.next() ^ step.wrapping_mul(0xd134_2543_de82_ef95));
        }
        random
    }

    pub fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Below `n`, which is not 0.
    pub fn below(&mut self, n: usize) -> usize {
        (self.next() % n as u64) as usize
    }

    /// True in `percent` of a hundred cases.
    pub fn chance(&mut self, percent: u64) -> bool {
        self.next() % 100 < percent
    }

    pub fn pick<'a, T>(&mut self, from: &'a [T]) -> &'a T {
        &from[self.below(from.len())]
    }

    /// One of some words.
    pub fn word<'a>(&mut self, from: &[&'a str]) -> &'a str {
        from[self.below(from.len())]
    }

    /// From `low` to `high`, of a thousand steps: short to print.
    pub fn number(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.below(1001) as f64 / 1000.0
    }
}
