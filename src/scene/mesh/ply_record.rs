//! One element of a PLY file: the part of it that a mesh needs, and how ASCII files spell it.

use super::MeshError;
use crate::scene::nearest::shown;
use ply_rs_bw::ply::{
    BeginList, ElementDef, Property, PropertyAccess, PropertyAccessResult, PropertyType,
};

/// Names under which files keep the corners of their faces.
pub(super) const CORNER_LISTS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Names of the two texture coordinates; the first pair that a file has counts, as in Mitsuba.
pub(super) const UV_PAIRS: [[&str; 2]; 3] = [["u", "v"], ["texture_u", "texture_v"], ["s", "t"]];

/// Whether [`Record`] has a place of its own for numbers of this name.
pub(super) fn is_known(name: &str) -> bool {
    Record::default().slot(name).is_some()
}

/// One vertex, face, or anything else: what of it a mesh needs.
#[derive(Default)]
pub(super) struct Record {
    pub position: [f32; 3],
    pub normal: [f32; 3],
    /// By [`UV_PAIRS`].
    pub uvs: [[f32; 2]; 3],
    /// Numbers of all other names, in the order of the header.
    pub others: Vec<f32>,
    /// Corners of a face. Two kinds, because the parser fills a vector of the type the file has.
    pub signed_corners: Vec<i32>,
    pub corners: Vec<u32>,
    pub bad_corners: bool,
}

impl Record {
    /// Where the number of this name belongs.
    fn slot(&mut self, name: &str) -> Option<&mut f32> {
        Some(match name {
            "x" => &mut self.position[0],
            "y" => &mut self.position[1],
            "z" => &mut self.position[2],
            "nx" => &mut self.normal[0],
            "ny" => &mut self.normal[1],
            "nz" => &mut self.normal[2],
            _ => {
                let pairs = UV_PAIRS.iter().zip(&mut self.uvs);
                let mut slots = pairs.flat_map(|(names, pair)| names.iter().zip(pair));
                slots.find(|(n, _)| **n == name)?.1
            }
        })
    }

    fn set_number(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        match self.slot(name) {
            Some(slot) => *slot = value,
            None => self.others.push(value),
        }
        PropertyAccessResult::Set
    }
}

impl PropertyAccess for Record {
    fn new() -> Self {
        Self::default()
    }

    fn set_float(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        self.set_number(name, value)
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        if let Some(value) = property.to_f32_lossy() {
            return self.set_number(name, value);
        }
        if CORNER_LISTS.contains(&name) {
            match property.to_u32_list() {
                Some(corners) => self.corners = corners,
                None => self.bad_corners = true,
            }
        }
        PropertyAccessResult::Ignored
    }

    fn begin_list_int(&mut self, name: &str, _len: usize) -> BeginList<'_, i32> {
        if CORNER_LISTS.contains(&name) {
            BeginList::Fill(&mut self.signed_corners)
        } else {
            BeginList::UseSetter
        }
    }

    fn begin_list_uint(&mut self, name: &str, _len: usize) -> BeginList<'_, u32> {
        if CORNER_LISTS.contains(&name) {
            BeginList::Fill(&mut self.corners)
        } else {
            BeginList::UseSetter
        }
    }
}

/// The values of an ASCII file, with the line each is on.
pub(super) struct Words<'a> {
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    line: std::str::SplitAsciiWhitespace<'a>,
    line_number: usize,
    first_line_number: usize,
}

impl<'a> Words<'a> {
    pub fn new(text: &'a str, first_line_number: usize) -> Self {
        Self {
            lines: text.lines().enumerate(),
            line: "".split_ascii_whitespace(),
            line_number: first_line_number,
            first_line_number,
        }
    }

    fn next(&mut self) -> Option<&'a str> {
        loop {
            if let Some(word) = self.line.next() {
                return Some(word);
            }
            let (index, line) = self.lines.next()?;
            self.line_number = self.first_line_number + index;
            self.line = line.split_ascii_whitespace();
        }
    }

    fn number<T: std::str::FromStr>(
        &mut self,
        element: &ElementDef,
        index: usize,
    ) -> Result<T, MeshError> {
        let Some(word) = self.next() else {
            let what = format!(
                "the file is truncated: it ends after {index} of {} in \"{}\"",
                element.count, element.name
            );
            return Err(MeshError::new(format!(":{}", self.line_number), what));
        };
        word.parse().map_err(|_| {
            let what = format!(
                "\"{}\" is no such number as {} {index} has there",
                shown(word),
                element.name
            );
            MeshError::new(format!(":{}", self.line_number), what)
        })
    }

    /// The next element: values may be spread over lines in any way.
    pub fn record(&mut self, element: &ElementDef, index: usize) -> Result<Record, MeshError> {
        let mut record = Record::default();
        for (name, property) in &element.properties {
            match property.data_type {
                PropertyType::Scalar(_) => {
                    let value = self.number::<f32>(element, index)?;
                    record.set_number(name, value);
                }
                PropertyType::List(..) => {
                    let is_corners = CORNER_LISTS.contains(&name.as_str());
                    for _ in 0..self.number::<u32>(element, index)? {
                        if is_corners {
                            record.corners.push(self.number::<u32>(element, index)?);
                        } else {
                            self.number::<f64>(element, index)?;
                        }
                    }
                }
            }
        }
        Ok(record)
    }

    /// An error if there is another word.
    pub fn refuse_more(&mut self) -> Result<(), MeshError> {
        match self.next() {
            None => Ok(()),
            Some(_) => Err(MeshError::new(
                format!(":{}", self.line_number),
                "there is more after the last element",
            )),
        }
    }
}
