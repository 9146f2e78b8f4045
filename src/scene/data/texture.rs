//! Colours and numbers.

use glam::Affine2;

/// Linear RGB radiance or reflectance.
pub type Rgb = [f32; 3];

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
    /// A texel for each vertex of the mesh, linear between.
    Vertices,
    /// A texel for each triangle of the mesh.
    Faces,
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
            Layout::Constant | Layout::Vertices | Layout::Faces => None,
            Layout::Checkerboard { to_uv } | Layout::Bitmap { to_uv, .. } => Some(to_uv),
        }
    }

    /// The same, to be changed.
    pub fn to_uv_mut(&mut self) -> Option<&mut Affine2> {
        match self {
            Layout::Constant | Layout::Vertices | Layout::Faces => None,
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

    /// The attribute of a mesh that it is, such as `face_color`: its key is that of the shape, and
    /// this.
    pub fn attribute(&self) -> Option<&str> {
        let start = match self.layout {
            Layout::Vertices => self.key.rfind(".vertex_"),
            Layout::Faces => self.key.rfind(".face_"),
            _ => None,
        };
        start.map(|start| &self.key[start + 1..])
    }

    /// Whether it varies over a surface.
    pub fn varies(&self) -> bool {
        self.layout != Layout::Constant
    }

    /// Whether it varies over texture coordinates, which a surface needs then.
    pub fn varies_by_uv(&self) -> bool {
        !matches!(
            self.layout,
            Layout::Constant | Layout::Vertices | Layout::Faces
        )
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
