//! From what a part of a line sees to what it sees beyond that.

use super::follow::{FirstRays, Followed};
use super::search::{ChainSearch, Points, Run, Way};
use crate::discontinuity::between::HALVINGS;
use crate::paths::chain_vertex::Turn;
use crate::paths::meeting::LEAST_CHANCE;

/// The chance with which chains go on that are as long as paths which roulette may end. Less than
/// that of paths: each look along a chain follows all of it anew.
const MOST_SURVIVAL: f64 = 0.75;

/// How many parts of what a line sees behind so many smooth surfaces are followed beyond that, in
/// expectation. Mirrors that see each other's facets would else cut a line into ever more parts
/// with every bounce.
fn most_parts(surfaces: usize, has_new_points: bool) -> f64 {
    match surfaces {
        0 if has_new_points => 8.0,
        0 => f64::INFINITY,
        1 => 4.0,
        2 => 2.0,
        _ => 0.5,
    }
}

impl<R: FirstRays> ChainSearch<'_, R> {
    /// Follows the parts of a line beyond what they see: all of them if they are few, or else some,
    /// which stand for the others. Half of the choice is by how long a part is.
    pub(super) fn branch(&mut self, runs: Vec<Run>, way: &Way) {
        let length = |run: &Run| {
            let view = self.scene.view;
            let [from, to] = run.ends()?;
            let is_smooth = Followed::is_smooth(view, run.rays[0].triangle);
            (is_smooth && from < to).then(|| self.rays.place(to) - self.rays.place(from))
        };
        let parts: Vec<(Run, f64)> = runs
            .into_iter()
            .filter_map(|run| length(&run).map(|length| (run, length)))
            .collect();
        let count = parts.len() as f64;
        let total: f64 = parts.iter().map(|(_, length)| length).sum();
        let most = most_parts(way.bends.len(), self.new_points.is_some());
        for (run, length) in parts {
            let share = 0.5 * (length / total + 1.0 / count);
            let chance = if count > most {
                (most * share).min(1.0)
            } else {
                1.0
            };
            if chance == 1.0 {
                self.deeper(run, way);
            } else if self.draw() < chance {
                let mut chosen = way.clone();
                chosen.inverse_chance /= chance;
                self.deeper(run, &chosen);
            }
        }
    }

    /// Follows rays that see one smooth surface beyond it.
    pub(super) fn deeper(&mut self, run: Run, way: &Way) {
        let view = self.scene.view;
        let number = way.bends.len() as u32;
        let Some(ends) = run.ends() else { return };
        let is_smooth = |ray: &Followed| {
            Followed::is_smooth(view, ray.triangle)
                && ray.meeting(view).is_some_and(|m| m.is_smooth())
        };
        // The next vertex has to be reached, and to be seen.
        if ends[0] >= ends[1]
            || !run.rays.iter().all(is_smooth)
            || self.depth + number + 2 > view.limits.max_depth
        {
            return;
        }
        let mut here = way.clone();
        here.met = run.met;
        let mut rays = run.rays;
        if let (Some(count), 0) = (self.new_points, number) {
            rays = self.put_anew(rays, ends, count, &here);
            here.points = Points::New {
                ends,
                count: f64::from(count),
                chance: here.met,
            };
        }
        // The mean chance of what any of them does.
        let mut turns: Vec<(Turn, f64)> = Vec::new();
        let share = 1.0 / rays.len() as f64;
        for meeting in rays.iter().filter_map(|ray| ray.meeting(view)) {
            meeting.for_each_turn(|turn, chance| {
                match turns.iter_mut().find(|(known, _)| *known == turn) {
                    Some((_, sum)) => *sum += share * chance,
                    None => turns.push((turn, share * chance)),
                }
            });
        }
        turns.retain(|(_, chance)| *chance > 0.0);
        if self.splits_first && number == 0 {
            for (turn, _) in turns {
                self.follow(rays.clone(), &here, turn, 1.0);
            }
            return;
        }
        let least = |chance: f64| match turns.len() {
            1 => chance,
            _ => chance.max(LEAST_CHANCE),
        };
        let sum: f64 = turns.iter().map(|(_, chance)| least(*chance)).sum();
        let mut left = self.draw();
        for &(turn, chance) in &turns {
            let chance = least(chance) / sum.max(1.0);
            if left < chance {
                self.follow(rays, &here, turn, chance);
                return;
            }
            left -= chance;
        }
    }

    /// Other rays between the first and the last.
    fn put_anew(
        &mut self,
        mut rays: Vec<Followed>,
        ends: [f64; 2],
        count: u32,
        way: &Way,
    ) -> Vec<Followed> {
        let jitter = self.draw();
        let [from, to] = ends.map(|s| self.rays.place(s));
        let last = rays.pop();
        rays.truncate(1);
        for k in 0..count {
            let part = (f64::from(k) + jitter) / f64::from(count);
            let s = self.rays.at_place(from + (to - from) * part);
            let view = self.scene.view;
            let ray = Followed::new(view, self.rays, s, &way.bends, self.counts);
            rays.extend(ray.filter(|ray| {
                Followed::is_smooth(view, ray.triangle) && ends[0] < s && s < ends[1]
            }));
        }
        rays.extend(last);
        rays
    }

    /// Follows rays that are bent so, which is done with this chance.
    fn follow(&mut self, rays: Vec<Followed>, way: &Way, turn: Turn, chance: f64) {
        let view = self.scene.view;
        let number = way.bends.len() as u32;
        let mut next = way.clone();
        next.bends.push(turn);
        next.inverse_chance /= chance;
        if self.depth + number + 1 >= view.limits.rr_depth {
            let brightest = rays.iter().map(|ray| ray.weight.max_element());
            let brightest = brightest.fold(0.0, f64::max) * next.inverse_chance;
            // A mask may let more through between its rays than along them.
            let survives = brightest.clamp(LEAST_CHANCE, MOST_SURVIVAL);
            if self.draw() >= survives {
                return;
            }
            next.inverse_chance /= survives;
        }
        for rays in self.where_bent(rays, turn, way) {
            let rays = rays.into_iter();
            let on: Vec<_> = rays
                .filter_map(|ray| ray.on(view, turn, self.counts))
                .collect();
            if on.len() > 1 {
                self.waiting.push((on, next.clone()));
            }
        }
    }

    /// The parts of a run in which what it sees bends rays so: beyond the angle of total reflection
    /// nothing is refracted.
    fn where_bent(&mut self, rays: Vec<Followed>, turn: Turn, way: &Way) -> Vec<Vec<Followed>> {
        let view = self.scene.view;
        let passes = |ray: &Followed| ray.meeting(view).is_some_and(|m| m.bent(turn).is_some());
        let mut parts: Vec<Vec<Followed>> = vec![Vec::new()];
        let mut last: Option<(Followed, bool)> = None;
        for ray in rays {
            let now = passes(&ray);
            if let Some((before, did)) = last
                && did != now
            {
                let (mut passing, mut other) = if did {
                    (before, ray.s)
                } else {
                    (ray.clone(), before.s)
                };
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (passing.s + other);
                    match Followed::new(view, self.rays, middle, &way.bends, self.counts) {
                        Some(ray) if passes(&ray) => passing = ray,
                        _ => other = middle,
                    }
                }
                if let (true, Some(part)) = (did, parts.last_mut()) {
                    part.push(passing);
                    parts.push(Vec::new());
                } else {
                    parts.push(vec![passing]);
                }
            }
            if let (true, Some(part)) = (now, parts.last_mut()) {
                part.push(ray.clone());
            }
            last = Some((ray, now));
        }
        parts
    }
}
