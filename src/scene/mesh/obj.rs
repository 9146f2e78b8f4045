//! Wavefront OBJ files: `v`, `vn` and `f` lines. Texture coordinates, groups and materials are passed over.
//!
//! Read here rather than by a crate: `tobj` splits vertices at every group and material (smooth normals and
//! `vertex_positions` would change with the grouping) and says no line in its errors.

use super::{MeshError, RawMesh, fan};
use crate::scene::nearest::shown;
use glam::Vec3;
use std::collections::HashMap;

/// Reads an OBJ file. Vertex `i` is the `i`-th `v` line. A vertex that faces use with several normals is
/// repeated behind the others, once for each further normal.
pub fn parse(bytes: &[u8], ignore_normals: bool) -> Result<RawMesh, MeshError> {
    let mut reader = ObjReader {
        positions: Vec::new(),
        normals: Vec::new(),
        corners: Corners::default(),
        triangles: Vec::new(),
        ignore_normals,
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
            .line(line)
            .map_err(|what| MeshError::new(format!(":{}", index + 1), what))?;
    }
    reader.finish()
}

struct ObjReader {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    corners: Corners,
    triangles: Vec<[u32; 3]>,
    ignore_normals: bool,
}

/// Which vertex of the mesh stands for a (position, normal) of the file.
#[derive(Default)]
struct Corners {
    /// By position, if a face used it: the normal it was first used with. That pair keeps the position's number.
    first_normal: Vec<Option<Option<u32>>>,
    /// The other pairs, by the order they were met in.
    others: HashMap<(u32, Option<u32>), u32>,
    others_in_order: Vec<(u32, Option<u32>)>,
}

/// A corner of a face before it is known how many `v` lines there are.
const OTHERS_START: u32 = 1 << 31;

impl Corners {
    fn index(&mut self, position: u32, normal: Option<u32>) -> u32 {
        let at = position as usize;
        if self.first_normal.len() <= at {
            self.first_normal.resize(at + 1, None);
        }
        if *self.first_normal[at].get_or_insert(normal) == normal {
            return position;
        }
        *self.others.entry((position, normal)).or_insert_with(|| {
            self.others_in_order.push((position, normal));
            OTHERS_START + self.others_in_order.len() as u32 - 1
        })
    }
}

impl ObjReader {
    fn line(&mut self, line: &str) -> Result<(), String> {
        let mut words = line.split_ascii_whitespace();
        match words.next() {
            Some("v") => {
                if self.positions.len() >= OTHERS_START as usize {
                    return Err("too many vertices".to_string());
                }
                self.positions.push(vector(words, "vertex position")?);
            }
            Some("vn") => self.normals.push(vector(words, "vertex normal")?),
            Some("f") => {
                let corners = words
                    .map(|word| self.corner(word))
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
    fn corner(&mut self, word: &str) -> Result<u32, String> {
        if word.matches('/').count() > 2 {
            return Err(format!("\"{}\" has more than three indices", shown(word)));
        }
        let mut parts = word.split('/');
        let position = index(parts.next(), self.positions.len(), "vertex", word)?;
        let position = position.ok_or_else(|| format!("\"{}\" names no vertex", shown(word)))?;
        let _texture_coordinates = parts.next();
        let normal = match parts.next() {
            Some(text) if !self.ignore_normals => {
                index(Some(text), self.normals.len(), "normal", word)?
            }
            _ => None,
        };
        Ok(self.corners.index(position, normal))
    }

    fn finish(self) -> Result<RawMesh, MeshError> {
        if self.triangles.is_empty() {
            return Err(MeshError::new("", "the mesh has no faces"));
        }
        let first_normals = &self.corners.first_normal;
        let uses_normals =
            first_normals.iter().flatten().any(Option::is_some) || !self.corners.others.is_empty();
        let mut positions = self.positions;
        let own = positions.len() as u32;
        let mut normals = uses_normals.then(|| vec![Vec3::ZERO; positions.len()]);
        if let Some(normals) = &mut normals {
            for (slot, first) in normals.iter_mut().zip(first_normals) {
                if let Some(Some(normal)) = first {
                    *slot = self.normals[*normal as usize];
                }
            }
            for &(vertex, normal) in &self.corners.others_in_order {
                positions.push(positions[vertex as usize]);
                normals.push(normal.map_or(Vec3::ZERO, |n| self.normals[n as usize]));
            }
        }
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
        })
    }
}

fn vector<'a>(mut words: impl Iterator<Item = &'a str>, kind: &str) -> Result<Vec3, String> {
    let mut out = [0.0f32; 3];
    for slot in &mut out {
        let word = words
            .next()
            .ok_or_else(|| format!("a {kind} has three numbers"))?;
        *slot = word
            .parse()
            .map_err(|_| format!("\"{}\" is not a number of a {kind}", shown(word)))?;
        if !slot.is_finite() {
            return Err(format!("the {kind} is not finite"));
        }
    }
    Ok(Vec3::from(out))
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
