//! What a pilot has tried, and which of it is best.

use super::contender::Contender;
use super::noise_map::NoiseMap;
use super::statistics::{Pilot, Trial};

/// What promises less than this over what is usual is not worth the risk of being misled, by half
/// of a whole look or more, and by shorter ones.
const WORTHWHILE: f64 = 1.2;
const WORTHWHILE_IN_SHORT: f64 = 2.0;
/// Differences may promise so much less than the best of all else: in crowds, elsewhere, and where
/// most of what borders bring lies over lights. In crowds few paths hold much of the variance of
/// cells, and most pilots do not meet them (`docs/method.md`, 14); lights have no such tails.
const WORTHWHILE_DIFFERENCES: [f64; 3] = [0.4, 0.8, 1.0];
/// It is a crowd if so many borders are found on the film for each path, and what differences see
/// is even: the worst pixel in so many holds less than this of their variance. Elsewhere, as in
/// rooms before a camera that moves, pilots miss as much of the noise of differences.
const CROWD: f64 = 0.25;
pub const WORST_IN: usize = 64;
const EVEN: f64 = 0.4;
/// Lights are most from this share.
const MOSTLY_LIGHTS: f64 = 0.5;

/// A way that has been tried.
pub struct Tried {
    pub way: Contender,
    /// Paths that it was looked at with.
    pub paths: f64,
    /// Of the job's gradient image, summed over its numbers.
    pub variance: f64,
    /// Of the job, in about microseconds.
    pub work: f64,
    pub looks_over_lobes: bool,
    /// What is looked at beside borders, in all its work.
    pub probes_share: f64,
    /// Borders that are found on the film, for each path.
    pub film_borders: f64,
    /// What borders over lights and environment maps bring, of what all bring; one if nothing does.
    pub lights_share: f64,
    /// The share of the variance that the worst pixel in [`WORST_IN`] holds.
    pub worst_pixels: f64,
    /// Where the noise lies, of what has been seen.
    pub noise: NoiseMap,
}

/// All that has been tried, the usual first, each way once.
pub struct AllTried {
    tried: Vec<Tried>,
    /// The variance that differences have at least, by what the usual way has found
    /// (`methods::foretold`).
    pub foretold_of_differences: f64,
    /// Paths of a look that is taken to see enough.
    whole_look: f64,
}

impl AllTried {
    /// Nothing yet.
    pub fn new(whole_look: f64) -> Self {
        Self {
            tried: Vec::new(),
            foretold_of_differences: 0.0,
            whole_look,
        }
    }

    /// Adds a trial, or puts it in the place of an earlier one of the same way.
    pub fn add(&mut self, tried: Tried) {
        match self.tried.iter_mut().find(|known| known.way == tried.way) {
            Some(known) => *known = tried,
            None => self.tried.push(tried),
        }
    }

    /// What was tried first.
    pub fn usual(&self) -> &Tried {
        &self.tried[0]
    }

    /// What has been seen of a way.
    pub fn of(&self, way: Contender) -> Option<&Tried> {
        self.tried.iter().find(|tried| tried.way == way)
    }

    /// That of differences is at least what is foretold of it.
    fn variance(&self, tried: &Tried) -> f64 {
        match tried.way.is_difference() {
            true => tried.variance.max(self.foretold_of_differences),
            false => tried.variance,
        }
    }

    fn cost(&self, tried: &Tried) -> f64 {
        self.variance(tried) * tried.work
    }

    /// Whether differences promise more than so many times the efficiency of what is usual.
    pub fn differences_promise(&self, times: f64) -> bool {
        let differences = self.least(true);
        differences.is_some_and(|it| self.cost(it) * times < self.cost(self.usual()))
    }

    /// What has the least noise for its work.
    pub fn best(&self) -> Contender {
        let ours = self.best_mixture();
        let Some(differences) = self.least(true) else {
            return ours.way;
        };
        let usual = self.usual();
        let [in_crowds, elsewhere, beside_lights] = WORTHWHILE_DIFFERENCES;
        let worthwhile = match usual.lights_share < MOSTLY_LIGHTS {
            _ if usual.film_borders >= CROWD && differences.worst_pixels < EVEN => in_crowds,
            true => elsewhere,
            false => beside_lights,
        };
        match self.cost(differences) * worthwhile < self.cost(ours) {
            true => differences.way,
            false => ours.way,
        }
    }

    /// The same without differences; the usual if that is nearly as good.
    pub fn best_mixture(&self) -> &Tried {
        let usual = self.usual();
        let worthwhile = match usual.paths < 0.5 * self.whole_look {
            true => WORTHWHILE_IN_SHORT,
            false => WORTHWHILE,
        };
        match self.least(false) {
            Some(best) if self.cost(best) * worthwhile < self.cost(usual) => best,
            _ => usual,
        }
    }

    /// The least of what has been tried, among differences or all else.
    fn least(&self, is_difference: bool) -> Option<&Tried> {
        let tried = self.tried.iter();
        let of_kind = tried.filter(|t| t.way.is_difference() == is_difference);
        of_kind.min_by(|a, b| self.cost(a).total_cmp(&self.cost(b)))
    }

    /// What a pilot tells of it.
    pub fn pilot(&self) -> Pilot {
        let usual = self.cost(self.usual());
        let trials = self.tried.iter().map(|tried| Trial {
            way: tried.way.name(),
            paths: tried.paths,
            variance: self.variance(tried),
            work: tried.work,
            efficiency: Some(usual / self.cost(tried)).filter(|by| by.is_finite()),
        });
        Pilot {
            trials: trials.collect(),
            ..Pilot::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::boundary::mixture::{Mixture, OnFilm};

    const USUAL: f64 = 10.0;

    fn after(film_at_rest: f64, differences: f64, paths: f64) -> Contender {
        after_with([film_at_rest, differences], paths, [0.0; 3])
    }

    fn after_with(
        [film_at_rest, differences]: [f64; 2],
        paths: f64,
        [film_borders, lights_share, worst_pixels]: [f64; 3],
    ) -> Contender {
        let on = |film| {
            Contender::Mixture(Mixture {
                film,
                ..Mixture::default()
            })
        };
        let mut all = AllTried::new(1000.0);
        for (way, variance) in [
            (on(OnFilm::Drifting), USUAL),
            (Contender::Differences { carried: true }, differences),
            (on(OnFilm::Resting), film_at_rest),
        ] {
            all.add(Tried {
                way,
                paths,
                variance,
                work: 2.0,
                looks_over_lobes: false,
                probes_share: 0.0,
                film_borders,
                lights_share,
                worst_pixels,
                noise: NoiseMap::default(),
            });
        }
        all.best()
    }

    /// Pilots miss some of the noise of paths, in crowds most of it, and beside lights none.
    #[test]
    fn differences_may_promise_less() {
        let is_taken = |differences: f64, told: [f64; 3]| {
            after_with([50.0, differences * USUAL], 1000.0, told).is_difference()
        };
        let turns = |at: f64, told| is_taken(0.96 * at, told) && !is_taken(1.04 * at, told);
        assert!(turns(1.25, [0.2, 0.4, 0.3]));
        assert!(turns(1.0, [0.2, 0.6, 0.3]));
        for lights_share in [0.4, 0.6] {
            assert!(turns(2.5, [0.3, lights_share, 0.3]));
        }
        // What few pixels hold is missed of differences, too.
        assert!(turns(1.25, [0.3, 0.4, 0.5]));
    }

    /// What is rare is not seen by the few differences of a look.
    #[test]
    fn foretold_noise_counts() {
        let differences = Contender::Differences { carried: true };
        let mut all = AllTried::new(1000.0);
        for (way, variance) in [
            (Contender::Mixture(Mixture::default()), USUAL),
            (differences, 0.1 * USUAL),
        ] {
            all.add(Tried {
                way,
                paths: 1000.0,
                variance,
                work: 1.0,
                looks_over_lobes: false,
                probes_share: 0.0,
                film_borders: 0.0,
                lights_share: 0.0,
                worst_pixels: 0.0,
                noise: NoiseMap::default(),
            });
        }
        assert!(all.best().is_difference() && all.differences_promise(4.0));
        all.foretold_of_differences = 2.0 * USUAL;
        assert!(!all.best().is_difference() && !all.differences_promise(1.0));
        assert_eq!(all.pilot().trials[1].variance, 2.0 * USUAL);
    }

    /// Short looks have to be clearer than whole ones.
    #[test]
    fn another_mixture_has_to_promise_more() {
        let is_usual = |way: Contender| way == Contender::Mixture(Mixture::default());
        assert!(is_usual(after(USUAL / 1.1, 99.0, 1000.0)));
        assert!(!is_usual(after(USUAL / 1.3, 99.0, 500.0)));
        assert!(is_usual(after(USUAL / 1.3, 99.0, 499.0)));
        assert!(!is_usual(after(USUAL / 2.1, 99.0, 499.0)));
    }

    #[test]
    fn a_longer_look_takes_the_place_of_a_shorter() {
        let mut all = AllTried::new(1000.0);
        for (paths, variance) in [(100.0, 1.0), (1000.0, 3.0)] {
            all.add(Tried {
                way: Contender::Differences { carried: true },
                paths,
                variance,
                work: 1.0,
                looks_over_lobes: false,
                probes_share: 0.0,
                film_borders: 0.0,
                lights_share: 0.0,
                worst_pixels: 0.0,
                noise: NoiseMap::default(),
            });
        }
        assert_eq!(all.pilot().trials.len(), 1);
        assert_eq!(all.usual().variance, 3.0);
    }
}
