//! From the gradients of small motions of the present scene to those of the motions that made it.
//!
//! A pose moves a mesh as v ↦ c + t + s·R(r)(v₀ − c), where c is the centre of the bounding box of
//! the scene as it was loaded. The engine gives derivatives by a further translation τ, by a
//! further rotation ω about the centre c₁ of the present box, and by a further scaling σ about it.
//! With p = c + t, the torque about p is that about c₁ plus (c₁ − p) × τ̄, and the same holds of
//! the virial. A rotation vector r + dr turns by R(J dr)R(r), where J is the left Jacobian of SO(3)
//! \[Sola2018\] (eq. 145).

use crate::scene::parameters::{self, Gradient, Parameter, Target};
use crate::scene::{Body, Scene};
use glam::{DMat3, DVec3};

/// J(r)ᵀw, for the rotation vector r.
pub fn transposed_left_jacobian(r: DVec3, w: DVec3) -> DVec3 {
    let angle = r.length();
    let (a, b) = match angle < 1e-4 {
        true => (
            0.5 - angle * angle / 24.0,
            1.0 / 6.0 - angle * angle / 120.0,
        ),
        false => (
            (1.0 - angle.cos()) / (angle * angle),
            (angle - angle.sin()) / angle.powi(3),
        ),
    };
    w - a * r.cross(w) + b * r.cross(r.cross(w))
}

/// The turn of a rotation vector.
pub fn turn(r: DVec3) -> DMat3 {
    DMat3::from_quat(glam::DQuat::from_scaled_axis(r))
}

/// The gradient of one of some parameters at its value, from that by the present scene.
pub fn gradient(
    base: &Scene,
    now: &Scene,
    all: &[Parameter],
    values: &[Vec<f32>],
    which: usize,
    found: &Gradient,
) -> Vec<f32> {
    let parameter = &all[which];
    let plain = found.by(now, parameter);
    let value = &values[which];
    let vector = |v: &[f32]| DVec3::new(v[0].into(), v[1].into(), v[2].into());
    match parameter.target {
        Some(Target::SensorRotation(_) | Target::EnvironmentRotation) => {
            let w = transposed_left_jacobian(vector(value), vector(&plain));
            w.as_vec3().to_array().to_vec()
        }
        Some(Target::ShapeRotation(body)) => {
            let about = about_pivot(base, now, all, values, body);
            let force = force(now, parameter, body, found);
            let torque = vector(&plain) + about.cross(force);
            let w = transposed_left_jacobian(vector(value), torque);
            w.as_vec3().to_array().to_vec()
        }
        Some(Target::ShapeScale(body)) => {
            let about = about_pivot(base, now, all, values, body);
            let force = force(now, parameter, body, found);
            let virial = f64::from(plain[0]) + about.dot(force);
            vec![(virial / f64::from(value[0])) as f32]
        }
        _ => plain,
    }
}

/// The parameters whose derivatives [`gradient`] needs to give those of these: what turns or grows
/// about a point that is not that of the present scene moves, too.
pub fn needed(scene: &Scene, wanted: &[Parameter]) -> Vec<Parameter> {
    let mut needed = wanted.to_vec();
    for parameter in wanted {
        if let Some(Target::ShapeRotation(body) | Target::ShapeScale(body)) = parameter.target {
            let translation = Some(Target::ShapeTranslation(body));
            if needed.iter().all(|p| p.target != translation) {
                let all = parameters::list(scene).into_iter();
                needed.extend(all.filter(|p| p.target == translation).take(1));
            }
        }
    }
    needed
}

/// From the pivot that the pose turns about to that of the present scene.
fn about_pivot(
    base: &Scene,
    now: &Scene,
    all: &[Parameter],
    values: &[Vec<f32>],
    body: Body,
) -> DVec3 {
    let is_translation = |p: &Parameter| p.target == Some(Target::ShapeTranslation(body));
    let by = all
        .iter()
        .position(is_translation)
        .map_or(DVec3::ZERO, |i| {
            let [x, y, z] = [0, 1, 2].map(|c| f64::from(values[i][c]));
            DVec3::new(x, y, z)
        });
    let [now, base] = [now, base].map(|scene| parameters::pivot(&scene.meshes[body.meshes()]));
    now - base - by
}

/// The derivative by a translation.
fn force(now: &Scene, parameter: &Parameter, body: Body, found: &Gradient) -> DVec3 {
    let translation = Parameter {
        target: Some(Target::ShapeTranslation(body)),
        ..parameter.clone()
    };
    let sum = found.by(now, &translation);
    DVec3::new(sum[0].into(), sum[1].into(), sum[2].into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SceneDifferential;
    use crate::scene::load_from;
    use crate::scene::source::Memory;
    use glam::Vec3;

    /// A cube whose bounding box turns with it, so that pivots differ.
    const SCENE: &str = r#"<scene version="3.0.0">
      <sensor type="perspective"><float name="fov" value="40"/></sensor>
      <shape type="cube" id="box"><transform name="to_world">
        <scale x="0.5" y="1" z="0.2"/><rotate x="1" y="0" z="0" angle="25"/><translate x="3" y="-1" z="2"/>
      </transform></shape></scene>"#;

    /// L is linear in the vertices, so its cotangent is known; the pose is far from none.
    #[test]
    fn a_pose_has_the_gradient_of_differences() {
        let files = Memory::new().with("s.xml", SCENE);
        let base = load_from(&files, "s.xml", &[]).unwrap();
        let keys = ["box.scale", "box.rotation", "box.translation"];
        let all: Vec<Parameter> = keys
            .iter()
            .map(|key| parameters::find(&base, key).unwrap())
            .collect();
        let values = vec![vec![1.3], vec![0.4, -0.7, 0.5], vec![0.3, 0.2, -0.6]];
        let weight = |i: usize| {
            let t = i as f32;
            Vec3::new((1.3 * t).sin() + 0.5, (0.7 * t).cos(), (2.1 * t).sin())
        };
        let posed = |values: &[Vec<f32>]| {
            let mut scene = base.clone();
            for (parameter, values) in all.iter().zip(values) {
                parameters::apply(&mut scene, parameter, values).unwrap();
            }
            scene
        };
        let loss = |values: &[Vec<f32>]| -> f64 {
            let scene = posed(values);
            let positions = scene.meshes[0].positions.iter().enumerate();
            positions
                .map(|(i, p)| p.as_dvec3().dot(weight(i).as_dvec3()))
                .sum()
        };
        let now = posed(&values);
        let mut cotangent = SceneDifferential::none(&now);
        let count = now.meshes[0].positions.len();
        cotangent.positions[0] = Some((0..count).map(weight).collect());
        let whole = Gradient::from(cotangent);
        // As differences have it: of what is needed for a rotation or a scaling alone, nothing
        // more.
        let alone = |parameter: &Parameter| {
            let needed = needed(&base, std::slice::from_ref(parameter)).into_iter();
            let numbers = needed.filter_map(|p| Some((p.target?, whole.by(&now, &p))));
            Gradient {
                cotangent: SceneDifferential::none(&now),
                numbers: numbers.collect(),
            }
        };
        for (which, parameter) in all.iter().enumerate() {
            let found = gradient(&base, &now, &all, &values, which, &whole);
            let again = gradient(&base, &now, &all, &values, which, &alone(parameter));
            assert_eq!(found, again, "{}", parameter.key);
            for c in 0..parameter.len() {
                let h = 1.0 / 64.0;
                let at = |by: f32| {
                    let mut values = values.clone();
                    values[which][c] += by;
                    loss(&values)
                };
                // Of the fourth order; what is left is rounding to single precision.
                let slope =
                    (8.0 * (at(h) - at(-h)) - (at(2.0 * h) - at(-2.0 * h))) / (12.0 * f64::from(h));
                let off = f64::from(found[c]) - slope;
                assert!(off.abs() < 1e-3, "{} {c}: {off} of {slope}", parameter.key);
            }
        }
    }

    #[test]
    fn the_left_jacobian_is_that_of_differences() {
        for r in [
            DVec3::new(0.3, -1.1, 0.7),
            DVec3::new(1e-6, 2e-6, -1e-6),
            DVec3::new(0.0, 3.0, 0.1),
        ] {
            let (p, bar) = (DVec3::new(0.4, 0.9, -0.5), DVec3::new(1.3, -0.2, 0.8));
            // L = bar · R(r)p has the torque Rp × bar.
            let torque = (turn(r) * p).cross(bar);
            let found = transposed_left_jacobian(r, torque);
            let value = |r: DVec3| bar.dot(turn(r) * p);
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                let h = 1e-5;
                let slope = (value(r + h * axis) - value(r - h * axis)) / (2.0 * h);
                let off = found.dot(axis) - slope;
                assert!(off.abs() < 1e-8, "{r}: {axis}: {off}");
            }
        }
    }
}
