//! Properties and transforms of an object, as their elements give them.

use super::file::{Attributes, File, no_elements_inside, unknown_tag, utf8};
use super::properties::Value;
use super::reader::Reader;
use super::{transform, values};
use crate::scene::error::{Place, SceneError};
use crate::scene::nearest::{known_hint, shown};
use crate::scene::source::read_file;
use crate::scene::spectrum::Spectrum;
use glam::DAffine3;
use roxmltree::Node;

impl Reader<'_> {
    /// Name and value of a property element.
    pub(super) fn property(
        &mut self,
        file: &File,
        node: Node,
    ) -> Result<(String, Value), SceneError> {
        let tag = node.tag_name().name();
        let place = file.place(&node);
        let simple = ["boolean", "integer", "float", "string", "rgb", "srgb"];
        let a = match tag {
            "transform" => {
                let a = self.attributes(file, node, &["name"], &[])?;
                return Ok((
                    a.text("name"),
                    Value::Transform(self.transform(file, node)?),
                ));
            }
            "point" | "vector" => {
                self.attributes(file, node, &["name"], &["value", "x", "y", "z"])?
            }
            "spectrum" => self.attributes(file, node, &["name"], &["value", "filename"])?,
            _ if simple.contains(&tag) => self.attributes(file, node, &["name", "value"], &[])?,
            "translate" | "rotate" | "scale" | "lookat" | "matrix" => {
                let what = format!("<{tag}> can only stand inside <transform>");
                return Err(SceneError::at(&place, what));
            }
            _ => return Err(unknown_tag(&place, tag)),
        };
        let text = a.text("value");
        let value = match tag {
            "boolean" => values::boolean(&text).map(Value::Boolean),
            "integer" => values::integer(&text).map(Value::Integer),
            "float" => values::number(&text).map(Value::Float),
            "string" => Ok(Value::String(text)),
            "rgb" => values::rgb(&text).map(Value::Rgb),
            "srgb" => values::srgb(&text).map(Value::Rgb),
            "spectrum" => match a.get("filename") {
                Some(name) => Ok(Value::Spectrum(self.spectrum_file(file, &place, &name)?)),
                None if text.contains(':') => values::spectrum(&text).map(Value::Spectrum),
                None => values::number(&text).map(Value::Grey),
            },
            _ => transform::xyz(&|name| a.get(name), 0.0).map(Value::Vector),
        };
        let value = value.map_err(|e| SceneError::at(&place, format!("<{tag}>: {e}")))?;
        Ok((a.text("name"), value))
    }

    /// Reads a file of wavelengths and values.
    fn spectrum_file(
        &mut self,
        file: &File,
        place: &Place,
        name: &str,
    ) -> Result<Spectrum, SceneError> {
        let found = self.tree.find_file(self.files, &file.folder, name);
        let path = found.map_err(|what| SceneError::at(place, what))?;
        let bytes = read_file(self.files, &path)?;
        self.hash.write(&bytes);
        Spectrum::from_lines(&utf8(&path, bytes)?).map_err(|what| {
            let what = format!("{}: {what}", path.display());
            SceneError::at(place, what)
        })
    }

    fn transform(&mut self, file: &File, node: Node) -> Result<DAffine3, SceneError> {
        let mut whole = DAffine3::IDENTITY;
        for child in node.children().filter(Node::is_element) {
            let tag = child.tag_name().name();
            let place = file.place(&child);
            let (required, optional): (&[&str], &[&str]) = match tag {
                "translate" | "scale" => (&[], &["value", "x", "y", "z"]),
                "rotate" => (&["angle"], &["value", "x", "y", "z"]),
                "lookat" => (&["origin", "target"], &["up"]),
                "matrix" => (&["value"], &[]),
                _ => {
                    let known = ["translate", "rotate", "scale", "lookat", "matrix"];
                    let what = format!(
                        "<{}> cannot stand inside <transform>{}",
                        shown(tag),
                        known_hint(tag, known)
                    );
                    return Err(SceneError::at(&place, what));
                }
            };
            let a = self.attributes(file, child, required, optional)?;
            let operation = transform::operation(tag, &|name| a.get(name));
            let operation =
                operation.map_err(|e| SceneError::at(&place, format!("<{tag}>: {e}")))?;
            if tag == "rotate"
                && let Ok(axis) = transform::xyz(&|name| a.get(name), 0.0)
                && !transform::is_unit(axis)
            {
                let length = axis.length();
                let what = format!(
                    "{place}: the rotation axis has the length {length}, not 1, so that this is no mere rotation (Mitsuba does the same)"
                );
                self.tree.warnings.push(what);
            }
            whole = operation * whole;
            if !whole.as_affine3a().is_finite() {
                return Err(SceneError::at(&place, "the transform is no longer finite"));
            }
            no_elements_inside(file, child, tag)?;
        }
        Ok(whole)
    }

    /// Substitutes in all attributes and checks their names.
    pub(super) fn attributes(
        &mut self,
        file: &File,
        node: Node,
        required: &[&str],
        optional: &[&str],
    ) -> Result<Attributes, SceneError> {
        let place = file.place(&node);
        let tag = node.tag_name().name();
        self.hash.write(tag.as_bytes());
        let mut out = Vec::new();
        for attribute in node.attributes() {
            let name = attribute.name();
            let known = required.iter().chain(optional).copied();
            if !known.clone().any(|k| k == name) {
                let what = format!(
                    "<{}> has no attribute \"{}\"{}",
                    shown(tag),
                    shown(name),
                    known_hint(name, known)
                );
                return Err(SceneError::at(&place, what));
            }
            let value = self.substitutions.substitute(attribute.value());
            let value = value.map_err(|e| SceneError::at(&place, e))?;
            for part in [name, &value] {
                self.hash.write(part.as_bytes());
                self.hash.write(&[0]);
            }
            out.push((name.to_string(), value));
        }
        for name in required {
            if !out.iter().any(|(n, _)| n == name) {
                let what = format!("<{}> lacks the attribute \"{name}\"", shown(tag));
                return Err(SceneError::at(&place, what));
            }
        }
        Ok(Attributes(out))
    }
}
