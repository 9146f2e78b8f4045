//! Pictures and environment maps at a point: values against brute force, slopes against finite
//! differences.
//!
//! Lookups are in single precision, and linear between texels in u and in v: differences within a
//! cell have no error but rounding.

use common::shapes::Random;
use glam::{Affine2, EulerRot, Mat3, Vec2, Vec3, vec2};
use warpath::paths::environment::map as environment;
use warpath::paths::surface::texture;
use warpath::scene::{EnvironmentMap, Layout, Texture, Wrap};

const WIDTH: u32 = 5;
const HEIGHT: u32 = 4;
const POINTS: usize = 2000;
/// A hundredth of a texel.
const STEP: f32 = 0.002;
/// Coordinates of size 4 are rounded by some 3e-7, a step's hundredth of a percent; slopes are up
/// to 10.
const ROUNDING: f32 = 1e-2;

fn picture(wrap: Wrap, bilinear: bool, to_uv: Affine2) -> Texture {
    let mut random = Random::new(3);
    Texture {
        texels: (0..WIDTH * HEIGHT)
            .map(|_| (random.cube() + 1.0).to_array())
            .collect(),
        layout: Layout::Bitmap {
            width: WIDTH,
            height: HEIGHT,
            wrap,
            bilinear,
            to_uv,
        },
        ..Texture::constant("picture".into(), [0.0; 3])
    }
}

fn transform() -> Affine2 {
    Affine2::from_scale_angle_translation(vec2(0.7, 1.3), 0.4, vec2(0.2, -0.3))
}

/// Texel `at` of a row that is repeated, held or reflected by walking there step by step.
fn walked(at: i64, size: i64, wrap: Wrap) -> i64 {
    let (mut place, mut forward) = (0, true);
    for _ in 0..at.abs() {
        let goes_up = forward == (at > 0);
        let next = if goes_up { place + 1 } else { place - 1 };
        let is_outside = !(0..size).contains(&next);
        match wrap {
            _ if !is_outside => place = next,
            Wrap::Repeat => place = if goes_up { 0 } else { size - 1 },
            Wrap::Clamp => {}
            // The edge texel comes twice.
            Wrap::Mirror => forward = !forward,
        }
    }
    place
}

/// A hat function over every texel of the plane near the point.
fn by_hats(texture: &Texture, wrap: Wrap, place: Vec2) -> Vec3 {
    let at = place.as_dvec2() * glam::dvec2(WIDTH.into(), HEIGHT.into()) - 0.5;
    let mut sum = glam::DVec3::ZERO;
    for y in -30..30i64 {
        for x in -30..30i64 {
            let hat = |d: f64| (1.0 - d.abs()).max(0.0);
            let weight = hat(at.x - x as f64) * hat(at.y - y as f64);
            if weight > 0.0 {
                let [x, y] = [
                    walked(x, WIDTH.into(), wrap),
                    walked(y, HEIGHT.into(), wrap),
                ];
                let texel = texture.texels[(y * i64::from(WIDTH) + x) as usize];
                sum += Vec3::from(texel).as_dvec3() * weight;
            }
        }
    }
    sum.as_vec3()
}

fn points() -> impl Iterator<Item = Vec2> {
    let mut random = Random::new(9);
    (0..POINTS).map(move |_| random.cube().truncate() * 2.0)
}

const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror];

#[test]
fn values_are_those_of_hat_functions() {
    for wrap in WRAPS {
        let of = |bilinear| picture(wrap, bilinear, transform());
        let (smooth, nearest) = (of(true), of(false));
        for uv in points() {
            let place = transform().transform_point2(uv);
            let found = texture::lookup(&smooth, uv);
            let wanted = by_hats(&smooth, wrap, place);
            assert!(found.value.distance(wanted) < 2e-5, "{wrap:?} at {uv}");
            assert!(
                found.mix(&smooth.texels).distance(wanted) < 2e-5,
                "{wrap:?} at {uv}"
            );

            let [x, y] =
                [place.x * WIDTH as f32, place.y * HEIGHT as f32].map(|x| x.floor() as i64);
            let [x, y] = [
                walked(x, WIDTH.into(), wrap),
                walked(y, HEIGHT.into(), wrap),
            ];
            let texel = nearest.texels[(y * i64::from(WIDTH) + x) as usize];
            let found = texture::lookup(&nearest, uv);
            assert_eq!(found.value, Vec3::from(texel), "{wrap:?} at {uv}");
            assert_eq!(found.by_uv, [Vec3::ZERO; 2]);
        }
    }
}

/// Whether both points lie in one cell between texels' centres.
fn in_one_cell(a: Vec2, b: Vec2) -> bool {
    let cell = |p: Vec2| (p * vec2(WIDTH as f32, HEIGHT as f32) - 0.5).floor();
    cell(a) == cell(b)
}

#[test]
fn slopes_are_those_of_differences() {
    for wrap in WRAPS {
        let texture = picture(wrap, true, transform());
        let place = |uv| transform().transform_point2(uv);
        let mut compared = 0;
        for uv in points() {
            let found = texture::lookup(&texture, uv);
            let compare =
                |what: &str, slope: Vec3, ends: [(Vec2, Affine2); 2], step: f32| -> usize {
                    let [a, b] = ends.map(|(uv, to_uv)| to_uv.transform_point2(uv));
                    if !in_one_cell(a, b) {
                        return 0;
                    }
                    let [a, b] = ends
                        .map(|(uv, to_uv)| texture::lookup(&picture(wrap, true, to_uv), uv).value);
                    let by_difference = (b - a) / (2.0 * step);
                    assert!(
                        slope.distance(by_difference) < ROUNDING,
                        "{wrap:?}, {what} at {uv} (place {}): {slope} against {by_difference}",
                        place(uv)
                    );
                    1
                };
            for axis in 0..2 {
                let along = [Vec2::X, Vec2::Y][axis] * STEP;
                let ends = [-along, along].map(|along| (uv + along, transform()));
                compared += compare("by uv", found.by_uv[axis], ends, STEP);
                let ends = [-along, along]
                    .map(|along| (uv, Affine2::from_translation(along) * transform()));
                compared += compare("by place", found.by_place[axis], ends, STEP);
            }
            // The transform itself, row by row, in any direction.
            let rows = [0.3, -0.2, 0.5, 0.4, 0.1, -0.6].map(|x: f32| 0.5 * x);
            let [m, t] = [
                [rows[0], rows[3], rows[1], rows[4]],
                [rows[2], rows[5], 0.0, 0.0],
            ];
            let moved = |by: f32| {
                let mut to_uv = transform();
                to_uv.matrix2 += glam::Mat2::from_cols_array(&m) * by;
                to_uv.translation += vec2(t[0], t[1]) * by;
                to_uv
            };
            let ends = [-STEP, STEP].map(|by| (uv, moved(by)));
            compared += compare("by to_uv", found.moved(&rows), ends, STEP);
            let bar = Vec3::new(0.3, -0.5, 0.7);
            let product: f32 = found
                .to_uv_bar(bar)
                .iter()
                .zip(rows)
                .map(|(a, b)| a * b)
                .sum();
            assert!((product - found.moved(&rows).dot(bar)).abs() < 1e-3);
        }
        assert!(compared > 4 * POINTS, "{wrap:?}: {compared} compared");
    }
}

#[test]
fn checkerboards_have_the_first_colour_in_equal_halves() {
    let texture = Texture {
        texels: vec![[0.4; 3], [0.2; 3]],
        layout: Layout::Checkerboard { to_uv: transform() },
        ..Texture::constant("board".into(), [0.0; 3])
    };
    for uv in points() {
        let at = transform().transform_point2(uv);
        // Cells of half a unit, counted.
        let cells = (at.x * 2.0).floor() + (at.y * 2.0).floor();
        let wanted = if cells.rem_euclid(2.0) == 0.0 {
            0.4
        } else {
            0.2
        };
        assert_eq!(texture::lookup(&texture, uv).value.x, wanted, "{at}");
    }
}

const SKY: [u32; 2] = [9, 6];

fn sky() -> (Texture, EnvironmentMap) {
    let mut random = Random::new(4);
    let [width, height] = SKY;
    let texture = Texture {
        texels: (0..width * height)
            .map(|_| (random.cube() + 1.0).to_array())
            .collect(),
        layout: Layout::Bitmap {
            width,
            height,
            wrap: Wrap::Repeat,
            bilinear: true,
            to_uv: Affine2::IDENTITY,
        },
        ..Texture::constant("sky".into(), [0.0; 3])
    };
    let map = EnvironmentMap {
        to_world: Mat3::from_euler(EulerRot::XYZ, 0.3, 0.5, -0.8),
        scale: 1.7,
    };
    (texture, map)
}

/// u and v as the conventions have them, in texels: columns have their centres at ½, rows at 0 and
/// the last.
fn place_on_sky(map: &EnvironmentMap, d: Vec3) -> [f64; 2] {
    let d = (map.to_world.as_dmat3().transpose() * d.as_dvec3()).normalize();
    let u = d.x.atan2(-d.z) / std::f64::consts::TAU;
    let v = d.y.acos() / std::f64::consts::PI;
    let [width, height] = SKY.map(f64::from);
    [u.rem_euclid(1.0) * width - 0.5, v * (height - 1.0)]
}

#[test]
fn environment_maps_have_values_and_slopes() {
    let (texture, map) = sky();
    let mut random = Random::new(5);
    let mut compared = 0;
    for _ in 0..POINTS {
        let d = random.direction() * (0.5 + random.unit());
        let found = environment::lookup(&texture, &map, d);
        let [x, y] = place_on_sky(&map, d);
        let texel = |x: f64, y: f64| {
            let column = x.rem_euclid(SKY[0].into()) as usize;
            Vec3::from(texture.texels[y as usize * SKY[0] as usize + column]).as_dvec3()
        };
        let (low, part) = ([x.floor(), y.floor()], [x - x.floor(), y - y.floor()]);
        let row = |y: f64| texel(low[0], y) * (1.0 - part[0]) + texel(low[0] + 1.0, y) * part[0];
        let value = (row(low[1]) * (1.0 - part[1]) + row(low[1] + 1.0) * part[1]) * 1.7;
        assert!(
            found.value.as_dvec3().distance(value) < 2e-4,
            "{d}: {} against {value}",
            found.value
        );
        let mixed: Vec3 = (0..4)
            .map(|k| Vec3::from(texture.texels[found.texels[k] as usize]) * found.weights[k])
            .sum();
        assert!(mixed.distance(found.value) < 1e-5);

        let side = random.cube();
        let ends = [-STEP, STEP].map(|by| d + side * by);
        // Near a pole longitudes turn by much within a step.
        let is_steep = (map.to_world.transpose() * d.normalize()).y.abs() > 0.95;
        let cells = ends.map(|d| place_on_sky(&map, d).map(f64::floor));
        if is_steep || cells[0] != cells[1] {
            continue;
        }
        compared += 1;
        let [a, b] = ends.map(|d| environment::lookup(&texture, &map, d).value);
        let difference = (b - a) / (2.0 * STEP);
        let [by_u, by_v] = found.by_direction.map(|g| g.dot(side));
        let slope = found.by_uv[0] * by_u + found.by_uv[1] * by_v;
        // Curvature of u and v leaves some step² times their third derivatives.
        let allowed = 4.0 * ROUNDING;
        assert!(
            slope.distance(difference) < allowed,
            "{d} along {side}: {slope} against {difference}"
        );
    }
    assert!(compared > POINTS * 3 / 4, "{compared} compared");
}
