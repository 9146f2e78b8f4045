//! As `finite_differences`: surfaces that are more than diffuse.

use common::comparison::Interior::{Agrees, Fails};
use common::comparison::*;
use common::materials::Paint;
use common::scenes::*;
use common::{direction, loses_nothing, settings};
use glam::{Vec3, vec3};
use warpath::methods::Method;
use warpath::scene::Distribution::{Beckmann, Ggx};
use warpath::scene::Scene;

const MOVED: (&str, &[f32]) = ("block.translation", &[1.0, 0.2, 0.1]);
/// Narrow lobes see edges by rays that happen to hit them: differences of the engine's own,
/// tenth-of-a-pixel steps are noise there. A step this long (world units, radians) leaves an error
/// of its fourth power.
const LONG_STEP: Option<f64> = Some(0.03);
/// What can be told of them in a minute; `interior` is off by ten times as much.
const COARSE: f64 = 0.1;
/// And where a bias of a few hundredths is looked for.
const FINE: f64 = 0.007;

fn moved(scene: &Scene, spp: u32, parts: &[(&str, &[f32])]) {
    check(scene, parts, spp, None, Fails);
}

fn moved_far(scene: &Scene, spp: u32, parts: &[(&str, &[f32])]) {
    check_to(COARSE, scene, parts, spp, LONG_STEP, Fails);
}

fn made_of(scene: &Scene, spp: u32, key: &str, by: &[f32]) {
    println!("{key}");
    check_to(COARSE, scene, &[(key, by)], spp, LONG_STEP, Agrees);
}

#[test]
fn seen_in_a_narrow_reflection() {
    moved(
        &close_up()
            .constant_environment(SKY)
            .depth(3)
            .metal("floor", 0.1, Ggx),
        64,
        &[MOVED],
    );
}

/// Some of the lobe's directions lie below the horizon, and the camera sees the plate in the floor
/// alone.
#[test]
fn seen_in_a_reflection_at_a_grazing_angle() {
    let plate = parallelogram(vec3(-0.3, 1.9, 1.1), Vec3::X * 0.8, Vec3::Z * 0.7);
    let scene = small_floor()
        .solid("plate", plate, [0.0; 3])
        .constant_environment(SKY);
    let scene = scene.depth(2).metal("floor", 0.14, Ggx);
    check_to(
        FINE,
        &scene,
        &[("plate.translation", &[1.0, 0.0, 0.2])],
        1024,
        Some(0.05),
        Fails,
    );
}

/// The same body in white, whose spikes are so thin that what starts beside the edge of one may
/// start on its other side.
#[test]
#[cfg_attr(not(feature = "long-tests"), ignore = "takes a minute: make test-long")]
fn thin_wedges_seen_in_a_reflection() {
    let body = spiky(vec3(0.1, 1.9, 1.5), 0.5, [1.4, 0.7]);
    let scene = small_floor()
        .smooth("star", body, [0.75; 3])
        .constant_environment(SKY);
    let scene = scene.depth(3).metal("floor", 0.05, Ggx);
    let moved = ("star.translation", [1.0, 0.0, 0.2].as_slice());
    check(&scene, &[moved], 1024, Some(0.01), Fails);
}

/// Many facets of a body in one lobe: each edge brings its own jump and no other's, and none of
/// what the radiance changes by beside it.
#[test]
fn facets_seen_in_a_reflection() {
    let body = ball(3, vec3(0.1, 1.9, 1.5), 0.5);
    let solid = small_floor().solid("ball", body.clone(), [0.75; 3]);
    let smooth = small_floor().smooth("ball", body, [0.75; 3]);
    for (scene, resolution) in thinned(2, [(smooth, 0.012), (solid, 0.02)]) {
        let scene = lit(scene).depth(3).metal("floor", 0.05, Ggx);
        let moved = ("ball.translation", [1.0, 0.0, 0.2].as_slice());
        check_to(resolution, &scene, &[moved], 512, Some(0.01), Fails);
    }
}

/// Spikes of one body before and behind one another: most silhouettes that walks come to lie behind
/// something, and many are far from the middle of the lobe.
#[test]
fn spikes_seen_in_a_reflection() {
    let body = spiky(vec3(0.1, 1.9, 1.5), 0.5, [1.4, 0.4]);
    let scene = small_floor().smooth("star", body, [0.0; 3]);
    let scene = scene
        .constant_environment(SKY)
        .depth(2)
        .metal("floor", 0.05, Ggx);
    let moved = ("star.translation", [1.0, 0.0, 0.2].as_slice());
    check_to(0.01, &scene, &[moved], 1024, Some(0.03), Fails);
}

/// Lines of a coarse ball with shading normals cross the planes of its triangles, below which they
/// see its inside: no contradiction that a silhouette would have to explain.
#[test]
fn planes_of_triangles_are_no_riddles() {
    let body = ball(1, vec3(0.1, 0.0, 0.45), 0.4);
    let scene = small_floor()
        .smooth("ball", body, [0.6; 3])
        .constant_environment(SKY);
    let scene = scene.depth(3).metal("ball", 0.05, Ggx);
    let turned = direction(&scene, &[("ball.rotation", &[0.5, 0.3, 1.0])]);
    let settings = settings(&scene, Method::Reparam, 64, 1);
    loses_nothing(&scene, &settings, &turned);
}

/// Above the plane of a triangle near the corner of a coarse ball is the sky, below it the inside
/// of the ball, and its shading normals put the plane in the middle of the lobe. Inside, edges
/// between triangles are borders too: light that leaks out is on one side. The camera sees nothing
/// but that triangle.
#[test]
fn planes_of_triangles_are_borders() {
    let (positions, triangles) = ball(0, Vec3::ZERO, 1.0);
    let [a, b, c] = triangles[0].map(|v| positions[v as usize]);
    let plane = (b - a).cross(c - a).normalize();
    let at = 0.8 * a + 0.1 * (b + c);
    let along = (a - b.midpoint(c)).normalize();
    let tilt = at.angle_between(plane);
    let toward_camera = tilt.cos() * plane + (tilt.sin() - 1.0) * along;
    let scene = scene(at + 3.0 * toward_camera.normalize(), at, 0.6, [4; 2], BOX);
    let scene = scene.smooth("ball", (positions, triangles), [0.6; 3]);
    let scene = scene
        .constant_environment(SKY)
        .depth(3)
        .metal("ball", 0.05, Ggx);
    let across = plane.cross(along).to_array();
    let motions = [("ball.rotation", 0.01), ("ball.translation", 0.0025)];
    for (key, step) in thinned(2, motions) {
        check(&scene, &[(key, &across)], 4096, Some(step), Fails);
    }
}

#[test]
fn seen_in_a_wide_reflection() {
    moved(&room(3).metal("floor", 0.3, Beckmann), 128, &[MOVED]);
}

#[test]
fn lamp_seen_in_a_wide_reflection() {
    let scene = shadow().metal("floor", 0.3, Ggx);
    moved(&scene, 64, &[("lamp.translation", &[1.0, 0.3, 0.2])]);
    moved(&scene, 64, &[MOVED]);
}

#[test]
fn metal_that_moves() {
    let scene = close_up()
        .constant_environment(SKY)
        .depth(3)
        .metal("block", 0.1, Beckmann);
    for part in [("block.rotation", [0.5, 0.3, 1.0].as_slice()), MOVED] {
        check(&scene, &[part], 768, Some(0.015), Fails);
    }
}

#[test]
fn plastic_floor() {
    moved(&room(3).plastic("floor", Some(0.3)), 128, &[MOVED]);
    moved(&room(3).plastic("floor", Some(0.1)), 128, &[MOVED]);
}

#[test]
fn glass_that_moves() {
    let scene = close_up()
        .constant_environment(SKY)
        .depth(5)
        .glass("block", 0.1);
    check(&scene, &[MOVED], 256, Some(0.015), Fails);
    moved_far(&scene, 128, &[("block.rotation", &[0.5, 0.3, 1.0])]);
}

#[test]
fn a_picture_that_moves() {
    let scene = close_up().constant_environment(SKY).picture("floor");
    moved(&scene, 64, &[("floor.translation", &[1.0, 0.4, 0.1])]);
    moved(&scene, 64, &[("cam.translation", &[1.0, 0.4, 0.1])]);
}

#[test]
fn what_metal_is_made_of() {
    for alpha in [0.1, 0.3] {
        let scene = room(3).metal("floor", alpha, Ggx);
        for (key, by) in [
            ("floor.bsdf.alpha.value", [1.0].as_slice()),
            ("floor.bsdf.eta.value", &[1.0, 0.5, 0.2]),
            ("floor.bsdf.k.value", &[1.0, 0.5, 0.2]),
            ("floor.bsdf.specular_reflectance.value", &[1.0, 0.5, 0.2]),
        ] {
            made_of(&scene, 64, key, by);
        }
    }
}

#[test]
fn what_plastic_is_made_of() {
    let scene = room(3).plastic("floor", Some(0.2));
    for (key, by) in [
        ("floor.bsdf.alpha", [1.0].as_slice()),
        ("floor.bsdf.eta", &[1.0]),
        ("floor.bsdf.diffuse_reflectance.value", &[1.0, 0.5, 0.2]),
        ("floor.bsdf.specular_reflectance.value", &[1.0, 0.5, 0.2]),
    ] {
        made_of(&scene, 64, key, by);
    }
    let smooth = room(3).plastic("floor", None);
    made_of(&smooth, 64, "floor.bsdf.eta", &[1.0]);
}

#[test]
fn what_glass_is_made_of() {
    let scene = close_up()
        .constant_environment(SKY)
        .depth(5)
        .glass("block", 0.2);
    for (key, by) in [
        ("block.bsdf.alpha.value", [1.0].as_slice()),
        ("block.bsdf.specular_transmittance.value", &[1.0, 0.5, 0.2]),
    ] {
        made_of(&scene, 64, key, by);
    }
    moved_far(&scene, 192, &[("block.bsdf.eta", &[1.0])]);
}

#[test]
fn what_a_picture_is_made_of() {
    let scene = room(3).picture("floor");
    let texels = [("floor.bsdf.reflectance.data", [1.0, 0.5, 0.2].as_slice())];
    check(&scene, &texels, 16, None, Agrees);
    let to_uv = [(
        "floor.bsdf.reflectance.to_uv",
        [0.3, 0.1, 0.5, -0.2, 0.4, 1.0].as_slice(),
    )];
    check(&scene, &to_uv, 64, None, Agrees);
}

#[test]
fn lit_by_the_sun() {
    let scene = close_up().sunny();
    moved_far(&scene, 128, &[MOVED]);
    moved_far(&scene, 128, &[("env.rotation", &[0.3, 0.5, 1.0])]);
    let wide = close_up().sunny().depth(3).metal("floor", 0.3, Ggx);
    let plastic = close_up().sunny().depth(3).plastic("floor", Some(0.2));
    for scene in thinned(2, [wide, plastic]) {
        moved_far(&scene, 128, &[MOVED]);
    }
}

#[test]
fn the_sun_itself() {
    let scene = close_up().sunny().depth(3);
    // The image is linear in the texels, so that any step is right. Short ones are noisy: the map
    // is sampled otherwise when its texels change.
    let step = Some(0.1);
    check(&scene, &[("env.data", &[1.0, 0.5, 0.2])], 16, step, Agrees);
    check(&scene, &[("env.scale", &[1.0])], 16, None, Agrees);
}
