//! As `transposition`, at the ends of what materials and lights may be given: every material under
//! every kind of light.

use common::Direction;
use common::comparison::thinned;
use common::materials::Paint;
use common::scenes::*;
use common::shapes::Random;
use common::transposition::{
    all_parameters, both_sides, difference, prepared, random_values, random_weight,
};
use glam::{Vec3, vec3};
use warpath::methods::Method;
use warpath::scene::Distribution::{self, Beckmann, Ggx};
use warpath::scene::{Bsdf, DeltaLight, DeltaLightKind, Material, Scene, Texture};

/// A body on a floor.
fn body() -> Scene {
    let block = placed(
        cuboid(Vec3::splat(0.4)),
        vec3(10.0, 20.0, 30.0),
        vec3(0.1, 0.0, 0.6),
    );
    scene(
        vec3(0.4, -4.0, 2.2),
        vec3(0.0, 0.0, 0.4),
        30.0,
        [8, 6],
        GAUSSIAN,
    )
    .depth(3)
    .solid("floor", floor(1.2, 0.0), [0.6, 0.5, 0.4])
    .smooth("body", block, [0.5; 3])
}

/// Sets every texel of the texture `key`.
fn with(mut scene: Scene, key: &str, value: f32) -> Scene {
    let texture = scene.textures.iter_mut().find(|t| t.key == key);
    let texture = texture.unwrap_or_else(|| panic!("no texture {key}"));
    texture.texels.fill([value; 3]);
    scene
}

/// Without microfacets.
fn polished(mut scene: Scene) -> Scene {
    for material in &mut scene.materials {
        match &mut material.bsdf {
            Bsdf::Conductor { microfacets, .. }
            | Bsdf::Dielectric { microfacets, .. }
            | Bsdf::Plastic { microfacets, .. } => *microfacets = None,
            _ => {}
        }
    }
    scene
}

type Named = (String, Scene);

fn diffuse() -> Vec<Named> {
    let of = |r| {
        let scene = with(body(), "body.bsdf.brdf_0.reflectance", r);
        (format!("diffuse of {r}"), scene)
    };
    [0.0, 1.0].map(of).into()
}

fn metals() -> Vec<Named> {
    let mut all = Vec::new();
    for (eta, k) in [
        (0.0, 1.0),
        (0.0, 0.0),
        (1.0, 0.0),
        (1e-4, 1.0),
        (0.2, 3.5),
        (0.5, 0.0),
    ] {
        let of = |alpha, distribution: Distribution| {
            let scene = with(
                body().metal("body", alpha, distribution),
                "body.bsdf.eta",
                eta,
            );
            let name = format!("metal of {eta} + {k}i, {distribution:?} {alpha}");
            (name, with(scene, "body.bsdf.k", k))
        };
        all.extend([of(1e-3, Ggx), of(1.0, Ggx), of(0.3, Beckmann)]);
        let (name, scene) = of(0.5, Ggx);
        all.push((format!("smooth {name}"), polished(scene)));
    }
    for alpha in [1e-4, 0.02, 1.0] {
        for r in [0.0, 1.0] {
            let scene = body().metal("body", alpha, Beckmann);
            let scene = with(scene, "body.bsdf.specular_reflectance", r);
            all.push((format!("metal of colour {r}, Beckmann {alpha}"), scene));
        }
    }
    all
}

fn glasses() -> Vec<Named> {
    let mut all = Vec::new();
    for eta in [0.01, 0.6, 1.0, 1.5, 100.0] {
        for alpha in [1e-3, 0.2, 1.0] {
            let scene = with(body().glass("body", alpha), "body.bsdf.eta", eta);
            all.push((format!("glass of {eta}, GGX {alpha}"), scene));
        }
        let scene = with(polished(body().glass("body", 0.1)), "body.bsdf.eta", eta);
        all.push((format!("smooth glass of {eta}"), scene));
    }
    for key in ["specular_reflectance", "specular_transmittance"] {
        let scene = with(body().glass("body", 0.3), &format!("body.bsdf.{key}"), 0.0);
        all.push((format!("glass without {key}"), scene));
    }
    all
}

fn plastics() -> Vec<Named> {
    let mut all = Vec::new();
    for alpha in [None, Some(1e-3), Some(0.04), Some(0.3), Some(1.0)] {
        for (key, value) in [
            ("diffuse_reflectance", 0.0),
            ("diffuse_reflectance", 1.0),
            ("specular_reflectance", 0.0),
            ("specular_reflectance", 1.0),
            ("eta", 1.0),
            ("eta", 100.0),
        ] {
            let scene = body().plastic("body", alpha);
            let scene = with(scene, &format!("body.bsdf.{key}"), value);
            all.push((format!("plastic of {alpha:?}, {key} {value}"), scene));
        }
    }
    all
}

fn delta_light(mut scene: Scene, kind: DeltaLightKind) -> Scene {
    scene.delta_lights.push(DeltaLight {
        key: "bulb".into(),
        kind,
        power: scene.textures.len(),
        beam: None,
    });
    let power = Texture::constant("bulb.power".into(), [2.0, 1.5, 1.0]);
    scene.textures.push(power);
    scene
}

/// The scene under each kind of light.
fn lit(scene: &Scene) -> Vec<(&'static str, Scene)> {
    let lamp = || ceiling(vec3(0.3, 0.2, 2.0), 0.5);
    let lamp_lit = scene.clone().light("lamp", lamp(), [5.0, 6.0, 4.0]);
    let mut pictured = lamp_lit.clone();
    pictured.meshes[2].uvs = pictured.meshes[2]
        .positions
        .iter()
        .map(|p| p.truncate())
        .collect();
    let radiance = pictured.area_lights[0].radiance;
    let picture = scene.clone().picture("floor").textures.pop().expect("one");
    let key = pictured.textures[radiance].key.clone();
    pictured.textures[radiance] = Texture { key, ..picture };
    let position = vec3(0.8, -0.9, 1.6);
    let direction = vec3(0.2, 0.3, -0.9).normalize();
    vec![
        ("a lamp", lamp_lit),
        ("a lamp with a picture", pictured),
        (
            "an even sky",
            scene.clone().constant_environment([0.5, 0.6, 0.8]),
        ),
        ("a sunny sky", scene.clone().sunny()),
        (
            "a bulb",
            delta_light(scene.clone(), DeltaLightKind::Point { position }),
        ),
        (
            "the sun",
            delta_light(scene.clone(), DeltaLightKind::Directional { direction }),
        ),
    ]
}

/// Random directions: of the camera, the floor, the body, what it is made of, and the light.
fn directions(scene: &Scene, random: &mut Random) -> Vec<(&'static str, Direction)> {
    let mut classes = ["cam.", "floor.", "body.bsdf", "body.", ""].map(|c| (c, Direction::new()));
    for parameter in all_parameters(scene) {
        let of = |(class, _): &&mut (&str, Direction)| parameter.key.starts_with(*class);
        let class = classes.iter_mut().find(of).expect("a class for the rest");
        let values = random_values(random, parameter.len());
        class.1.push((parameter, values));
    }
    classes.into()
}

/// Smooth materials have sharp edges that `reparam` does not find.
fn method(scene: &Scene) -> Method {
    let is_smooth = |m: &Material| {
        matches!(
            m.bsdf,
            Bsdf::Conductor {
                microfacets: None,
                ..
            } | Bsdf::Dielectric {
                microfacets: None,
                ..
            } | Bsdf::Plastic {
                microfacets: None,
                ..
            }
        )
    };
    if scene.materials.iter().any(is_smooth) {
        Method::Interior
    } else {
        Method::Reparam
    }
}

/// Forward and reverse mode are transposes, and neither leaves a term out.
fn hold(materials: Vec<Named>) {
    let mut random = Random::new(1);
    let mut wrong = Vec::new();
    let under = |(material, scene): Named| {
        let lit = lit(&scene).into_iter();
        lit.map(move |(light, scene)| (format!("{material} under {light}"), scene))
    };
    // There are six lights: every material and every light is met.
    for (case, scene) in thinned(5, materials.into_iter().flat_map(under)) {
        let method = method(&scene);
        let prepared = prepared(&scene);
        let weight = random_weight(&mut random, &scene);
        for (class, direction) in directions(&scene, &mut random) {
            let class = if class.is_empty() { "the light" } else { class };
            let what = format!("{case}, {class}");
            let sides = both_sides(&prepared, &direction, &weight, method);
            wrong.extend(difference(&what, &sides));
        }
    }
    assert!(
        wrong.is_empty(),
        "{} wrong:\n{}",
        wrong.len(),
        wrong.join("\n")
    );
}

#[test]
fn of_diffuse_surfaces() {
    hold(diffuse());
}

#[test]
fn of_metals() {
    hold(metals());
}

#[test]
fn of_glasses() {
    hold(glasses());
}

#[test]
fn of_plastics() {
    hold(plastics());
}
