//! OpenEXR images of 32-bit float RGB are written.

use super::atomic;
use super::error::FileError;
use crate::picture::Image;
use exr::prelude::*;
use std::io::{Cursor, Write};
use std::path::Path;

/// Writes `image` as three 32-bit float channels, losslessly compressed.
pub fn write(path: &Path, image: &Image) -> std::result::Result<(), FileError> {
    let width = image.width;
    let channels = SpecificChannels::rgb(|at: Vec2<usize>| {
        let [r, g, b] = image.pixels[at.y() * width + at.x()];
        (r, g, b)
    });
    let layer = Layer::new(
        (image.width, image.height),
        LayerAttributes::default(),
        Encoding::SMALL_LOSSLESS,
        channels,
    );
    let mut bytes = Cursor::new(Vec::new());
    exr::image::Image::from_layer(layer)
        .write()
        .non_parallel()
        .to_buffered(&mut bytes)
        .map_err(|error| FileError::io(path, error))?;
    atomic::write(path, |file| file.write_all(bytes.get_ref()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::output::picture::PictureFile;

    fn read(path: &Path) -> std::result::Result<Image, FileError> {
        PictureFile::open(path)?.read()
    }

    #[test]
    fn what_is_written_is_read_back() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("a.exr");
        let pixels = (0..6)
            .map(|i| [i as f32, -0.5 * i as f32, 1e-20 * i as f32])
            .collect();
        let image = Image {
            width: 3,
            height: 2,
            pixels,
        };
        write(&path, &image).unwrap();
        assert_eq!(read(&path).unwrap(), image);
    }

    #[test]
    fn half_and_prefixed_and_grey_channels_are_read() {
        let encode = |list: Vec<AnyChannel<FlatSamples>>| {
            let mut bytes = Cursor::new(Vec::new());
            let channels = AnyChannels::sort(list.into_iter().collect());
            exr::image::Image::from_channels((2, 1), channels)
                .write()
                .to_buffered(&mut bytes)
                .unwrap();
            bytes.into_inner()
        };
        let half = |name, values: [f32; 2]| {
            AnyChannel::new(
                name,
                FlatSamples::F16(values.iter().map(|v| f16::from_f32(*v)).collect()),
            )
        };
        let directory = tempfile::tempdir().unwrap();
        let decode = |bytes: &[u8]| {
            let path = directory.path().join("a.exr");
            std::fs::write(&path, bytes).unwrap();
            read(&path).map_err(|error| error.to_string())
        };
        let prefixed = encode(vec![
            half("c.R", [1., 2.]),
            half("c.G", [3., 4.]),
            half("c.B", [5., 6.]),
            half("c.A", [1., 1.]),
        ]);
        assert_eq!(
            decode(&prefixed).unwrap().pixels,
            vec![[1., 3., 5.], [2., 4., 6.]]
        );
        let grey = encode(vec![half("Y", [1., 2.])]);
        assert_eq!(decode(&grey).unwrap().pixels, vec![[1.; 3], [2.; 3]]);
        let neither = encode(vec![half("U", [1., 2.]), half("V", [1., 2.])]);
        assert!(decode(&neither).unwrap_err().contains("U, V"));
        assert!(decode(&prefixed[..prefixed.len() - 9]).is_err());
        assert!(decode(b"not an image").is_err());
    }
}
