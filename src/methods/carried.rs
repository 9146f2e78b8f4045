//! Differences of images whose samples are carried along with what they see.
//!
//! At a film point that rests every difference of images sees something else come by, where there
//! are many edges, fine pictures, or smooth surfaces that turn light far away; and it divides what
//! that changes by its step. Let T(u) = u + (θ' − θ)·V(u) map the film onto itself, for a field V
//! of velocities that vanishes at its rim. With f the radiance and h a pixel's filter,
//!
//!   ∫ h(u) f(u; θ') du = ∫ h(T(u)) f(T(u); θ') det ∇T(u) du
//!
//! for every V and every θ': the images are the same in the mean, and so are their differences. If
//! V is about the velocity of what is seen, samples see at θ' what they have seen at θ. What is
//! left is what lies before one another and moves apart, and the noise of an image whose filter
//! slides.
//!
//! V is that of the film's drift ([`crate::paths::film::drift`]), with another choice of what nodes
//! follow: whatever moves, since nothing finds borders here, and most of all what is nearest,
//! because borders belong to what lies in front.

use super::error::EngineError;
use super::prepared::Prepared;
use super::settings::Settings;
use super::stage::Stage;
use super::statistics::Statistics;
use crate::gradient::path::forward::ForwardSweep;
use crate::gradient::scene::forward::Motion;
use crate::paths::film::drift::{Drift, DriftGrid, DriftVelocity, Followed};
use crate::paths::film::node_hits::{self, Hit, NodeHits};
use crate::paths::moving::Moving;
use crate::paths::scene_view::SceneView;
use crate::scene::parameters::{Parameter, tangent};
use crate::scene::{Scene, SceneDifferential};
use rayon::prelude::*;

/// Points count by this power of how near they are.
const NEARER: i32 = 8;

/// What rests holds samples back that lies nearer than this part of the way to what moves.
const IN_FRONT: f64 = 0.9;

/// Pixels that a sample is carried at most, by the step: nodes are two pixels apart, and the
/// film must not be folded.
pub const MOST_PIXELS: f64 = 0.3;

/// Whether samples can be carried along a direction: something moves that is seen, and no pixel
/// begins with a jump.
pub fn is_possible(scene: &Scene, settings: &Settings, tangent: &SceneDifferential) -> bool {
    let sensor = &scene.sensors[settings.sensor];
    let moves = tangent.camera.is_some() || tangent.positions.iter().any(Option::is_some);
    moves && sensor.film.filter.is_continuous()
}

/// What carries the samples along a direction, if anything does.
pub fn velocity(
    base: &Prepared,
    settings: &Settings,
    direction: &[(Parameter, Vec<f32>)],
) -> Result<Option<DriftVelocity>, EngineError> {
    let scene = base.scene;
    let tangent = tangent(scene, direction, settings.sensor)?;
    if !is_possible(scene, settings, &tangent) {
        return Ok(None);
    }
    let stage = Stage::new(base, settings, None, &mut Statistics::default())?;
    let view = stage.view();
    let moving = Moving::new(scene, &stage.parts.geometry, &tangent);
    let grid = DriftGrid::new(&stage.lattice);
    let stream = node_hits::stream(settings.seed);
    let of_node = |node| {
        if grid.is_rim(node) {
            return Vec::new();
        }
        let moves = |mesh| moving.moves_mesh(mesh);
        let seen = NodeHits::around(&view, &stream, (&grid, node), moves);
        followed(&view, &seen)
    };
    let nodes = grid.nodes[0] * grid.nodes[1];
    let pool = &base.workers.pool;
    let followed: Vec<_> = pool.install(|| (0..nodes).into_par_iter().map(of_node).collect());
    if followed.iter().all(Vec::is_empty) {
        return Ok(None);
    }
    let motion = Motion::without_normals(&stage.parts.geometry, &tangent);
    let sweep = ForwardSweep::new(&view, &motion, None);
    let drift = Drift {
        grid,
        followed,
        holds_sheets: false,
    };
    Ok(Some(drift.velocity(|f| sweep.film_velocity(f))))
}

/// What a node follows.
fn followed(view: &SceneView, seen: &NodeHits) -> Vec<Followed> {
    let distance = |h: &Hit| h.distance - view.camera.reach();
    let distances = seen.hits.iter().filter(|h| h.moves).map(distance);
    let nearest = distances.fold(f64::INFINITY, f64::min);
    if nearest == f64::INFINITY {
        return Vec::new();
    }
    let counts = |h: &&Hit| h.moves || distance(h) < IN_FRONT * nearest;
    let weight = |h: &Hit| (nearest / distance(h)).powi(NEARER);
    let sum: f64 = seen.hits.iter().filter(counts).map(weight).sum();
    let hits = seen.hits.iter().filter(counts);
    hits.map(|h| seen.follow(view, h, weight(h) / sum))
        .collect()
}
