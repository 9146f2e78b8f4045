//! Lines over the hemisphere of a vertex that other surfaces surround.
//!
//! What lies beyond a silhouette has to be known here: the ends of cells are first hits,
//! silhouettes are walked to from both, and a path is traced on either side of each
//! (`boundary::cells::lobe::search`).

use super::line::{LaneSurface, Line, Lobe};
use super::search::{self, LinePart, Way};
use super::vertex::{FAMILIES, LobeSearch};
use crate::boundary::cells::environment::constant;
use crate::boundary::search_scene::SearchScene;
use crate::lanes::LANES;
use crate::paths::at::At;
use crate::paths::bounce::{Bounce, BounceEnd};
use crate::paths::boundary_sample::Found;
use crate::paths::dimensions::{Branch, Pair, Single};
use crate::paths::rays::lane_of;
use crate::trace::geometry::NO_TRIANGLE;

/// Reflected lobes wider than this see what a packet's bounces do not tell of.
const WIDE_RAD: f64 = 0.04;
/// So many lanes of a packet and a mesh look, where crowds are.
const IN_CROWDS: u32 = 2;

/// How often a packet's diffuse and wide lobes are searched at the first vertex, by what part of
/// that at each further one, and the least. A line costs the paths beside all that it meets, in a
/// furnished room forty borders, and what it finds has a few hundredths of the noise there
/// (`docs/method.md`, 5). What narrow lobes find has heavy tails, and is never thinned.
const CHANCE: f32 = 0.5;
const CHANCE_AT_NEXT: f32 = 0.6;
const LEAST_CHANCE: f32 = 1.0 / 16.0;

/// Finds what jumps on a line through the lobes of some lanes' vertices. One of the two families is
/// drawn for all lanes.
pub fn find(scene: &SearchScene, at: &At, (bounce, lanes): (&Bounce, u32), out: &mut Found) {
    let (view, numbers) = (scene.view, &at.numbers);
    let (jitter, _) = numbers.pair(Pair::LobeLine);
    let name = [numbers.index[0], numbers.depth, 0];
    let family = numbers.stream.single(Single::DiffuseFamily, name);
    let at_last = numbers.depth + 2 >= view.limits.max_depth;
    let mut search = LobeSearch {
        scene,
        at,
        bounce,
        lanes,
        axis: (family * FAMILIES as f32) as usize,
        jitter: jitter.to_array(),
        at_last,
        out,
    };
    let environment = view.scene.environment.as_ref();
    let is_even = environment.is_none_or(|e| e.map.is_none()) && at.vertices.kinds.special() == 0;
    // Where only an constant environment shines a line needs no more than occlusion; else every
    // line costs walks over whatever is seen, and one lane stands for all.
    if at_last && is_even {
        if environment.is_some() {
            let free = match bounce.seen {
                BounceEnd::Environment(free) => free,
                BounceEnd::Triangles(triangles) => (0..LANES)
                    .filter(|&l| triangles[l] == NO_TRIANGLE)
                    .fold(0, |b, l| b | 1 << l),
            };
            constant::find(&mut search, free);
        }
    } else {
        among_surfaces(&mut search);
    }
}

/// Lines among reflecting surfaces. A line costs many rays: mostly that of one lane stands for all.
/// But where narrow lobes of a packet see different meshes, a silhouette is near, and where they
/// are not that narrow, one may be near though they do not: all its lanes look for it. Where
/// surfaces move and directions rest, what rests brings nothing over the lobe, and one lane is
/// enough: inside of a scanned animal of rough glass all had two and a half times the variance in
/// equal time. In crowds surfaces differ in what they see and a line meets much: there two of each
/// mesh look.
fn among_surfaces(search: &mut LobeSearch) {
    let At { vertices, .. } = *search.at;
    let environment = &search.scene.view.scene.environment;
    let has_constant_environment = environment.as_ref().is_some_and(|e| e.map.is_none());
    let [mut narrow, mut others] = [0u32; 2];
    let looks = vertices.line_survival.to_array();
    let wanted = |&l: &usize| search.lanes >> l & 1 == 1 && looks[l] > 0.0;
    for lane in (0..LANES).filter(wanted) {
        match Lobe::of_lane(vertices, lane) {
            None => {}
            Some(_) if is_narrow(search, lane) => narrow |= 1 << lane,
            // What light samples find at the last vertex has lines of its own, on the lights.
            Some(_) if search.at_last && !has_constant_environment => {}
            Some(_) => others |= 1 << lane,
        }
    }
    among_narrow(search, narrow);
    // Under an even sky these lines find the shadows of what lights the scene.
    let chance = match has_constant_environment {
        true => 1.0,
        false => chance(search),
    };
    let numbers = &search.at.numbers;
    let name = [numbers.index[0], numbers.depth, 0];
    if numbers.stream.single(Single::LobeLooks, name) < chance {
        among_others(search, others, 1.0 / f64::from(chance));
    }
}

/// That of a packet's diffuse and wide lobes to be searched.
fn chance(search: &LobeSearch) -> f32 {
    let depth = search.at.numbers.depth as i32;
    let chance = search.scene.lines_over_lobes * CHANCE * CHANCE_AT_NEXT.powi(depth);
    chance.max(LEAST_CHANCE)
}

/// Lines of narrow lobes.
fn among_narrow(search: &mut LobeSearch, narrow: u32) {
    let vertices = search.at.vertices;
    let all = narrow != 0
        && narrow & vertices.rests & vertices.moves == 0
        && (is_wide(search, narrow) || sees_several(search, narrow & search.bounce.rays.active));
    if all {
        lines_of_some(search, narrow, LANES as u32, (0, 1.0));
    } else {
        line_of_one(search, narrow, (0, 1.0));
    }
}

/// Lines of diffuse and wide lobes, each of which stands for so many.
fn among_others(search: &mut LobeSearch, mut others: u32, times: f64) {
    let vertices = search.at.vertices;
    if !search.scene.lobe_drift.is_some_and(|drift| drift.has_crowd) {
        line_of_one(search, others, (1, times));
        return;
    }
    let mesh_of_triangle = &search.scene.view.geometry.mesh_of_triangle;
    let mesh = |lane: u32| mesh_of_triangle[vertices.triangle[lane as usize] as usize];
    let mut group = 1;
    while others != 0 {
        let first = others.trailing_zeros();
        let has = |&l: &u32| others >> l & 1 == 1 && mesh(l) == mesh(first);
        let lanes = (first..LANES as u32).filter(has).fold(0, |b, l| b | 1 << l);
        lines_of_some(search, lanes, IN_CROWDS, (group, times));
        others &= !lanes;
        group += 1;
    }
}

/// A line for one of these lanes, which stands for all and for so many `times` as many; `group` is
/// one of the packet's.
fn line_of_one(search: &mut LobeSearch, lanes: u32, (group, times): (u32, f64)) {
    let number = number_of_group(search, group);
    let surroundings = search.scene.surroundings();
    let drawn = surroundings.draw(search.at.surface.x, lanes, number);
    if let Some((lane, weight)) = drawn {
        line_of_lane(search, lane, weight * times);
    }
}

/// Says which lanes of one of the packet's groups look.
fn number_of_group(search: &LobeSearch, group: u32) -> f32 {
    let numbers = &search.at.numbers;
    let name = [numbers.index[0], numbers.depth, group];
    numbers.stream.single(Single::LobeLane, name)
}

/// Lines for so many of these lanes, likewise.
fn lines_of_some(search: &mut LobeSearch, lanes: u32, some: u32, (group, times): (u32, f64)) {
    let count = lanes.count_ones();
    let some = some.min(count);
    let start = f64::from(number_of_group(search, group));
    let step = f64::from(count) / f64::from(some);
    let mut chosen = (0..some).map(|i| ((start + f64::from(i)) * step) as u32);
    let mut next = chosen.next();
    let lanes = (0..LANES).filter(|&l| lanes >> l & 1 == 1);
    for (number, lane) in (0..count).zip(lanes) {
        if next.map(|n| n.min(count - 1)) == Some(number) {
            line_of_lane(search, lane, step * times);
            next = chosen.next();
        }
    }
}

/// Whether the first of these lanes reflects in a wide lobe.
fn is_wide(search: &LobeSearch, lanes: u32) -> bool {
    let lane = lanes.trailing_zeros() as usize;
    let width_rad = |lobe| LaneSurface::new(search.at, lane, lobe).main_direction().1;
    match Lobe::of_lane(search.at.vertices, lane) {
        Some(Lobe::Reflected) => width_rad(Lobe::Reflected) > WIDE_RAD,
        _ => false,
    }
}

/// Whether light samples are of no use to a lobe.
fn is_narrow(search: &LobeSearch, lane: usize) -> bool {
    search.at.vertices.shares_lights() >> lane & 1 == 0
}

/// Whether these lanes' bounces end on different meshes.
fn sees_several(search: &LobeSearch, lanes: u32) -> bool {
    match search.bounce.seen {
        BounceEnd::Environment(free) => free & lanes != 0 && free & lanes != lanes,
        BounceEnd::Triangles(triangles) => {
            let lanes = (0..LANES).filter(|&l| lanes >> l & 1 == 1);
            let mesh_of_triangle = &search.scene.view.geometry.mesh_of_triangle;
            let mesh = |triangle: u32| {
                (triangle != NO_TRIANGLE).then(|| mesh_of_triangle[triangle as usize])
            };
            let mut meshes = lanes.map(|l| mesh(triangles[l]));
            let first = meshes.next();
            meshes.any(|m| Some(m) != first)
        }
    }
}

/// A line for one lane of the packet, which stands for as many as `weight`.
fn line_of_lane(search: &mut LobeSearch, lane: usize, weight: f64) {
    let here = search.at;
    let Some(lobe) = Lobe::of_lane(here.vertices, lane) else {
        return;
    };
    let is_narrow = is_narrow(search, lane);
    let (index, depth) = (here.numbers.index[lane], here.numbers.depth);
    let number = |user, of| here.numbers.stream.single(user, [index, depth, of]) as f64;
    let choice = |cell| number(Single::LobeEdge, cell);
    let mut at = LaneSurface::new(here, lane, lobe);
    let jitter = search.jitter[lane] as f64;
    let line = if lobe == Lobe::Diffuse {
        let bounce = lane_of(search.bounce.rays.direction, lane);
        let bounce = bounce.as_dvec3().normalize();
        let is_known = matches!(search.bounce.seen, BounceEnd::Triangles(_));
        Some(Line::diffuse(&at, bounce, search.axis, jitter, is_known))
    } else {
        let family = (number(Single::LobeFamily, 0) * FAMILIES) as usize;
        Line::lobe(&at, family, number(Single::LobePlace, 0), jitter)
    };
    let Some(line) = line else { return };
    let sees_silhouettes = search.moves(lane, &line, &at);
    if !sees_silhouettes && !search.has_sharp_shadows() {
        return;
    }
    // All that looks along a line shares its random numbers: what is seen on the inner sides of a
    // thin thing's two borders cancels then, as far as it is the same.
    let way = Way {
        lane,
        weight,
        is_narrow,
        sees_silhouettes,
        index,
        stream: &here.numbers.stream.branch(Branch::LobeProbe, [depth, 0, 0]),
    };
    let geometric = lane_of(here.surface.geometric, lane).as_dvec3();
    let Some((psi, [before, beyond])) = line.cut(geometric) else {
        let part = LinePart {
            line: &line,
            choice: &choice,
        };
        search::on_part(search, &mut at, &way, &part);
        return;
    };
    let cells = before.psi.len() as u32 - 1;
    let parts = [
        LinePart {
            line: &before,
            choice: &choice,
        },
        LinePart {
            line: &beyond,
            choice: &|cell| choice(cells + cell),
        },
    ];
    for part in &parts {
        search::on_part(search, &mut at, &way, part);
    }
    if sees_silhouettes {
        search::on_own_plane(search, &mut at, &way, [&before, &beyond], psi);
    }
}
