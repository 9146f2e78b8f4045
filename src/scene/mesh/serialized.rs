//! Mitsuba's own binary meshes (`.serialized`), several of which may share a file.
//!
//! Each begins with a magic number and a version, both u16. A zlib stream follows: flags, from
//! version 4 on a name that ends with a zero, the numbers of vertices and triangles (u64), then
//! positions, normals, texture coordinates and colours, as far as the flags say that they are
//! there, and the corners of triangles (u32). The file ends with the offsets of all its meshes
//! (u64, before version 4 u32) and their number (u32). All of it is little-endian. (Mitsuba 3's
//! documentation of `serialized`.)

use super::{MeshError, RawMesh};
use flate2::read::ZlibDecoder;
use glam::{Vec2, Vec3};
use std::io::{ErrorKind, Read};

const MAGIC: u16 = 0x041C;
const NORMALS: u32 = 0x0001;
const TEXTURE_COORDINATES: u32 = 0x0002;
const COLOURS: u32 = 0x0008;
const DOUBLE: u32 = 0x2000;
/// Numbers that are unpacked at once: what a file claims takes no memory before it is there.
const BLOCK: usize = 1 << 14;

/// Reads the mesh with this number, from 0. The flag 0x10, which asks for face normals, says
/// nothing, as in Mitsuba 3.9.1, whatever its documentation says.
pub fn parse(bytes: &[u8], number: u32) -> Result<RawMesh, MeshError> {
    let version = version(bytes, 0)?;
    let start = match number {
        0 => 0,
        _ => offset(bytes, version, number)?,
    };
    self::version(bytes, start)?;
    let mut stream = Stream(ZlibDecoder::new(&bytes[start + 4..]));
    let flags = u32::from_le_bytes(stream.array()?);
    if version >= 4 {
        while stream.array::<1>()? != [0] {}
    }
    let [vertices, triangles] = [stream.count("vertices")?, stream.count("triangles")?];
    let is_double = flags & DOUBLE != 0;
    let positions = stream.vectors(vertices, is_double)?;
    let bad = positions.iter().position(|p| !p.is_finite());
    if let Some(vertex) = bad {
        let what = "the position is not a finite number";
        return Err(MeshError::new(format!(", vertex {vertex}"), what));
    }
    let given = |flag: u32| flags & flag != 0;
    let part = |flag: u32| if given(flag) { vertices } else { 0 };
    let normals = stream.vectors(part(NORMALS), is_double)?;
    let uvs = stream.pairs(part(TEXTURE_COORDINATES), is_double)?;
    if let Some(vertex) = uvs.iter().position(|uv| !uv.is_finite()) {
        let what = "the texture coordinates are not finite numbers";
        return Err(MeshError::new(format!(", vertex {vertex}"), what));
    }
    stream.numbers(3 * part(COLOURS), is_double)?;
    let mut corners = Vec::new();
    for triangle in 0..triangles {
        let corner = |stream: &mut Stream| Ok(u32::from_le_bytes(stream.array()?));
        let three = [
            corner(&mut stream)?,
            corner(&mut stream)?,
            corner(&mut stream)?,
        ];
        if let Some(v) = three.into_iter().find(|&v| v as usize >= vertices) {
            let what = format!("vertex {v} is not there: the mesh has {vertices}");
            return Err(MeshError::new(format!(", face {triangle}"), what));
        }
        corners.push(three);
    }
    Ok(RawMesh {
        positions,
        triangles: corners,
        normals: given(NORMALS).then_some(normals),
        uvs: given(TEXTURE_COORDINATES).then_some(uvs),
        attributes: Vec::new(),
    })
}

/// Of the mesh that begins at an offset.
fn version(bytes: &[u8], start: usize) -> Result<u16, MeshError> {
    let two = |at: usize| -> Option<u16> {
        let end = at.checked_add(2)?;
        Some(u16::from_le_bytes(bytes.get(at..end)?.try_into().ok()?))
    };
    let words = two(start).zip(start.checked_add(2).and_then(two));
    match words {
        Some((MAGIC, version @ (3 | 4))) => Ok(version),
        Some((MAGIC, version)) => {
            let what = format!("version {version} of serialized meshes is unknown: it is 3 or 4");
            Err(MeshError::new("", what))
        }
        _ => {
            let what = "this is no serialized mesh: it does not begin with the bytes 1C 04";
            Err(MeshError::new("", what))
        }
    }
}

/// Where a mesh begins.
fn offset(bytes: &[u8], version: u16, number: u32) -> Result<usize, MeshError> {
    let broken = || MeshError::new("", "the list of meshes at the end of the file is broken");
    let (rest, count) = bytes.split_last_chunk::<4>().ok_or_else(broken)?;
    let count = u32::from_le_bytes(*count);
    if number >= count {
        let what = format!("there is no mesh number {number}: the file has {count}, from 0 on");
        return Err(MeshError::new("", what));
    }
    let size = if version >= 4 { 8 } else { 4 };
    let from_end = (count - number) as usize * size;
    let at = rest.len().checked_sub(from_end).ok_or_else(broken)?;
    let mut word = [0; 8];
    word[..size].copy_from_slice(&rest[at..at + size]);
    usize::try_from(u64::from_le_bytes(word)).map_err(|_| broken())
}

/// What the zlib stream holds.
struct Stream<'a>(ZlibDecoder<&'a [u8]>);

impl Stream<'_> {
    fn fill(&mut self, bytes: &mut [u8]) -> Result<(), MeshError> {
        self.0.read_exact(bytes).map_err(|e| {
            let what = match e.kind() {
                ErrorKind::UnexpectedEof => "the file is truncated".to_string(),
                _ => format!("the compressed data is broken: {e}"),
            };
            MeshError::new("", what)
        })
    }

    fn array<const N: usize>(&mut self) -> Result<[u8; N], MeshError> {
        let mut bytes = [0; N];
        self.fill(&mut bytes)?;
        Ok(bytes)
    }

    fn count(&mut self, what: &str) -> Result<usize, MeshError> {
        let count = u64::from_le_bytes(self.array()?);
        u32::try_from(count).map(|c| c as usize).map_err(|_| {
            MeshError::new("", format!("{count} {what} are too many: at most 2³² − 1"))
        })
    }

    /// As many numbers, in single precision.
    fn numbers(&mut self, count: usize, is_double: bool) -> Result<Vec<f32>, MeshError> {
        let size = if is_double { 8 } else { 4 };
        let mut bytes = vec![0; size * count.min(BLOCK)];
        let mut numbers = Vec::new();
        while numbers.len() < count {
            let block = &mut bytes[..size * (count - numbers.len()).min(BLOCK)];
            self.fill(block)?;
            let words = block.chunks_exact(size);
            numbers.extend(words.map(|word| match word.try_into() {
                Ok(double) => f64::from_le_bytes(double) as f32,
                Err(_) => word.try_into().map_or(f32::NAN, f32::from_le_bytes),
            }));
        }
        Ok(numbers)
    }

    fn vectors(&mut self, count: usize, is_double: bool) -> Result<Vec<Vec3>, MeshError> {
        let numbers = self.numbers(3 * count, is_double)?;
        let three = numbers.chunks_exact(3);
        Ok(three.map(|v| Vec3::new(v[0], v[1], v[2])).collect())
    }

    fn pairs(&mut self, count: usize, is_double: bool) -> Result<Vec<Vec2>, MeshError> {
        let numbers = self.numbers(2 * count, is_double)?;
        let two = numbers.chunks_exact(2);
        Ok(two.map(|v| Vec2::new(v[0], v[1])).collect())
    }
}
