//! What the film drifts with (`paths::film::drift`).
//!
//! Around each node a pilot looks at the film in a few points. Where it meets metal, glass or
//! plastic that moves the node follows what it hits of such surfaces, because their light changes
//! along them. Where it meets many things the node follows all that it hits: there are too many
//! borders to find, on the film and in what its vertices see, and they move about as the points do.
//! Before an environment map it does so everywhere if the camera moves and paths are long, since
//! the whole world rests then. Where it meets a mesh with detail that sees itself (`detail`), or
//! with fine pictures (`pictures`), or one that lies upon another (`contact`), it follows what it
//! hits of that. Elsewhere the node rests. The few borders there are found for sure, and an image's
//! noise would be worse than theirs.
//!
//! That is what mostly pays. Over a ball of smooth normals that rests on the film they turn by one
//! over the cosine at which a facet is seen, and a few facets that are seen edge-on have most of
//! the variance once samples meet them; over one of even light following has hundreds of times the
//! variance of rest. So a pilot may also try to follow all ([`Follows`]).

use super::{contact, detail, pictures};
use crate::boundary::search_scene::SearchScene;
use crate::lanes::LANES;
use crate::paths::estimator::WholeFilm;
use crate::paths::film::drift::{Drift, DriftGrid, Followed};
use crate::paths::film::node_hits::{self, Hit, NodeHits};
use crate::paths::random::Stream;
use glam::DVec3;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::mem::take;

/// What nodes follow of what they see.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Follows {
    /// That whose light slides over it by more than an image has noise, mostly.
    WhatPays,
    /// All, if any of it moves.
    All,
}

/// So many pieces, and the void among them, are many.
const MANY: usize = 3;

/// Makes the drift of a film; `None` if it rests everywhere.
pub fn find(scene: &SearchScene, film: &WholeFilm, follows: Follows) -> Option<Drift> {
    let may = follows != Follows::WhatPays || may_pay(scene);
    if !film.filter.filter.is_continuous() || !may {
        return None;
    }
    let grid = DriftGrid::new(film.lattice);
    let [columns, rows] = film.lattice.per_pixel;
    let pilot = Pilot {
        scene,
        grid: &grid,
        stream: node_hits::stream(film.seed),
        per_pixel: ((columns * rows) as f64).sqrt(),
        follows,
    };
    let nodes = grid.nodes[0] * grid.nodes[1];
    let found: Vec<Node> = (0..nodes)
        .into_par_iter()
        .map(|node| of_node(&pilot, node))
        .collect();
    let holds_sheets = found.iter().any(|node| node.holds_sheet);
    let followed: Vec<_> = found.into_iter().map(|node| node.followed).collect();
    let any = followed.iter().any(|f| !f.is_empty());
    any.then_some(Drift {
        grid,
        followed,
        holds_sheets,
    })
}

/// Whether there may be anything that pays.
fn may_pay(scene: &SearchScene) -> bool {
    let pieces = scene.pieces();
    let meshes = 0..scene.view.scene.meshes.len();
    let asks_for_detail = asks_for_detail(scene);
    let has_detail = |mesh| {
        scene.moving.moves_mesh(mesh)
            && ((asks_for_detail && pieces.may_hide_itself(mesh as u32))
                || pictures::has_any(scene.view.scene, mesh))
    };
    scene.view.materials.any_special
        || pieces.count() + 1 >= MANY
        || meshes.into_iter().any(has_detail)
        || follows_all(scene)
}

/// What nodes look with.
struct Pilot<'a> {
    scene: &'a SearchScene<'a>,
    grid: &'a DriftGrid,
    stream: Stream,
    /// Samples of a group along a pixel.
    per_pixel: f64,
    follows: Follows,
}

/// What a node follows, and whether a sheet that lies upon something is among it.
#[derive(Default)]
struct Node {
    followed: Vec<Followed>,
    holds_sheet: bool,
}

fn of_node(pilot: &Pilot, node: usize) -> Node {
    let Pilot { scene, grid, .. } = *pilot;
    if grid.is_rim(node) {
        return Node::default();
    }
    let moves = |mesh| scene.moving.moves_mesh(mesh);
    let mut seen = NodeHits::around(scene.view, &pilot.stream, (grid, node), moves);
    let hits = take(&mut seen.hits);
    let (hits, holds_sheet) = match pilot.follows {
        Follows::WhatPays => worth_following(pilot, node, &seen.directions, hits),
        Follows::All => (hits, false),
    };
    if !hits.iter().any(|h| h.moves) {
        return Node::default();
    }
    let share = 1.0 / hits.len() as f64;
    let followed = hits.iter().map(|h| seen.follow(scene.view, h, share));
    Node {
        followed: followed.collect(),
        holds_sheet,
    }
}

/// Those of a node's hits that it follows, and whether a sheet is among them.
fn worth_following(
    pilot: &Pilot,
    node: usize,
    directions: &[DVec3; LANES],
    hits: Vec<Hit>,
) -> (Vec<Hit>, bool) {
    let scene = pilot.scene;
    let materials = &scene.view.materials;
    let material = |h: &Hit| scene.view.scene.meshes[h.mesh as usize].material;
    let reflects = |h: &Hit| h.moves && materials.has_lobes(material(h));
    if hits.iter().any(reflects) {
        return (hits.into_iter().filter(reflects).collect(), false);
    }
    if follows_all(scene) || sees_many(scene, &hits) {
        return (hits, false);
    }
    let mut meshes = contact::meshes(scene, directions, &hits);
    let holds_sheet = !meshes.is_empty();
    meshes.append(&mut pictures::meshes(scene, &hits));
    if asks_for_detail(scene) {
        meshes.append(&mut detail::meshes(
            scene,
            &detail::Looks {
                stream: &pilot.stream,
                node,
                per_pixel: pilot.per_pixel,
                directions,
            },
            &hits,
        ));
    }
    let is_special = |h: &Hit| h.moves && materials.is_special(material(h));
    let is_followed = |h: &Hit| is_special(h) || meshes.contains(&h.mesh);
    (hits.into_iter().filter(is_followed).collect(), holds_sheet)
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
fn sees_many(scene: &SearchScene, hits: &[Hit]) -> bool {
    let pieces = scene.pieces();
    let piece = |hit: &Hit| {
        let triangle = scene.view.geometry.triangles[hit.triangle as usize];
        pieces.number(triangle[0])
    };
    let seen: BTreeSet<u32> = hits.iter().map(piece).collect();
    let void = usize::from(hits.len() < LANES);
    seen.len() + void >= MANY
}
