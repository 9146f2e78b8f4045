//! Lines on which silhouettes are looked for: how they lie, and how often their points fall between
//! two angles.

use super::*;
use common::materials::Paint;
use common::optics::*;
use common::statistics::Estimate;
use common::swatch::{Swatch, bare};
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, PI};
use warpath::boundary::cells::lobe::line::{LaneSurface, Line, Lobe};
use warpath::lanes::Lane;
use warpath::paths::rays::lane_of;
use warpath::paths::surface::lobe_sample::cosine_direction;
use warpath::scene::Distribution::Ggx;

/// Counts how often a point of lines, their two ends apart, falls between two angles, against the
/// chances they tell.
struct Run {
    ends: [f64; 2],
    /// Their sum.
    chances: f64,
    counts: [usize; 2],
}

impl Run {
    fn new(ends: [f64; 2]) -> Self {
        Self {
            ends,
            chances: 0.0,
            counts: [0; 2],
        }
    }

    fn look_at(&mut self, line: &Line) {
        let (psi, [from, to]) = (&line.psi, self.ends);
        if psi[0] > from || psi[psi.len() - 1] < to {
            return;
        }
        let intervals = line.intervals(&self.ends);
        let met = (intervals.places[1] - intervals.places[0]).min(1.0);
        self.chances += 1.0 - (1.0 - met) * (1.0 - intervals.extra[1]);
        let inner = &psi[1..psi.len() - 1];
        self.counts[inner.iter().any(|p| (from..to).contains(p)) as usize] += 1;
    }

    fn check(&self, what: &str) {
        let what = format!("{what}, points in {:?}", self.ends);
        let lines = self.counts.iter().sum::<usize>();
        assert!(lines > SAMPLES / 2, "{what}");
        let chance = self.chances / lines as f64;
        if chance >= 1.0 {
            return assert_eq!(self.counts[0], 0, "{what}");
        }
        expect_shares(&what, &self.counts, &[1.0 - chance, chance]);
    }
}

fn diffuse_bounces() -> impl Iterator<Item = (DVec3, f64)> {
    let jitters = pairs(53, 4, 4).map(|[jitter, _]| f64::from(jitter));
    let bounces = pairs(53, 3, 4).map(|[u, v]| {
        let local = cosine_direction(Lane::splat(u), Lane::splat(v));
        lane_of(local, 0).as_dvec3().normalize()
    });
    bounces.zip(jitters)
}

/// φ of lines through diffuse bounces is as their density says, and their points are met as often.
#[test]
fn lines_of_diffuse_light() {
    let swatch = Swatch::new(bare(), false);
    let view = swatch.view();
    let (vertices, surface) = swatch.seen(&view, &[incidence(30.0)]);
    let stream = Stream::new(0, [0, 0]);
    let here = Swatch::at(&view, &vertices, &surface, &stream);
    let at = LaneSurface::new(&here, 0, Lobe::Diffuse);
    for axis in 0..2 {
        let line = |bounce, jitter, on| {
            [axis, 1 - axis].map(|axis| Line::diffuse(&at, bounce, axis, jitter, on))
        };
        let mut turns = vec![0; 32];
        let mut shares = vec![0.0; 32];
        let mut runs = [[-1.5, -1.3], [-0.2, 0.2], [0.3, 1.0], [0.2, 1.4]].map(Run::new);
        let mut runs_without = [[-0.1, 0.3]].map(Run::new);
        for (bounce, jitter) in diffuse_bounces() {
            let [line, other] = line(bounce, jitter, true);
            let number = line.bounce.expect("the bounce is on its line");
            assert!(line.direction(line.psi[number]).distance(bounce) < 1e-6);
            assert!((line.psi_of(bounce) - line.psi[number]).abs() < 1e-6);
            assert!(line.psi.is_sorted());
            let (middle, across) = (line.direction(0.0), other.direction(FRAC_PI_2));
            let mut poles = [line.direction(FRAC_PI_2), across];
            poles.rotate_right(axis);
            let turn = middle.z.atan2(middle.dot(across));
            let place = bin((turn / PI) as f32, 32);
            turns[place] += 1;
            // p is a sine: its integral over a bin from its value anywhere in it.
            let [a, b] = [place, place + 1].map(|k| PI * k as f64 / 32.0);
            shares[place] = (a.cos() - b.cos()) / turn.sin() / line.inverse_density;
            runs.iter_mut().for_each(|run| run.look_at(&line));
            let without = Line::diffuse(&at, bounce, axis, jitter, false);
            runs_without
                .iter_mut()
                .for_each(|run| run.look_at(&without));
        }
        let what = format!("diffuse lines about pole {axis}");
        expect_shares(&what, &turns, &shares);
        runs.iter().for_each(|run| run.check(&what));
        runs_without
            .iter()
            .for_each(|run| run.check(&format!("{what} without bounce")));
    }
}

/// Lines of narrow lobes turn with the number that draws them as their density says, their points
/// are met as often, and none lies below the horizon.
#[test]
fn lines_of_narrow_lobes() {
    let metal = || bare().metal("floor", 0.1, Ggx);
    let glass = || bare().glass("floor", 0.1);
    let cases = [
        ("metal", Swatch::new(metal(), false), Lobe::Reflected, 1.0),
        ("glass", Swatch::new(glass(), false), Lobe::Refracted, 1.5),
        (
            "glass from inside",
            Swatch::new(glass(), true),
            Lobe::Refracted,
            1.0 / 1.5,
        ),
    ];
    for (what, swatch, lobe, ratio) in cases {
        let view = swatch.view();
        let i = incidence(30.0);
        let main = match lobe {
            Lobe::Refracted => refract(i, DVec3::Z, ratio).expect("below the critical angle"),
            _ => reflect(i, DVec3::Z),
        };
        let main = swatch.turned(main);
        let (vertices, surface) = swatch.seen(&view, &[i]);
        let stream = Stream::new(0, [0, 0]);
        let here = Swatch::at(&view, &vertices, &surface, &stream);
        let at = LaneSurface::new(&here, 0, lobe);
        for axis in 0..2 {
            let centre = [0, 1].map(|axis| Line::lobe(&at, axis, 0.5, 0.5).expect("a line"));
            let poles = centre.each_ref().map(|l| l.direction(FRAC_PI_2));
            assert!(poles[0].dot(poles[1]).abs() < 1e-6);
            assert!(centre[axis].direction(0.0).distance(main) < 1e-6, "{what}");
            let turn = |line: &Line| {
                let middle = line.direction(0.0);
                middle.dot(poles[1 - axis]).atan2(middle.dot(main))
            };
            let mut runs = [[-0.1, 0.02], [0.05, 0.3], [-0.6, -0.25]].map(Run::new);
            for [place, jitter] in pairs(59, 1, 6) {
                let [place, jitter] = [place, jitter].map(f64::from);
                let Some(line) = Line::lobe(&at, axis, place, jitter) else {
                    continue;
                };
                assert!(line.psi.is_sorted());
                let below = line.psi.iter().map(|psi| line.direction(*psi));
                let side = main.dot(at.n).signum();
                assert!(below.map(|d| d.dot(at.n) * side).all(|cos| cos > -1e-6));
                runs.iter_mut().for_each(|run| run.look_at(&line));
            }
            for place in [0.01, 0.1, 0.3, 0.5, 0.75, 0.95, 0.99] {
                let at = |place: f64| Line::lobe(&at, axis, place, 0.5).expect("a line");
                let slope = (turn(&at(place + 1e-6)) - turn(&at(place - 1e-6))) / 2e-6;
                let told = at(place).inverse_density;
                assert!(
                    (slope / told - 1.0).abs() < 1e-4,
                    "{what}, pole {axis}, {place}: {slope} against {told}"
                );
            }
            for run in &runs {
                run.check(&format!("lines of {what} about pole {axis}"));
            }
        }
    }
}

/// Far off the middle of a lobe of GGX's shape, along and across lines and on both at once, as much
/// light goes where points lie as in its middle, and not many times as much.
#[test]
fn points_lie_as_light_does() {
    /// A lobe is not quite (1 + φ² + ψ²)⁻²; off both axes it would be 7 times as much if points lay
    /// alike on all lines.
    const MOST: f64 = 2.0;
    let swatch = Swatch::new(bare().metal("floor", 0.02, Ggx), false);
    let view = swatch.view();
    let (vertices, surface) = swatch.seen(&view, &[incidence(30.0)]);
    let stream = Stream::new(0, [0, 0]);
    let here = Swatch::at(&view, &vertices, &surface, &stream);
    let mut at = LaneSurface::new(&here, 0, Lobe::Reflected);
    // Of a number in units of the lobe's width the place that it is drawn by.
    let place = |x: f64| 0.5 * (1.0 + x / x.hypot(1.0));
    for axis in 0..2 {
        let middle = Line::lobe(&at, axis, 0.5, 0.5).expect("a line");
        let width = middle.at_place(middle.place(0.0) + 1.0);
        // The second of four points lies a quarter of them from the middle: at x with place 3/4.
        let width = width * 3f64.sqrt();
        let mut light_over_points = |x: f64, y: f64| {
            let line = Line::lobe(&at, axis, place(x), 0.5).expect("a line");
            let psi = y * width;
            let points = (line.place(psi + 1e-6) - line.place(psi - 1e-6)) / 2e-6;
            let (_, weight, density) = at.value(line.direction(psi)).expect("above the horizon");
            weight.x * density * psi.cos() * line.inverse_density / points
        };
        let of_middle = light_over_points(0.0, 0.0);
        for x in [-5.0, 0.0, 5.0] {
            for y in [-5.0, 0.0, 5.0] {
                let of_place = light_over_points(x, y) / of_middle;
                assert!(of_place < MOST, "pole {axis}, ({x}, {y}): {of_place}");
            }
        }
    }
}

/// What lines carry, integrated over them, is what bounces carry.
#[test]
fn lines_of_narrow_lobes_carry_what_bounces_do() {
    const PLACES: usize = 800;
    const STEPS: usize = 1000;
    const STREAMS: u32 = 32;
    const POINTS: u32 = 1 << 12;
    /// Student's t with 31 degrees of freedom: once in 10⁴ times.
    const SIGMAS: f64 = 4.5;
    /// What the quadrature leaves.
    const QUADRATURE: f64 = 5e-4;
    let metal = Swatch::new(bare().metal("floor", 0.1, Ggx), false);
    let glass = Swatch::new(bare().glass("floor", 0.1), false);
    let cases = [
        ("metal", metal, Lobe::Reflected),
        ("glass", glass, Lobe::Refracted),
    ];
    for (what, swatch, lobe) in cases {
        let view = swatch.view();
        let toward = incidence(50.0);
        let mut carried = [0.0; STREAMS as usize];
        swatch.bounces(&[toward], STREAMS, POINTS, |stream, _, bounce| {
            let of_lobe = match lobe {
                Lobe::Reflected => bounce.lobes.reflected,
                _ => bounce.lobes.refracted,
            };
            carried[stream] += f64::from(bounce.weight[0]) * f64::from(of_lobe) / f64::from(POINTS);
        });
        let carried = Estimate::mean(&carried);
        let (vertices, surface) = swatch.seen(&view, &[toward]);
        let stream = Stream::new(0, [0, 0]);
        let here = Swatch::at(&view, &vertices, &surface, &stream);
        let mut at = LaneSurface::new(&here, 0, lobe);
        let middle = |k: usize, count: usize| (k as f64 + 0.5) / count as f64;
        for axis in 0..2 {
            let other = Line::lobe(&at, 1 - axis, 0.5, 0.5).expect("a line");
            let mut sum = 0.0;
            for k in 0..PLACES {
                // Finer near both ends: the place is (1 + tanh u)/2.
                let u = 14.0 * (middle(k, PLACES) - 0.5);
                let share = 7.0 / PLACES as f64 / (u.cosh() * u.cosh());
                let place = 0.5 * (1.0 + u.tanh());
                let Some(line) = Line::lobe(&at, axis, place, 0.5) else {
                    continue;
                };
                let mut poles = [&line, &other].map(|l| l.direction(FRAC_PI_2));
                poles.rotate_right(axis);
                let inverse_density = line.inverse_density;
                let [low, high] = [line.psi[0], line.psi[line.psi.len() - 1]];
                // Finer in the middle of the lobe: ψ = 0.1 sinh t.
                let [from, to] = [low, high].map(|psi| (psi / 0.1).asinh());
                for i in 0..STEPS {
                    let t = from + (to - from) * middle(i, STEPS);
                    let psi = 0.1 * t.sinh();
                    let step = 0.1 * t.cosh() * (to - from) / STEPS as f64;
                    if let Some((_, weight, density)) = at.value(line.direction(psi)) {
                        let value = weight * density;
                        sum += value.x * psi.cos() * step * inverse_density * share;
                    }
                }
            }
            let allowed = SIGMAS * carried.error + QUADRATURE * carried.value;
            assert!(
                (sum - carried.value).abs() < allowed,
                "{what} about pole {axis}: {sum}, bounces {carried:?}"
            );
        }
    }
}
