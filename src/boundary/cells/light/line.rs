//! What all lines over lights share.

use crate::boundary::clearance::Lit;
use crate::boundary::search_scene::SearchScene;
use crate::boundary::shadows::chance_of_any;
use crate::lanes::LANES;
use crate::paths::at::At;
use crate::paths::dimensions::Pair;
use crate::paths::estimator::LightDraw;
use crate::paths::light::lamp::Lamp;
use crate::paths::rays::lane_of;

/// What lines of either direction draw.
pub const PAIRS: [Pair; 2] = [Pair::LightLineAlongS, Pair::LightLineAlongR];

/// Jittered points between the ends of a line.
const INNER_POINTS: usize = 2;
/// Of a line: its ends, those, and one more.
pub const POINTS: usize = INNER_POINTS + 3;

/// A lamp is looked at as one thing from this many radii away.
const OUTSIDE: f64 = 1.05;

/// The lamp that a lane has drawn a sample of, and stands outside of.
pub fn lamp_of<'a>(at: &At<'a>, draw: &LightDraw, lane: usize) -> Option<&'a Lamp> {
    let lights = at.view.lights;
    let light = lights.patches[draw.patch[lane] as usize].light;
    let lamp = lights.lamps[light as usize].as_ref()?;
    let x = lane_of(at.surface.x, lane).as_dvec3();
    (x.distance(lamp.centre) > OUTSIDE * lamp.radius).then_some(lamp)
}

/// Those of some lanes from whose lamps something may hide a part, if that may move: `lamp` tells
/// what is looked at, and a vertex of it.
pub fn unclear(
    scene: &SearchScene,
    at: &At,
    lanes: u32,
    lamp: impl Fn(usize) -> Option<(Lit, u32)>,
) -> u32 {
    let is_clear = |&lane: &usize| {
        lanes >> lane & 1 == 1
            && lamp(lane).is_some_and(|(lit, vertex)| {
                // Else lines are asked first whether they meet what does.
                let moves = at.vertices.moves >> lane & 1 == 1
                    || scene.moving.vertex(scene.view.geometry, vertex);
                moves && scene.sees_all_of(at, lane, &lit)
            })
    };
    (0..LANES)
        .filter(is_clear)
        .fold(lanes, |bits, lane| bits & !(1 << lane))
}

/// The points of a line, increasing: its ends, jittered ones, and one anywhere. Without that there
/// would be shadows that are met by nothing but the line's ends.
pub fn points<F: Into<f64>>(ends: [F; 2], random: [f32; 2]) -> [f64; POINTS] {
    let [from, to] = ends.map(F::into);
    let [jitter, extra] = random.map(f64::from);
    let mut points = [from; POINTS];
    for (i, point) in points[1..=INNER_POINTS].iter_mut().enumerate() {
        *point += (to - from) * (i as f64 + jitter) / INNER_POINTS as f64;
    }
    points[POINTS - 2] += (to - from) * extra;
    points[POINTS - 1] = to;
    points.sort_by(f64::total_cmp);
    points
}

/// The chance that one of them lies in a part of the line.
pub fn chance_of_point(part: f64) -> f64 {
    chance_of_any(part * INNER_POINTS as f64, part)
}
