//! Inclusion probabilities: how likely a border on a line is to be found. What is found is weighed
//! by one over that (Horvitz & Thompson 1952).
//!
//! Points are put on a line at equal distances, shifted together by one random number, and what
//! lies between two neighbours is searched for. Between the borders that are known afterwards lie
//! *intervals*, in each of which one thing is seen. A border is found by a pair of neighbours on
//! either side of it, but not by all such pairs: where the points fall before and behind something
//! thin they see the same, and neither of its borders is found. What is found is weighed by one
//! over the probability of that,
//!
//!   P(border) = Σ over intervals j before and k after it of
//!               |(R_j + 1) ∩ R_k| · [a search between points in R_j and R_k finds it],
//!
//! lengths being in distances of points. The sum of all the lengths is 1, so a border between two
//! long intervals has P = 1 without any search. Beyond the first and the last border the line is
//! taken to go on for ever: its two ends are points, too.

/// Chances below this are taken for it: it bounds the weight of one border.
const SMALLEST_CHANCE: f64 = 1e-3;
/// Chances nearer to one than this are one.
const ROUNDING: f64 = 1e-9;

/// The intervals of a line. Number r lies before border r.
pub struct Intervals {
    /// Of the borders, increasing, in distances of points.
    pub places: Vec<f64>,
    /// The chance that one more point, drawn independently of all others, falls in each interval.
    pub extra: Vec<f64>,
}

impl Intervals {
    /// With another point that falls before each border with these chances.
    pub fn with_extra(places: Vec<f64>, before: impl Iterator<Item = f64>) -> Self {
        let mut extra: Vec<f64> = before.chain([1.0]).collect();
        for interval in (1..extra.len()).rev() {
            extra[interval] -= extra[interval - 1];
        }
        Self { places, extra }
    }

    /// Without another point.
    pub fn new(places: Vec<f64>) -> Self {
        let extra = vec![0.0; places.len() + 1];
        Self { places, extra }
    }

    fn ends(&self, interval: usize) -> [f64; 2] {
        let before = interval.checked_sub(1).map(|b| self.places[b]);
        let after = self.places.get(interval).copied();
        [
            before.unwrap_or(f64::NEG_INFINITY),
            after.unwrap_or(f64::INFINITY),
        ]
    }

    /// |(R_j + 1) ∩ R_k|
    fn overlap(&self, [j, k]: [usize; 2]) -> f64 {
        let ([from, to], [low, high]) = (self.ends(j), self.ends(k));
        ((to + 1.0).min(high) - (from + 1.0).max(low)).max(0.0)
    }

    /// Pairs of intervals, one before or equal to `first` and the other after or equal to `last`,
    /// between which there are neighbours.
    fn pairs_around(&self, [first, last]: [usize; 2]) -> Vec<([usize; 2], f64)> {
        let mut pairs = Vec::new();
        for j in (0..=first).rev() {
            let reach = self.ends(j)[1] + 1.0;
            if reach <= self.ends(last)[0] {
                break;
            }
            for k in last..=self.places.len() {
                if self.ends(k)[0] >= reach {
                    break;
                }
                let overlap = self.overlap([j, k]);
                if overlap > 0.0 {
                    pairs.push(([j, k], overlap));
                }
            }
        }
        pairs
    }

    /// Whether the intervals on either side of a border are long.
    pub fn is_always_found(&self, border: usize) -> bool {
        self.overlap([border, border + 1]) >= 1.0 - ROUNDING
    }

    /// The probability of finding a border. `finds` is asked whether searches between two intervals
    /// that are not neighbours do.
    ///
    /// The other point falls between two of the row with the chances of `extra`, and the border is
    /// then found from it and that one of them which lies on the border's other side, or else
    /// from these two. Sums over the intervals in which it falls grow by one as the row's intervals
    /// are gone through away from the border.
    pub fn inclusion_of_border(
        &self,
        border: usize,
        mut finds: impl FnMut([usize; 2]) -> bool,
    ) -> f64 {
        if self.is_always_found(border) {
            return 1.0;
        }
        let mut finds = |[j, k]: [usize; 2]| (k == j + 1 || finds([j, k])) as u32 as f64;
        let mut chance = 0.0;
        // Of the intervals after the border: the extra point lies before it, and they find it.
        let mut from_before = vec![0.0; self.extra.len() - border - 1];
        // The extra point lies between the border and the interval before it that is looked at.
        let mut extra_before = 0.0f64;
        for j in (0..=border).rev() {
            let reach = self.ends(j)[1] + 1.0;
            if reach <= self.ends(border + 1)[0] {
                break;
            }
            let mut from_after = 0.0;
            let mut extra_after = 0.0;
            for (before, k) in from_before.iter_mut().zip(border + 1..) {
                if self.ends(k)[0] >= reach {
                    break;
                }
                let found = finds([j, k]);
                let neither = (1.0 - extra_before - extra_after).max(0.0);
                chance += self.overlap([j, k]) * (*before + from_after + neither * found);
                extra_after += self.extra[k];
                from_after += self.extra[k] * found;
                *before += self.extra[j] * found;
            }
            extra_before += self.extra[j];
        }
        chance.clamp(SMALLEST_CHANCE, 1.0)
    }

    /// The probability that a search looks at what is seen within an interval. `looks` is asked
    /// whether searches between two others, one on each side of it, do.
    pub fn inclusion_within(
        &self,
        interval: usize,
        mut looks: impl FnMut([usize; 2]) -> bool,
    ) -> f64 {
        let [from, to] = self.ends(interval);
        let met = to - from;
        if met >= 1.0 - ROUNDING {
            return 1.0;
        }
        let mut chance = met;
        for (pair, overlap) in self.pairs_around([interval - 1, interval + 1]) {
            if looks(pair) {
                chance += overlap;
            }
        }
        let extra = self.extra[interval];
        (chance + (1.0 - chance) * extra).clamp(SMALLEST_CHANCE, 1.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Intervals of even numbers are open. A search between one that is not and one that is finds
    /// the border next to the first.
    fn found_by([j, k]: [usize; 2]) -> Option<usize> {
        match [j % 2, k % 2] {
            [1, 0] => Some(j),
            [0, 1] => Some(k - 1),
            _ => None,
        }
    }

    /// The chances are those that are counted over all shifts of the points, with one more point or
    /// without.
    #[test]
    fn chances_are_those_of_counting() {
        const SHIFTS: usize = 2_000;
        const POINTS: i32 = 6;
        let places = vec![0.3, 0.5, 0.55, 1.4, 1.5, 4.0];
        let borders = places.len();
        let middles = |count: usize| (0..count).map(move |i| (i as f64 + 0.5) / count as f64);
        for with_extra in [false, true] {
            let mut extra = vec![0.0; borders + 1];
            if with_extra {
                // Uniform from 0.2 to 1.8.
                let below = |p: f64| ((p - 0.2) / 1.6).clamp(0.0, 1.0);
                let cut: Vec<f64> = places.iter().map(|&p| below(p)).collect();
                extra[..borders].copy_from_slice(&cut);
                extra[borders] = 1.0;
                (0..borders).for_each(|b| extra[b + 1] -= cut[b]);
            }
            let intervals = Intervals {
                places: places.clone(),
                extra,
            };
            let run_of = |place: f64| intervals.places.partition_point(|&p| p < place);
            let extras: Vec<Option<f64>> = if with_extra {
                middles(800).map(|p| Some(0.2 + 1.6 * p)).collect()
            } else {
                vec![None]
            };
            let mut counted = vec![0usize; borders];
            for shift in middles(SHIFTS) {
                for extra in &extras {
                    let points = (-2..POINTS).map(|p| p as f64 + shift);
                    let mut points: Vec<f64> = points.chain(*extra).collect();
                    points.sort_by(f64::total_cmp);
                    for pair in points.windows(2) {
                        let [j, k] = [pair[0], pair[1]].map(run_of);
                        if let Some(border) = found_by([j, k]) {
                            counted[border] += 1;
                        }
                    }
                }
            }
            let trials = (SHIFTS * extras.len()) as f64;
            for (border, count) in counted.into_iter().enumerate() {
                let finds = |pair| found_by(pair) == Some(border);
                let chance = intervals.inclusion_of_border(border, finds);
                let expected = count as f64 / trials;
                assert!(
                    (chance - expected).abs() < 4.0 / SHIFTS as f64,
                    "{chance} for {expected}, {with_extra}"
                );
            }
        }
    }
}
