//! Finding a number among ascending sums without searching all of them.
//!
//! The range of the numbers is cut into equal buckets, and for each bucket's lower end it is known
//! where among the sums that lies \[Chen1974\]. What is left is a search between the two ends of a
//! bucket, some neighbours in memory.

/// Sums for each bucket, about.
const SUMS_A_BUCKET: usize = 4;

/// First guesses for sums from 0 to 1.
#[derive(Default)]
pub struct Guide {
    /// Of each list of sums, for each bucket's lower end and for 1.
    first: Vec<u32>,
    buckets: usize,
}

impl Guide {
    /// `sums`: lists one after another, each of this length, ascending to 1.
    pub fn new(sums: &[f64], length: usize) -> Self {
        // A power of two, by which numbers are multiplied and divided exactly.
        let buckets = length.div_ceil(SUMS_A_BUCKET).next_power_of_two();
        let mut first = Vec::with_capacity(sums.len() / length * (buckets + 1));
        for list in sums.chunks_exact(length) {
            let mut at = 0;
            for bucket in 0..=buckets {
                let low = bucket as f64 / buckets as f64;
                while at < length && list[at] <= low {
                    at += 1;
                }
                first.push(at as u32);
            }
        }
        Self { first, buckets }
    }

    /// How many of the sums of a list are at most `u`, a number from 0 to 1.
    pub fn find(&self, list: usize, sums: &[f64], u: f64) -> usize {
        let bucket = ((u * self.buckets as f64) as usize).min(self.buckets - 1);
        let at = list * (self.buckets + 1) + bucket;
        let [low, high] = [self.first[at], self.first[at + 1]].map(|i| i as usize);
        low + sums[low..high].partition_point(|&s| s <= u)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_finds_what_a_search_finds() {
        // Steep and flat parts, sums that are equal, and one that is 1 before the end.
        let list = |power: f64, length: usize| -> Vec<f64> {
            let sum = |i: usize| ((i + 1) as f64 / length as f64).powf(power);
            // Some are equal, and some fall, until they are sorted.
            let at = |i: usize| sum(i / 2 + i % 2);
            let mut sums: Vec<f64> = (0..length).map(at).collect();
            sums.sort_by(f64::total_cmp);
            let last = sums[length - 1];
            sums.iter_mut().for_each(|s| *s /= last);
            sums
        };
        for length in [1, 2, 7, 64, 511] {
            let lists = [0.05, 1.0, 40.0].map(|power| list(power, length));
            let guide = Guide::new(&lists.concat(), length);
            for (number, sums) in lists.iter().enumerate() {
                let grid = (0..=4096).map(|i| f64::from(i) / 4096.0);
                let beside = |s: f64| [s.next_down().max(0.0), s, s.next_up().min(1.0)];
                for u in grid.chain(sums.iter().copied().flat_map(beside)) {
                    let wanted = sums.partition_point(|&s| s <= u);
                    assert_eq!(guide.find(number, sums, u), wanted, "{length} {u}");
                }
            }
        }
    }
}
