//! Gradient images against finite differences of the plain path tracer, in standard errors.
//!
//! Both sides are means of independent runs, so that their errors are measured, not believed. Two
//! numbers must be zero within four standard errors: the error of the gradient's size, and the
//! excess of χ² over pixels (`common::statistics::Agreement`). `interior`, which ignores
//! visibility, must fail the same check where anything that hides something moves: a check that
//! cannot fail proves nothing.
//!
//! Most scenes use a Gaussian filter: with a box the image has kinks wherever an edge lies along a
//! pixel's border, and the differences are wrong there (by 5 % in places, at a tenth of a pixel).
//! The box gets a smaller step.

use common::comparison::Interior::Fails;
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use common::shapes::Shape;
use glam::{Vec3, vec3};

#[test]
fn silhouette_gaussian_filter() {
    check(
        &silhouette(GAUSSIAN),
        &[("block.translation", &[1.0, 0.2, 0.4])],
        128,
        None,
        Fails,
    );
}

#[test]
fn silhouette_box_filter() {
    check(
        &silhouette(BOX),
        &[("block.translation", &[1.0, 0.2, 0.4])],
        256,
        Some(2e-3),
        Fails,
    );
}

/// Normals a vertex do not make a body smooth.
#[test]
fn hard_edges_of_vertex_normals() {
    let body = placed(
        cuboid(vec3(0.5, 0.3, 0.4)),
        vec3(12.0, 25.0, 33.0),
        vec3(0.0, 0.0, 0.2),
    );
    let (torn, normals) = torn_apart(body);
    let scene = small_floor().with_normals("block", torn, normals, [0.3, 0.5, 0.2]);
    check(
        &lit(scene),
        &[("block.translation", &[1.0, 0.2, 0.4])],
        256,
        None,
        Fails,
    );
}

/// A facet among spikes, which throw thin shadows on it beside one another: between two points of a
/// line there are often several.
#[test]
fn shadows_beside_one_another() {
    let centre = vec3(0.1, 0.0, 0.4);
    let body = || spiky(centre, 0.3, [1.4, 0.7]);
    let at = centre + vec3(0.0, 0.0, 0.12);
    let facet = || {
        let scene = scene(vec3(0.3, -3.4, 1.9), at, 0.3, [4; 2], GAUSSIAN);
        scene.solid("star", body(), [0.75; 3])
    };
    for scene in thinned(2, [facet().constant_environment(SKY), facet().sunny()]) {
        let moved = ("star.translation", [1.0, 0.0, 0.2].as_slice());
        check(&scene, &[moved], 1024, Some(1e-3), Fails);
    }
}

/// The same for a lamp, whose light comes through slats. Some hide the ends of lines on it; what
/// their edges bring nearly cancels.
#[test]
#[cfg_attr(not(feature = "long-tests"), ignore = "takes a minute: make test-long")]
fn shadows_of_slats() {
    let mut slats: Shape = (Vec::new(), Vec::new());
    for i in 0..9 {
        let corner = vec3(0.15 * i as f32 - 0.6, -0.5, 1.1);
        let (positions, triangles) = parallelogram(corner, Vec3::X * 0.05, Vec3::Y);
        let first = slats.0.len() as u32;
        slats.0.extend(positions);
        slats
            .1
            .extend(triangles.into_iter().map(|t| t.map(|v| v + first)));
    }
    let at = vec3(0.05, 0.0, 0.0);
    let scene = scene(vec3(0.3, -3.4, 0.9), at, 1.0, [4; 2], GAUSSIAN)
        .solid("floor", floor(2.0, 0.0), [0.6, 0.5, 0.4])
        .solid("slats", slats, [0.0; 3]);
    let lowered = ("slats.translation", [0.1, 0.0, -1.0].as_slice());
    check_to(0.06, &lit(scene), &[lowered], 4096, Some(0.01), Fails);
}

#[test]
fn shadow_of_what_is_translated() {
    check(
        &shadow(),
        &[("block.translation", &[1.0, 0.2, 0.1])],
        128,
        None,
        Fails,
    );
}

#[test]
fn shadow_of_what_is_rotated() {
    check(
        &shadow(),
        &[("block.rotation", &[0.5, 0.3, 1.0])],
        128,
        None,
        Fails,
    );
}

#[test]
fn shadow_of_what_is_scaled() {
    check(&shadow(), &[("block.scale", &[1.0])], 128, None, Fails);
}

/// A round lamp of 320 triangles, which is looked at as one thing, just below a ceiling; and two
/// that are none: a long one and a bent one.
#[test]
fn shadow_under_lamps_of_many_triangles() {
    let centre = vec3(0.2, 0.1, 2.2);
    let mut long = ball(2, centre, 0.3);
    let stretch = |p: &mut Vec3| p.y += 2.0 * (p.y - centre.y);
    long.0.iter_mut().for_each(stretch);
    let lamps = [ball(2, centre, 0.5), long, spiky(centre, 0.5, [1.0, 0.8])];
    for lamp in lamps {
        let body = placed(
            cuboid(vec3(0.5, 0.3, 0.1)),
            vec3(12.0, 25.0, 33.0),
            vec3(0.0, 0.0, 0.6),
        );
        let scene = small_floor()
            .solid("block", body, [0.3, 0.5, 0.2])
            .solid("ceiling", ceiling(vec3(0.0, 0.0, 2.75), 3.0), [0.5; 3])
            .light("lamp", lamp, [4.0, 5.0, 6.0]);
        for key in ["block.translation", "lamp.translation"] {
            let moved = (key, [1.0, 0.3, -0.4].as_slice());
            check_to(0.05, &scene, &[moved], 512, Some(0.01), Fails);
        }
    }
}

#[test]
fn moving_light() {
    check(
        &shadow(),
        &[("lamp.translation", &[1.0, 0.3, -0.2])],
        128,
        None,
        Fails,
    );
    check(
        &shadow(),
        &[("lamp.rotation", &[1.0, 0.3, 0.5])],
        128,
        None,
        Fails,
    );
    check(&shadow(), &[("lamp.scale", &[1.0])], 128, None, Fails);
}

#[test]
fn moving_receiver() {
    check(
        &shadow(),
        &[("floor.translation", &[0.3, 0.2, 1.0])],
        128,
        None,
        Fails,
    );
    check(
        &shadow(),
        &[("floor.rotation", &[0.3, 0.5, 1.0])],
        128,
        None,
        Fails,
    );
}

#[test]
fn moving_camera() {
    check(
        &shadow(),
        &[("cam.translation", &[1.0, 0.2, -0.3])],
        128,
        None,
        Fails,
    );
    check(
        &shadow(),
        &[("cam.rotation", &[0.3, 0.5, 1.0])],
        128,
        None,
        Fails,
    );
    check(&shadow(), &[("cam.x_fov", &[1.0])], 128, None, Fails);
}

/// The shading jumps at every edge inside the outline.
#[test]
fn flat_shaded_ball_under_camera_motion() {
    let ball = ball(2, vec3(0.0, 0.0, 0.55), 0.5);
    let scene = lit(floor_seen(20, GAUSSIAN).solid("ball", ball, [0.7, 0.4, 0.2]));
    check(
        &scene,
        &[("cam.translation", &[1.0, 0.0, 0.2])],
        128,
        None,
        Fails,
    );
}

#[test]
fn smooth_ball() {
    let ball = ball(5, vec3(0.0, 0.0, 0.55), 0.5);
    let scene = lit(floor_seen(16, GAUSSIAN).smooth("ball", ball, [0.7, 0.4, 0.2]));
    check(
        &scene,
        &[("ball.translation", &[1.0, 0.2, 0.3])],
        128,
        None,
        Fails,
    );
}

/// Light that arrives between the planes of two triangles is seen on one side of their edge only,
/// though shading goes on. Nothing but such edges moves here against the sky, half of which a wall
/// hides.
#[test]
fn bends_of_smooth_bodies() {
    let wall = parallelogram(
        vec3(1.5, -50.0, -50.0),
        vec3(0.0, 100.0, 0.0),
        vec3(0.0, 0.0, 100.0),
    );
    for (levels, spp) in [(0, 64), (1, 640)] {
        let scene = scene(vec3(0.3, 0.2, 4.0), Vec3::ZERO, 20.0, [16; 2], GAUSSIAN)
            .smooth("ball", ball(levels, Vec3::ZERO, 1.0), [0.7, 0.4, 0.2])
            .solid("wall", wall.clone(), [0.0; 3])
            .constant_environment(SKY)
            .depth(2);
        check(
            &scene,
            &[("ball.rotation", &[0.0, 0.0, 1.0])],
            spp,
            None,
            Fails,
        );
    }
}

/// A concave mesh hides and shades itself.
#[test]
fn self_shadowing() {
    let shape = placed(l_shape(0.4, 0.6), vec3(0.0, 0.0, 25.0), vec3(0.0, 0.0, 0.1));
    let scene = lit(floor_seen(20, GAUSSIAN).solid("corner", shape, [0.5, 0.5, 0.7]));
    check(
        &scene,
        &[("corner.translation", &[1.0, 0.2, 0.1])],
        128,
        None,
        Fails,
    );
    check(
        &scene,
        &[("corner.rotation", &[0.8, 0.5, 1.0])],
        128,
        None,
        Fails,
    );
}

#[test]
fn shapes_that_pass_through_each_other() {
    let wall = parallelogram(
        vec3(-1.0, 0.3, -0.2),
        vec3(2.0, 0.2, 0.0),
        vec3(0.0, 0.1, 1.3),
    );
    let scene = lit(floor_seen(20, GAUSSIAN).solid("wall", wall, [0.7, 0.3, 0.3])).solid(
        "ball",
        ball(2, vec3(0.0, 0.2, 0.5), 0.4),
        [0.3, 0.6, 0.3],
    );
    check(
        &scene,
        &[("ball.translation", &[0.5, 1.0, 0.3])],
        256,
        None,
        Fails,
    );
}

/// Edges of a fine flat-shaded mesh are many in a thousandth of a coarse pixel near its outline;
/// taken as one they cost 2.7 % of the gradient here.
#[test]
fn fine_bodies_in_coarse_images() {
    let scene = scene(
        vec3(0.0, -5.0, 2.6),
        vec3(0.0, 0.0, 0.55),
        38.0,
        [6; 2],
        GAUSSIAN,
    )
    .solid("floor", floor(6.0, 0.0), [0.65, 0.63, 0.6])
    .solid(
        "ball",
        ball(5, vec3(-0.15, 0.1, 1.25), 0.85),
        [0.75, 0.3, 0.1],
    )
    .light(
        "lamp",
        placed(
            ceiling(Vec3::ZERO, 0.6),
            vec3(0.0, 20.0, 0.0),
            vec3(-1.4, -0.6, 4.0),
        ),
        [22.0, 21.0, 19.0],
    );
    let resolution = 0.004;
    check_to(
        resolution,
        &scene,
        &[("ball.translation", &[1.0, 0.0, 0.0])],
        4096,
        None,
        Fails,
    );
}
