//! What goes wrong with meshes whose vertices move one by one: faces that turn over.

use crate::optimize::problem::Problem;
use glam::DVec3;

/// Faces whose normals point the other way after a step than before it, of all meshes that move
/// vertex by vertex.
pub fn inverted(problem: &Problem, before: &[Vec<f32>], after: &[Vec<f32>]) -> u64 {
    let mut count = 0;
    for (i, variable) in problem.variables.iter().enumerate() {
        if let Some(m) = variable.mesh() {
            let triangles = &problem.base.scene.meshes[m].triangles;
            count += turned(triangles, &before[i], &after[i]);
        }
    }
    count
}

fn turned(triangles: &[[u32; 3]], before: &[f32], after: &[f32]) -> u64 {
    let turned = triangles.iter().filter(|t| {
        let [a, b] = [before, after].map(|numbers| normal(t, numbers));
        a.dot(b) < 0.0 || b == DVec3::ZERO
    });
    turned.count() as u64
}

/// Along the normal, twice as long as the face is large.
fn normal(triangle: &[u32; 3], numbers: &[f32]) -> DVec3 {
    let [a, b, c] = triangle.map(|i| {
        let at = 3 * i as usize;
        DVec3::new(
            numbers[at].into(),
            numbers[at + 1].into(),
            numbers[at + 2].into(),
        )
    });
    (b - a).cross(c - a)
}

#[cfg(test)]
mod tests {
    use super::turned;

    #[test]
    fn a_face_that_turns_over_is_seen() {
        let before = [0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0];
        let mut after = before;
        assert_eq!(turned(&[[0, 1, 2]], &before, &after), 0);
        after[7] = -1.0;
        assert_eq!(turned(&[[0, 1, 2]], &before, &after), 1);
        after[7] = 0.0;
        assert_eq!(turned(&[[0, 1, 2]], &before, &after), 1);
    }
}
