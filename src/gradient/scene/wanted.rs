//! What reverse mode is asked for.

use crate::scene::{Scene, SceneDifferential};
use crate::trace::geometry::{Geometry, NO_TRIANGLE};

/// What reverse mode is asked for: which sums are worth the work.
pub struct Wanted {
    pub mesh: Vec<bool>,
    pub camera: bool,
    /// Per texture.
    pub texels: Vec<bool>,
    pub to_uv: Vec<bool>,
    /// The environment map's rotation and scale.
    pub environment: bool,
    pub delta_lights: bool,
    /// Whether an index of refraction that bends rays is wanted.
    pub refraction_moves: bool,
}

impl Wanted {
    pub fn new(scene: &Scene, request: &SceneDifferential) -> Self {
        Self {
            mesh: request.positions.iter().map(Option::is_some).collect(),
            camera: request.camera.is_some(),
            texels: request.texels.iter().map(Option::is_some).collect(),
            to_uv: request.to_uv.iter().map(Option::is_some).collect(),
            environment: request.environment.is_some(),
            delta_lights: request.delta_lights.iter().any(Option::is_some),
            refraction_moves: request.refraction_moves(scene),
        }
    }

    /// Whether any colour is wanted.
    pub fn colours(&self) -> bool {
        self.texels.contains(&true) || self.to_uv.contains(&true)
    }

    /// Whether rays move with what is wanted, so that everything along a path does.
    pub fn attached(&self) -> bool {
        self.geometry() || self.refraction_moves
    }

    /// Whether any vertex or the camera is wanted.
    pub fn geometry(&self) -> bool {
        self.camera || self.mesh.contains(&true)
    }

    /// Vertices, normals and texels that there are sums for.
    pub(super) fn counts(&self, scene: &Scene, geometry: &Geometry) -> [usize; 3] {
        let of = |wanted: bool, count: usize| if wanted { count } else { 0 };
        let moves = self.mesh.contains(&true);
        let texels = first_texels(scene).last().map_or(0, |&n| n as usize);
        [
            of(moves, geometry.positions.len()),
            of(moves, geometry.normals.len()),
            of(self.colours(), texels),
        ]
    }

    /// Whether the mesh of a triangle is wanted.
    pub fn moves(&self, geometry: &Geometry, triangle: u32) -> bool {
        triangle != NO_TRIANGLE && self.mesh[geometry.mesh_of_triangle[triangle as usize] as usize]
    }
}

/// The number of the first texel of each texture, and of all texels.
pub(super) fn first_texels(scene: &Scene) -> Vec<u32> {
    let mut first = vec![0];
    for texture in &scene.textures {
        first.push(first[first.len() - 1] + texture.texels.len() as u32);
    }
    first
}
