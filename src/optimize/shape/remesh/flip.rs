//! Edges turn where that brings points nearer to six neighbours.

use super::soup::Soup;
use std::collections::BTreeSet;

const PASSES: usize = 4;
const NEIGHBOURS: i64 = 6;

/// Flips edges within the surface.
pub fn flip(soup: &mut Soup) {
    for _ in 0..PASSES {
        let edges = soup.edges();
        let mut known: BTreeSet<(usize, usize)> = edges.keys().copied().collect();
        let mut valence = vec![0i64; soup.points.len()];
        for (a, b) in edges.keys() {
            valence[*a] += 1;
            valence[*b] += 1;
        }
        let mut touched = vec![false; soup.triangles.len()];
        let mut flipped = 0;
        for (&(a, b), triangles) in &edges {
            let [first, second] = triangles[..] else {
                continue;
            };
            if touched[first] || touched[second] {
                continue;
            }
            let (c, d) = (soup.opposite(first, (a, b)), soup.opposite(second, (a, b)));
            let new = (c.min(d), c.max(d));
            if c == d || known.contains(&new) {
                continue;
            }
            let far = |p: usize, by: i64| (valence[p] + by - NEIGHBOURS).abs();
            let before = far(a, 0) + far(b, 0) + far(c, 0) + far(d, 0);
            let after = far(a, -1) + far(b, -1) + far(c, 1) + far(d, 1);
            if after >= before || valence[a] <= 3 || valence[b] <= 3 {
                continue;
            }
            // `first` runs from a to b or from b to a: the new triangles keep its sense.
            let corners = soup.triangles[first];
            let at = corners.iter().position(|&p| p == a).unwrap_or(0);
            let (from, to) = if corners[(at + 1) % 3] == b {
                (a, b)
            } else {
                (b, a)
            };
            let made = [[from, d, c], [to, c, d]];
            let [n, m] = [first, second].map(|t| soup.normal(soup.triangles[t]));
            let is_flat = made.iter().all(|&t| {
                let normal = soup.normal(t);
                let along =
                    |old: glam::DVec3| normal.dot(old) > 0.7 * normal.length() * old.length();
                along(n) && along(m)
            });
            if !is_flat {
                continue;
            }
            (soup.triangles[first], soup.triangles[second]) = (made[0], made[1]);
            (touched[first], touched[second]) = (true, true);
            known.remove(&(a, b));
            known.insert(new);
            for (p, by) in [(a, -1), (b, -1), (c, 1), (d, 1)] {
                valence[p] += by;
            }
            flipped += 1;
        }
        if flipped == 0 {
            return;
        }
    }
}
