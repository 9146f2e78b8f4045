//! The lights as edges stand before them.

use super::directions::Part;
use crate::paths::light::patches::Patch;
use crate::paths::scene_view::SceneView;
use glam::DVec3;
use std::collections::HashMap;
use std::f64::consts::PI;

/// All lights.
pub struct LightsAround {
    pub around: Vec<LightSphere>,
    /// The patch of each triangle that shines.
    pub patch_of: HashMap<u32, u32>,
}

/// A sphere around a light, and the chance that a sample is of it.
pub struct LightSphere {
    centre: DVec3,
    radius: f64,
    pub chance: f64,
}

impl LightsAround {
    pub fn new(view: &SceneView) -> Self {
        let patches = &view.lights.patches;
        let around = (0..view.scene.area_lights.len()).map(|light| {
            let mesh = view.scene.area_lights[light].mesh;
            let [first, end] = [mesh, mesh + 1].map(|m| view.geometry.first_vertex[m] as usize);
            let points = view.geometry.positions[first..end].iter();
            let points = points.map(|p| p.as_dvec3());
            let low = points.clone().fold(DVec3::INFINITY, DVec3::min);
            let high = points.clone().fold(DVec3::NEG_INFINITY, DVec3::max);
            let centre = low.midpoint(high);
            let own = patches.iter().filter(|p| p.light as usize == light);
            LightSphere {
                centre,
                radius: points.map(|p| p.distance(centre)).fold(0.0, f64::max),
                chance: own.map(|p| f64::from(p.probability)).sum(),
            }
        });
        let triangles = |(patch, p): (usize, &Patch)| {
            p.triangles().map(move |triangle| (triangle, patch as u32))
        };
        Self {
            around: around.collect(),
            patch_of: patches.iter().enumerate().flat_map(triangles).collect(),
        }
    }
}

impl LightSphere {
    /// What stands before it, as seen from `x`.
    pub fn cone(&self, x: DVec3) -> Part {
        let way = self.centre - x;
        let distance = way.length();
        let is_outside = distance > self.radius;
        Part::Cone {
            axis: way.normalize_or(DVec3::Z),
            half_rad: if is_outside {
                (self.radius / distance).asin()
            } else {
                PI
            },
            far: distance + self.radius,
        }
    }
}
