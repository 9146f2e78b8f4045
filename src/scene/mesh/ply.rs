//! PLY files: ASCII and binary of either byte order.

use super::{MeshError, RawMesh, fan};
use glam::Vec3;
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{
    BeginList, ElementDef, Encoding, Header, Property, PropertyAccess, PropertyAccessResult,
    PropertyType, ScalarType,
};
use std::io::ErrorKind;

/// Names under which files keep the corners of their faces.
const CORNER_LISTS: [&str; 2] = ["vertex_indices", "vertex_index"];

/// Reads a PLY file. Memory stays in proportion to the bytes that are there, whatever the header claims.
pub fn parse(bytes: &[u8]) -> Result<RawMesh, MeshError> {
    let parser = Parser::<Record>::new();
    let mut reader = Reader::new(bytes);
    let header = parser
        .read_header(&mut reader)
        .map_err(|e| header_error(&e))?;
    let payload = reader.into_inner();
    let header_text = &bytes[..bytes.len() - payload.len()];
    check_header(header_text, &header, payload.len())?;
    let mut mesh = MeshBuilder::new(&header.elements)?;
    match header.encoding {
        Encoding::Ascii => {
            let lines = header_text.iter().filter(|&&b| b == b'\n').count();
            let text = std::str::from_utf8(payload)
                .map_err(|e| MeshError::new("", format!("the ASCII data is not text: {e}")))?;
            let mut words = Words::new(text, lines + 1);
            for element in header.elements.values() {
                for index in 0..element.count {
                    let record = words.record(element, index)?;
                    mesh.add(element, index, record)?;
                }
            }
            words.refuse_more()?;
        }
        binary => {
            let mut rest = payload;
            for element in header.elements.values() {
                for index in 0..element.count {
                    let record = match binary {
                        Encoding::BinaryBigEndian => {
                            parser.read_big_endian_element(&mut rest, element)
                        }
                        _ => parser.read_little_endian_element(&mut rest, element),
                    };
                    let record = record.map_err(|e| record_error(&e, element, index))?;
                    mesh.add(element, index, record)?;
                }
            }
            if !rest.is_empty() {
                let what = format!("{} bytes follow after the last element", rest.len());
                return Err(MeshError::new("", what));
            }
        }
    }
    mesh.finish()
}

/// One vertex, face, or anything else: what of it a mesh needs.
#[derive(Default)]
struct Record {
    position: [f32; 3],
    normal: [f32; 3],
    /// Corners of a face. Two kinds, because the parser fills a vector of the type the file has.
    signed_corners: Vec<i32>,
    corners: Vec<u32>,
    bad_corners: bool,
}

impl Record {
    fn set_number(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        match name {
            "x" => self.position[0] = value,
            "y" => self.position[1] = value,
            "z" => self.position[2] = value,
            "nx" => self.normal[0] = value,
            "ny" => self.normal[1] = value,
            "nz" => self.normal[2] = value,
            _ => return PropertyAccessResult::Ignored,
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

type Elements = ply_rs_bw::ply::KeyMap<ElementDef>;

/// Refuses headers that would be misread or that claim more than the file holds.
fn check_header(header: &[u8], parsed: &Header, payload_bytes: usize) -> Result<(), MeshError> {
    let elements = &parsed.elements;
    // The parser keeps one of two elements or properties of the same name, and the data would be misread.
    let declared = |word: &[u8]| {
        let lines = header.split(|&b| b == b'\n');
        lines
            .filter(|l| l.starts_with(word) && matches!(l.get(word.len()), Some(b' ' | b'\t')))
            .count()
    };
    let properties: usize = elements.values().map(|e| e.properties.len()).sum();
    if declared(b"element") != elements.len() || declared(b"property") != properties {
        let what = "the header declares two elements or two properties of the same name";
        return Err(MeshError::new("", what));
    }
    let mut least_bytes: u128 = 0;
    for element in elements.values() {
        let of_one: usize = match parsed.encoding {
            // A digit each.
            Encoding::Ascii => element.properties.len(),
            _ => element
                .properties
                .values()
                .map(|p| least_size(&p.data_type))
                .sum(),
        };
        if of_one == 0 && element.count > 0 {
            let what = format!("element \"{}\" has no properties", element.name);
            return Err(MeshError::new("", what));
        }
        least_bytes += of_one as u128 * element.count as u128;
    }
    if least_bytes > payload_bytes as u128 {
        return Err(truncated(elements, payload_bytes));
    }
    Ok(())
}

fn truncated(elements: &Elements, payload_bytes: usize) -> MeshError {
    let claims: Vec<String> = elements
        .values()
        .map(|e| format!("{} of \"{}\"", e.count, e.name))
        .collect();
    let what = format!(
        "the file is truncated: the header claims {}, but only {payload_bytes} bytes follow it",
        claims.join(" and ")
    );
    MeshError::new("", what)
}

/// Bytes of a value; of a list without entries.
fn least_size(kind: &PropertyType) -> usize {
    let (PropertyType::Scalar(scalar) | PropertyType::List(scalar, _)) = kind;
    match scalar {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}

fn header_error(error: &ParseError) -> MeshError {
    let sentence = error.to_string();
    let first = sentence.lines().next().unwrap_or_default();
    let first = match error.line() {
        Some(line) => first.trim_start_matches(&format!("Line {line}: ")),
        None => first,
    };
    let at = error
        .line()
        .map_or(String::new(), |line| format!(":{line}"));
    MeshError::new(at, format!("this is no valid PLY header: {first}"))
}

fn record_error(error: &ParseError, element: &ElementDef, index: usize) -> MeshError {
    let at = format!(", {} {index}", element.name);
    if error.kind() == ErrorKind::UnexpectedEof {
        let what = format!(
            "the file is truncated: it ends after {index} of {} in \"{}\"",
            element.count, element.name
        );
        return MeshError::new(at, what);
    }
    let sentence = error.to_string();
    MeshError::new(at, sentence.lines().next().unwrap_or_default())
}

/// Collects vertices and faces in whichever order they come.
struct MeshBuilder {
    mesh: RawMesh,
    has_normals: bool,
    /// Largest corner index so far with its face: vertices may come after faces.
    largest_corner: Option<(u32, usize)>,
}

impl MeshBuilder {
    fn new(elements: &Elements) -> Result<Self, MeshError> {
        let (Some(vertex), Some(face)) = (elements.get("vertex"), elements.get("face")) else {
            let what = "the header must declare the elements \"vertex\" and \"face\"";
            return Err(MeshError::new("", what));
        };
        let is_number = |name: &str| {
            let kind = vertex.properties.get(name).map(|p| &p.data_type);
            matches!(kind, Some(PropertyType::Scalar(_)))
        };
        if let Some(missing) = ["x", "y", "z"].into_iter().find(|name| !is_number(name)) {
            let what = format!("the vertices have no property \"{missing}\"");
            return Err(MeshError::new("", what));
        }
        let is_list = |name: &str| {
            let kind = face.properties.get(name).map(|p| &p.data_type);
            matches!(kind, Some(PropertyType::List(..)))
        };
        if !CORNER_LISTS.iter().any(|name| is_list(name)) {
            let what = "the faces have no list \"vertex_indices\"";
            return Err(MeshError::new("", what));
        }
        Ok(Self {
            mesh: RawMesh::default(),
            has_normals: ["nx", "ny", "nz"].into_iter().all(is_number),
            largest_corner: None,
        })
    }

    fn add(&mut self, element: &ElementDef, index: usize, record: Record) -> Result<(), MeshError> {
        match element.name.as_str() {
            "vertex" => self.add_vertex(index, &record),
            "face" => self.add_face(index, record),
            _ => Ok(()),
        }
    }

    fn add_vertex(&mut self, index: usize, record: &Record) -> Result<(), MeshError> {
        let position = Vec3::from(record.position);
        if !position.is_finite() {
            return Err(MeshError::new(
                format!(", vertex {index}"),
                "the position is not finite",
            ));
        }
        self.mesh.positions.push(position);
        if self.has_normals {
            let normal = Vec3::from(record.normal);
            if !normal.is_finite() {
                return Err(MeshError::new(
                    format!(", vertex {index}"),
                    "the normal is not finite",
                ));
            }
            self.mesh.normals.get_or_insert_default().push(normal);
        }
        Ok(())
    }

    fn add_face(&mut self, index: usize, record: Record) -> Result<(), MeshError> {
        let at = || format!(", face {index}");
        let mut corners = record.corners;
        if !record.signed_corners.is_empty() {
            // A negative index becomes one that is out of range.
            corners = record.signed_corners.iter().map(|&i| i as u32).collect();
        }
        if record.bad_corners {
            return Err(MeshError::new(
                at(),
                "the vertex indices are not whole numbers from 0",
            ));
        }
        if corners.len() < 3 {
            let what = format!(
                "a face needs at least 3 corners, this one has {}",
                corners.len()
            );
            return Err(MeshError::new(at(), what));
        }
        for &corner in &corners {
            if self
                .largest_corner
                .is_none_or(|(largest, _)| corner > largest)
            {
                self.largest_corner = Some((corner, index));
            }
        }
        self.mesh.triangles.extend(fan(&corners));
        Ok(())
    }

    fn finish(self) -> Result<RawMesh, MeshError> {
        let vertices = self.mesh.positions.len();
        if let Some((corner, face)) = self.largest_corner
            && corner as usize >= vertices
        {
            let what = format!(
                "vertex index {} is out of range: there are {vertices} vertices",
                corner as i32
            );
            return Err(MeshError::new(format!(", face {face}"), what));
        }
        if self.mesh.triangles.is_empty() {
            return Err(MeshError::new("", "the mesh has no faces"));
        }
        Ok(self.mesh)
    }
}

/// The values of an ASCII file, with the line each is on.
struct Words<'a> {
    lines: std::iter::Enumerate<std::str::Lines<'a>>,
    line: std::str::SplitAsciiWhitespace<'a>,
    line_number: usize,
    first_line_number: usize,
}

impl<'a> Words<'a> {
    fn new(text: &'a str, first_line_number: usize) -> Self {
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
                crate::scene::nearest::shown(word),
                element.name
            );
            MeshError::new(format!(":{}", self.line_number), what)
        })
    }

    fn record(&mut self, element: &ElementDef, index: usize) -> Result<Record, MeshError> {
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

    fn refuse_more(&mut self) -> Result<(), MeshError> {
        match self.next() {
            None => Ok(()),
            Some(_) => Err(MeshError::new(
                format!(":{}", self.line_number),
                "there is more after the last element",
            )),
        }
    }
}
