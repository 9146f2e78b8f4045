//! What the film drifts with (`paths::film::drift`).
//!
//! Around each node a pilot looks at the film in a few points. Where it meets metal, glass or plastic
//! the node follows what it hits of such surfaces, because their light changes along them. Where it
//! meets many things the node follows all that it hits: there are too many borders to find, on the
//! film and in what its vertices see, and they move about as the points do. Before an environment map
//! it does so everywhere if the camera moves and paths are long, since the whole world rests then.
//! Where it meets a mesh with detail that sees itself (`detail`), it follows what it hits of that.
//! Elsewhere the node rests. The few borders there are found for sure, and an image's noise would be
//! worse than theirs.

use super::detail;
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::boundary::{dvec3, vector};
use crate::kernels::triangle::triangle_hit;
use crate::lanes::LANES;
use crate::paths::dimensions::Single;
use crate::paths::estimator::WholeFilm;
use crate::paths::film::drift::{Drift, DriftGrid, Followed};
use crate::paths::random::Stream;
use crate::paths::rays::from_lanes;
use crate::trace::Coherence;
use crate::trace::geometry::NO_TRIANGLE;
use rayon::prelude::*;
use std::collections::BTreeSet;

/// The pilot has a group to itself.
const GROUP: u32 = u32::MAX;

/// So many pieces, and the void among them, are many.
const MANY: usize = 3;

/// Makes the drift of a film; `None` if it rests everywhere.
pub fn find(scene: &SearchScene, film: &WholeFilm) -> Option<Drift> {
    let pieces = scene.pieces();
    let meshes = 0..scene.view.scene.meshes.len();
    let may_hide = |mesh| scene.moving.moves_mesh(mesh) && pieces.may_hide_itself(mesh as u32);
    let may = scene.view.materials.any_special
        || pieces.count() + 1 >= MANY
        || (asks_for_detail(scene) && meshes.into_iter().any(may_hide))
        || follows_all(scene);
    if !film.filter.is_continuous() || !may {
        return None;
    }
    let grid = DriftGrid::new(film.lattice);
    let [columns, rows] = film.lattice.per_pixel;
    let pilot = Pilot {
        scene,
        grid: &grid,
        stream: Stream::new(film.seed, [GROUP, 0]),
        per_pixel: ((columns * rows) as f64).sqrt(),
    };
    let nodes = grid.nodes[0] * grid.nodes[1];
    let followed: Vec<Vec<Followed>> = (0..nodes)
        .into_par_iter()
        .map(|node| followed(&pilot, node))
        .collect();
    let any = followed.iter().any(|f| !f.is_empty());
    any.then_some(Drift { grid, followed })
}

/// What nodes look with.
struct Pilot<'a> {
    scene: &'a SearchScene<'a>,
    grid: &'a DriftGrid,
    stream: Stream,
    /// Samples of a group along a pixel.
    per_pixel: f64,
}

/// What a node follows.
fn followed(pilot: &Pilot, node: usize) -> Vec<Followed> {
    let Pilot {
        scene,
        grid,
        ref stream,
        per_pixel,
    } = *pilot;
    if grid.is_rim(node) {
        return Vec::new();
    }
    let SearchScene { view, moving, .. } = *scene;
    let camera = &view.camera;
    let middle = grid.position(node);
    let points: [[f64; 2]; LANES] = std::array::from_fn(|point| {
        [0, 1].map(|i| {
            let name = [node as u32, point as u32, i as u32];
            let random = f64::from(stream.single(Single::DriftPoint, name));
            middle[i] + (2.0 * random - 1.0) * grid.spacing[i]
        })
    });
    let directions = points.map(|[u, v]| dvec3(camera.direction(u, v)));
    let rays = camera.rays(
        from_lanes(&directions.map(|d| d.as_vec3())),
        u32::MAX >> (32 - LANES),
    );
    let geometry = view.geometry;
    let seen = view.intersect(&rays, Coherence::Coherent);
    let sees_many = follows_all(scene) || sees_many(scene, &seen);
    let mesh = |l: usize| geometry.mesh_of_triangle[seen[l] as usize];
    let moves = |&l: &usize| moving.moves_mesh(mesh(l) as usize);
    let hit: Vec<usize> = (0..LANES).filter(|&l| seen[l] != NO_TRIANGLE).collect();
    let may_hide = |l: &&usize| moves(l) && scene.pieces().may_hide_itself(mesh(**l));
    let detailed = if sees_many || !asks_for_detail(scene) {
        BTreeSet::new()
    } else {
        let asked = detail::Seen {
            node,
            per_pixel,
            directions: &directions,
            triangles: &seen,
            lanes: hit.iter().filter(may_hide).fold(0, |b, l| b | 1 << l),
        };
        detail::meshes(scene, stream, &asked)
    };
    let is_followed =
        |&l: &usize| sees_many || is_special(scene, seen[l]) || detailed.contains(&mesh(l));
    let lanes: Vec<usize> = hit.into_iter().filter(is_followed).collect();
    if !lanes.iter().any(moves) {
        return Vec::new();
    }
    let share = 1.0 / lanes.len() as f64;
    let follow = |&l: &usize| {
        let triangle = geometry.triangles[seen[l] as usize];
        let [v0, v1, v2] = triangle.map(|v| vector(geometry.positions[v as usize].as_dvec3()));
        let origin = vector(camera.origin.as_dvec3());
        let (_, b1, b2) = triangle_hit(origin, vector(directions[l]), v0, v1, v2);
        Followed {
            triangle,
            barycentrics: [1.0 - b1 - b2, b1, b2],
            at: points[l],
            share,
        }
    };
    let all = lanes.iter().map(follow);
    all.filter(|f| f.barycentrics.iter().all(|b| b.is_finite()))
        .collect()
}

/// Whether all nodes follow all that they hit.
fn follows_all(scene: &SearchScene) -> bool {
    let view = scene.view;
    let is_long = view.limits.max_depth > 2;
    is_long && view.map_distribution.is_some() && scene.moving.camera_lanes() != 0
}

/// Whether detail is followed: of an even sky alone, which paths of two segments see, lines bring
/// less noise than an image has.
fn asks_for_detail(scene: &SearchScene) -> bool {
    let view = scene.view;
    let is_lit = !view.lights.is_empty() || !view.delta_lights.is_empty();
    view.limits.max_depth > 2 || is_lit || view.map_distribution.is_some()
}

/// Whether these are of many pieces.
fn sees_many(scene: &SearchScene, triangles: &[u32; LANES]) -> bool {
    let pieces = scene.pieces();
    let piece = |&triangle: &u32| {
        let triangle = scene.view.geometry.triangles.get(triangle as usize);
        triangle.map(|t| pieces.number(t[0]))
    };
    triangles.iter().map(piece).collect::<BTreeSet<_>>().len() >= MANY
}

fn is_special(scene: &SearchScene, triangle: u32) -> bool {
    let view = scene.view;
    let mesh = view.geometry.mesh_of_triangle[triangle as usize] as usize;
    view.materials.is_special(view.scene.meshes[mesh].material)
}
