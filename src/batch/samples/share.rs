//! The file of a share: tensors by group.

use crate::output::tensors::Tensor;
use crate::picture::Image;

/// The file of a share.
pub const PARTIAL: &str = "partial.safetensors";

/// The name of a group's tensor.
pub fn of_group(name: &str, group: u32) -> String {
    format!("{name}@{group}")
}

/// An image as a tensor.
pub fn image_tensor(name: String, image: &Image) -> Tensor {
    Tensor {
        name,
        shape: vec![image.height, image.width, 3],
        values: image.pixels.as_flattened().to_vec(),
    }
}

/// A tensor as an image.
pub fn as_image(tensor: &Tensor) -> Image {
    let side = |axis: usize| tensor.shape.get(axis).copied().unwrap_or(0);
    Image {
        width: side(1),
        height: side(0),
        pixels: tensor.values.as_chunks::<3>().0.to_vec(),
    }
}
