//! The border of a light's beam on what it falls on: that of a projector's picture, or the cutoff
//! of a spot that is as bright there as within.
//!
//! A picture lies between four planes through the projector, which keep their directions. With n
//! the normal of one and w the way from the receiver to the light, F = n·w ([`Boundary::Plane`]).
//!
//! A spot's beam is a cone about the z axis of the light's own axes: with p = −w in these, the
//! border is where p_z − cos(cutoff) |p| is 0. To first order that changes as n·p with n = z −
//! cos(cutoff) p/|p|, the normal of the plane that touches the cone along p. So each point of the
//! border moves as that of this plane does.

use super::follow::{Rays, parameter_of, surface};
use super::receiver::Receiver;
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::boundary::Boundary;
use crate::paths::boundary_sample::Shadow;
use crate::paths::counts::Counts;
use crate::scene::{BeamProfile, DeltaLight, DeltaLightKind};
use glam::{DMat3, DVec3, Vec3};

/// Where the beam of a light ends.
pub struct Rim {
    position: DVec3,
    shape: Shape,
}

enum Shape {
    /// Planes, by their inward normals in the world's axes.
    Picture([DVec3; 4]),
    Cone(Cone),
}

struct Cone {
    /// May scale, so that the cone of the light's own axes is another in the world's.
    to_local: DMat3,
    cos_cutoff: f64,
}

/// Where a straight way crosses the border.
pub struct Crossing {
    pub boundary: Boundary,
    /// Part of the way.
    pub at: f64,
    /// Whether the way goes in there.
    pub goes_in: bool,
}

impl Rim {
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
        let DeltaLightKind::Point { position } = light.kind else {
            return None;
        };
        let to_world = beam.to_local.transpose();
        let shape = match beam.profile {
            BeamProfile::Projector { half_tangents, .. } => {
                let [x, y] = half_tangents.to_array();
                let local = [
                    Vec3::new(1.0, 0.0, x),
                    Vec3::new(-1.0, 0.0, x),
                    Vec3::new(0.0, 1.0, y),
                    Vec3::new(0.0, -1.0, y),
                ];
                Shape::Picture(local.map(|n| (to_world * n).as_dvec3()))
            }
            BeamProfile::Spot {
                beam_width_rad,
                cutoff_rad,
                ..
            } if beam_width_rad >= cutoff_rad => Shape::Cone(Cone {
                to_local: beam.to_local.as_dmat3(),
                cos_cutoff: f64::from(cutoff_rad).cos(),
            }),
            // It falls to zero at its cutoff.
            BeamProfile::Spot { .. } => return None,
        };
        Some(Self {
            position: position.as_dvec3(),
            shape,
        })
    }

    /// Where the way between two points crosses the border.
    pub fn crossings(&self, ends: [DVec3; 2]) -> Vec<Crossing> {
        let ends = ends.map(|x| x - self.position);
        match &self.shape {
            Shape::Picture(normals) => with_planes(normals, ends),
            Shape::Cone(cone) => cone.crossings(ends),
        }
    }

    /// The border near a point of it, if it is not that which it is near others.
    pub fn touching(&self, x: DVec3) -> Option<Boundary> {
        match &self.shape {
            Shape::Picture(_) => None,
            Shape::Cone(cone) => {
                let p = cone.to_local * (x - self.position);
                Some(Boundary::Plane(cone.normal(p)))
            }
        }
    }
}

impl Cone {
    /// Inward in the world's axes, of the plane that touches it along `p` in its own.
    fn normal(&self, p: DVec3) -> DVec3 {
        self.to_local.transpose() * (DVec3::Z - p.normalize() * self.cos_cutoff)
    }

    /// z² = cos² p² along p = from + t along, before the light: cutoffs are below 90 degrees.
    fn crossings(&self, ends: [DVec3; 2]) -> Vec<Crossing> {
        let [from, to] = ends.map(|p| self.to_local * p);
        let along = to - from;
        let square = self.cos_cutoff * self.cos_cutoff;
        let form = |p: DVec3, q: DVec3| p.z * q.z - square * p.dot(q);
        let (a, b, c) = (form(along, along), form(along, from), form(from, from));
        let discriminant = b * b - a * c;
        if discriminant <= 0.0 {
            return Vec::new();
        }
        // Neither root takes the difference of nearly equal numbers.
        let sum = -(b + discriminant.sqrt().copysign(b));
        let crossing = |at: f64| {
            let p = from + along * at;
            let normal = self.normal(p);
            let is_there = (0.0..1.0).contains(&at) && p.z > 0.0;
            is_there.then_some(Crossing {
                boundary: Boundary::Plane(normal),
                at,
                goes_in: normal.dot(ends[1] - ends[0]) > 0.0,
            })
        };
        [sum / a, c / sum]
            .into_iter()
            .filter_map(crossing)
            .collect()
    }
}

fn with_planes(normals: &[DVec3; 4], ends: [DVec3; 2]) -> Vec<Crossing> {
    let [a, b] = ends.map(|p| normals.map(|n| n.dot(p)));
    let is_within =
        |plane: usize, at: f64| (0..4).all(|p| p == plane || a[p] + (b[p] - a[p]) * at > 0.0);
    let crossing = |plane: usize| {
        let (before, after) = (a[plane], b[plane]);
        let at = before / (before - after);
        let crosses = (before > 0.0) != (after > 0.0) && is_within(plane, at);
        crosses.then_some(Crossing {
            boundary: Boundary::Plane(normals[plane]),
            at,
            goes_in: after > 0.0,
        })
    };
    (0..4).filter_map(crossing).collect()
}

/// Where the border lies on what rays see.
pub struct OnSurface {
    /// Parameter of the arc.
    pub s: f64,
    pub boundary: Boundary,
    pub shadow: Shadow,
    pub goes_in: bool,
}

/// Up to which parameter the surface is seen that the first ray meets, and the borders of beams
/// on it that the light reaches and that move: if its light or the surface does, or where `drifts`
/// says so of a parameter.
pub fn on_surface<F: Fn(f64) -> u32>(
    scene: &SearchScene,
    rims: &[(usize, Rim)],
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
        for (light, rim) in rims {
            let receiver = Receiver::new(scene, *light, facet.triangle);
            let shines_anew = scene.moving.shines_anew(geometry, *light, facet.triangle);
            let ends = ends.map(|d| receiver.point(arc.origin, d));
            for crossing in rim.crossings(ends) {
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
