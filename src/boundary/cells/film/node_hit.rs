//! What the film's drift looks at around a node.

/// What one of a node's rays hits.
pub struct Hit {
    pub lane: usize,
    pub triangle: u32,
    pub mesh: u32,
    /// In lengths of the ray's direction.
    pub distance: f64,
    /// Of the triangle's second and third corner.
    pub barycentrics: [f64; 2],
    pub moves: bool,
}
