//! OpenEXR images: 32-bit float RGB out; any channel type and the usual channel layouts in.

use super::{FileError, atomic};
use crate::methods::Image;
use exr::prelude::*;
use std::io::{self, Cursor, Write};
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

/// Reads the first layer that has colour: channels `R`, `G`, `B` under any prefix, or one grey channel.
pub fn read(path: &Path) -> std::result::Result<Image, FileError> {
    let bytes =
        std::fs::read(path).map_err(|error| FileError::contents(path, atomic::plain(&error)))?;
    decode(&bytes).map_err(|what| FileError::contents(path, what))
}

/// Decodes the bytes of an OpenEXR file.
pub fn decode(bytes: &[u8]) -> std::result::Result<Image, String> {
    let file = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .all_layers()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(|error| format!("not a readable OpenEXR image: {}", describe(&error)))?;
    let mut seen = Vec::new();
    for layer in &file.layer_data {
        let channels = &layer.channel_data.list;
        seen.extend(channels.iter().map(|channel| channel.name.to_string()));
        if let Some(rgb) = colour(channels) {
            return assemble(layer.size, rgb);
        }
    }
    Err(format!(
        "no R, G and B channels, nor a single grey one; it has {}",
        seen.join(", ")
    ))
}

fn describe(error: &exr::error::Error) -> String {
    match error {
        exr::error::Error::Io(cause) if cause.kind() == io::ErrorKind::UnexpectedEof => {
            "it ends too early".into()
        }
        other => other.to_string(),
    }
}

/// The three channels to read. A grey channel stands for all three.
fn colour(channels: &[AnyChannel<FlatSamples>]) -> Option<[&FlatSamples; 3]> {
    let find = |wanted: &str| {
        channels
            .iter()
            .find(|channel| {
                // `layer.R`, `view.layer.R`, and Mitsuba's `<integrator>.R` are all red.
                let name = channel.name.to_string();
                name.rsplit('.')
                    .next()
                    .is_some_and(|last| last.eq_ignore_ascii_case(wanted))
            })
            .map(|channel| &channel.sample_data)
    };
    if let (Some(r), Some(g), Some(b)) = (find("R"), find("G"), find("B")) {
        return Some([r, g, b]);
    }
    let grey = match channels {
        [only] => &only.sample_data,
        _ => find("Y")?,
    };
    Some([grey; 3])
}

fn assemble(size: Vec2<usize>, rgb: [&FlatSamples; 3]) -> std::result::Result<Image, String> {
    let (width, height) = (size.width(), size.height());
    if rgb.iter().any(|channel| channel.len() != width * height) {
        return Err("its channels are subsampled".into());
    }
    let mut pixels = vec![[0.0; 3]; width * height];
    for (c, channel) in rgb.iter().enumerate() {
        for (pixel, value) in pixels.iter_mut().zip(channel.values_as_f32()) {
            pixel[c] = value;
        }
    }
    Ok(Image {
        width,
        height,
        pixels,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

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
