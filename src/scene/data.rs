//! What a scene is once it is loaded: plain data, no file in sight.

use glam::{Affine3A, Vec2, Vec3};

/// Linear RGB radiance or reflectance.
pub type Rgb = [f32; 3];

/// A loaded scene. Indices (`material`, `emitter`) point into its own vectors.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Shapes in the order of the file.
    pub meshes: Vec<Mesh>,
    pub materials: Vec<Material>,
    /// Area emitters, in the order of their shapes.
    pub area_lights: Vec<AreaLight>,
    /// The `constant` environment, if the scene has one.
    pub environment: Option<Environment>,
    /// At least one.
    pub sensors: Vec<Sensor>,
    pub integrator: Integrator,
    /// Non-fatal remarks met while loading (unread properties, dropped zero-area faces, …).
    pub warnings: Vec<String>,
    /// FNV-1a 64 of every file read, after substitution, in reading order.
    pub hash: u64,
}

/// A triangle mesh in world space.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// As in the file, or Mitsuba's default name.
    pub id: String,
    /// World space, already transformed.
    pub positions: Vec<Vec3>,
    /// Counter-clockwise seen from outside, `flip_normals` already applied.
    pub triangles: Vec<[u32; 3]>,
    pub normals: Normals,
    /// Index into [`Scene::materials`].
    pub material: usize,
    /// Index into [`Scene::area_lights`].
    pub area_light: Option<usize>,
}

/// How a mesh is shaded.
#[derive(Clone, Debug, Default)]
pub enum Normals {
    /// One geometric normal a triangle.
    #[default]
    Flat,
    /// Unit vertex normals read from the file: data of their own, which rigid motions carry along and
    /// which `vertex_positions` leaves alone. One a vertex.
    Given(Vec<Vec3>),
    /// Unit vertex normals computed from the positions (angle-weighted), so that they move with them.
    /// One a vertex; the values at the present positions.
    Computed(Vec<Vec3>),
}

impl Normals {
    /// The unit normal of each vertex, if shading is smooth.
    pub fn vertex(&self) -> Option<&[Vec3]> {
        match self {
            Normals::Flat => None,
            Normals::Given(n) | Normals::Computed(n) => Some(n),
        }
    }
}

/// A surface's reflection. Only what a scene here needs.
#[derive(Clone, Debug)]
pub struct Material {
    /// The key under which `params` lists it (`<id>` or `<shape id>.bsdf`).
    pub key: String,
    pub reflectance: Rgb,
    /// Reflects on both sides (`twosided`); otherwise the back is black.
    pub two_sided: bool,
}

/// Diffuse emission of a mesh, on the side its normals point to.
#[derive(Clone, Debug)]
pub struct AreaLight {
    pub mesh: usize,
    pub radiance: Rgb,
    pub key: String,
}

/// Constant radiance from every direction.
#[derive(Clone, Debug)]
pub struct Environment {
    pub key: String,
    pub radiance: Rgb,
}

/// A perspective camera with its film.
#[derive(Clone, Debug)]
pub struct Sensor {
    pub id: String,
    /// Camera to world: looks along +z, +x is left in the image, +y up (Mitsuba's convention). Rigid.
    pub to_world: Affine3A,
    /// Horizontal opening angle in radians, whatever `fov_axis` the file used.
    pub x_fov_rad: f32,
    pub near_clip: f32,
    pub far_clip: f32,
    /// Shift of the principal point as a fraction of the film's width and height.
    pub principal_point_offset: Vec2,
    pub film: Film,
    pub sample_count: u32,
    pub seed: u32,
}

#[derive(Clone, Debug)]
pub struct Film {
    /// Full size in pixels, before cropping.
    pub width: u32,
    pub height: u32,
    /// Offset and size of the crop window, in pixels: the image that is written.
    pub crop_offset: [u32; 2],
    pub crop_size: [u32; 2],
    pub filter: Filter,
    /// Also sample the filter's border around the film.
    pub sample_border: bool,
}

/// Film reconstruction filters; lengths in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Filter {
    Box {
        radius: f32,
    },
    Tent {
        radius: f32,
    },
    /// exp(−x²/2σ²) − exp(−r²/2σ²), r = 4σ.
    Gaussian {
        stddev: f32,
    },
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Integrator {
    /// Longest path in segments; `u32::MAX` for Mitsuba's −1.
    pub max_depth: u32,
    /// First segment at which russian roulette may end a path.
    pub rr_depth: u32,
    /// Emitters seen directly by the camera are black.
    pub hide_emitters: bool,
}
