//! Triangles on which a delta light's shadow falls.

use crate::boundary::occlusion::SurfacePoint;
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::arc::Arc;
use crate::discontinuity::boundary::{dvec3, vector};
use crate::kernels::triangle::triangle_point;
use crate::paths::counts::Counts;
use crate::paths::light::delta::toward;
use crate::paths::moving::Sector;
use crate::scene::{Bsdf, DeltaLight, DeltaLightKind};
use crate::trace::geometry::{Geometry, NO_TRIANGLE};
use glam::DVec3;

/// Where shadow rays come from.
#[derive(Clone, Copy)]
pub enum Source {
    Point(DVec3),
    /// From nowhere in particular: two directions across them.
    Parallel([DVec3; 2]),
}

impl Source {
    /// A point as walks among parallel or other rays take it (`discontinuity::walk`).
    pub fn position(&self, p: DVec3) -> DVec3 {
        match *self {
            Source::Point(source) => p - source,
            Source::Parallel([u, v]) => DVec3::new(u.dot(p), v.dot(p), 1.0),
        }
    }
}

/// The plane of a triangle, and the delta light that may shine on it.
pub struct Receiver<'a> {
    scene: &'a SearchScene<'a>,
    light: &'a DeltaLight,
    pub triangle: u32,
    corners: [DVec3; 3],
    /// Unit, as the triangle is wound.
    normal: DVec3,
}

impl<'a> Receiver<'a> {
    pub fn new(scene: &'a SearchScene<'a>, light: usize, triangle: u32) -> Self {
        let corners = corners(scene.view.geometry, triangle);
        let [p, q, r] = corners;
        Self {
            scene,
            light: &scene.view.delta_lights[light],
            triangle,
            corners,
            normal: (q - p).cross(r - p).normalize(),
        }
    }

    /// Where a ray meets its plane.
    pub fn point(&self, origin: DVec3, direction: DVec3) -> DVec3 {
        let [p, q, r] = self.corners.map(vector);
        dvec3(triangle_point(vector(origin), vector(direction), p, q, r))
    }

    /// The way from a point to the light.
    pub fn toward_light(&self, x: DVec3) -> DVec3 {
        dvec3(toward(self.light, vector(x)).0)
    }

    /// What stands nearest before the light, as seen from `x`.
    pub fn occluder(&self, x: DVec3) -> u32 {
        let (w, far) = toward(self.light, vector(x));
        self.surface_point(x)
            .first_hit(self.scene.view, dvec3(w), far)
    }

    /// Whether the light could shine on what a ray meets there, and something hides it.
    pub fn is_hidden(&self, origin: DVec3, direction: DVec3, counts: &mut Counts) -> bool {
        let x = self.point(origin, direction);
        self.is_lit(x, direction) && {
            counts.probe += 1;
            self.occluder(x) != NO_TRIANGLE
        }
    }

    /// Whether the light shines on what a ray along `direction` meets there.
    pub fn sees_light(&self, x: DVec3, direction: DVec3, counts: &mut Counts) -> bool {
        counts.probe += 1;
        self.is_lit(x, direction) && self.occluder(x) == NO_TRIANGLE
    }

    fn surface_point(&self, x: DVec3) -> SurfacePoint {
        let geometry = self.scene.view.geometry;
        SurfacePoint::new(geometry, x.as_vec3(), self.normal.as_vec3(), self.triangle)
    }

    /// Shadow rays start a little off the surface. This far, at `x`.
    pub fn lift(&self, x: DVec3) -> DVec3 {
        let point = self.surface_point(x);
        (point.leave(self.toward_light(x)) - point.x).as_dvec3()
    }

    /// Where all shadow rays come from that start beside `x`, as far off the surface as that one.
    pub fn source(&self, x: DVec3) -> Source {
        match self.light.kind {
            DeltaLightKind::Point { position } => Source::Point(position.as_dvec3() + self.lift(x)),
            DeltaLightKind::Directional { direction } => {
                let (u, v) = direction.as_dvec3().normalize().any_orthonormal_pair();
                Source::Parallel([u, v])
            }
        }
    }

    /// Whether the light shines on the side that is seen along `direction`, or on either of glass.
    pub fn is_lit(&self, x: DVec3, direction: DVec3) -> bool {
        let view = self.scene.view;
        let mesh = view.geometry.mesh_of_triangle[self.triangle as usize] as usize;
        let parts = view.scene.parts_of(view.scene.meshes[mesh].material);
        let is_glass = parts.iter().any(|&m| match view.scene.materials[m].bsdf {
            Bsdf::Dielectric { .. } => true,
            Bsdf::Principled(p) => p.transmits,
            _ => false,
        });
        is_glass || self.faces_light(x, direction)
    }

    /// Whether the side that is seen along `direction` faces the light.
    pub fn faces_light(&self, x: DVec3, direction: DVec3) -> bool {
        self.normal.dot(direction) * self.normal.dot(self.toward_light(x)) < 0.0
    }

    /// Where what hides the light from between two points lies.
    pub fn sector(&self, arc: &Arc) -> Sector {
        let [a, b] = [arc.a, arc.b].map(|d| self.point(arc.origin, d));
        let toward = self.toward_light(a);
        let up = self.normal * self.normal.dot(toward).signum();
        Sector {
            origin: a,
            normal: (b - a).cross(toward),
            inward: [up; 2],
        }
    }
}

fn corners(geometry: &Geometry, triangle: u32) -> [DVec3; 3] {
    let corners = geometry.triangles[triangle as usize];
    corners.map(|v| geometry.positions[v as usize].as_dvec3())
}
