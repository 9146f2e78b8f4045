//! What is found on a line behind smooth surfaces, weighed by one over the chance of finding it.

use super::follow::{FirstRays, Followed};
use super::search::{ChainSearch, Cuts, Near, Run, Way};

/// Places that are nearer to each other are one, in parts of what lies between two borders.
const SAME_PLACE: f64 = 0.05;

/// The runs of a line between cuts, and the rays they were found with.
struct Line<'a> {
    near: Vec<Near>,
    ends: Vec<Option<[f64; 2]>>,
    /// The chance that any ray met what lies on one side of a plane, of the runs there.
    met: Vec<f64>,
    rays: &'a [Followed],
    way: &'a Way,
}

impl Line<'_> {
    /// The first of the runs that go on to this one up to such a cut.
    fn first(&self, mut run: usize, end: Near) -> usize {
        while run > 0 && ![end, Near::OwnPlane].contains(&self.near[run - 1]) {
            run -= 1;
        }
        run
    }

    fn last(&self, mut run: usize, end: Near) -> usize {
        while run < self.near.len() && ![end, Near::OwnPlane].contains(&self.near[run]) {
            run += 1;
        }
        run
    }

    /// The chance to find a cut at which rays change sides of a plane: both sides have to be met.
    /// Zero for other cuts.
    fn plane(&self, cut: usize) -> f64 {
        match self.near[cut] {
            Near::OwnPlane => self.met[cut].min(self.met[cut + 1]),
            _ => 0.0,
        }
    }
}

impl<R: FirstRays> ChainSearch<'_, R> {
    /// Weighs what was found by one over the chance of finding it, and notes those of runs. A
    /// border is found from the side that hides the other, wherever a point lies there; what in
    /// turn hides that, up to its own border, finds it as well. So is a run found from what hides
    /// it, and from what it hangs together with. Where rays change sides of the plane of the
    /// triangle that bends them, that is found if both sides are met, and what ends there is found
    /// with it.
    pub(super) fn weigh(
        &mut self,
        all: &mut Cuts,
        runs: &mut [Run],
        (rays, way): (&[Followed], &Way),
    ) {
        let mut line = Line {
            near: all.cuts.iter().map(|cut| cut.near).collect(),
            ends: runs.iter().map(Run::ends).collect(),
            met: vec![way.met; runs.len()],
            rays,
            way,
        };
        for run in 0..runs.len() {
            line.met[run] = match run {
                1.. if line.near[run - 1] != Near::OwnPlane => line.met[run - 1],
                _ => self.chance_of_runs([run, line.last(run, Near::OwnPlane)], &line),
            };
        }
        let mut chance = |from: usize, to: usize| {
            let before = from.checked_sub(1).map_or(way.met, |cut| line.plane(cut));
            let after = match to < line.near.len() {
                true => line.plane(to),
                false => way.met,
            };
            match before.max(after) {
                0.0 => self.chance_of_runs([from, to], &line),
                known => known,
            }
        };
        for (i, cut) in all.cuts.iter_mut().enumerate() {
            let Some(border) = &mut cut.border else {
                continue;
            };
            border.weight /= match cut.near {
                Near::Before => chance(line.first(i, Near::After), i),
                Near::After => chance(i + 1, line.last(i + 1, Near::Before)),
                Near::None => {
                    let [from, to] = [line.first(i, Near::After), line.last(i + 1, Near::Before)];
                    chance(from, to)
                }
                Near::OwnPlane => line.plane(i),
            };
        }
        for (i, run) in runs.iter_mut().enumerate() {
            run.met = chance(line.first(i, Near::After), line.last(i, Near::Before));
        }
        for ridge in &mut all.ridges {
            let holds = |run: &&Run| {
                run.ends()
                    .is_some_and(|[from, to]| (from..=to).contains(&ridge.s))
            };
            if let Some(run) = runs.iter().find(holds) {
                ridge.weight /= run.met;
            }
        }
        self.found.append(&mut all.ridges);
        self.found
            .extend(all.cuts.iter_mut().filter_map(|cut| cut.border.take()));
    }

    /// That of all from one run to another; what reaches to the end of the line has been met.
    fn chance_of_runs(&mut self, [from, to]: [usize; 2], line: &Line) -> f64 {
        match (line.ends[from], line.ends[to]) {
            (Some([low, _]), Some([_, high])) if from > 0 && to < line.near.len() => {
                self.chance_of_part([low, high], (line.rays, line.way))
            }
            _ => line.way.met,
        }
    }

    /// The chance that a part of the line is found, other than at its ends.
    ///
    /// That is the chance that a point lies on it, unless it is found from beyond, too: what a
    /// sheet shows of its other side lies behind a fold of the one that is seen, and whoever walks
    /// over it from there passes the fold. A part that no point lies in was found so. Of one in
    /// which points do lie, it is tried whether it is found without them. Else borders would weigh
    /// more than they are rare.
    fn chance_of_part(&mut self, [low, high]: [f64; 2], (rays, way): (&[Followed], &Way)) -> f64 {
        let chance = self.chance([low, high], way);
        if chance >= way.met {
            return chance;
        }
        let lies_there = |ray: &Followed| (low..=high).contains(&ray.s);
        if !rays.iter().any(lies_there) {
            return way.met;
        }
        let before = rays.iter().rev().find(|ray| ray.s < low);
        let after = rays.iter().find(|ray| ray.s > high);
        let (Some(before), Some(after)) = (before, after) else {
            return chance;
        };
        let mut without = Cuts::default();
        let unresolved = self.counts.unresolved;
        self.cuts([before, after], way, &mut without);
        self.counts.unresolved = unresolved;
        let room = SAME_PLACE * (high - low);
        let part = low - room..=high + room;
        let is_found = without
            .cuts
            .iter()
            .any(|cut| part.contains(&cut.sides[0].s));
        if is_found { way.met } else { chance }
    }
}
