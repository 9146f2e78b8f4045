//! PLY files: ASCII and binary of either byte order.

use super::ply_attributes::{Columns, columns};
use super::ply_record::{CORNER_LISTS, Record, UV_PAIRS, Words, is_known};
use super::{MeshError, RawMesh, fan};
use glam::{Vec2, Vec3};
use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyType, ScalarType};
use std::io::ErrorKind;

/// Reads a PLY file. Memory stays in proportion to the bytes that are there, whatever the header
/// claims.
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

type Elements = ply_rs_bw::ply::KeyMap<ElementDef>;

/// Refuses headers that would be misread or that claim more than the file holds.
fn check_header(header: &[u8], parsed: &Header, payload_bytes: usize) -> Result<(), MeshError> {
    let elements = &parsed.elements;
    // The parser keeps one of two elements or properties of the same name, and the data would be
    // misread.
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
    /// Which of [`UV_PAIRS`] the file has.
    uv_pair: Option<usize>,
    /// Those of vertices, then those of faces, as the mesh has them.
    columns: [Vec<Columns>; 2],
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
        let columns = [("vertex", vertex), ("face", face)].map(|(prefix, element)| {
            let scalars = element.properties.iter().filter_map(|(name, property)| {
                matches!(property.data_type, PropertyType::Scalar(_)).then_some(name.as_str())
            });
            let others: Vec<&str> = scalars.filter(|name| !is_known(name)).collect();
            columns(prefix, &others)
        });
        let mesh = RawMesh {
            attributes: columns.iter().flatten().map(Columns::attribute).collect(),
            ..RawMesh::default()
        };
        Ok(Self {
            mesh,
            has_normals: ["nx", "ny", "nz"].into_iter().all(is_number),
            uv_pair: UV_PAIRS
                .iter()
                .position(|pair| pair.iter().all(|name| is_number(name))),
            columns,
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
        if let Some(pair) = self.uv_pair {
            let uv = Vec2::from(record.uvs[pair]);
            if !uv.is_finite() {
                return Err(MeshError::new(
                    format!(", vertex {index}"),
                    "the texture coordinates are not finite",
                ));
            }
            self.mesh.uvs.get_or_insert_default().push(uv);
        }
        let [of_vertices, _] = &self.columns;
        for (columns, attribute) in of_vertices.iter().zip(&mut self.mesh.attributes) {
            attribute.values.push(columns.value(&record.others));
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
        let [of_vertices, of_faces] = &self.columns;
        let attributes = self.mesh.attributes.iter_mut().skip(of_vertices.len());
        for (columns, attribute) in of_faces.iter().zip(attributes) {
            let value = columns.value(&record.others);
            attribute.values.resize(self.mesh.triangles.len(), value);
        }
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
        Ok(self.mesh)
    }
}
