//! `mesh_attribute`: numbers or colours of a mesh's vertices or faces.

use super::{Awaited, Kind, Textures, check, raise};
use crate::scene::camera::no_children;
use crate::scene::data::{Layout, Texture};
use crate::scene::error::{Place, SceneError};
use crate::scene::mesh::{Attribute, is_of_faces};
use crate::scene::nearest::shown;
use crate::scene::xml::{Object, Tree};

impl Textures {
    /// A texture whose texels a mesh brings.
    pub(super) fn attribute(
        &mut self,
        tree: &Tree,
        object: &Object,
        key: String,
        kind: Kind,
    ) -> Result<usize, SceneError> {
        no_children(tree, object)?;
        let name = object.string("name")?.unwrap_or_default();
        let layout = if is_of_faces(&name) {
            Layout::Faces
        } else if name.starts_with("vertex_") {
            Layout::Vertices
        } else {
            let what = format!(
                "the name of a mesh_attribute starts with \"vertex_\" or \"face_\"; \"{}\" does not",
                shown(&name)
            );
            return Err(object.property_error("name", what));
        };
        let scale = object.float("scale")?.unwrap_or(1.0) as f32;
        let texture = self.push(Texture {
            layout,
            limits: kind.limits,
            channels: kind.channels,
            ..Texture::constant(key, [0.0; 3])
        });
        let place = object.place.clone();
        self.waiting.insert(texture, Awaited { name, scale, place });
        Ok(texture)
    }

    /// Refuses those that wait for a mesh but stand where there is none, as in a light: all but
    /// those `of_materials`, which no shape may have a use for.
    pub fn refuse_homeless(&self, of_materials: &[usize]) -> Result<(), SceneError> {
        let mut waiting = self.waiting.iter();
        match waiting.find(|(t, _)| !of_materials.contains(t)) {
            Some((_, Awaited { place, .. })) => {
                let what = "a mesh_attribute has values on shapes alone: nothing here has vertices";
                Err(SceneError::at(place, what))
            }
            None => Ok(()),
        }
    }

    /// Gives those of `textures` that wait for them the attributes of the shape `id`.
    pub fn bring(
        &mut self,
        textures: &[usize],
        (id, shape): (&str, &Place),
        attributes: &[Attribute],
    ) -> Result<(), SceneError> {
        for &t in textures {
            if !matches!(self.list[t].layout, Layout::Vertices | Layout::Faces) {
                continue;
            }
            let Some(Awaited { name, scale, place }) = self.waiting.remove(&t) else {
                let what = format!(
                    "several shapes have attributes of their own: give \"{}\" a mesh_attribute of its own",
                    shown(id)
                );
                return Err(SceneError::at(shape, what));
            };
            let texture = &mut self.list[t];
            let Some(found) = attributes.iter().find(|a| a.name == name) else {
                return Err(SceneError::at(&place, missing(id, &name, attributes)));
            };
            if found.channels != texture.channels {
                let count = |channels| match channels {
                    3 => "three numbers",
                    _ => "one number",
                };
                let what = format!(
                    "\"{}\" of \"{}\" has {} where {} is needed",
                    shown(&name),
                    shown(id),
                    count(found.channels),
                    count(texture.channels)
                );
                return Err(SceneError::at(&place, what));
            }
            if !found.values.iter().flatten().all(|v| v.is_finite()) {
                let what = format!(
                    "\"{}\" of \"{}\" has numbers that are not finite",
                    shown(&name),
                    shown(id)
                );
                return Err(SceneError::at(&place, what));
            }
            texture.texels = found.values.iter().map(|v| v.map(|v| v * scale)).collect();
            texture.key = format!("{id}.{name}");
            if texture.channels == 1 {
                raise(texture);
            }
            check(texture, &place)?;
        }
        Ok(())
    }
}

/// What a mesh has in place of the attribute that is asked for, and where a file would have it.
fn missing(id: &str, name: &str, attributes: &[Attribute]) -> String {
    let has = match attributes {
        [] => "no attributes".to_string(),
        some => {
            let names = some.iter().map(|a| format!("\"{}\"", shown(&a.name)));
            names.collect::<Vec<_>>().join(", ")
        }
    };
    let (of, property) = match name.split_once('_') {
        Some(("face", property)) => ("faces", property),
        Some((_, property)) => ("vertices", property),
        None => ("vertices", name),
    };
    let property = shown(property);
    format!(
        "\"{}\" has {has}, and no \"{}\": the {of} of a ply have it as properties {property}_0, {property}_1, \
         {property}_2 (or r, g, b, or red, green, blue, for a color), or {property}_0 alone if it is a number",
        shown(id),
        shown(name)
    )
}
