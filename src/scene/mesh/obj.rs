//! Wavefront OBJ files: `v`, `vt`, `vn` and `f` lines. Groups and materials are passed over.
//!
//! Read here rather than by a crate: `tobj` splits vertices at every group and material (smooth
//! normals and `vertex_positions` would change with the grouping) and says no line in its errors.

use super::{MeshError, RawMesh, fan};
use crate::scene::nearest::shown;
use glam::{Vec2, Vec3};
use std::collections::HashMap;

/// What of a file is read besides positions and faces.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Reads {
    pub normals: bool,
    pub uvs: bool,
}

/// Reads an OBJ file. Vertex `i` is the `i`-th `v` line. A vertex that faces use with several
/// normals or texture coordinates is repeated behind the others, once for each further combination.
pub fn parse(bytes: &[u8], reads: Reads) -> Result<RawMesh, MeshError> {
    if bytes.is_empty() {
        return Err(MeshError::new("", "the file is empty"));
    }
    let mut reader = ObjReader {
        positions: Vec::new(),
        uvs: Vec::new(),
        normals: Vec::new(),
        corners: Corners::default(),
        triangles: Vec::new(),
        reads,
        bare_corner: None,
    };
    let mut continued = String::new();
    for (index, line) in bytes.split(|&b| b == b'\n').enumerate() {
        // Names and comments may be in any encoding; numbers are ASCII.
        let line = String::from_utf8_lossy(line);
        let line = line.split('#').next().unwrap_or_default().trim();
        if let Some(start) = line.strip_suffix('\\') {
            continued.push_str(start);
            continued.push(' ');
            continue;
        }
        let whole;
        let line = if continued.is_empty() {
            line
        } else {
            whole = std::mem::take(&mut continued) + line;
            &whole
        };
        reader
            .line(line, index + 1)
            .map_err(|what| MeshError::new(format!(":{}", index + 1), what))?;
    }
    reader.finish()
}

struct ObjReader {
    positions: Vec<Vec3>,
    uvs: Vec<Vec2>,
    normals: Vec<Vec3>,
    corners: Corners,
    triangles: Vec<[u32; 3]>,
    reads: Reads,
    /// The line of the first face corner without texture coordinates.
    bare_corner: Option<usize>,
}

/// What a face corner has besides its position: indices of `vt` and `vn`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
struct Attributes {
    uv: Option<u32>,
    normal: Option<u32>,
}

/// Which vertex of the mesh stands for a position of the file with its attributes.
#[derive(Default)]
struct Corners {
    /// By position, if a face used it: what it was first used with. That pair keeps the position's
    /// number.
    first: Vec<Option<Attributes>>,
    /// The other pairs, by the order they were met in.
    others: HashMap<(u32, Attributes), u32>,
    others_in_order: Vec<(u32, Attributes)>,
}

/// A corner of a face before it is known how many `v` lines there are.
const OTHERS_START: u32 = 1 << 31;

impl Corners {
    fn index(&mut self, position: u32, attributes: Attributes) -> u32 {
        let at = position as usize;
        if self.first.len() <= at {
            self.first.resize(at + 1, None);
        }
        if *self.first[at].get_or_insert(attributes) == attributes {
            return position;
        }
        *self
            .others
            .entry((position, attributes))
            .or_insert_with(|| {
                self.others_in_order.push((position, attributes));
                OTHERS_START + self.others_in_order.len() as u32 - 1
            })
    }

    /// Vertices in the order of the mesh; `None` for those that no face uses.
    fn attributes(&self, positions: usize) -> impl Iterator<Item = Option<Attributes>> {
        let first = (0..positions).map(|i| self.first.get(i).copied().flatten());
        first.chain(self.others_in_order.iter().map(|other| Some(other.1)))
    }

    /// One value a vertex, zero where there is none; `None` if no face uses any.
    fn gather<T: Copy + Default>(
        &self,
        positions: usize,
        values: &[T],
        index: impl Fn(Attributes) -> Option<u32>,
    ) -> Option<Vec<T>> {
        let mut all = self.attributes(positions).flatten();
        all.any(|a| index(a).is_some()).then(|| {
            let indices = self.attributes(positions).map(|a| a.and_then(&index));
            indices
                .map(|i| i.map_or_else(T::default, |i| values[i as usize]))
                .collect()
        })
    }
}

impl ObjReader {
    fn line(&mut self, line: &str, number: usize) -> Result<(), String> {
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => {
                if self.positions.len() >= OTHERS_START as usize {
                    return Err("too many vertices".to_string());
                }
                self.positions
                    .push(Vec3::from(numbers(words, "vertex position")?));
            }
            Some("vn") if self.reads.normals => {
                self.normals
                    .push(Vec3::from(numbers(words, "vertex normal")?));
            }
            Some("vt") if self.reads.uvs => {
                self.uvs
                    .push(Vec2::from(numbers(words, "texture coordinate")?));
            }
            Some("f") => {
                let corners = words
                    .map(|word| self.corner(word, number))
                    .collect::<Result<Vec<_>, _>>()?;
                if corners.len() < 3 {
                    return Err(format!(
                        "a face needs at least 3 corners, this one has {}",
                        corners.len()
                    ));
                }
                self.triangles.extend(fan(&corners));
            }
            _ => {}
        }
        Ok(())
    }

    /// `7`, `7/1`, `7//3` or `7/1/3`; negative numbers count from the latest line back.
    fn corner(&mut self, word: &str, line: usize) -> Result<u32, String> {
        if word.matches('/').count() > 2 {
            return Err(format!("\"{}\" has more than three indices", shown(word)));
        }
        let mut parts = word.split('/');
        let position = index(parts.next(), self.positions.len(), "vertex", word)?;
        let position = position.ok_or_else(|| format!("\"{}\" names no vertex", shown(word)))?;
        let (uv, normal) = (parts.next(), parts.next());
        let mut attributes = Attributes::default();
        if self.reads.uvs {
            attributes.uv = index(uv, self.uvs.len(), "texture coordinate", word)?;
            if attributes.uv.is_none() {
                self.bare_corner.get_or_insert(line);
            }
        }
        if self.reads.normals {
            attributes.normal = index(normal, self.normals.len(), "normal", word)?;
        }
        Ok(self.corners.index(position, attributes))
    }

    fn finish(self) -> Result<RawMesh, MeshError> {
        let mut positions = self.positions;
        let own = positions.len() as u32;
        let corners = &self.corners;
        let normals = corners.gather(positions.len(), &self.normals, |a| a.normal);
        let uvs = corners.gather(positions.len(), &self.uvs, |a| a.uv);
        if let (Some(line), true) = (self.bare_corner, uvs.is_some()) {
            let what = "this face has no texture coordinates, though others have";
            return Err(MeshError::new(format!(":{line}"), what));
        }
        let others = corners.others_in_order.iter();
        let repeated: Vec<Vec3> = others.map(|o| positions[o.0 as usize]).collect();
        positions.extend(repeated);
        let number = |i: u32| {
            if i < OTHERS_START {
                i
            } else {
                own + (i - OTHERS_START)
            }
        };
        Ok(RawMesh {
            positions,
            triangles: self.triangles.iter().map(|t| t.map(number)).collect(),
            normals,
            uvs,
            attributes: Vec::new(),
        })
    }
}

/// The first numbers of a line; more may follow (a weight, a colour).
fn numbers<'a, const N: usize>(
    mut words: impl Iterator<Item = &'a str>,
    kind: &str,
) -> Result<[f32; N], String> {
    let mut out = [0.0f32; N];
    for slot in &mut out {
        let word = words
            .next()
            .ok_or_else(|| format!("a {kind} has {} numbers", ["two", "three"][N - 2]))?;
        *slot = word
            .parse()
            .map_err(|_| format!("\"{}\" is not a number of a {kind}", shown(word)))?;
        if !slot.is_finite() {
            return Err(format!("the {kind} is not finite"));
        }
    }
    Ok(out)
}

/// A one-based or negative index as a zero-based one; `None` for an empty text.
fn index(text: Option<&str>, count: usize, kind: &str, word: &str) -> Result<Option<u32>, String> {
    let text = text.unwrap_or_default();
    if text.is_empty() {
        return Ok(None);
    }
    let written: i64 = text
        .parse()
        .map_err(|_| format!("\"{}\" is not a face corner", shown(word)))?;
    let count = count as i64;
    let zero_based = if written < 0 {
        count.saturating_add(written)
    } else {
        written - 1
    };
    if (0..count).contains(&zero_based) {
        Ok(Some(zero_based as u32))
    } else {
        Err(format!(
            "{kind} index {written} is out of range: {count} so far"
        ))
    }
}
