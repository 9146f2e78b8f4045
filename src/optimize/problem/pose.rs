//! From the gradients of small motions of the present scene to those of the motions that made it.
//!
//! A pose moves a mesh as v ↦ c + t + s·R(r)(v₀ − c), where c is the centre of the bounding box of
//! the scene as it was loaded. The engine gives derivatives by a further translation τ, by a further
//! rotation ω about the centre c₁ of the present box, and by a further scaling σ about it. With p =
//! c + t, the torque about p is that about c₁ plus (c₁ − p) × τ̄, and the same holds of the virial.
//! A rotation vector r + dr turns by R(J dr)R(r), where J is the left Jacobian of SO(3)
//! [Sola2018] (eq. 145).

use super::variable::Variable;
use crate::scene::parameters::{self, Parameter, Target};
use crate::scene::{Body, Scene, SceneDifferential};
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

/// The gradient of one variable at its value, from the cotangents of the present scene.
pub fn gradient(
    base: &Scene,
    now: &Scene,
    variables: &[Variable],
    values: &[Vec<f32>],
    which: usize,
    cotangent: &SceneDifferential,
) -> Vec<f32> {
    let parameter = &variables[which].parameter;
    let plain = parameters::reduce(now, parameter, cotangent);
    let value = &values[which];
    let vector = |v: &[f32]| DVec3::new(v[0].into(), v[1].into(), v[2].into());
    match parameter.target {
        Some(Target::SensorRotation(_) | Target::EnvironmentRotation) => {
            let w = transposed_left_jacobian(vector(value), vector(&plain));
            w.as_vec3().to_array().to_vec()
        }
        Some(Target::ShapeRotation(body)) => {
            let about = about_pivot(base, now, variables, values, body);
            let force = force(now, parameter, body, cotangent);
            let torque = vector(&plain) + about.cross(force);
            let w = transposed_left_jacobian(vector(value), torque);
            w.as_vec3().to_array().to_vec()
        }
        Some(Target::ShapeScale(body)) => {
            let about = about_pivot(base, now, variables, values, body);
            let force = force(now, parameter, body, cotangent);
            let virial = f64::from(plain[0]) + about.dot(force);
            vec![(virial / f64::from(value[0])) as f32]
        }
        _ => plain,
    }
}

/// From the pivot that the pose turns about to that of the present scene.
fn about_pivot(
    base: &Scene,
    now: &Scene,
    variables: &[Variable],
    values: &[Vec<f32>],
    body: Body,
) -> DVec3 {
    let moved = variables
        .iter()
        .position(|v| v.parameter.target == Some(Target::ShapeTranslation(body)));
    let by = moved.map_or(DVec3::ZERO, |i| {
        DVec3::new(
            values[i][0].into(),
            values[i][1].into(),
            values[i][2].into(),
        )
    });
    let [now, base] = [now, base].map(|scene| parameters::pivot(&scene.meshes[body.meshes()]));
    now - base - by
}

/// The derivative by a translation.
fn force(now: &Scene, parameter: &Parameter, body: Body, cotangent: &SceneDifferential) -> DVec3 {
    let translation = Parameter {
        target: Some(Target::ShapeTranslation(body)),
        ..parameter.clone()
    };
    let sum = parameters::reduce(now, &translation, cotangent);
    DVec3::new(sum[0].into(), sum[1].into(), sum[2].into())
}

#[cfg(test)]
mod tests {
    use super::*;

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
