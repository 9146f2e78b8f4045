//! Where what the rays of a line see changes.

use super::follow::{FirstRays, Followed, pencil};
use super::search::{Border, ChainSearch, Cut, Cuts, Found, Near, Way};
use crate::boundary::search_scene::SearchScene;
use crate::discontinuity::between::{HALVINGS, Unresolved};
use crate::discontinuity::boundary::Boundary;
use crate::discontinuity::crossing::Crossing;
use crate::discontinuity::pencil::{Between, between};
use crate::paths::chain_vertex::ChainVertex;
use crate::paths::scene_view::SceneView;

/// Cuts behind one another that are looked for in one part of an interval.
const ROUNDS: u32 = 6;
/// Parts of one interval that are looked at behind so many smooth surfaces. Where mirrors face each
/// other all parts differ from their neighbours, and each would be halved to the end.
fn most_parts(surfaces: usize) -> u32 {
    match surfaces {
        0 | 1 => 96,
        2 => 48,
        _ => 24,
    }
}

/// Facets of one smooth surface that are told apart in one interval.
const MOST_FACETS: usize = 16;

impl<R: FirstRays> ChainSearch<'_, R> {
    /// Where what is seen between two rays changes.
    // Long: one loop over parts of an interval, of which every step may end one or begin others.
    pub(super) fn cuts(&mut self, ends: [&Followed; 2], way: &Way, out: &mut Cuts) {
        let SearchScene {
            view, adjacency, ..
        } = *self.scene;
        let mut parts = vec![(ends.map(Followed::clone), ROUNDS, HALVINGS)];
        let mut looked_at = 0;
        while let Some(([a, b], rounds, halvings)) = parts.pop() {
            if looked_at == most_parts(way.bends.len()) {
                self.counts.unresolved += parts.len() as u64 + 1;
                break;
            }
            looked_at += 1;
            let seen = [a.triangle, b.triangle];
            if a.s >= b.s {
                continue;
            }
            if !a.is_bent_as(&b, view) {
                let places = [b.s, a.s];
                let around = self.around([a, b], places, way, out);
                parts.extend(around.map(|p| (p, rounds, halvings)));
                continue;
            }
            if a.leaks != b.leaks {
                if rounds == 0 {
                    continue;
                }
                let (crossing, border) = match self.own_plane([&a, &b], way) {
                    Ok(found) => found,
                    Err(Some(hidden)) if halvings > 0 => {
                        let around = self.around([a, b], [hidden; 2], way, out);
                        parts.extend(around.map(|p| (p, rounds, halvings - 1)));
                        continue;
                    }
                    Err(_) => {
                        self.counts.unresolved += 1;
                        continue;
                    }
                };
                let [before, after] = border.sides.clone();
                parts.push(([a, before.clone()], rounds - 1, HALVINGS));
                parts.push(([after.clone(), b], rounds - 1, HALVINGS));
                out.cuts.push(Cut {
                    border: self.kept(&crossing, border, 1.0, way),
                    sides: [before, after],
                    near: Near::OwnPlane,
                });
                continue;
            }
            // On the first surface what searches there finds them, unless they cut what lies
            // behind.
            let has_lines = view.geometry.has_texture_edges(seen[0])
                && (!way.bends.is_empty() || bends_otherwise(view, seen[0]));
            if seen[0] == seen[1] && !has_lines {
                continue;
            }
            let rays = pencil([&a, &b]);
            let between = between(view.geometry, adjacency, &rays, seen);
            if let Err(why @ Unresolved::Coincident) = between {
                self.counts.miss(why);
                out.cuts.push(Cut::unseen([a, b]));
                continue;
            }
            let border = between.ok().and_then(|Between { silhouette, ridges }| {
                let Some((crossing, near)) = silhouette else {
                    return Some((None, ridges));
                };
                let border = self.border([&a, &b], &crossing, way)?;
                Some((Some((border, crossing, near)), ridges))
            });
            let Some((border, ridges)) = border else {
                if halvings == 0 {
                    // What is seen first is looked for there, too. And where the starts pass
                    // through what is seen, that meets what bends the rays: a border of what they
                    // see before.
                    let is_known = way.bends.is_empty() || rays.starts_pass(view.geometry, seen);
                    self.counts.unresolved += u64::from(!is_known);
                    out.cuts.push(Cut::unseen([a, b]));
                    continue;
                }
                let middle = 0.5 * (a.s + b.s);
                match Followed::new(view, self.rays, middle, &way.bends, self.counts) {
                    Some(m) if ends.iter().any(|end| end.is_bent_as(&m, view)) => {
                        parts.push(([m.clone(), b], rounds, halvings - 1));
                        parts.push(([a, m], rounds, halvings - 1));
                    }
                    _ => {
                        let around = self.around([a, b], [middle; 2], way, out);
                        parts.extend(around.map(|p| (p, rounds, halvings - 1)));
                    }
                }
                continue;
            };
            let Some((border, crossing, near)) = border else {
                self.ridges([&a, &b], ridges, way, out);
                continue;
            };
            let [before, after] = border.sides.clone();
            if rounds > 0 {
                // These find the edges on either side of it.
                parts.push(([a, before.clone()], rounds - 1, HALVINGS));
                parts.push(([after.clone(), b], rounds - 1, HALVINGS));
            } else {
                self.ridges([&a, &b], ridges, way, out);
            }
            if before.triangle != after.triangle {
                let near = match near {
                    Some(0) => Near::Before,
                    Some(_) => Near::After,
                    None => Near::None,
                };
                out.cuts.push(Cut {
                    border: self.kept(&crossing, border, 1.0, way),
                    sides: [before, after],
                    near,
                });
            }
        }
    }

    /// Edges within what is seen: smooth surfaces are cut there; of others one stands for all.
    fn ridges(
        &mut self,
        ends: [&Followed; 2],
        mut ridges: Vec<Crossing>,
        way: &Way,
        out: &mut Cuts,
    ) {
        let view = self.scene.view;
        let is_smooth = Followed::is_smooth(view, ends[0].triangle);
        if ridges.is_empty() || (!is_smooth && way.bends.is_empty()) {
            return;
        }
        let mut count = 1.0;
        if is_smooth {
            ridges.truncate(MOST_FACETS);
        } else {
            count = ridges.len() as f64;
            let chosen = ((self.draw() * count) as usize).min(ridges.len() - 1);
            ridges = vec![ridges[chosen]];
        }
        for crossing in ridges {
            let Some(border) = self.border(ends, &crossing, way) else {
                continue;
            };
            let sides = border.sides.clone();
            if !crossing.is_hidden([0, 1].map(|i| sides[i].triangle)) {
                let border = self.kept(&crossing, border, count, way);
                let is_texture = matches!(crossing.boundary, Boundary::TextureEdge { .. });
                if is_smooth && (!is_texture || bends_otherwise(view, sides[0].triangle)) {
                    out.cuts.push(Cut {
                        sides,
                        near: Near::None,
                        border,
                    });
                } else {
                    out.ridges.extend(border);
                }
            }
        }
    }

    /// A border, if something moves there and it is seen through a chain.
    fn kept(&self, crossing: &Crossing, border: Border, count: f64, way: &Way) -> Option<Found> {
        let SearchScene { view, moving, .. } = *self.scene;
        let Border { at, sides } = border;
        let geometry = view.geometry;
        let first = |v: &ChainVertex| geometry.triangles[v.triangle as usize][0];
        let beside = [0, 1].map(|i| sides[i].triangle);
        let boundary = crossing.boundary.standing(geometry, beside);
        let moves = self.rays.moves(at.s)
            || moving.boundary(geometry, &boundary)
            || at.chain.iter().any(|v| moving.vertex(geometry, first(v)));
        (!way.bends.is_empty() && moves).then(|| Found {
            s: at.s,
            boundary,
            shadow: None,
            weight: at.weight * (way.inverse_chance * count),
            chain: at.chain,
            bends: way.bends.len(),
            sides: sides.map(|side| (side.origin, side.direction)),
        })
    }
}

/// Whether rays are bent otherwise beyond a line of a picture on a triangle.
fn bends_otherwise(view: &SceneView, triangle: u32) -> bool {
    Followed::is_smooth(view, triangle) && view.geometry.has_turned_normals(triangle)
}
