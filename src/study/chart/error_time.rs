//! Error against time, both logarithmic: a curve a method, with its slope, and the front that
//! nothing beats.

use super::axis::{LogAxis, label};
use super::colour;
use super::svg::{Anchor, Svg};
use crate::statistics::tradeoff::{exponent, pareto_front};
use crate::study::cell::Row;
use crate::study::peers::Peer;
use crate::study::verdict::Kind;

const WIDTH: f64 = 520.0;
const PLOT: [f64; 4] = [62.0, 30.0, 500.0, 290.0];
const LINE: f64 = 17.0;
const GREY: &str = "#8a8a8a";

struct Point {
    seconds: f64,
    error: f64,
    is_right: bool,
}

/// A method with its points, by samples.
struct Curve {
    name: String,
    points: Vec<Point>,
    /// What stands behind its name instead of a slope.
    remark: Option<String>,
}

/// The chart of a direction. `label` says where the other programs' points are from.
pub fn svg(row: &Row, peers: &[&Peer], peers_label: &str) -> String {
    let curves = curves(row);
    let others = of_peers(peers);
    let points = || curves.iter().chain(&others).flat_map(|curve| &curve.points);
    let [left, top, right, bottom] = PLOT;
    let x = LogAxis::around(points().map(|p| p.seconds), left, right);
    let noise = Some(row.reference.noise).filter(|noise| *noise > 0.0);
    let y = LogAxis::around(points().map(|p| p.error), bottom, top);
    let lines = curves.len() + others.len() + usize::from(!others.is_empty()) + 1;
    let mut svg = Svg::new(WIDTH, bottom + 52.0 + LINE * lines as f64);
    let title = format!("{} {}", row.scene, row.direction);
    svg.text([left, 19.0], Anchor::Start, 14.0, "#111", &title);
    frame(&mut svg, &x, &y, row.reference.rms.is_some());
    let place = |p: &Point| [x.at(p.seconds), y.at(p.error)];
    if let Some(level) = noise
        .map(|n| y.at(n))
        .filter(|level| (top..=bottom).contains(level))
    {
        svg.line([left, level], [right, level], GREY, "2 4");
        let what = "standard error of the reference";
        svg.text([right - 4.0, level - 4.0], Anchor::End, 10.0, GREY, what);
    }
    draw_front(&mut svg, &curves, &place);
    for (at, curve) in others.iter().enumerate() {
        for [x, y] in curve.points.iter().map(place) {
            svg.diamond([x, y], "#666");
            svg.text([x + 6.0, y + 4.0], Anchor::Start, 10.0, "#666", &letter(at));
        }
    }
    for (at, curve) in curves.iter().enumerate() {
        let places: Vec<[f64; 2]> = curve.points.iter().map(place).collect();
        svg.path(&places, colour(at), 1.8, "");
        for (point, place) in curve.points.iter().zip(places) {
            svg.dot(place, 4.0, colour(at), point.is_right);
        }
    }
    legend(&mut svg, &curves, &others, peers_label);
    svg.finish(&format!("Error against time of {title}"))
}

fn curves(row: &Row) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    for cell in &row.cells {
        let at = match curves.iter().position(|curve| curve.name == cell.method) {
            Some(at) => at,
            None => {
                curves.push(Curve {
                    name: cell.method.clone(),
                    points: Vec::new(),
                    remark: None,
                });
                curves.len() - 1
            }
        };
        match (&cell.figures, &cell.times) {
            (Some(figures), Some(times)) if figures.rmse > 0.0 => curves[at].points.push(Point {
                seconds: times.processor_seconds,
                error: figures.rmse,
                is_right: cell.verdict.kind == Kind::Right,
            }),
            (Some(_), _) => curves[at].remark = Some("no error to be seen".into()),
            _ => curves[at].remark = Some("refuses".into()),
        }
    }
    curves
}

fn of_peers(peers: &[&Peer]) -> Vec<Curve> {
    let mut curves: Vec<Curve> = Vec::new();
    for peer in peers {
        let point = Point {
            seconds: peer.cpu,
            error: peer.rel_rmse,
            is_right: true,
        };
        match curves
            .iter_mut()
            .find(|curve| curve.name == peer.integrator)
        {
            Some(curve) => curve.points.push(point),
            None => curves.push(Curve {
                name: peer.integrator.clone(),
                points: vec![point],
                remark: None,
            }),
        }
    }
    curves
}

fn frame(svg: &mut Svg, x: &LogAxis, y: &LogAxis, is_relative: bool) {
    let [left, top, right, bottom] = PLOT;
    for mark in x.marks() {
        svg.line([x.at(mark), top], [x.at(mark), bottom], "#e4e4e4", "");
        svg.text(
            [x.at(mark), bottom + 14.0],
            Anchor::Middle,
            11.0,
            "#444",
            &label(mark),
        );
    }
    for mark in y.marks() {
        svg.line([left, y.at(mark)], [right, y.at(mark)], "#e4e4e4", "");
        svg.text(
            [left - 6.0, y.at(mark) + 4.0],
            Anchor::End,
            11.0,
            "#444",
            &label(mark),
        );
    }
    svg.line([left, bottom], [right, bottom], "#444", "");
    svg.line([left, top], [left, bottom], "#444", "");
    let middle = [(left + right) / 2.0, (top + bottom) / 2.0];
    let time = "processor seconds of a gradient";
    svg.text(
        [middle[0], bottom + 30.0],
        Anchor::Middle,
        12.0,
        "#444",
        time,
    );
    let error = match is_relative {
        true => "root mean square error / that of the gradient",
        false => "root mean square error",
    };
    svg.text_upwards([16.0, middle[1]], 12.0, error);
}

/// Tells other programs' diamonds apart.
fn letter(at: usize) -> String {
    char::from(b'a' + (at % 26) as u8).to_string()
}

/// The points that none beats both in time and in error.
fn draw_front(svg: &mut Svg, curves: &[Curve], place: &dyn Fn(&Point) -> [f64; 2]) {
    let points: Vec<&Point> = curves.iter().flat_map(|curve| &curve.points).collect();
    let pairs: Vec<(f64, f64)> = points.iter().map(|p| (p.seconds, p.error)).collect();
    let on_front = pareto_front(&pairs);
    let chosen = points.iter().zip(on_front).filter(|(_, on)| *on);
    let mut front: Vec<&Point> = chosen.map(|(point, _)| *point).collect();
    front.sort_by(|a, b| a.seconds.total_cmp(&b.seconds));
    let places: Vec<[f64; 2]> = front.into_iter().map(place).collect();
    svg.path(&places, "#ffd54d", 8.0, "");
    for place in places {
        svg.dot(place, 7.0, "#ffd54d", true);
    }
}

fn legend(svg: &mut Svg, curves: &[Curve], others: &[Curve], peers_label: &str) {
    let [left, _, _, bottom] = PLOT;
    let mut y = bottom + 52.0;
    let mut entry = |svg: &mut Svg, text: &str, mark: &dyn Fn(&mut Svg, [f64; 2])| {
        mark(svg, [left + 6.0, y - 4.0]);
        svg.text([left + 20.0, y], Anchor::Start, 11.5, "#222", text);
        y += LINE;
    };
    for (at, curve) in curves.iter().enumerate() {
        let logs: Vec<(f64, f64)> = curve.points.iter().map(|p| (p.seconds, p.error)).collect();
        let slope = exponent(&logs).map(|slope| format!("slope {slope:.2}"));
        let is_right = curve.points.iter().all(|p| p.is_right);
        let doubt = if is_right {
            ""
        } else {
            " (hollow: not found right)"
        };
        let rest = curve.remark.clone().or(slope).unwrap_or_default();
        let text = format!("{}  {rest}{doubt}", curve.name);
        entry(svg, &text, &|svg, at_| {
            svg.dot(at_, 4.0, colour(at), is_right)
        });
    }
    entry(svg, "what nothing here beats", &|svg, at| {
        svg.dot(at, 6.0, "#ffd54d", true)
    });
    for (at, curve) in others.iter().enumerate() {
        let text = format!("{}  {}", letter(at), curve.name);
        entry(svg, &text, &|svg, at| svg.diamond(at, "#666"));
    }
    if !others.is_empty() {
        entry(svg, &format!("diamonds: {peers_label}"), &|_, _| {});
    }
}
