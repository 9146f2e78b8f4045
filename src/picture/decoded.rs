//! What reading a picture gives.

use super::error::Fault;

/// A picture in memory, of at least one texel, all of them finite.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// In texels.
    pub width: u32,
    /// In texels.
    pub height: u32,
    /// Red, green and blue, row by row from the top, each from the left: `width · height` of them.
    /// Grey is in all three; alpha is dropped, and colours are not divided or multiplied by it.
    pub pixels: Vec<[f32; 3]>,
    /// How the file stores colours.
    pub encoding: Encoding,
}

/// How a file stores colours, whatever was made of them while reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// Integers, taken to be sRGB-encoded. The pixels are linear after [`super::Colours::Auto`],
    /// and as stored but divided by the largest integer after [`super::Colours::Raw`].
    Srgb,
    /// Linear numbers, and so are the pixels.
    Linear,
}

impl Picture {
    /// The picture itself, or where it is not finite.
    pub(super) fn all_finite(self) -> Result<Self, Fault> {
        let is_bad = |texel: &[f32; 3]| texel.iter().any(|v| !v.is_finite());
        match self.pixels.iter().position(is_bad) {
            None => Ok(self),
            Some(at) => {
                let width = self.width as usize;
                let (x, y) = (at % width, at / width);
                Err(format!("the texel at x {x}, y {y} is not finite").into())
            }
        }
    }
}
