//! The ends of short edges become one point.

use super::soup::Soup;
use glam::DVec3;
use std::collections::BTreeSet;

const PASSES: usize = 12;

/// Collapses edges until none within the surface is shorter than `shortest`, but where that made
/// one longer than `longest`, turned a triangle over, or changed what hangs together.
pub fn collapse(soup: &mut Soup, shortest: f64, longest: f64) {
    for _ in 0..PASSES {
        let edges = soup.edges();
        let border = soup.on_border(&edges);
        let around = soup.around();
        let mut short: Vec<(usize, usize)> = edges
            .keys()
            .filter(|edge| soup.length(**edge) < shortest)
            .filter(|(a, b)| !border[*a] && !border[*b])
            .copied()
            .collect();
        short.sort_by(|a, b| soup.length(*a).total_cmp(&soup.length(*b)).then(a.cmp(b)));
        let mut touched = vec![false; soup.points.len()];
        let mut gone: BTreeSet<usize> = BTreeSet::new();
        for (a, b) in short {
            let ring: BTreeSet<usize> = [a, b]
                .iter()
                .flat_map(|&p| around[p].iter().flat_map(|&t| soup.triangles[t]))
                .collect();
            if ring.iter().any(|&p| touched[p]) {
                continue;
            }
            let middle = 0.5 * (soup.points[a] + soup.points[b]);
            if !is_safe(soup, &around, (a, b), middle, longest) {
                continue;
            }
            touch(&mut touched, ring);
            soup.points[a] = middle;
            for &t in &around[b] {
                let corners = soup.triangles[t];
                match corners.contains(&a) {
                    true => drop(gone.insert(t)),
                    false => soup.triangles[t] = corners.map(|c| if c == b { a } else { c }),
                }
            }
        }
        if gone.is_empty() {
            return;
        }
        let mut number = 0;
        soup.triangles.retain(|_| {
            number += 1;
            !gone.contains(&(number - 1))
        });
    }
}

fn touch(touched: &mut [bool], points: BTreeSet<usize>) {
    for point in points {
        touched[point] = true;
    }
}

fn is_safe(
    soup: &Soup,
    around: &[Vec<usize>],
    (a, b): (usize, usize),
    middle: DVec3,
    longest: f64,
) -> bool {
    let neighbours = |p: usize| -> BTreeSet<usize> {
        let all = around[p].iter().flat_map(|&t| soup.triangles[t]);
        all.filter(|&q| q != p).collect()
    };
    let (of_a, of_b) = (neighbours(a), neighbours(b));
    // More than the two triangles' far corners in common: the surface would be pinched.
    if of_a.intersection(&of_b).count() != 2 || of_a.len() + of_b.len() < 8 {
        return false;
    }
    let others = of_a.union(&of_b).filter(|&&p| p != a && p != b);
    let fits = others
        .into_iter()
        .all(|&p| soup.points[p].distance(middle) <= longest);
    fits && [a, b].iter().all(|&end| {
        around[end].iter().all(|&t| {
            let corners = soup.triangles[t];
            if corners.contains(&a) && corners.contains(&b) {
                return true;
            }
            let [p, q, r] = corners.map(|c| if c == end { middle } else { soup.points[c] });
            let (before, after) = (soup.normal(corners), (q - p).cross(r - p));
            before.dot(after) > 0.2 * before.length() * after.length()
        })
    })
}
