//! Runs of two kinds, with as many samples as it takes to tell whether they agree.

use super::statistics::{Agreement, Estimate};

/// Comparisons begin with one sample of so many, and no fewer than so many samples.
const FIRST: u32 = 16;
const FEWEST: u32 = 32;
/// Standard errors of `make test` may be larger than those of `make test-long` by this.
const LOOSENED: f64 = if cfg!(feature = "all-samples") {
    1.0
} else {
    2.0
};
/// So many pixels are compared as one by χ².
const POOLED: usize = if cfg!(feature = "all-samples") { 1 } else { 4 };
/// Samples are multiplied by this much more than a standard error promises to need.
const SPARE: f64 = 1.3;

/// Runs with so many samples.
pub type Runs<'a> = &'a dyn Fn(u32) -> Vec<Vec<f64>>;

/// Two kinds of runs, of which the second are the reference.
pub struct Compared {
    pub agreement: Agreement,
    /// Of either kind.
    pub samples: [u32; 2],
    ours: Vec<Vec<f64>>,
    pub theirs: Vec<Vec<f64>>,
}

/// Compares runs with few samples first, and with more of what needs them while the standard error
/// of their difference is above `resolution` of the gradient, or somewhat more: up to `most`, with
/// which it must not be. What is found has no say in it. `make test-long` takes all at once, and
/// is content with no more.
pub fn compared(most: u32, resolution: f64, runs: [Runs; 2]) -> Compared {
    let resolution = resolution * LOOSENED;
    let samples = [first(most), (2 * first(most)).min(most)];
    let [ours, theirs] = runs;
    let mut found = Compared::of(samples, [ours(samples[0]), theirs(samples[1])]);
    while found.agreement.bias.error > resolution {
        let error = found.agreement.bias.error;
        assert!(found.samples != [most; 2], "nothing can be said: ± {error}");
        let more = found.more_samples(most, resolution);
        found = found.with(more, runs);
    }
    found
}

impl Compared {
    fn of(samples: [u32; 2], [ours, theirs]: [Vec<Vec<f64>>; 2]) -> Self {
        let agreement = agreement(&ours, &theirs);
        println!("{samples:?} samples: {agreement:.4?}");
        Self {
            agreement,
            samples,
            ours,
            theirs,
        }
    }

    /// The same with other numbers of samples.
    pub fn with(self, samples: [u32; 2], [ours, theirs]: [Runs; 2]) -> Self {
        let again = |kind: usize, run: Runs, had: Vec<Vec<f64>>| match samples[kind] {
            same if same == self.samples[kind] => had,
            other => run(other),
        };
        let runs = [again(0, ours, self.ours), again(1, theirs, self.theirs)];
        Self::of(samples, runs)
    }

    /// Samples that promise the standard error that is wanted with the least of work, if either
    /// kind of runs has cost as much as the other so far.
    fn more_samples(&self, most: u32, resolution: f64) -> [u32; 2] {
        let variances = self.variances();
        let target = resolution * resolution / SPARE;
        let deviations = variances.map(f64::sqrt);
        let mut growth = deviations.map(|d| d * (deviations[0] + deviations[1]) / target);
        for kind in 0..2 {
            if growth[kind] < 1.0 {
                growth[1 - kind] = variances[1 - kind] / (target - variances[kind]);
            }
        }
        let mut more = [0, 1].map(|kind| at_least(self.samples[kind], growth[kind]).min(most));
        if more == self.samples {
            let open = [0, 1].into_iter().filter(|&kind| more[kind] < most);
            let noisiest = open.max_by(|&a, &b| variances[a].total_cmp(&variances[b]));
            let kind = noisiest.expect("one with fewer samples than the most");
            more[kind] = (2 * more[kind]).min(most);
        }
        more
    }

    /// The variance of the gradient's size, by the kind of runs it comes from.
    fn variances(&self) -> [f64; 2] {
        let numbers = 0..self.theirs[0].len();
        let size = |i: usize| self.theirs.iter().map(|run| run[i]).sum::<f64>();
        let sizes: Vec<f64> = numbers.map(size).collect();
        let own = [&self.ours, &self.theirs].map(|runs| {
            let along = |run: &Vec<f64>| run.iter().zip(&sizes).map(|(a, b)| a * b).sum();
            let along: Vec<f64> = runs.iter().map(along).collect();
            Estimate::mean(&along).error.powi(2)
        });
        let both = self.agreement.bias.error.powi(2);
        own.map(|variance| both * variance / (own[0] + own[1]))
    }
}

/// How far they are apart in size, and in sums over a few pixels beside one another: with few
/// samples differences are skewed in single pixels, most of which meet no border, and χ² would take
/// that for a bias.
pub fn agreement(ours: &[Vec<f64>], theirs: &[Vec<f64>]) -> Agreement {
    let sums = |run: &Vec<f64>| -> Vec<f64> {
        let of = |pixels: &[f64], channel| pixels.iter().skip(channel).step_by(3).sum();
        let few = run.chunks(3 * POOLED);
        few.flat_map(|pixels| [0, 1, 2].map(|channel| of(pixels, channel)))
            .collect()
    };
    let pooled = [ours, theirs].map(|runs| runs.iter().map(sums).collect::<Vec<_>>());
    let mut agreement = Agreement::new(ours, theirs);
    agreement.chi_squared = Agreement::new(&pooled[0], &pooled[1]).chi_squared;
    agreement
}

/// With how many samples to begin.
fn first(most: u32) -> u32 {
    match cfg!(feature = "all-samples") {
        true => most,
        false => most.div_ceil(FIRST).max(FEWEST).min(most),
    }
}

/// So many times the samples, or more: a power of two or three quarters of one. As many if they
/// are not to grow.
fn at_least(samples: u32, growth: f64) -> u32 {
    if growth <= 1.0 {
        return samples;
    }
    let wanted = f64::from(samples) * growth;
    let power = (wanted as u32).next_power_of_two();
    match f64::from(power / 4 * 3) >= wanted {
        true => power / 4 * 3,
        false => power,
    }
}

/// Measures with few samples first, and with more while the standard error that `measure` says
/// beside what it finds is above `resolution`, as [`compared`].
pub fn with_samples<T>(most: u32, resolution: f64, measure: impl Fn(u32) -> (f64, T)) -> T {
    let mut samples = first(most);
    loop {
        let (error, found) = measure(samples);
        let off = error / resolution;
        if off <= 1.0 {
            return found;
        }
        assert!(samples < most, "nothing can be said: ± {error}");
        samples = at_least(samples, (SPARE * off * off).max(2.0)).min(most);
    }
}
