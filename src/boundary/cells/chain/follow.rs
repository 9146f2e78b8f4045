//! Following the rays of a line through smooth surfaces.

use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::boundary::{Boundary, dvec3, vector};
use crate::discontinuity::pencil::Pencil;
use crate::kernels::triangle::triangle_point;
use crate::lanes::{Dual, Real, V3};
use crate::paths::boundary_sample::Shadow;
use crate::paths::chain::{AtRest, through};
use crate::paths::chain_vertex::{ChainVertex, Turn};
use crate::paths::counts::Counts;
use crate::paths::light::delta::toward;
use crate::paths::meeting::Meeting;
use crate::paths::scene_view::SceneView;
use crate::trace::geometry::NO_TRIANGLE;
use glam::DVec3;

/// The rays that chains begin with, over a line with a coordinate.
pub trait FirstRays {
    /// Where the ray of a place starts, and its direction.
    fn ray(&self, s: f64) -> (DVec3, DVec3);

    /// The chance that any of the points of the line lies between two places.
    fn chance_between(&self, places: [f64; 2]) -> f64;

    /// Of a place in the measure in which points lie at equal distances.
    fn place(&self, s: f64) -> f64;

    /// The other way round.
    fn at_place(&self, place: f64) -> f64;

    /// Whether all that is seen at a place moves against where it is seen from.
    fn moves(&self, s: f64) -> bool;

    /// From where to where rays see, in units of their directions.
    fn reach(&self) -> [f32; 2];
}

/// A ray at the end of a chain, and what it meets.
#[derive(Clone, Debug)]
pub struct Followed {
    /// The place of the first ray.
    pub s: f64,
    pub origin: DVec3,
    pub direction: DVec3,
    pub triangle: u32,
    pub chain: Vec<ChainVertex>,
    /// What radiance along the ray is multiplied with.
    pub weight: DVec3,
    /// Whether it starts on the wrong side of the triangle that bent it last.
    pub leaks: bool,
}

impl Followed {
    /// The first ray of a place, which meets this triangle.
    pub fn first(rays: &impl FirstRays, s: f64, triangle: u32) -> Self {
        let (origin, direction) = rays.ray(s);
        Self {
            s,
            origin,
            direction,
            triangle,
            chain: Vec::new(),
            weight: DVec3::ONE,
            leaks: false,
        }
    }

    /// Follows the ray of a place through surfaces that bend it so; `None` if it meets others.
    pub fn new(
        view: &SceneView,
        rays: &impl FirstRays,
        s: f64,
        bends: &[Turn],
        counts: &mut Counts,
    ) -> Option<Self> {
        let (o, d) = rays.ray(s);
        let [near, far] = rays.reach();
        counts.probe += 1;
        let triangle = view.first_hit(o.as_vec3(), d.as_vec3(), near, far);
        let first = Self::first(rays, s, triangle);
        bends
            .iter()
            .try_fold(first, |ray, &turn| ray.on(view, turn, counts))
    }

    /// What it meets.
    pub fn meeting<'v>(&self, view: &'v SceneView<'v>) -> Option<Meeting<'v>> {
        Meeting::new(view, self.origin, self.direction, self.triangle)
    }

    /// The same beyond what it meets.
    pub fn on(mut self, view: &SceneView, turn: Turn, counts: &mut Counts) -> Option<Self> {
        let meeting = self.meeting(view)?;
        let (direction, weight) = meeting.bent(turn)?;
        self.chain.push(meeting.vertex(turn));
        self.leaks = meeting.leaks(turn.bend, direction);
        self.origin = meeting.leave(direction);
        self.direction = direction;
        self.weight *= weight;
        counts.probe += 1;
        let (o, d) = (self.origin.as_vec3(), direction.as_vec3());
        self.triangle = view.first_hit(o, d, 0.0, f32::INFINITY);
        Some(self)
    }

    /// Whether the same surfaces have bent it as another ray of the line: flat facets, or meshes
    /// whose facets are shaded as one.
    pub fn is_bent_as(&self, other: &Self, view: &SceneView) -> bool {
        let geometry = view.geometry;
        let is_one = |(v, w): (&ChainVertex, &ChainVertex)| {
            let [mesh, other] =
                [v, w].map(|v| geometry.mesh_of_triangle[v.triangle as usize] as usize);
            v.triangle == w.triangle
                || (mesh == other
                    && (geometry.smooth[mesh] || geometry.coincide([v.triangle, w.triangle])))
        };
        self.chain.iter().zip(&other.chain).all(is_one)
    }

    /// F of a boundary along its ray, or along that from where it ends toward a delta light.
    pub fn side(&self, scene: &SearchScene, boundary: &Boundary, shadow: Option<Shadow>) -> f64 {
        let position = |v: u32| vector(scene.view.geometry.positions[v as usize].as_dvec3());
        let ray = (vector(self.origin), vector(self.direction));
        let (o, d) = toward_delta_light(scene.view, shadow, ray, position);
        boundary.side(o, d, position)
    }

    /// Whether a triangle's mesh bends rays without blurring them.
    pub fn is_smooth(view: &SceneView, triangle: u32) -> bool {
        triangle != NO_TRIANGLE && {
            let mesh = view.geometry.mesh_of_triangle[triangle as usize] as usize;
            view.materials.of_mesh(view.scene, mesh).kinds.in_chains() != 0
        }
    }
}

/// The rays between two.
pub fn pencil(ends: [&Followed; 2]) -> Pencil {
    Pencil {
        starts: ends.map(|end| end.origin),
        // As long as each other, so that what is between them is near the middle.
        directions: ends.map(|end| end.direction.normalize()),
    }
}

/// From where a ray meets the receiver of a shadow, toward the light; the ray itself without one.
fn toward_delta_light<F: Real<Mask = bool>>(
    view: &SceneView,
    shadow: Option<Shadow>,
    (o, d): (V3<F>, V3<F>),
    position: impl Fn(u32) -> V3<F>,
) -> (V3<F>, V3<F>) {
    let Some(Shadow { light, receiver }) = shadow else {
        return (o, d);
    };
    let [p, q, r] = view.geometry.triangles[receiver as usize].map(position);
    let y = triangle_point(o, d, p, q, r);
    (y, toward(&view.delta_lights[light as usize], y).0)
}

/// c in F = c·d for the directions d in which a chain's first ray starts at `o`: how the boundary's
/// F at its end changes with d.
pub fn normal_through(
    view: &SceneView,
    chain: &[ChainVertex],
    (boundary, shadow): (&Boundary, Option<Shadow>),
    o: DVec3,
    d: DVec3,
) -> DVec3 {
    if chain.is_empty() && shadow.is_none() {
        return boundary.normal(view.geometry, o);
    }
    let constant = |v: DVec3| {
        let [x, y, z] = v.to_array().map(Dual::<f64>::splat);
        V3 { x, y, z }
    };
    let along = |axis: DVec3| {
        let mut d = constant(d);
        (d.x.tangent, d.y.tangent, d.z.tangent) = axis.into();
        let point = |v: u32| constant(view.geometry.positions[v as usize].as_dvec3());
        let ray = through(view, chain, (constant(o), d), &AtRest(view));
        let (o, d) = toward_delta_light(view, shadow, ray, point);
        boundary.side(o, d, point).tangent
    };
    dvec3(V3 {
        x: along(DVec3::X),
        y: along(DVec3::Y),
        z: along(DVec3::Z),
    })
}
