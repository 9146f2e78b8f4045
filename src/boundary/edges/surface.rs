//! Edges as the vertices of a packet see them: one is drawn in each lane, and those before which
//! nothing stands are kept.

use super::directions::Directions;
use super::horizon::Horizon;
use super::point::EdgePoint;
use super::sources::Edges;
use crate::boundary::occlusion::SurfacePoint;
use crate::lanes::LANES;
use crate::paths::at::At;
use crate::paths::counts::Counts;
use crate::paths::dimensions::Single;
use crate::paths::rays::from_lanes;
use crate::paths::scene_view::SceneView;
use glam::Vec3;

/// So many edges are drawn at once at most.
const MOST_DRAWS: u32 = 4;

/// A point in each lane that sees one.
pub type EdgePoints = [Option<EdgePoint>; LANES];

impl Edges<'_> {
    /// Draws an edge in each lane in which `directions` gives what matters, in lanes of `moves`
    /// from all edges, in others from those that move. Numbers are those of `user`.
    pub(super) fn draw(
        &self,
        at: &At,
        user: Single,
        moves: u32,
        directions: impl Fn(usize) -> Option<Directions>,
        counts: &mut Counts,
    ) -> EdgePoints {
        self.draw_part(at, (user, [1; LANES], 0), moves, directions, counts)
    }

    /// How many edges are worth drawing at once in lanes that see lights: as many as there are, if
    /// these are few. A lamp's edges on one side and on the other bring nearly the opposite.
    pub(super) fn draws(&self, view: &SceneView, moves: u32, sees_lights: u32) -> [u32; LANES] {
        std::array::from_fn(|lane| match sees_lights >> lane & 1 {
            0 => 1,
            _ => {
                let set = self.set(view, moves >> lane & 1 == 1);
                set.map_or(1, |set| set.edges.edges.len() as u32)
                    .min(MOST_DRAWS)
            }
        })
    }

    /// Of so many edges drawn in each lane, each from its share of the numbers, the one with this
    /// number.
    pub(super) fn draw_part(
        &self,
        at: &At,
        (user, draws, part): (Single, [u32; LANES], u32),
        moves: u32,
        directions: impl Fn(usize) -> Option<Directions>,
        counts: &mut Counts,
    ) -> EdgePoints {
        let view = at.view;
        let numbers = &at.numbers;
        let mut points: EdgePoints = std::array::from_fn(|lane| {
            if part >= draws[lane] {
                return None;
            }
            let directions = directions(lane)?;
            let set = self.set(view, moves >> lane & 1 == 1)?;
            let number = |of| {
                let name = [numbers.index[lane], numbers.depth, of];
                f64::from(numbers.stream.single(user, name))
            };
            let point = SurfacePoint::of_lane(at, lane);
            let share = 1.0 / f64::from(draws[lane]);
            let [which, along] = [0, 1].map(number);
            let which = (f64::from(part) + which) * share;
            // Of a point that rests the horizon does, too.
            let horizon = (moves >> lane & 1 == 1)
                .then(|| Horizon::new(view, &directions, &point))
                .flatten();
            let of_edges = 1.0 - horizon.as_ref().map_or(0.0, |horizon| horizon.chance);
            let geometry = view.geometry;
            let (drawn, share) = if which < of_edges {
                let numbers = [which / of_edges, along];
                let drawn = EdgePoint::draw(set, geometry, &directions, &point, numbers);
                (drawn?, share / of_edges)
            } else {
                (horizon?.draw(geometry, &directions, along)?, share)
            };
            Some(EdgePoint {
                per_side: drawn.per_side * share,
                ..drawn
            })
        });
        let mut ends = [Vec3::ZERO; LANES];
        let (mut active, mut open) = (0, 0);
        for (lane, found) in points.iter().enumerate() {
            if let Some(found) = found {
                if found.is_horizon {
                    open |= 1 << lane;
                    continue;
                }
                let point = SurfacePoint::of_lane(at, lane);
                let start = point.leave(found.way).as_dvec3();
                ends[lane] = found.end(start).as_vec3();
                active |= 1 << lane;
            }
        }
        let surface = at.surface;
        let rays = view.toward(surface.x, surface.geometric, from_lanes(&ends), active);
        let seen = view.unoccluded(&rays, &mut counts.edge) | open;
        for (lane, point) in points.iter_mut().enumerate() {
            if seen >> lane & 1 == 0 {
                *point = None;
            }
        }
        points
    }
}

/// Which lanes have one, and the directions beside it on one side in each.
pub fn beside(points: &EdgePoints, side: impl Fn(&EdgePoint) -> f64) -> (u32, [Vec3; LANES]) {
    let mut active = 0;
    let directions = std::array::from_fn(|lane| match &points[lane] {
        Some(point) => {
            active |= 1 << lane;
            point.beside(side(point)).as_vec3()
        }
        None => Vec3::Z,
    });
    (active, directions)
}
