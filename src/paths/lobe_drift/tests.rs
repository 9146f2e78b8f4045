use super::*;

fn body(centre: impl Into<DVec3>, radius: f64, is_ball: bool) -> Body {
    let centre = centre.into();
    let corners = [DVec3::X, DVec3::Y, DVec3::Z, DVec3::NEG_ONE.normalize()];
    let at = |v: u32| centre + corners[v as usize] * radius;
    Body::new((0..4).collect(), at, (centre, radius), [true, is_ball]).unwrap()
}

fn drift_of(bodies: Vec<Body>) -> LobeDrift {
    LobeDrift::new([bodies, Vec::new()], false, Vec::new()).unwrap()
}

/// Low over the origin's left, and half hidden by a ball.
fn wall() -> Body {
    let centre = DVec3::new(0.5, 0.1, 0.3);
    let arms = [DVec3::X, DVec3::Z, DVec3::NEG_X, DVec3::NEG_Z];
    let at = |v: u32| centre + arms[v as usize] * 1.5;
    let body = Body::new((0..4).collect(), at, (centre, 1.5), [true, false]);
    body.unwrap().as_wall(DVec3::Y)
}

fn wall_and_ball() -> LobeDrift {
    let ball = body([1.3, 0.25, 0.5], 0.3, true);
    LobeDrift::new([vec![ball], vec![wall()]], false, Vec::new()).unwrap()
}

/// Two balls that overlap as seen from the origin.
fn two_balls() -> LobeDrift {
    drift_of(vec![
        body([0.9, 0.2, 1.1], 0.5, true),
        body([1.6, -0.3, 1.0], 0.7, true),
    ])
}

/// A body around the origin, one beside it, and a ball.
fn bodies() -> LobeDrift {
    drift_of(vec![
        body([0.2, 0.1, -0.3], 2.0, false),
        body([1.6, -0.3, 1.0], 0.7, false),
        body([0.9, 0.2, 1.1], 0.5, true),
    ])
}

const N: DVec3 = DVec3::Z;
/// Balls do not turn.
fn motion(drift: &LobeDrift, body: usize) -> BodyMotion {
    let turns = if drift.bodies[body].is_ball() {
        0.0
    } else {
        1.0
    };
    let velocities = [[0.3, -1.0, 0.4], [-0.7, 0.2, 0.9], [0.1, 0.8, -0.5]];
    BodyMotion {
        velocity: velocities[body].into(),
        rotation: DVec3::new(0.4, 0.7, -0.3) * turns,
    }
}

const OF_X: DVec3 = DVec3::new(0.5, 0.1, -0.3);
const TURN: DVec3 = DVec3::new(0.2, -0.4, 0.6);

/// Directions in, between and around the balls.
fn directions() -> impl Iterator<Item = DVec3> {
    let at = |i: u32| {
        let (height, angle) = (
            0.04 + 0.9 * f64::from(i) / 60.0,
            0.8 * (f64::from(i) + 0.1).sin(),
        );
        let radius = (1.0 - height * height).sqrt();
        DVec3::new(radius * angle.cos(), radius * angle.sin(), height)
    };
    (0..60).map(at)
}

/// Over surfaces where they rest, and over others.
fn cases() -> impl Iterator<Item = (LobeDrift, DVec3, bool)> {
    let drifts = [two_balls(), bodies(), wall_and_ball()].into_iter();
    let turned = |drift: LobeDrift| [(drift.clone(), false), (drift, true)];
    drifts
        .flat_map(turned)
        .flat_map(|(drift, rests)| directions().map(move |d| (drift.clone(), d, rests)))
}

fn velocity(drift: &LobeDrift, d: DVec3, rests: bool) -> Option<(DVec3, f64)> {
    let field = drift.field([DVec3::ZERO, N, d], true, rests)?;
    Some(field.velocity(|body| motion(drift, body), OF_X, TURN.cross(d)))
}

/// The change of the weight is the divergence of the field times the cosine, over the cosine.
#[test]
fn weights_change_by_the_divergence() {
    let mut tried = 0;
    for (drift, d, rests) in cases() {
        let Some((_, change)) = velocity(&drift, d, rests) else {
            continue;
        };
        let s = d.any_orthonormal_vector();
        let axes = [s, d.cross(s)];
        let h = 1e-6;
        let along = |axis: DVec3, step: f64| {
            let moved = (d + axis * step).normalize();
            // On the sphere a neighbour's axis leans by what the direction does.
            let axis = (axis - moved * moved.dot(axis)).normalize();
            velocity(&drift, moved, rests).map_or(0.0, |(v, _)| v.dot(axis) * moved.dot(N))
        };
        let slope = |axis| (along(axis, h) - along(axis, -h)) / (2.0 * h);
        let expected: f64 = axes.map(slope).iter().sum::<f64>() / d.dot(N);
        let error = (change - expected).abs();
        assert!(
            error < 1e-6 * (1.0 + expected.abs()),
            "{d}: {change} {expected}"
        );
        tried += 1;
    }
    assert!(tried > 200, "{tried}");
}

#[test]
fn the_adjoint_is_the_transpose() {
    let (velocity_bar, change_bar) = (DVec3::new(0.3, 0.9, -0.5), 0.7);
    let mut tried = 0;
    for (drift, d, rests) in cases() {
        let Some(field) = drift.field([DVec3::ZERO, N, d], true, rests) else {
            continue;
        };
        let turning = TURN.cross(d);
        let (v, change) = field.velocity(|body| motion(&drift, body), OF_X, turning);
        let mut back = 0.0;
        let bars = field.velocity_adjoint(velocity_bar, change_bar, |body, bar| {
            let moved = motion(&drift, body);
            back += bar.velocity.dot(moved.velocity) + bar.rotation.dot(moved.rotation);
        });
        back += bars.x.dot(OF_X) + bars.turning.dot(turning);
        let there = v.dot(velocity_bar) + change * change_bar;
        assert!(
            (back - there).abs() < 1e-12 * (1.0 + there.abs()),
            "{back} {there}"
        );
        tried += 1;
    }
    assert!(tried > 200, "{tried}");
}

/// What moves with a body sees it at rest in directions that turn with it.
#[test]
fn a_body_rests_from_within() {
    let drift = drift_of(vec![body([0.2, 0.1, -0.3], 2.0, false)]);
    let moved = motion(&drift, 0);
    let of = |y: DVec3| moved.velocity + moved.rotation.cross(drift.bodies[0].arm(y));
    for d in directions().filter(|d| d.z > HORIZON) {
        let field = drift.field([DVec3::ZERO, N, d], true, false).unwrap();
        let turning = TURN.cross(d);
        let (v, _) = field.velocity(|_| moved, of(DVec3::ZERO), turning);
        let distance = 0.7;
        let seen = (of(d * distance) - of(DVec3::ZERO)) / distance;
        let across = seen - d * seen.dot(d);
        assert!((v + turning).distance(across) < 1e-12);
    }
}

/// Across the outline of a ball the field moves as the outline does.
#[test]
fn the_outline_of_a_ball_rests() {
    let (centre, radius) = (DVec3::new(0.4, 0.3, 2.0), 0.6);
    let drift = drift_of(vec![body(centre, radius, true)]);
    let w = motion(&drift, 0).velocity - OF_X;
    let (axis, sin) = (centre.normalize(), radius / centre.length());
    let s = axis.any_orthonormal_vector();
    for step in 0..8 {
        let (sin_turn, cos_turn) = f64::from(step).sin_cos();
        let beside = s * cos_turn + axis.cross(s) * sin_turn;
        let d = axis * (1.0 - sin * sin).sqrt() + beside * sin;
        let field = drift
            .field([DVec3::ZERO, N, d * (1.0 - 1e-12)], true, false)
            .unwrap();
        let (v, _) = field.velocity(|body| motion(&drift, body), OF_X, DVec3::ZERO);
        // Where a ray touches the ball it keeps touching it: (w − |y| v)·normal = 0.
        let distance = (centre.length_squared() - radius * radius).sqrt();
        let normal = (d * distance - centre) / radius;
        let slides = (w - v * distance).dot(normal);
        assert!(slides.abs() < 1e-9, "{slides}");
    }
}

/// What a direction meets far along a wall stays there as the height over the wall changes.
#[test]
fn a_wall_that_is_grazed_rests() {
    let drift = LobeDrift::new([Vec::new(), vec![wall()]], false, Vec::new()).unwrap();
    let moved = motion(&drift, 0);
    let of_wall = moved.velocity + moved.rotation.cross(drift.bodies[0].arm(DVec3::ZERO));
    let mut tried = 0;
    for cos in [0.01, 0.05, 0.1] {
        let d =
            DVec3::new(0.9, 0.0, 0.4).normalize() * (1.0f64 - cos * cos).sqrt() + DVec3::Y * cos;
        let field = drift.field([DVec3::ZERO, N, d], true, false).unwrap();
        let (v, _) = field.velocity(|_| moved, OF_X, DVec3::ZERO);
        let distance = 0.1 / cos;
        // How fast what is met on the wall's plane leaves it, seen along the moving direction.
        let slides = (of_wall - OF_X - v * distance).dot(DVec3::Y);
        let without = (of_wall - OF_X).dot(DVec3::Y);
        assert!(
            slides.abs() < 0.02 * without.abs(),
            "{cos}: {slides} {without}"
        );
        tried += 1;
    }
    assert_eq!(tried, 3);
}
