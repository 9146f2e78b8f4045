//! Long edges get a point in their middle.

use super::soup::Soup;

/// Passes at most; each halves the longest edges.
const PASSES: usize = 12;

/// Splits edges until none within the surface is longer than this.
pub fn split(soup: &mut Soup, longest: f64) {
    for _ in 0..PASSES {
        let edges = soup.edges();
        let mut long: Vec<(usize, usize)> = edges
            .iter()
            .filter(|(edge, triangles)| triangles.len() == 2 && soup.length(**edge) > longest)
            .map(|(edge, _)| *edge)
            .collect();
        if long.is_empty() {
            return;
        }
        long.sort_by(|a, b| soup.length(*b).total_cmp(&soup.length(*a)).then(a.cmp(b)));
        let mut touched = vec![false; soup.triangles.len()];
        for edge in long {
            let triangles = &edges[&edge];
            if triangles.iter().any(|&t| touched[t]) {
                continue;
            }
            let middle = soup.points.len();
            let point = 0.5 * (soup.points[edge.0] + soup.points[edge.1]);
            soup.points.push(point);
            for &t in triangles {
                touched[t] = true;
                let swap = |from: usize| {
                    soup.triangles[t].map(|corner| if corner == from { middle } else { corner })
                };
                let (first, second) = (swap(edge.0), swap(edge.1));
                soup.triangles[t] = first;
                soup.triangles.push(second);
            }
        }
    }
}
