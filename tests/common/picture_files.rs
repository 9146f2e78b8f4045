//! Picture files in memory, made by the encoders of the crates that also read them.

use exr::prelude::{
    AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer, LayerAttributes, WritableImage,
    f16,
};
use image::codecs::{hdr::HdrEncoder, jpeg::JpegEncoder};
use std::io::Cursor;

/// A PNG of `width × height`; samples of 16 bits are big-endian bytes.
pub fn png(size: [u32; 2], colour: png::ColorType, depth: png::BitDepth, data: &[u8]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, size[0], size[1]);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    if colour == png::ColorType::Indexed {
        encoder.set_palette(vec![0, 51, 255, 255, 102, 0]);
    }
    let mut writer = encoder.write_header().expect("a header");
    writer.write_image_data(data).expect("data");
    writer.finish().expect("an end");
    bytes
}

pub fn png8(size: [u32; 2], rgb: &[u8]) -> Vec<u8> {
    png(size, png::ColorType::Rgb, png::BitDepth::Eight, rgb)
}

pub fn png16(size: [u32; 2], rgb: &[u16]) -> Vec<u8> {
    let data: Vec<u8> = rgb.iter().flat_map(|v| v.to_be_bytes()).collect();
    png(size, png::ColorType::Rgb, png::BitDepth::Sixteen, &data)
}

pub fn jpeg(size: [u16; 2], data: &[u8], colour: image::ExtendedColorType) -> Vec<u8> {
    let mut bytes = Vec::new();
    JpegEncoder::new_with_quality(&mut bytes, 100)
        .encode(data, size[0].into(), size[1].into(), colour)
        .expect("a JPEG");
    bytes
}

pub fn hdr(size: [usize; 2], pixels: &[[f32; 3]]) -> Vec<u8> {
    let mut bytes = Vec::new();
    let pixels: Vec<_> = pixels.iter().map(|p| image::Rgb(*p)).collect();
    HdrEncoder::new(&mut bytes)
        .encode(&pixels, size[0], size[1])
        .expect("an HDR");
    bytes
}

pub fn pfm(header: &str, floats: impl IntoIterator<Item = [u8; 4]>) -> Vec<u8> {
    let mut bytes = header.as_bytes().to_vec();
    bytes.extend(floats.into_iter().flatten());
    bytes
}

pub fn float(name: &str, values: &[f32]) -> AnyChannel<FlatSamples> {
    AnyChannel::new(name, FlatSamples::F32(values.to_vec()))
}

pub fn half(name: &str, values: &[f32]) -> AnyChannel<FlatSamples> {
    let values = values.iter().map(|v| f16::from_f32(*v)).collect();
    AnyChannel::new(name, FlatSamples::F16(values))
}

/// One layer.
pub fn exr(size: [usize; 2], channels: Vec<AnyChannel<FlatSamples>>) -> Vec<u8> {
    exr_coded(size, Encoding::SMALL_LOSSLESS, channels)
}

pub fn exr_coded(
    size: [usize; 2],
    encoding: Encoding,
    channels: Vec<AnyChannel<FlatSamples>>,
) -> Vec<u8> {
    let layer = Layer::new(
        (size[0], size[1]),
        LayerAttributes::named("picture"),
        encoding,
        AnyChannels::sort(channels.into_iter().collect()),
    );
    exr_layer(layer)
}

pub fn exr_layer(layer: Layer<AnyChannels<FlatSamples>>) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        .to_buffered(&mut bytes)
        .expect("an EXR");
    bytes.into_inner()
}

/// Red, green and blue planes of pixels.
pub fn planes(pixels: &[[f32; 3]]) -> [Vec<f32>; 3] {
    [0, 1, 2].map(|c| pixels.iter().map(|p| p[c]).collect())
}

pub fn exr_rgb(
    size: [usize; 2],
    pixels: &[[f32; 3]],
    channel: fn(&str, &[f32]) -> AnyChannel<FlatSamples>,
) -> Vec<u8> {
    let [r, g, b] = planes(pixels);
    exr(
        size,
        vec![channel("R", &r), channel("G", &g), channel("B", &b)],
    )
}
