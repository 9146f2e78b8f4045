//! What the rays of a line see behind smooth surfaces, and what lies between.
//!
//! The surfaces that neighbouring rays of a line meet first are compared, and where these part the
//! line is cut. On each part that sees one smooth surface, what that does with the rays is chosen
//! (reflect or refract), all of its rays are followed to what they meet next, and so on. Where a cut
//! lies behind a smooth surface it is a border whose jump counts.

use super::follow::{FirstRays, Followed, pencil};
use crate::boundary::occlusion::{NEAREST, PROBE, SurfacePoint};
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::between::HALVINGS;
use crate::discontinuity::boundary::Boundary;
use crate::discontinuity::crossing::{Crossing, Kind};
use crate::discontinuity::pencil::{Between, between};
use crate::paths::chain::{Bend, ChainVertex, LEAST_CHANCE};
use crate::paths::counts::Counts;
use crate::paths::rays::OFFSET;
use glam::DVec3;

/// Cuts behind one another that are looked for in one part of an interval.
const ROUNDS: u32 = 6;
/// Steps toward a border along a chain.
const STEPS: u32 = 24;
/// Chances below this are taken for it: it bounds the weight of one border. Both borders of what is
/// thinner move nearly alike.
const LEAST_MET: f64 = 0.1;
/// How near to where rays change sides of a plane to look, in parts of an interval.
const OWN_PLANE: f64 = 1e-4;
/// Facets of one smooth surface that are told apart in one interval.
const MOST_FACETS: usize = 16;

/// A border behind smooth surfaces.
pub struct Found {
    /// The place of the first ray.
    pub s: f64,
    pub boundary: Boundary,
    pub chain: Vec<ChainVertex>,
    /// Smooth surfaces before the last rays: one more than the chain where it is the last surface
    /// that has an edge there.
    pub bends: usize,
    /// The chain's last rays on either side.
    pub sides: [(DVec3, DVec3); 2],
    /// What the jump is multiplied with: the chain's weight, over the chance of finding it and that
    /// of its bends.
    pub weight: DVec3,
}

/// A search on a line.
pub struct ChainSearch<'a, R> {
    pub scene: &'a SearchScene<'a>,
    pub rays: &'a R,
    pub counts: &'a mut Counts,
    /// Uniform numbers, by their place in the search.
    pub random: &'a dyn Fn(u32) -> f64,
    /// How many of them have been drawn.
    pub drawn: u32,
    /// Number of the vertex that the first rays lead to.
    pub depth: u32,
    /// Whether reflection and refraction are both followed at the first surface.
    pub splits_first: bool,
    /// Points that are put anew on each part of the line that sees one smooth surface, if any.
    pub new_points: Option<u32>,
    pub found: Vec<Found>,
}

/// How points lie that look for something.
#[derive(Clone, Copy)]
enum Points {
    /// Those of the line.
    OfLine,
    /// So many at equal distances of the line's measure between two places, shifted together; with
    /// the chance that they are there.
    New {
        ends: [f64; 2],
        count: f64,
        chance: f64,
    },
}

/// How a chain came about.
#[derive(Clone)]
struct Way {
    bends: Vec<Bend>,
    /// One over the chance of these bends.
    inverse_chance: f64,
    points: Points,
    /// The chance that the part of the line is met on which all this is seen.
    met: f64,
}

/// Which side of a cut hides the other.
#[derive(Clone, Copy, PartialEq)]
enum Near {
    Before,
    After,
    /// Neither does.
    None,
    /// Rays change sides of the plane of the triangle that bends them last.
    OwnPlane,
}

/// A place at which what is seen changes, and what is seen beside it.
struct Cut {
    sides: [Followed; 2],
    near: Near,
    /// If its jump counts.
    border: Option<Found>,
}

/// What lies between the rays of a part of a line.
#[derive(Default)]
struct Cuts {
    cuts: Vec<Cut>,
    /// Edges within what is seen.
    ridges: Vec<Found>,
}

/// Rays that see one surface, and whether the part that sees it goes on beyond the first and the
/// last of them.
struct Run {
    rays: Vec<Followed>,
    is_open: [bool; 2],
}

impl Run {
    fn ends(&self) -> Option<[f64; 2]> {
        Some([self.rays.first()?.s, self.rays.last()?.s])
    }
}

impl<R: FirstRays> ChainSearch<'_, R> {
    /// Searches between the first rays of places in order.
    pub fn search(&mut self, rays: Vec<Followed>) {
        let way = Way {
            bends: Vec::new(),
            inverse_chance: 1.0,
            points: Points::OfLine,
            met: 1.0,
        };
        self.look_between(rays, &way);
    }

    fn draw(&mut self) -> f64 {
        self.drawn += 1;
        (self.random)(self.drawn)
    }

    /// What lies between rays with chains of one kind.
    fn look_between(&mut self, rays: Vec<Followed>, way: &Way) {
        let mut all = Cuts::default();
        let mut runs = vec![Run {
            rays: Vec::new(),
            is_open: [true; 2],
        }];
        let mut known = 0;
        for (i, ray) in rays.iter().enumerate() {
            let is_first = i == 0;
            if !is_first {
                self.cuts([&rays[i - 1], ray], way, &mut all);
            }
            all.cuts[known..].sort_by(|a, b| a.sides[0].s.total_cmp(&b.sides[0].s));
            for cut in &all.cuts[known..] {
                if let Some(run) = runs.last_mut() {
                    run.rays.push(cut.sides[0].clone());
                    run.is_open[1] = false;
                }
                runs.push(Run {
                    rays: vec![cut.sides[1].clone()],
                    is_open: [false, true],
                });
            }
            known = all.cuts.len();
            if let Some(run) = runs.last_mut() {
                run.rays.push(ray.clone());
            }
        }
        self.weigh(&mut all, &runs, way);
        for run in runs {
            self.deeper(run, way);
        }
    }

    /// Weighs what was found by one over the chance of finding it. A border is found from the side
    /// that hides the other, wherever a point lies there; what in turn hides that, up to its own
    /// border, finds it as well.
    fn weigh(&mut self, all: &mut Cuts, runs: &[Run], way: &Way) {
        let near: Vec<Near> = all.cuts.iter().map(|cut| cut.near).collect();
        let chance = |[first, last]: [usize; 2]| {
            let [a, b] = [&runs[first], &runs[last]].map(Run::ends);
            let (Some([from, _]), Some([_, to])) = (a, b) else {
                return way.met;
            };
            if runs[first].is_open[0] || runs[last].is_open[1] {
                return way.met;
            }
            self.chance([from, to], way)
        };
        for i in 0..near.len() {
            let before = || {
                let mut first = i;
                while first > 0 && near[first - 1] == Near::Before {
                    first -= 1;
                }
                chance([first, i])
            };
            let after = || {
                let mut last = i + 1;
                while last < near.len() && near[last] == Near::After {
                    last += 1;
                }
                chance([i + 1, last])
            };
            let chance = match near[i] {
                Near::Before => before(),
                Near::After => after(),
                Near::None => before().min(after()),
                Near::OwnPlane => {
                    self.own_plane_counts(&all.cuts[i], [&runs[i], &runs[i + 1]], way)
                }
            };
            if let Some(border) = &mut all.cuts[i].border {
                border.weight /= chance;
            }
        }
        for ridge in &mut all.ridges {
            let holds = |run: &Run| {
                run.ends()
                    .is_some_and(|[from, to]| (from..=to).contains(&ridge.s))
            };
            if let Some(run) = runs.iter().position(holds) {
                ridge.weight /= chance([run; 2]);
            }
        }
        self.found.append(&mut all.ridges);
        self.found
            .extend(all.cuts.iter_mut().filter_map(|cut| cut.border.take()));
    }

    /// Whether a border at which rays change sides of a plane counts: infinity if not. Those that
    /// lie between two such borders move alike, and what they bring cancels. Only what reaches to
    /// the end of the surface is left.
    fn own_plane_counts(&self, cut: &Cut, runs: [&Run; 2], way: &Way) -> f64 {
        let leaks_first = cut.sides[0].leaks;
        let reaches_end = if leaks_first {
            runs[0].is_open[0]
        } else {
            runs[1].is_open[1]
        };
        if reaches_end { way.met } else { f64::INFINITY }
    }

    /// The chance that any point lies between two places.
    fn chance(&self, [from, to]: [f64; 2], way: &Way) -> f64 {
        let chance = match way.points {
            Points::OfLine => self.rays.chance_between([from, to]),
            Points::New {
                ends,
                count,
                chance,
            } => {
                let place = |s| self.rays.place(s);
                let part = (place(to) - place(from)) / (place(ends[1]) - place(ends[0]));
                chance * (count * part).min(1.0)
            }
        };
        chance.max(LEAST_MET)
    }

    /// Follows rays that see one smooth surface beyond it.
    fn deeper(&mut self, run: Run, way: &Way) {
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
        here.met = match run.is_open {
            [false, false] => self.chance(ends, way),
            _ => way.met,
        };
        let mut rays = run.rays;
        if let (Some(count), 0) = (self.new_points, number) {
            rays = self.put_anew(rays, ends, count, &here);
            here.points = Points::New {
                ends,
                count: f64::from(count),
                chance: here.met,
            };
        }
        let chances = rays.iter().filter_map(|ray| ray.meeting(view));
        let chances: Vec<_> = chances.map(|m| m.chances()).collect();
        let mean = |i: usize| chances.iter().map(|c| c[i].1).sum::<f64>() / chances.len() as f64;
        let bends = [0, 1].map(|i| chances[0][i].0);
        let [mut chance, mut other] = [mean(0), mean(1)];
        if self.splits_first && number == 0 {
            for (bend, chance) in bends.into_iter().zip([chance, other]) {
                if chance > 0.0 {
                    self.follow(rays.clone(), &here, bend, 1.0);
                }
            }
            return;
        }
        if chance > 0.0 && other > 0.0 {
            chance = (chance / (chance + other)).clamp(LEAST_CHANCE, 1.0 - LEAST_CHANCE);
            other = 1.0 - chance;
        }
        let random = self.draw();
        if random < chance {
            self.follow(rays, &here, bends[0], chance);
        } else if random < chance + other {
            self.follow(rays, &here, bends[1], other);
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
    fn follow(&mut self, rays: Vec<Followed>, way: &Way, bend: Bend, chance: f64) {
        let view = self.scene.view;
        let number = way.bends.len() as u32;
        let mut next = way.clone();
        next.bends.push(bend);
        next.inverse_chance /= chance;
        if self.depth + number + 1 >= view.limits.rr_depth {
            let brightest = rays.iter().map(|ray| ray.weight.max_element());
            let brightest = brightest.fold(0.0, f64::max) * next.inverse_chance;
            let survives = brightest.min(0.95);
            if self.draw() >= survives {
                return;
            }
            next.inverse_chance /= survives;
        }
        for rays in self.where_bent(rays, bend, way) {
            let rays = rays.into_iter();
            let on: Vec<_> = rays
                .filter_map(|ray| ray.on(view, bend, self.counts))
                .collect();
            if on.len() > 1 {
                self.look_between(on, &next);
            }
        }
    }

    /// The parts of a run in which what it sees bends rays so: beyond the angle of total reflection
    /// nothing is refracted.
    fn where_bent(&mut self, rays: Vec<Followed>, bend: Bend, way: &Way) -> Vec<Vec<Followed>> {
        let view = self.scene.view;
        let passes = |ray: &Followed| ray.meeting(view).is_some_and(|m| m.bent(bend).is_some());
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

    /// Where what is seen between two rays changes.
    fn cuts(&mut self, ends: [&Followed; 2], way: &Way, out: &mut Cuts) {
        let SearchScene {
            view, adjacency, ..
        } = *self.scene;
        let mut parts = vec![(ends.map(Followed::clone), ROUNDS, HALVINGS)];
        while let Some(([a, b], rounds, halvings)) = parts.pop() {
            let seen = [a.triangle, b.triangle];
            if a.s >= b.s {
                continue;
            }
            if a.leaks != b.leaks {
                if rounds == 0 {
                    continue;
                }
                let Some((crossing, border)) = self.own_plane([&a, &b], way) else {
                    self.counts.unresolved += 1;
                    continue;
                };
                let [before, after] = border.sides.clone();
                parts.push(([a, before.clone()], rounds - 1, HALVINGS));
                parts.push(([after.clone(), b], rounds - 1, HALVINGS));
                out.cuts.push(Cut {
                    border: self.kept(&crossing, border, 1.0, way),
                    sides: [before, after],
                    near: Near::OwnPlane,
                });
                continue;
            }
            let has_lines = !way.bends.is_empty() && view.geometry.has_texture_edges(seen[0]);
            if seen[0] == seen[1] && !has_lines {
                continue;
            }
            let rays = pencil([&a, &b]);
            let between = between(view.geometry, adjacency, &rays, seen);
            let border = between.ok().and_then(|Between { silhouette, ridges }| {
                let Some((crossing, near)) = silhouette else {
                    return Some((None, ridges));
                };
                let border = self.border([&a, &b], &crossing, way)?;
                Some((Some((border, crossing, near)), ridges))
            });
            let Some((border, ridges)) = border else {
                if halvings == 0 {
                    self.counts.unresolved += 1;
                    continue;
                }
                let middle = 0.5 * (a.s + b.s);
                let middle = Followed::new(view, self.rays, middle, &way.bends, self.counts);
                match middle {
                    Some(m) => {
                        parts.push(([m.clone(), b], rounds, halvings - 1));
                        parts.push(([a, m], rounds, halvings - 1));
                    }
                    None => self.counts.unresolved += 1,
                }
                continue;
            };
            self.ridges([&a, &b], ridges, way, out);
            let Some((border, crossing, near)) = border else {
                continue;
            };
            let [before, after] = border.sides.clone();
            if rounds > 0 {
                parts.push(([a, before.clone()], rounds - 1, HALVINGS));
                parts.push(([after.clone(), b], rounds - 1, HALVINGS));
            }
            if before.triangle != after.triangle {
                let near = match near {
                    Some(0) => Near::Before,
                    Some(_) => Near::After,
                    None => Near::None,
                };
                out.cuts.push(Cut {
                    border: self.kept(&crossing, border, 1.0, way),
                    sides: [before, after],
                    near,
                });
            }
        }
    }

    /// Edges within what is seen: smooth surfaces are cut there; of others one stands for all.
    fn ridges(
        &mut self,
        ends: [&Followed; 2],
        mut ridges: Vec<Crossing>,
        way: &Way,
        out: &mut Cuts,
    ) {
        let view = self.scene.view;
        let is_smooth = Followed::is_smooth(view, ends[0].triangle);
        if ridges.is_empty() || (!is_smooth && way.bends.is_empty()) {
            return;
        }
        let mut count = 1.0;
        if is_smooth {
            ridges.truncate(MOST_FACETS);
        } else {
            count = ridges.len() as f64;
            let chosen = ((self.draw() * count) as usize).min(ridges.len() - 1);
            ridges = vec![ridges[chosen]];
        }
        for crossing in ridges {
            let Some(border) = self.border(ends, &crossing, way) else {
                continue;
            };
            let sides = border.sides.clone();
            if !crossing.is_hidden([0, 1].map(|i| sides[i].triangle)) {
                let border = self.kept(&crossing, border, count, way);
                let is_texture = matches!(crossing.boundary, Boundary::TextureEdge { .. });
                if is_smooth && !is_texture {
                    out.cuts.push(Cut {
                        sides,
                        near: Near::None,
                        border,
                    });
                } else {
                    out.ridges.extend(border);
                }
            }
        }
    }

    /// A border, if something moves there and it is seen through a chain.
    fn kept(&self, crossing: &Crossing, border: Border, count: f64, way: &Way) -> Option<Found> {
        let SearchScene { view, moving, .. } = *self.scene;
        let Border { at, sides } = border;
        let geometry = view.geometry;
        let first = |v: &ChainVertex| geometry.triangles[v.triangle as usize][0];
        let moves = self.rays.moves(at.s)
            || moving.boundary(geometry, &crossing.boundary)
            || at.chain.iter().any(|v| moving.vertex(geometry, first(v)));
        (!way.bends.is_empty() && moves).then(|| Found {
            s: at.s,
            boundary: crossing.boundary,
            weight: at.weight * (way.inverse_chance * count),
            chain: at.chain,
            bends: way.bends.len(),
            sides: sides.map(|side| (side.origin, side.direction)),
        })
    }

    /// Where a crossing really is, and what is seen beside it.
    fn border(&mut self, ends: [&Followed; 2], crossing: &Crossing, way: &Way) -> Option<Border> {
        let (at, slope) = self.root(ends, crossing, way)?;
        let beside = self.beside(&at, crossing, slope);
        let view = self.scene.view;
        let places = [at.s - beside, at.s + beside];
        let [before, after] =
            places.map(|s| Followed::new(view, self.rays, s, &way.bends, self.counts));
        Some(Border {
            at,
            sides: [before?, after?],
        })
    }

    /// Where rays change sides of the plane of the triangle that bends them last: within it, or
    /// where the next one begins.
    fn own_plane(&mut self, ends: [&Followed; 2], way: &Way) -> Option<(Crossing, Border)> {
        let view = self.scene.view;
        let [mut a, mut b] = ends.map(Followed::clone);
        let length = b.s - a.s;
        while b.s - a.s > OWN_PLANE * length {
            let middle = 0.5 * (a.s + b.s);
            let m = Followed::new(view, self.rays, middle, &way.bends, self.counts)?;
            let end = if m.leaks == a.leaks { &mut a } else { &mut b };
            *end = m;
        }
        let [t, u] = [&a, &b].map(|end| end.chain.last().map(|v| v.triangle));
        let (t, u) = (t?, u?);
        let corners = view.geometry.triangles[t as usize];
        let mut at = a.clone();
        let edge = if t == u {
            let point = SurfacePoint {
                x: at.origin.as_vec3(),
                geometric: glam::Vec3::ZERO,
                triangle: t,
            };
            point.plane_edge(view)
        } else {
            at.chain.pop();
            let corner = (0..3).find(|&corner| {
                let across = self.scene.adjacency.across(t, corner);
                across.is_some_and(|across| across.triangle == u)
            })?;
            [corners[corner], corners[(corner + 1) % 3]]
        };
        let boundary = Boundary::Edge(edge);
        let crossing = Crossing::new(boundary, Kind::FacetEdge, 0.0);
        Some((crossing, Border { at, sides: [a, b] }))
    }

    /// The root of F along the chain near where rays that are not bent otherwise have it, and its
    /// slope there.
    fn root(
        &mut self,
        [a, b]: [&Followed; 2],
        crossing: &Crossing,
        way: &Way,
    ) -> Option<(Followed, f64)> {
        let (scene, rays) = (self.scene, self.rays);
        let boundary = &crossing.boundary;
        let length = b.s - a.s;
        let [mut low, mut high] = [a, b].map(|end| (end.s, end.side(scene, boundary)));
        let is_bracketed = low.1 * high.1 < 0.0;
        let mut s = a.s + crossing.s.clamp(0.0, 1.0) * length;
        let mut last: Option<(f64, f64)> = None;
        for step in 0..STEPS {
            let here = Followed::new(scene.view, rays, s, &way.bends, self.counts)?;
            let side = here.side(scene, boundary);
            // The slope between the last two places; at first between the ends, or a little beside.
            let slope = match last {
                Some((t, f)) if t != s => (side - f) / (s - t),
                _ if is_bracketed => (high.1 - low.1) / (high.0 - low.0),
                _ => {
                    let t = if s < a.s + 0.5 * length { 1.0 } else { -1.0 };
                    let t = s + 1e-3 * t * length;
                    let beside = Followed::new(scene.view, rays, t, &way.bends, self.counts)?;
                    (beside.side(scene, boundary) - side) / (t - s)
                }
            };
            if slope == 0.0 || !slope.is_finite() {
                return None;
            }
            let enough = 0.02 * self.beside(&here, crossing, slope);
            if step > 0 && (side / slope).abs() <= enough {
                return Some((here, slope));
            }
            last = Some((s, side));
            let mut next = s - side / slope;
            if is_bracketed {
                *(if side * low.1 > 0.0 {
                    &mut low
                } else {
                    &mut high
                }) = (s, side);
                let inside = next > low.0.min(high.0) && next < low.0.max(high.0);
                if !inside || step % 4 == 3 {
                    next = 0.5 * (low.0 + high.0);
                }
            }
            if !(a.s - 1e-3 * length..=b.s + 1e-3 * length).contains(&next) {
                return None;
            }
            s = next;
        }
        None
    }

    /// How far beside a border to look: as near as single precision lets.
    fn beside(&self, at: &Followed, crossing: &Crossing, slope: f64) -> f64 {
        let Boundary::Edge(edge) = crossing.boundary else {
            return PROBE;
        };
        let [p, q] = edge.map(|v| self.scene.view.geometry.positions[v as usize].as_dvec3());
        let point = p.midpoint(q);
        let room = point.abs().max_element() + 1.0;
        let distance = if crossing.kind == Kind::ThinSilhouette {
            10.0 * f64::from(OFFSET) * room
        } else {
            NEAREST * (room + point.distance(at.origin))
        };
        let per_distance = at.direction.cross(q - p).length();
        (distance * per_distance / slope.abs()).min(PROBE)
    }
}

/// A border and the rays beside it.
struct Border {
    at: Followed,
    sides: [Followed; 2],
}
