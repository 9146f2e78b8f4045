//! What a scene is once it is loaded: plain data, no file in sight.

use glam::{Affine2, Affine3A, Vec2, Vec3};

/// Linear RGB radiance or reflectance.
pub type Rgb = [f32; 3];

/// A loaded scene. Indices (`material`, `emitter`) point into its own vectors.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Shapes in the order of the file.
    pub meshes: Vec<Mesh>,
    pub materials: Vec<Material>,
    /// Everything that has a colour: slots of materials and emitters point here.
    pub textures: Vec<Texture>,
    /// Area emitters, in the order of their shapes.
    pub area_lights: Vec<AreaLight>,
    /// Delta lights, in the order of the file.
    pub delta_lights: Vec<DeltaLight>,
    /// The `constant` or `envmap` environment, if the scene has one.
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
    /// Texture coordinates, one a vertex; empty if the mesh has none.
    pub uvs: Vec<Vec2>,
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
    /// Unit vertex normals read from the file: data of their own, which rigid motions carry along
    /// and which `vertex_positions` leaves alone. One a vertex.
    Given(Vec<Vec3>),
    /// Unit vertex normals computed from the positions (angle-weighted), so that they move with
    /// them. One a vertex; the values at the present positions.
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

/// How a surface reflects and transmits. Only what a scene here needs.
#[derive(Clone, Debug)]
pub struct Material {
    /// The key under which `params` lists it (`<id>` or `<shape id>.bsdf`).
    pub key: String,
    pub bsdf: Bsdf,
    /// Reflects on both sides (`twosided`); otherwise the back is black. Means nothing to those
    /// that transmit.
    pub two_sided: bool,
}

/// Plugins of Mitsuba 3, with its conventions. Colours and roughnesses are indices into
/// [`Scene::textures`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bsdf {
    Diffuse {
        reflectance: usize,
    },
    Conductor {
        /// Real and imaginary index of refraction, in RGB. A mirror of reflectance 1 has η = 0, k =
        /// 1.
        eta: usize,
        k: usize,
        specular_reflectance: usize,
        microfacets: Option<Microfacets>,
    },
    Dielectric {
        /// Index inside over index outside (a texture of one channel).
        eta: usize,
        specular_reflectance: usize,
        specular_transmittance: usize,
        microfacets: Option<Microfacets>,
    },
    Plastic {
        eta: usize,
        diffuse_reflectance: usize,
        specular_reflectance: usize,
        /// Colours shift with the number of internal reflections.
        nonlinear: bool,
        microfacets: Option<Microfacets>,
    },
    /// Lets everything through.
    Null,
}

/// A rough interface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Microfacets {
    pub distribution: Distribution,
    /// Roughness: a texture of one channel.
    pub alpha: usize,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Distribution {
    Beckmann,
    Ggx,
}

/// A colour or a number over a surface.
#[derive(Clone, Debug)]
pub struct Texture {
    /// Of the slot that uses it first, such as `floor.bsdf.reflectance`: `params` lists
    /// `<key>.value` and so on.
    pub key: String,
    /// All its numbers: one for a constant, two for a checkerboard, row by row for a bitmap. Those
    /// of one channel hold it three times.
    pub texels: Vec<Rgb>,
    pub layout: Layout,
    /// 3, or 1 for roughnesses and indices of refraction.
    pub channels: usize,
    /// The smallest and largest values that make sense.
    pub limits: [f32; 2],
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Layout {
    Constant,
    /// The first texel where both coordinates, after `to_uv`, are in the same half of the unit,
    /// else the second.
    Checkerboard {
        to_uv: Affine2,
    },
    Bitmap {
        width: u32,
        height: u32,
        wrap: Wrap,
        /// Between texels; otherwise the nearest one counts.
        bilinear: bool,
        to_uv: Affine2,
    },
}

impl Layout {
    /// What happens to texture coordinates first, unless they do not matter.
    pub fn to_uv(&self) -> Option<Affine2> {
        match *self {
            Layout::Constant => None,
            Layout::Checkerboard { to_uv } | Layout::Bitmap { to_uv, .. } => Some(to_uv),
        }
    }

    /// The same, to be changed.
    pub fn to_uv_mut(&mut self) -> Option<&mut Affine2> {
        match self {
            Layout::Constant => None,
            Layout::Checkerboard { to_uv } | Layout::Bitmap { to_uv, .. } => Some(to_uv),
        }
    }
}

/// What a bitmap is outside the unit square.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wrap {
    Repeat,
    Mirror,
    Clamp,
}

/// Diffuse emission of a mesh, on the side its normals point to.
#[derive(Clone, Debug)]
pub struct AreaLight {
    pub mesh: usize,
    /// Index into [`Scene::textures`].
    pub radiance: usize,
    pub key: String,
}

/// A light whose shadows are sharp.
#[derive(Clone, Debug)]
pub struct DeltaLight {
    pub key: String,
    pub kind: DeltaLightKind,
    /// Index into [`Scene::textures`]: intensity (W/sr) of a point, irradiance across the beam of a
    /// directional light.
    pub power: usize,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DeltaLightKind {
    Point {
        position: Vec3,
    },
    /// The unit direction in which the light travels.
    Directional {
        direction: Vec3,
    },
}

/// Radiance from all directions.
#[derive(Clone, Debug)]
pub struct Environment {
    pub key: String,
    /// Index into [`Scene::textures`]: a constant, or a latitude-longitude bitmap if there is a
    /// `map`.
    pub radiance: usize,
    pub map: Option<EnvironmentMap>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnvironmentMap {
    /// From the map's own axes (+y is up) to the world's.
    pub to_world: glam::Mat3,
    /// Multiplies the texels.
    pub scale: f32,
}

impl Scene {
    /// The colour of a texture that is constant (the first texel of others).
    pub fn constant(&self, texture: usize) -> Rgb {
        self.textures[texture].texels[0]
    }
}

impl Texture {
    /// A texture of one colour.
    pub fn constant(key: String, value: Rgb) -> Self {
        Self {
            key,
            texels: vec![value],
            layout: Layout::Constant,
            channels: 3,
            limits: [0.0, f32::INFINITY],
        }
    }

    /// Whether it varies over a surface, which then needs texture coordinates.
    pub fn varies(&self) -> bool {
        self.layout != Layout::Constant
    }

    /// Which texel is `color0` (or `color1`, if `number` is 1) of a checkerboard. Mitsuba exchanges
    /// the two where a checkerboard stands for a number, such as a roughness.
    pub fn checkerboard_texel(&self, number: usize) -> usize {
        if self.channels == 1 {
            1 - number
        } else {
            number
        }
    }
}

impl Bsdf {
    /// The texture of its main colour.
    pub fn colour(&self) -> Option<usize> {
        match *self {
            Bsdf::Diffuse { reflectance } => Some(reflectance),
            Bsdf::Conductor {
                specular_reflectance,
                ..
            }
            | Bsdf::Dielectric {
                specular_reflectance,
                ..
            } => Some(specular_reflectance),
            Bsdf::Plastic {
                diffuse_reflectance,
                ..
            } => Some(diffuse_reflectance),
            Bsdf::Null => None,
        }
    }

    /// The slots that hold a texture, under Mitsuba's names.
    pub fn slots(&self) -> Vec<(&'static str, usize)> {
        let (mut slots, microfacets) = match *self {
            Bsdf::Diffuse { reflectance } => (vec![("reflectance", reflectance)], None),
            Bsdf::Conductor {
                eta,
                k,
                specular_reflectance,
                microfacets,
            } => (
                vec![
                    ("eta", eta),
                    ("k", k),
                    ("specular_reflectance", specular_reflectance),
                ],
                microfacets,
            ),
            Bsdf::Dielectric {
                eta,
                specular_reflectance,
                specular_transmittance,
                microfacets,
            } => (
                vec![
                    ("eta", eta),
                    ("specular_reflectance", specular_reflectance),
                    ("specular_transmittance", specular_transmittance),
                ],
                microfacets,
            ),
            Bsdf::Plastic {
                eta,
                diffuse_reflectance,
                specular_reflectance,
                microfacets,
                ..
            } => (
                vec![
                    ("eta", eta),
                    ("diffuse_reflectance", diffuse_reflectance),
                    ("specular_reflectance", specular_reflectance),
                ],
                microfacets,
            ),
            Bsdf::Null => (Vec::new(), None),
        };
        slots.extend(microfacets.map(|m| ("alpha", m.alpha)));
        slots
    }

    /// The textures of its slots.
    pub fn textures(&self) -> Vec<usize> {
        self.slots().into_iter().map(|slot| slot.1).collect()
    }
}

/// A perspective camera with its film.
#[derive(Clone, Debug)]
pub struct Sensor {
    pub id: String,
    /// Camera to world: looks along +z, +x is left in the image, +y up (Mitsuba's convention).
    /// Rigid.
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
