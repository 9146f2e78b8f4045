//! What is said of results that few samples carry: see `gradient::terms`.

use super::results::{BackwardGradient, ForwardGradient};
use crate::gradient::terms::Object;
use crate::scene::Rgb;
use crate::scene::parameters::{Parameter, Target};

/// Where one part carries more of a result than this, its standard error may be too small
/// (scripts/coverage.py).
pub const MOST: f64 = 0.3;

/// Notes of a gradient by these parameters what its largest parts are.
pub fn add_largest_parts(done: &mut BackwardGradient, wanted: &[Parameter]) {
    for parameter in wanted {
        let object = parameter.target.and_then(object_of);
        let share = object.and_then(|object| done.terms.largest_share(object));
        let parts = &mut done.statistics.largest_parts;
        parts.extend(share.map(|share| (parameter.key.clone(), share)));
    }
}

/// What a parameter's gradient is a part of.
fn object_of(target: Target) -> Option<Object> {
    match target {
        Target::VertexPositions(mesh) | Target::VertexNormals(mesh) => Some(Object::Mesh(mesh)),
        Target::ShapeToWorld(body)
        | Target::ShapeTranslation(body)
        | Target::ShapeRotation(body)
        | Target::ShapeScale(body) => Some(Object::Mesh(body.first)),
        Target::SensorTranslation(_)
        | Target::SensorRotation(_)
        | Target::SensorXFov(_)
        | Target::SensorToWorld(_)
        | Target::SensorPrincipalPoint { .. } => Some(Object::Camera),
        Target::Texels(texture) | Target::Texel { texture, .. } => Some(Object::Texture(texture)),
        Target::EnvironmentScale | Target::EnvironmentRotation => Some(Object::Environment),
        // Their samples are as good as those of the colours beside them.
        Target::ToUv(_) | Target::DeltaLightPosition(_) | Target::DeltaLightTranslation(_) => None,
    }
}

/// The share of the variance that the worst pixel in so many holds, of standard errors.
pub fn share_of_worst_pixels(stderr: &[Rgb], in_so_many: usize) -> Option<f64> {
    let squares = |pixel: &Rgb| pixel.iter().map(|e| f64::from(*e).powi(2)).sum::<f64>();
    let mut variances: Vec<f64> = stderr.iter().map(squares).collect();
    let worst = variances.len().div_ceil(in_so_many);
    let sum: f64 = variances.iter().sum();
    variances.sort_unstable_by(|a, b| b.total_cmp(a));
    (sum > 0.0).then(|| variances[..worst].iter().sum::<f64>() / sum)
}

/// The same of those that were seen to have any; all of it if none has.
pub fn share_of_worst_seen(found: &ForwardGradient, in_so_many: usize) -> f64 {
    let errors = found.stderr.iter().flat_map(|image| &image.pixels);
    let seen: Vec<Rgb> = errors.filter(|e| **e != [0.0; 3]).copied().collect();
    share_of_worst_pixels(&seen, in_so_many).unwrap_or(1.0)
}
