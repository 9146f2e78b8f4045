//! The border of a projector's picture, where its light ends on what it falls on.
//!
//! It lies in four planes through the projector, which keep their directions: with n the normal of
//! one and w the way from the receiver to the projector, F = n·w ([`Boundary::Plane`]).

use super::follow::{Rays, parameter_of, surface};
use super::receiver::Receiver;
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::boundary::Boundary;
use crate::paths::boundary_sample::Shadow;
use crate::paths::counts::Counts;
use crate::scene::{BeamProfile, DeltaLight, DeltaLightKind};
use glam::{DVec3, Vec3};

/// The planes between which a projector's picture lies.
pub struct Frame {
    position: DVec3,
    /// Inward, in the world's axes.
    normals: [DVec3; 4],
}

/// Where a straight way crosses the border.
pub struct Crossing {
    pub boundary: Boundary,
    /// Part of the way.
    pub at: f64,
    /// Whether the way goes in there.
    pub goes_in: bool,
}

impl Frame {
    /// Those of lights, by their numbers.
    pub fn all(lights: &[DeltaLight]) -> Vec<(usize, Self)> {
        let numbered = lights.iter().enumerate();
        numbered
            .filter_map(|(number, light)| Some((number, Self::of(light)?)))
            .collect()
    }

    /// That of a light, if it has one.
    pub fn of(light: &DeltaLight) -> Option<Self> {
        let beam = light.beam.as_ref()?;
        let BeamProfile::Projector { half_tangents, .. } = beam.profile else {
            return None;
        };
        let DeltaLightKind::Point { position } = light.kind else {
            return None;
        };
        let [x, y] = half_tangents.to_array();
        let local = [
            Vec3::new(1.0, 0.0, x),
            Vec3::new(-1.0, 0.0, x),
            Vec3::new(0.0, 1.0, y),
            Vec3::new(0.0, -1.0, y),
        ];
        let to_world = beam.to_local.transpose();
        Some(Self {
            position: position.as_dvec3(),
            normals: local.map(|n| (to_world * n).as_dvec3()),
        })
    }

    /// Where the way between two points crosses the border.
    pub fn crossings(&self, [a, b]: [DVec3; 2]) -> impl Iterator<Item = Crossing> {
        let [a, b] = [a, b].map(|x| self.normals.map(|n| n.dot(x - self.position)));
        let is_within = move |plane: usize, at: f64| {
            (0..4).all(|p| p == plane || a[p] + (b[p] - a[p]) * at > 0.0)
        };
        let normals = self.normals;
        (0..4).filter_map(move |plane| {
            let (before, after) = (a[plane], b[plane]);
            let at = before / (before - after);
            let crosses = (before > 0.0) != (after > 0.0) && is_within(plane, at);
            crosses.then_some(Crossing {
                boundary: Boundary::Plane(normals[plane]),
                at,
                goes_in: after > 0.0,
            })
        })
    }
}

/// Where the border lies on what rays see.
pub struct OnSurface {
    /// Parameter of the arc.
    pub s: f64,
    pub boundary: Boundary,
    pub shadow: Shadow,
    pub goes_in: bool,
}

/// Up to which parameter the surface is seen that the first ray meets, and the borders of pictures
/// on it that the light reaches and that move: if its light or the surface does, or where `drifts`
/// says so of a parameter.
pub fn on_surface<F: Fn(f64) -> u32>(
    scene: &SearchScene,
    frames: &[(usize, Frame)],
    rays: &Rays<F>,
    drifts: impl Fn(f64) -> bool,
    counts: &mut Counts,
) -> (f64, Vec<OnSurface>) {
    let (arc, geometry) = (&rays.arc, scene.view.geometry);
    let (end, passed) = surface(scene, rays, 1.0, counts);
    let mut found = Vec::new();
    let mut begin = 0.0;
    for facet in passed {
        let ends = [begin, facet.to].map(|s| arc.direction(s));
        begin = facet.to;
        for (light, frame) in frames {
            let receiver = Receiver::new(scene, *light, facet.triangle);
            let shines_anew = scene.moving.shines_anew(geometry, *light, facet.triangle);
            let ends = ends.map(|d| receiver.point(arc.origin, d));
            for crossing in frame.crossings(ends) {
                let x = ends[0].lerp(ends[1], crossing.at);
                let s = parameter_of(arc, x);
                let moves = shines_anew || drifts(s);
                if moves && receiver.sees_light(x, arc.direction(s), counts) {
                    found.push(OnSurface {
                        s,
                        boundary: crossing.boundary,
                        shadow: Shadow {
                            light: *light as u32,
                            receiver: facet.triangle,
                        },
                        goes_in: crossing.goes_in,
                    });
                }
            }
        }
    }
    (end, found)
}
