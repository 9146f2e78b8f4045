//! OpenEXR: half and float channels R, G and B, or grey Y, with or without others beside them.
//!
//! Blocks are decoded one by one, so that layers, mip-map levels and channels which are not asked
//! for take no memory.

use super::error::Fault;
use super::size::texels;
use super::{ChannelNames, Encoding, Picture};
use crate::room;
use ::exr::block::{self, UncompressedBlock, reader::ChunksReader};
use ::exr::error::Error;
use ::exr::meta::header::Header;
use ::exr::prelude::{SampleType, Vec2, f16};
use std::io::{self, Cursor};

/// What the samples of one layer may take, in bytes: 16 for each texel of the largest picture.
const MOST_BYTES: u64 = 1 << 32;

const LARGEST_LEVEL: Vec2<usize> = Vec2(0, 0);

pub(super) fn decode(bytes: &[u8], names: ChannelNames) -> Result<Picture, Fault> {
    let reader = block::read(Cursor::new(bytes), false).map_err(|e| unreadable(&e))?;
    let layer = Layer::choose(reader.headers(), names)?;
    let Vec2(width, height) = layer.header.layer_size;
    let count = texels(width as u64, height as u64, bytes.len())?;
    layer.check(count)?;
    // Whatever no block covers is found out with the other texels that are not finite.
    let mut pixels = room::filled([f32::NAN; 3], count)?;
    // The compressed and the decoded bytes of a block, which may be the whole picture.
    room::look_for(2 * layer.header.max_block_byte_size() as u64)?;
    let chunks = reader
        .filter_chunks(false, |_, _, block| {
            block.layer == layer.index && block.level == LARGEST_LEVEL
        })
        .map_err(|e| unreadable(&e))?;
    for block in chunks.sequential_decompressor(false) {
        layer.copy(&block.map_err(|e| unreadable(&e))?, &mut pixels)?;
    }
    Ok(Picture {
        width: width as u32,
        height: height as u32,
        pixels,
        encoding: Encoding::Linear,
    })
}

/// The layer that is read.
struct Layer {
    index: usize,
    header: Header,
    /// Of red, green and blue: the same one three times if it is grey.
    channels: [usize; 3],
}

impl Layer {
    /// The first that has colours.
    fn choose(headers: &[Header], allowed: ChannelNames) -> Result<Self, String> {
        let mut seen = Vec::new();
        for (index, header) in headers.iter().enumerate() {
            let names = header.channels.list.iter().map(|c| c.name.to_string());
            let names: Vec<_> = names.collect();
            if let Some(channels) = colour(&names, allowed) {
                let header = header.clone();
                return Ok(Self {
                    index,
                    header,
                    channels,
                });
            }
            seen.extend(names);
        }
        Err(format!(
            "it has no channels R, G and B, nor Y without chroma, but {}",
            seen.join(", ")
        ))
    }

    /// Refuses what would be misread.
    fn check(&self, texels: usize) -> Result<(), String> {
        if self.header.deep {
            return Err("it holds deep data: flatten it".into());
        }
        let list = &self.header.channels.list;
        if self
            .channels
            .iter()
            .any(|&c| list[c].sample_type == SampleType::U32)
        {
            return Err("its channels are 32-bit integers: save them as half or float".into());
        }
        if list.iter().any(|channel| channel.sampling != Vec2(1, 1)) {
            return Err("its channels are subsampled: save them in full".into());
        }
        let bytes = self.header.channels.bytes_per_pixel as u64 * texels as u64;
        if bytes > MOST_BYTES {
            return Err(format!(
                "its {} channels are absurdly large: {} MB",
                list.len(),
                bytes >> 20
            ));
        }
        Ok(())
    }

    fn copy(&self, block: &UncompressedBlock, pixels: &mut [[f32; 3]]) -> Result<(), String> {
        // A broken table of blocks may lead to any other.
        if block.index.layer != self.index || block.index.level != LARGEST_LEVEL {
            return Err(MISPLACED.into());
        }
        let width = self.header.layer_size.width();
        for line in block.lines(&self.header.channels) {
            let Vec2(x, y) = line.location.position;
            let start = y * width + x;
            let row = pixels
                .get_mut(start..start + line.location.sample_count)
                .ok_or(MISPLACED)?;
            let sample_type = self.header.channels.list[line.location.channel].sample_type;
            for (c, _) in self
                .channels
                .iter()
                .enumerate()
                .filter(|(_, i)| **i == line.location.channel)
            {
                let filled = match sample_type {
                    SampleType::F16 => {
                        fill(row, c, line.read_samples().map(|v| v.map(f16::to_f32)))
                    }
                    _ => fill(row, c, line.read_samples()),
                };
                filled.map_err(|e| unreadable(&e))?;
            }
        }
        Ok(())
    }
}

const MISPLACED: &str = "not a readable OpenEXR picture: its blocks are not where they should be";

fn fill(
    row: &mut [[f32; 3]],
    channel: usize,
    samples: impl Iterator<Item = Result<f32, Error>>,
) -> Result<(), Error> {
    for (texel, sample) in row.iter_mut().zip(samples) {
        texel[channel] = sample?;
    }
    Ok(())
}

/// Where red, green and blue are among a layer's channels.
fn colour(names: &[String], allowed: ChannelNames) -> Option<[usize; 3]> {
    let is_called = |name: &str, wanted: &str| match allowed {
        ChannelNames::Plain => name == wanted,
        ChannelNames::WithPrefix => {
            let last = name.rsplit('.').next().unwrap_or(name);
            last.eq_ignore_ascii_case(wanted)
        }
    };
    let find = |wanted: &str| names.iter().position(|name| is_called(name, wanted));
    match (find("R"), find("G"), find("B")) {
        (Some(r), Some(g), Some(b)) => Some([r, g, b]),
        // Beside chroma, Y is no grey picture.
        _ if find("RY").or(find("BY")).is_some() => None,
        _ if allowed == ChannelNames::WithPrefix && names.len() == 1 => Some([0; 3]),
        _ => find("Y").map(|y| [y; 3]),
    }
}

fn unreadable(error: &Error) -> String {
    let cause = match error {
        Error::Io(cause) if cause.kind() == io::ErrorKind::UnexpectedEof => TOO_SHORT.into(),
        // The crate's words for the same.
        Error::Invalid(cause) if cause == "reference to missing bytes" => TOO_SHORT.into(),
        other => other.to_string(),
    };
    format!("not a readable OpenEXR picture: {cause}")
}

const TOO_SHORT: &str = "it ends too early";
