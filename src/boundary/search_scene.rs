//! The scene as searches for boundaries see it.

use crate::boundary::clearance::{Clearance, Lit, Viewer};
use crate::boundary::surroundings::Surroundings;
use crate::discontinuity::adjacency::Adjacency;
use crate::discontinuity::boundary::Boundary;
use crate::discontinuity::crossing::{Crossing, Kind};
use crate::discontinuity::outline::Corners;
use crate::discontinuity::pieces::Pieces;
use crate::paths::at::At;
use crate::paths::lobe_drift::LobeDrift;
use crate::paths::moving::Moving;
use crate::paths::rays::lane_of;
use crate::paths::scene_view::SceneView;
use glam::DVec3;
use std::sync::OnceLock;

/// A thing is small if the sine of half the angle that it fills is less than this: it fills half a
/// cell of a line over a diffuse lobe at most.
const SMALL: f64 = 0.2;

/// What rays see, which triangles are neighbours, and what moves.
#[derive(Clone, Copy)]
pub struct SearchScene<'a> {
    pub view: &'a SceneView<'a>,
    pub adjacency: &'a Adjacency,
    pub moving: &'a Moving,
    pub lobe_drift: Option<&'a LobeDrift>,
    /// How often diffuse and wide lobes are searched, of what is usual.
    pub lines_over_lobes: f32,
    pub things: &'a Things,
}

/// What is in the scene, found out when first asked for.
#[derive(Default)]
pub struct Things {
    pieces: OnceLock<Pieces>,
    corners: OnceLock<Corners>,
    surroundings: OnceLock<Surroundings>,
    clearance: OnceLock<Clearance>,
}

impl SearchScene<'_> {
    /// What meshes consist of.
    pub fn pieces(&self) -> &Pieces {
        let find = || Pieces::new(self.view.geometry, self.adjacency);
        self.things.pieces.get_or_init(find)
    }

    /// Which triangles vertices are of.
    pub fn corners(&self) -> &Corners {
        let find = || Corners::new(self.view.geometry);
        self.things.corners.get_or_init(find)
    }

    /// What lanes may be close to.
    pub fn surroundings(&self) -> &Surroundings {
        let find = || Surroundings::new(self.view.geometry);
        self.things.surroundings.get_or_init(find)
    }

    /// Whether nothing can hide any of a lamp from a lane's vertex.
    pub fn sees_all_of(&self, at: &At, lane: usize, lit: &Lit) -> bool {
        let geometry = self.view.geometry;
        let viewer = Viewer {
            x: lane_of(at.surface.x, lane).as_dvec3(),
            normal: lane_of(at.surface.geometric, lane).as_dvec3(),
            mesh: geometry.mesh_of_triangle[at.vertices.triangle[lane] as usize],
        };
        let find = || Clearance::new(geometry, self.adjacency);
        let clearance = self.things.clearance.get_or_init(find);
        clearance.is_clear(geometry, &viewer, lit)
    }

    /// Whether a crossing is a facet edge of a surface that does nothing but bend rays. Only those
    /// jump there that shading normals send below the plane of a triangle: chains look for them.
    pub fn is_bare_facet(&self, crossing: &Crossing) -> bool {
        let (Kind::FacetEdge, Boundary::Edge([v, _])) = (crossing.kind, crossing.boundary) else {
            return false;
        };
        let SceneView {
            geometry,
            materials,
            scene,
            ..
        } = *self.view;
        let mesh = geometry.mesh_of_vertex(v) as usize;
        let kinds = materials.of_mesh(scene, mesh).kinds;
        kinds.smooth & (kinds.conductor | kinds.dielectric) != 0
    }

    /// Whether a border is that of a thing that is small as seen from `x`, so that lines mostly
    /// miss it.
    pub fn is_small(&self, border: &Boundary, x: DVec3) -> bool {
        let Boundary::Edge([v, _]) = *border else {
            return false;
        };
        let around = self.pieces().around(v);
        around.radius < SMALL * around.centre.distance(x)
    }
}
