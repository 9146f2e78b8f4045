//! Where the shadows of delta lights end on what a vertex sees along a line over its lobe.
//!
//! As on the film (`boundary::cells::film::shadows`), but all points of a line are known, and from
//! each that is hidden its shadow is followed to both of its ends.

use super::cell::LobeCell;
use super::line::{LaneSurface, Line};
use super::met::{Met, SMALLEST_CHANCE};
use super::rims;
use super::vertex::{Border, FAMILIES, LobeSearch};
use crate::boundary::cells::delta::follow::{Followed, ShadowEnd, follow};
use crate::boundary::cells::delta::receiver::Receiver;
use crate::boundary::cells::delta::value::brought;
use crate::boundary::cells::line_search::Cell;
use crate::boundary::occlusion::SurfacePoint;
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::boundary::Boundary;
use crate::lanes::LANES;
use crate::paths::boundary_sample::Shadow;
use crate::paths::counts::Counts;
use crate::paths::rays::{RayPacket, from_lanes};
use crate::paths::store::Vertices;
use crate::trace::geometry::NO_TRIANGLE;
use glam::{DVec3, Vec3};

/// Finds the ends of shadows on a line, or a part of one, of which these are the cells.
pub fn find(
    search: &mut LobeSearch,
    at: &mut LaneSurface,
    (weight, point): (f64, &SurfacePoint),
    line: &Line,
    cells: &[LobeCell],
) {
    let on_line = OnLine {
        scene: search.scene,
        point,
        line,
        cells,
    };
    let counts = &mut search.out.counts;
    let mut all = Vec::new();
    for (light, lit) in on_line.lit(counts).iter().enumerate() {
        all.extend(on_line.ends(light, lit, counts));
    }
    all.extend(rims::find(on_line.scene, line, cells, counts));
    for group in all.chunks(LANES) {
        let brought = on_line.brought(group, &mut search.out.counts);
        for (met, brought) in group.iter().zip(brought) {
            if brought != DVec3::ZERO {
                let border = Border {
                    chain: &[],
                    boundary: met.boundary,
                    beside: None,
                    shadow: Some(met.shadow),
                };
                let times = met.jump * FAMILIES * weight;
                search.push(at, line, border, met.direction, (brought, times));
            }
        }
    }
}

/// What a light does to what is seen at a point.
#[derive(Clone, Copy, PartialEq)]
enum Lit {
    /// It shines on it.
    Yes,
    /// Something hides it.
    Hidden,
    /// It could not shine there.
    Never,
}

/// How a shadow goes on from a point.
enum Reach {
    /// To an end of the line.
    Rim,
    /// To where what throws it ends, at a coordinate.
    Edge(ShadowEnd, f64),
    /// To a coordinate at which the surface ends that it falls on, or it is not known why.
    Other(f64),
}

impl Reach {
    fn coordinate(&self) -> Option<f64> {
        match *self {
            Reach::Rim => None,
            Reach::Edge(_, psi) | Reach::Other(psi) => Some(psi),
        }
    }
}

struct OnLine<'a> {
    scene: &'a SearchScene<'a>,
    point: &'a SurfacePoint,
    line: &'a Line,
    cells: &'a [LobeCell<'a>],
}

impl OnLine<'_> {
    fn rays(&self, directions: &[Vec3; LANES], active: u32) -> RayPacket {
        let [x, normal] = [self.point.x, self.point.geometric].map(|v| from_lanes(&[v; LANES]));
        self.scene
            .view
            .leaving(x, normal, from_lanes(directions), active)
    }

    /// What each light does to what is seen at the line's points.
    fn lit(&self, counts: &mut Counts) -> Vec<Vec<Lit>> {
        let view = self.scene.view;
        let lights = &view.delta_lights;
        let first = self
            .cells
            .iter()
            .take(1)
            .map(|c| (c.arc().a, c.triangles()[0]));
        let rest = self.cells.iter().map(|c| (c.arc().b, c.triangles()[1]));
        let points: Vec<(DVec3, u32)> = first.chain(rest).collect();
        let mut lit = vec![Vec::new(); lights.len()];
        for group in points.chunks(LANES) {
            let mut directions = [Vec3::Z; LANES];
            let mut triangle = [NO_TRIANGLE; LANES];
            let mut hit = 0;
            for (lane, &(d, seen)) in group.iter().enumerate() {
                (directions[lane], triangle[lane]) = (d.as_vec3(), seen);
                hit |= u32::from(seen != NO_TRIANGLE) << lane;
            }
            let rays = self.rays(&directions, hit);
            let mut vertices = Vertices {
                hit,
                origin: rays.origin,
                direction: rays.direction,
                triangle,
                ..Vertices::default()
            };
            let surface = view.surface(&mut vertices);
            for (number, lit) in lit.iter_mut().enumerate() {
                let light = &lights[number];
                let sight = view.delta_sight(light, &vertices, &surface, &mut counts.bounce_cell);
                for (lane, &(d, seen)) in group.iter().enumerate() {
                    lit.push(if view.is_mixed(seen) {
                        // What is met of it need not be what is lit.
                        let receiver = Receiver::new(self.scene, number, seen);
                        match receiver.is_hidden(self.point.leave(d).as_dvec3(), d, counts) {
                            true => Lit::Hidden,
                            false => Lit::Yes,
                        }
                    } else {
                        match [sight.hidden, sight.seen].map(|lanes| lanes >> lane & 1 == 1) {
                            [true, _] => Lit::Hidden,
                            [_, true] => Lit::Yes,
                            _ => Lit::Never,
                        }
                    });
                }
            }
        }
        lit
    }

    /// The ends that move of all shadows of a light in which a point lies.
    fn ends(&self, light: usize, lit: &[Lit], counts: &mut Counts) -> Vec<Met> {
        let mut met = Vec::new();
        let mut known_to = f64::NEG_INFINITY;
        for number in (0..lit.len()).filter(|&n| lit[n] == Lit::Hidden) {
            if self.line.psi[number] <= known_to {
                continue;
            }
            let [before, after] = [-1, 1].map(|step| self.reach(light, lit, number, step, counts));
            let chance = match [&before, &after].map(|reach| reach.coordinate()) {
                [Some(low), Some(high)] => self.line.chance_between([low, high]),
                _ => 1.0,
            };
            known_to = after.coordinate().unwrap_or(f64::INFINITY);
            let weight = 1.0 / chance.max(SMALLEST_CHANCE);
            for (reach, jump) in [(before, weight), (after, -weight)] {
                if let Reach::Edge(end, psi) = reach {
                    met.extend(self.moving(light, &end, psi, jump));
                }
            }
        }
        met
    }

    /// The end of a shadow, if it moves.
    fn moving(&self, light: usize, end: &ShadowEnd, psi: f64, jump: f64) -> Option<Met> {
        let (geometry, moving) = (self.scene.view.geometry, self.scene.moving);
        let boundary = Boundary::Edge(end.edge);
        let moves = self.cells.iter().any(|cell| cell.moves(&boundary))
            || moving.shines_anew(geometry, light, end.receiver);
        moves.then(|| Met {
            shadow: Shadow {
                light: light as u32,
                receiver: end.receiver,
            },
            boundary,
            direction: self.line.direction(psi),
            looked_at: self.line.direction(psi),
            jump,
        })
    }

    /// How the shadow in which a point lies goes on from there: up the line (1) or down it (−1).
    fn reach(
        &self,
        light: usize,
        lit: &[Lit],
        number: usize,
        step: isize,
        counts: &mut Counts,
    ) -> Reach {
        let mut from = number;
        loop {
            let next = from.checked_add_signed(step);
            let Some(to) = next.filter(|&to| to < lit.len()) else {
                return Reach::Rim;
            };
            let psi = &self.line.psi;
            if psi[from] == psi[to] {
                // Points beyond an end of the line were put there.
                from = to;
                continue;
            }
            let rays = self.cells[from.min(to)].rays(step < 0);
            let place = |s: f64| self.line.psi_of(rays.arc.direction(s));
            match follow(self.scene, light, &rays, 1.0, counts) {
                Followed::Shadow(end) => return Reach::Edge(end, place(end.s)),
                Followed::Surface(s) => return Reach::Other(place(s)),
                Followed::Lost(s) => {
                    counts.unresolved += 1;
                    return Reach::Other(place(s));
                }
                Followed::AllHidden if lit[to] == Lit::Hidden => from = to,
                Followed::AllHidden => {
                    counts.unresolved += u64::from(lit[to] == Lit::Yes);
                    return Reach::Other(psi[to]);
                }
            }
        }
    }

    /// What the lights bring where these shadows end.
    fn brought(&self, group: &[Met], counts: &mut Counts) -> [DVec3; LANES] {
        let mut directions = [Vec3::Z; LANES];
        let [mut receivers, mut lights] = [[0; LANES]; 2];
        for (lane, met) in group.iter().enumerate() {
            directions[lane] = met.looked_at.as_vec3();
            receivers[lane] = met.shadow.receiver;
            lights[lane] = met.shadow.light;
        }
        let rays = self.rays(&directions, u32::MAX >> (32 - group.len()));
        brought(self.scene, &rays, &receivers, &lights, counts)
    }
}
