//! A logarithmic axis.

/// From numbers to places along a line.
#[derive(Clone, Copy, Debug)]
pub struct LogAxis {
    /// Logarithms of base ten of both ends.
    low: f64,
    high: f64,
    /// Where the ends stand.
    from: f64,
    to: f64,
}

impl LogAxis {
    /// An axis that holds all the numbers, with a little room at its ends.
    pub fn around(numbers: impl Iterator<Item = f64>, from: f64, to: f64) -> Self {
        let logs = numbers
            .filter(|x| *x > 0.0 && x.is_finite())
            .map(f64::log10);
        let none = [f64::INFINITY, f64::NEG_INFINITY];
        let [low, high] = logs.fold(none, |[low, high], x| [low.min(x), high.max(x)]);
        let [low, high] = if low <= high {
            [low, high]
        } else {
            [-1.0, 1.0]
        };
        // At least a decade, so that noise does not look like a trend.
        let room = f64::max(0.08 * (high - low), 0.5 * (1.0 - (high - low)));
        Self {
            low: low - room,
            high: high + room,
            from,
            to,
        }
    }

    pub fn at(&self, number: f64) -> f64 {
        let part = (number.log10() - self.low) / (self.high - self.low);
        self.from + part * (self.to - self.from)
    }

    /// Numbers to mark: powers of ten, or also their doubles and halves where there are few.
    pub fn marks(&self) -> Vec<f64> {
        let decades = self.low.floor() as i32..=self.high.ceil() as i32;
        // A dozen labels have room.
        let every = ((self.high - self.low) / 12.0).ceil().max(1.0) as i32;
        let decades = decades.filter(|d| d % every == 0);
        let factors: &[f64] = match self.high - self.low {
            range if range < 2.0 => &[1.0, 2.0, 5.0],
            _ => &[1.0],
        };
        let all = decades.flat_map(|d| factors.iter().map(move |f| f * 10f64.powi(d)));
        all.filter(|x| (self.low..=self.high).contains(&x.log10()))
            .collect()
    }
}

/// `0.01`, `300`, `2e-5`.
pub fn label(number: f64) -> String {
    match number.abs() {
        x if (0.001..10_000.0).contains(&x) => {
            let digits = (2.0 - x.log10().floor()).clamp(0.0, 6.0) as usize;
            let text = format!("{number:.digits$}");
            match text.contains('.') {
                true => text.trim_end_matches('0').trim_end_matches('.').into(),
                false => text,
            }
        }
        _ => format!("{number:.0e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_are_within_and_places_are_logarithmic() {
        let axis = LogAxis::around([0.1, 10.0, 0.0, f64::NAN].into_iter(), 0.0, 232.0);
        assert!((axis.at(10.0) - axis.at(1.0) - 100.0).abs() < 1e-9);
        assert_eq!(axis.marks(), [0.1, 1.0, 10.0]);
        let narrow = LogAxis::around([3.0].into_iter(), 0.0, 1.0);
        assert_eq!(narrow.at(3.0), 0.5);
        assert_eq!(narrow.marks(), [1.0, 2.0, 5.0]);
        let labels = [0.1, 0.005, 1.0, 250.0, 2e-5, 1e5].map(label);
        assert_eq!(labels, ["0.1", "0.005", "1", "250", "2e-5", "1e5"]);
    }
}
