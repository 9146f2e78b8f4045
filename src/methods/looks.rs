//! How long a pilot looks.
//!
//! A trial has to see enough of the few paths that hold much of the variance, and a pilot must not
//! cost more than it may save. A first look is short; where it says that differences do, which are
//! the cheapest answer, it is left at that, unless a second one tells far more. The rest is looked
//! at again, for as long as the job lets: about a 32nd of it.

use super::error::EngineError;
use super::prepared::Prepared;
use super::settings::{Groups, Settings};
use super::stage::Stage;
use super::statistics::Statistics;

/// The pilot's own random numbers.
pub const SEED: u64 = 0x7069_6c6f_7400_0001;
/// The least groups of a whole look, and the samples a pixel of each, as far as the job's groups
/// have as many.
const GROUPS: u32 = 4;
const SAMPLES: [u32; 2] = [2, 16];
/// The least of a shorter one, which is to see more of the film.
const FEW_GROUPS: u32 = 2;
const FEW_SAMPLES: u32 = 1;

/// Paths of a whole look, and the share that they have in the job's at least.
const WHOLE_PATHS: f64 = 16384.0;
const WHOLE_SHARE: f64 = 1.0 / 64.0;
/// Paths of the shortest look.
const LEAST_PATHS: f64 = 1024.0;
/// What a first look has in all that will be done, and later ones.
const FIRST_SHARE: f64 = 1.0 / 256.0;
const LATER_SHARE: f64 = 1.0 / 32.0;
/// What a survey has in all that will be done, the least and the most samples a pixel of one, and
/// its groups.
const SURVEY_SHARE: f64 = 1.0 / 32.0;
const SURVEY_SAMPLES: [u32; 2] = [2, 8];
const SURVEY_GROUPS: u32 = 2;
/// A look that is so many times as long as another tells far more.
const TELLS_MORE: f64 = 4.0;
/// So many differences, one for each number, cost about what paths do.
const AS_DEAR: f64 = 8.0;

/// What trials are for.
#[derive(Clone, Copy)]
pub struct Job {
    pixels: f64,
    /// Samples a pixel.
    pub spp: u32,
    /// How often it will be done.
    times: f64,
    /// Differences that would answer, one for each number.
    pub differences: usize,
}

/// How a trial looks.
pub struct Look {
    pub settings: Settings,
    /// The part of the film that is looked at.
    pub film: f64,
    /// Its paths in those of one job.
    pub share: f64,
}

impl Job {
    pub fn new(
        prepared: &Prepared,
        settings: &Settings,
        times: u64,
        differences: Option<usize>,
    ) -> Result<Self, EngineError> {
        let stage = Stage::new(prepared, settings, None, &mut Statistics::default())?;
        Ok(Self {
            pixels: stage.size.iter().product::<usize>() as f64,
            spp: settings.spp,
            times: times as f64,
            differences: differences.unwrap_or(1),
        })
    }

    /// Paths of one job.
    fn paths(&self) -> f64 {
        self.pixels * f64::from(self.spp)
    }

    /// Paths of a look that is taken to see enough.
    pub fn whole_look(&self) -> f64 {
        WHOLE_PATHS.max(WHOLE_SHARE * self.paths())
    }

    /// Paths of a first look.
    pub fn first_look(&self) -> f64 {
        let all = self.times * self.paths();
        self.share(FIRST_SHARE).max(LEAST_PATHS.min(all))
    }

    /// Paths of a later one, if the job is worth more than a first.
    pub fn later_look(&self) -> Option<f64> {
        let paths = self.share(LATER_SHARE);
        (paths > LEAST_PATHS).then_some(paths)
    }

    /// Whether a later look tells far more than a first, at a small part of the job.
    pub fn later_tells_more(&self) -> bool {
        let later = self.later_look();
        let first = self.first_look();
        first < WHOLE_PATHS && later.is_some_and(|paths| paths >= TELLS_MORE * first)
    }

    /// A share of all that will be done in paths, at most a whole look.
    fn share(&self, share: f64) -> f64 {
        let dear = (self.differences as f64).min(AS_DEAR);
        (share * dear * self.times * self.paths()).min(self.whole_look())
    }
}

impl Job {
    /// How to see where the noise lies on the film: all of it, with a few samples of the many. None
    /// if there are not many, or no more than one of a group, which leaves nothing to spare.
    pub fn survey(&self, settings: &Settings) -> Option<Settings> {
        let all = self.times * f64::from(self.spp);
        let spp = (SURVEY_SHARE * all) as u32;
        let spare = settings.spp / settings.groups().count > 1;
        (spare && spp >= SURVEY_SAMPLES[0]).then(|| Settings {
            seed: SEED,
            spp: spp.min(SURVEY_SAMPLES[1]) / SURVEY_GROUPS * SURVEY_GROUPS,
            standard_error: true,
            groups: Some(Groups {
                count: SURVEY_GROUPS,
                only: None,
            }),
            part_of_film: Some(1.0),
            counts_tiles: true,
            ..settings.clone()
        })
    }
}

impl Look {
    /// About so many paths: fewer samples on the whole film, or on tiles of it where even the least
    /// would be too many. What has most of the noise, as a lamp that is seen, may lie in one place.
    pub fn new(
        prepared: &Prepared,
        settings: &Settings,
        job: Job,
        paths: f64,
    ) -> Result<Self, EngineError> {
        let of_group = settings.spp / settings.groups().count;
        let [count, samples] = groups(paths, job.pixels, of_group);
        let spp = samples * count;
        let part = (paths / (job.pixels * f64::from(spp))).min(1.0);
        let settings = Settings {
            seed: SEED,
            spp,
            standard_error: true,
            groups: Some(Groups { count, only: None }),
            part_of_film: (part < 1.0).then_some(part),
            counts_tiles: true,
            ..settings.clone()
        };
        let stage = Stage::new(prepared, &settings, None, &mut Statistics::default())?;
        let film = stage.part_of_tiles();
        Ok(Self {
            share: film * f64::from(spp) / f64::from(job.spp),
            settings,
            film,
        })
    }
}

/// How many groups a look of so many paths has, and how many samples a pixel each of them. The
/// job's groups have `of_group`: a look's samples lie as theirs, so on a small film it has more
/// groups.
fn groups(paths: f64, pixels: f64, of_group: u32) -> [u32; 2] {
    let (count, least) = match paths < WHOLE_PATHS {
        true => (FEW_GROUPS, FEW_SAMPLES),
        false => (GROUPS, SAMPLES[0]),
    };
    let [least, most] = [least, SAMPLES[1]].map(|n| n.min(of_group).max(1));
    let of_pixel = (paths / pixels) as u32;
    let samples = (of_pixel / count).clamp(least, most);
    [count.max(of_pixel / samples), samples]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A look is as long as it is to be, on a small film, too, and no group is denser than the
    /// job's.
    #[test]
    fn looks_have_their_paths() {
        for side in [16.0, 32.0, 64.0] {
            let pixels: f64 = side * side;
            for paths in [12_288.0, WHOLE_PATHS, 4.0 * WHOLE_PATHS] {
                let [count, samples] = groups(paths, pixels, 4);
                assert!(count >= FEW_GROUPS && samples <= 4, "{side} {paths}");
                let done = pixels * f64::from(count * samples);
                assert!(done > 0.75 * paths, "{side} {paths}: {done}");
            }
        }
    }
}
