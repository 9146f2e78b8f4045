//! What the rays of a line see behind smooth surfaces, and what lies between.
//!
//! The surfaces that neighbouring rays of a line meet first are compared, and where these part the
//! line is cut. On each part that sees one smooth surface, what that does with the rays is chosen
//! (reflect or refract), all of its rays are followed to what they meet next, and so on. Where a
//! cut lies behind a smooth surface it is a border whose jump counts.

use super::follow::{FirstRays, Followed};
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::boundary::Boundary;
use crate::paths::boundary_sample::Shadow;
use crate::paths::chain_vertex::{ChainVertex, Turn};
use crate::paths::counts::Counts;
use glam::DVec3;

/// Chances below this are taken for it: it bounds the weight of one border. Both borders of what is
/// thinner move nearly alike.
const LEAST_MET: f64 = 0.1;

/// A border behind smooth surfaces.
pub struct Found {
    /// The place of the first ray.
    pub s: f64,
    pub boundary: Boundary,
    /// Given if it is that of a delta light's shadow: its jump is what the light brings.
    pub shadow: Option<Shadow>,
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

impl Found {
    /// What those have in common that are looked at together.
    pub fn kind(&self) -> (usize, bool) {
        (self.bends, self.shadow.is_some())
    }

    /// How often it counts, about: surfaces seldom reflect more than all.
    pub fn times(&self) -> f64 {
        self.weight.max_element().max(1.0)
    }
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
    /// Rays with chains of one kind, between which nothing has been looked for yet.
    pub(super) waiting: Vec<(Vec<Followed>, Way)>,
    pub found: Vec<Found>,
}

/// How points lie that look for something.
#[derive(Clone, Copy)]
pub(super) enum Points {
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
pub(super) struct Way {
    pub bends: Vec<Turn>,
    /// One over the chance of these bends.
    pub inverse_chance: f64,
    pub points: Points,
    /// The chance that the part of the line is met on which all this is seen.
    pub met: f64,
}

/// Which side of a cut hides the other.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Near {
    Before,
    After,
    /// Neither does.
    None,
    /// Rays change sides of the plane of the triangle that bends them last.
    OwnPlane,
}

/// A place at which what is seen changes, and what is seen beside it.
pub(super) struct Cut {
    pub sides: [Followed; 2],
    pub near: Near,
    /// If its jump counts.
    pub border: Option<Found>,
}

impl Cut {
    /// Of which nothing is known but what is seen beside it.
    pub fn unseen(sides: [Followed; 2]) -> Self {
        Self {
            sides,
            near: Near::None,
            border: None,
        }
    }
}

/// What lies between the rays of a part of a line.
#[derive(Default)]
pub(super) struct Cuts {
    pub cuts: Vec<Cut>,
    /// Edges within what is seen.
    pub ridges: Vec<Found>,
}

/// Rays that see one surface, and the chance that the part of the line is met that sees it.
pub(super) struct Run {
    pub rays: Vec<Followed>,
    pub met: f64,
}

impl Run {
    pub fn ends(&self) -> Option<[f64; 2]> {
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
        self.waiting.push((rays, way));
        while let Some((rays, way)) = self.waiting.pop() {
            self.look_between(rays, &way);
        }
    }

    pub(super) fn draw(&mut self) -> f64 {
        self.drawn += 1;
        (self.random)(self.drawn)
    }

    /// What lies between rays with chains of one kind.
    fn look_between(&mut self, rays: Vec<Followed>, way: &Way) {
        let mut all = Cuts::default();
        let run = |rays| Run { rays, met: way.met };
        let mut runs = vec![run(Vec::new())];
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
                }
                runs.push(run(vec![cut.sides[1].clone()]));
            }
            known = all.cuts.len();
            if let Some(run) = runs.last_mut() {
                run.rays.push(ray.clone());
            }
        }
        self.weigh(&mut all, &mut runs, (&rays, way));
        self.delta_lights(&runs, way);
        self.branch(runs, way);
    }

    /// The chance that any point lies between two places.
    pub(super) fn chance(&self, [from, to]: [f64; 2], way: &Way) -> f64 {
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
}

/// A border and the rays beside it.
pub(super) struct Border {
    pub at: Followed,
    pub sides: [Followed; 2],
}
