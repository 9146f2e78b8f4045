//! Whether few samples carry a result: then its standard error, from a few groups of samples, cannot be trusted.
//!
//! A sum of n independent terms of finite variance has a largest squared deviation that is about 2 ln n / n of all of them.
//! Where single terms are heavy-tailed so that the variance is infinite, or so rare that few were met, the largest
//! carries a share of the whole that does not fall with n, and the spread of groups says little.
//! The terms here are what a tile of one group brings to the sum of an object's gradient, as a deviation from the mean of the
//! same tile over groups.

use crate::gradient::accumulator::{Object, TileGradient, Wanted};
use crate::scene::Rgb;
use crate::scene::parameters::Target;
use crate::trace::geometry::Geometry;
use std::collections::HashMap;

/// Where one part carries more of a result's variance than this, its standard error means little.
pub const MOST: f64 = 0.3;

/// What each tile of each group brings to the gradients of what was asked about, one number an object.
#[derive(Debug)]
pub struct Tails {
    objects: HashMap<Object, usize>,
    /// Group by group, tile by tile, object by object.
    parts: Vec<f64>,
}

impl Tails {
    /// Of no tile yet.
    pub fn new(wanted: &Wanted) -> Self {
        let objects = wanted.objects().into_iter().enumerate();
        Self {
            objects: objects.map(|(i, object)| (object, i)).collect(),
            parts: Vec::new(),
        }
    }

    /// Adds a tile; groups come one after another, and their tiles in one order.
    pub fn add(&mut self, tile: &TileGradient, geometry: &Geometry) {
        let first = self.parts.len();
        self.parts.resize(first + self.objects.len(), 0.0);
        let parts = &mut self.parts[first..];
        tile.for_each_part(geometry, |object, value| {
            if let Some(&i) = self.objects.get(&object) {
                parts[i] += value;
            }
        });
    }

    /// The share of the largest squared deviation in all those of the object that `target` belongs to; `None` where
    /// nothing deviates.
    pub fn largest_share(&self, target: Target, groups: usize) -> Option<f64> {
        let object = *self.objects.get(&object_of(target)?)?;
        let n = groups as f64;
        let group_len = self.parts.len() / groups;
        let (mut sum, mut largest) = (0.0, 0.0f64);
        for tile in (object..group_len).step_by(self.objects.len()) {
            let values = self.parts[tile..].iter().step_by(group_len);
            let mean = values.clone().sum::<f64>() / n;
            for square in values.map(|v| (v - mean).powi(2)) {
                sum += square;
                largest = largest.max(square);
            }
        }
        (sum > 0.0).then(|| largest / sum)
    }
}

fn object_of(target: Target) -> Option<Object> {
    match target {
        Target::VertexPositions(mesh)
        | Target::ShapeTranslation(mesh)
        | Target::ShapeRotation(mesh)
        | Target::ShapeScale(mesh) => Some(Object::Mesh(mesh)),
        Target::SensorTranslation(_) | Target::SensorRotation(_) | Target::SensorXFov(_) => {
            Some(Object::Camera)
        }
        Target::Texels(texture) | Target::Texel { texture, .. } => Some(Object::Texture(texture)),
        Target::EnvironmentScale | Target::EnvironmentRotation => Some(Object::Environment),
        // Their samples are as good as those of the colours beside them.
        Target::ToUv(_) | Target::DeltaLightPosition(_) | Target::DeltaLightTranslation(_) => None,
    }
}

/// The share of the variance that the worst pixel in a thousand holds, of standard errors.
pub fn share_of_worst_pixels(stderr: &[Rgb]) -> Option<f64> {
    let squares = |pixel: &Rgb| pixel.iter().map(|e| f64::from(*e).powi(2)).sum::<f64>();
    let mut variances: Vec<f64> = stderr.iter().map(squares).collect();
    let worst = variances.len().div_ceil(1000);
    let sum: f64 = variances.iter().sum();
    variances.sort_unstable_by(|a, b| b.total_cmp(a));
    (sum > 0.0).then(|| variances[..worst].iter().sum::<f64>() / sum)
}
