//! What lies between two rays, and the choice of one among many.

use crate::discontinuity::boundary::Boundary;

/// What happens at a boundary.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A surface ends, or passes through another.
    Silhouette,
    /// Likewise, at an acute edge of a body with shading normals.
    ThinSilhouette,
    /// An edge within what is seen, at which its shading changes.
    Ridge,
    /// Shading goes on, but the plane of the triangles does not: below that rays start on the other
    /// side of the surface, so that the part of a lobe that lies between the two planes sees
    /// something else.
    FacetEdge,
}

/// A boundary between two rays.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    pub boundary: Boundary,
    pub kind: Kind,
    /// Parameter of the arc.
    pub s: f64,
    /// How many of its kind it stands for.
    pub count: f64,
}

impl Crossing {
    /// Stands for itself.
    pub fn new(boundary: Boundary, kind: Kind, s: f64) -> Self {
        Self {
            boundary,
            kind,
            s,
            count: 1.0,
        }
    }

    /// An edge within what is seen.
    pub fn ridge(boundary: Boundary, s: f64) -> Self {
        Self::new(boundary, Kind::Ridge, s)
    }

    /// Whether it lies behind what is seen, if these triangles are seen on its two sides: all but
    /// texture edges separate two.
    pub fn is_hidden(&self, seen: [u32; 2]) -> bool {
        seen[0] == seen[1] && !matches!(self.boundary, Boundary::TextureEdge { .. })
    }

    /// Whether what starts right beside it may start on the other side of what lies there: rays
    /// start a little off surfaces, and there two of them are nearer to each other than that.
    pub fn is_tight(&self) -> bool {
        self.kind == Kind::ThinSilhouette || matches!(self.boundary, Boundary::Crease(_))
    }

    /// Whether something ends there.
    pub fn is_silhouette(&self) -> bool {
        matches!(self.kind, Kind::Silhouette | Kind::ThinSilhouette)
    }
}

/// One crossing out of a stream of unknown length, each with the same chance (a reservoir of one,
/// whose random number is stretched after each decision).
pub struct Reservoir {
    chosen: Option<Crossing>,
    met: u32,
    /// In [0, 1); `None` if nothing is to be collected.
    choice: Option<f64>,
    /// Crossings nearer than this to the next one are left out: who looks beside the next one sees
    /// both.
    gap: f64,
    pending: Option<Crossing>,
}

impl Reservoir {
    /// Collects crossings that are at least `gap` apart; `choice` is uniform in [0, 1).
    pub fn new(choice: f64, gap: f64) -> Self {
        Self {
            chosen: None,
            met: 0,
            choice: Some(choice),
            gap,
            pending: None,
        }
    }

    /// Takes nothing.
    pub fn closed() -> Self {
        Self {
            choice: None,
            ..Self::new(0.0, 0.0)
        }
    }

    /// The same choice, seen from the arc's other end.
    pub fn turned(mut self) -> Self {
        self.chosen = self.chosen.map(|crossing| Crossing {
            s: 1.0 - crossing.s,
            ..crossing
        });
        self
    }

    /// What was chosen stands for all.
    pub fn chosen(self) -> Option<Crossing> {
        self.chosen.map(|crossing| Crossing {
            s: crossing.s.clamp(0.0, 1.0),
            count: crossing.count * self.met as f64,
            ..crossing
        })
    }

    /// Whether anything is to be collected.
    pub fn is_open(&self) -> bool {
        self.choice.is_some()
    }

    /// Offers a crossing.
    pub fn meet(&mut self, crossing: Crossing) {
        self.settle(crossing.s);
        self.pending = Some(crossing);
    }

    /// Offers a bend with this chance; it then stands for as many as it must. Right beside another
    /// edge it is left out, since who looks beside that sees both, and who looks beside a bend does
    /// not.
    pub fn meet_facet_edge(&mut self, crossing: Crossing, chance: f64) {
        let is_beside =
            |other: Crossing| other.kind != Kind::FacetEdge && crossing.s - other.s <= self.gap;
        if self.pending.is_some_and(is_beside) {
            return;
        }
        if self.happens(chance) {
            self.meet(Crossing {
                count: 1.0 / chance,
                kind: Kind::FacetEdge,
                ..crossing
            });
        }
    }

    /// Decides about the crossing offered last, now that the next one is known to be at `s`.
    pub fn settle(&mut self, s: f64) {
        let Some(pending) = self.pending.take() else {
            return;
        };
        if s - pending.s < self.gap {
            return;
        }
        self.met += 1;
        if self.happens(1.0 / self.met as f64) {
            self.chosen = Some(pending);
        }
    }

    fn happens(&mut self, chance: f64) -> bool {
        let Some(choice) = &mut self.choice else {
            return false;
        };
        let happens = *choice < chance;
        *choice = if happens {
            *choice / chance
        } else {
            (*choice - chance) / (1.0 - chance)
        };
        happens
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Whatever the choice, what it stands for adds up to each crossing once, on average.
    #[test]
    fn each_crossing_counts_once() {
        const CHOICES: usize = 100_000;
        let chances = [0.3, 1.0, 0.02, 0.5, 1.0];
        let mut counts = [0.0; 5];
        for choice in 0..CHOICES {
            let mut crossings = Reservoir::new((choice as f64 + 0.5) / CHOICES as f64, 0.1);
            for (i, chance) in chances.into_iter().enumerate() {
                let edge = Boundary::Edge([i as u32; 2]);
                crossings.meet_facet_edge(Crossing::ridge(edge, i as f64), chance);
            }
            crossings.settle(f64::INFINITY);
            if let Some(Crossing {
                boundary: Boundary::Edge([i, _]),
                count,
                ..
            }) = crossings.chosen()
            {
                counts[i as usize] += count / CHOICES as f64;
            }
        }
        for count in counts {
            assert!((count - 1.0).abs() < 0.01, "{counts:?}");
        }
    }

    #[test]
    fn of_two_that_are_near_the_second_is_met() {
        let mut crossings = Reservoir::new(0.5, 0.1);
        for (i, s) in [0.2, 0.5, 0.55].into_iter().enumerate() {
            crossings.meet(Crossing::ridge(Boundary::Edge([i as u32; 2]), s));
        }
        crossings.settle(f64::INFINITY);
        assert_eq!(crossings.met, 2);
    }
}
