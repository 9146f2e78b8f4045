//! `mesh_attribute`: colours of a mesh's vertices.

use super::{Attribute, Kind, Textures, check};
use crate::scene::camera::no_children;
use crate::scene::data::{Layout, Rgb, Texture};
use crate::scene::error::{Place, SceneError};
use crate::scene::nearest::shown;
use crate::scene::xml::{Object, Tree};

/// The one that is read.
const COLOUR: &str = "vertex_color";

impl Textures {
    /// A texture whose texels a mesh brings.
    pub(super) fn attribute(
        &mut self,
        tree: &Tree,
        object: &Object,
        key: String,
        kind: Kind,
        place: &Place,
    ) -> Result<usize, SceneError> {
        no_children(tree, object)?;
        let name = object.string("name")?.unwrap_or_default();
        if name != COLOUR {
            let what = format!(
                "the mesh_attribute \"{}\" is not supported: \"{COLOUR}\" is, the properties red, green and blue \
                 of the vertices in a ply",
                shown(&name)
            );
            return Err(object.property_error("name", what));
        }
        if kind.channels != 3 {
            let what = format!("\"{COLOUR}\" has three numbers a vertex, and cannot stand for one");
            return Err(SceneError::at(place, what));
        }
        let scale = object.float("scale")?.unwrap_or(1.0) as f32;
        let texture = self.push(Texture {
            layout: Layout::Vertices,
            limits: kind.limits,
            ..Texture::constant(key, [0.0; 3])
        });
        let place = object.place.clone();
        self.waiting.insert(texture, Attribute { scale, place });
        Ok(texture)
    }

    /// Refuses those that wait for a mesh but stand where there is none, as in a light: all but
    /// those `of_materials`, which no shape may have a use for.
    pub fn refuse_homeless(&self, of_materials: &[usize]) -> Result<(), SceneError> {
        let mut waiting = self.waiting.iter();
        match waiting.find(|(t, _)| !of_materials.contains(t)) {
            Some((_, Attribute { place, .. })) => {
                let what =
                    "a mesh_attribute has colours on shapes alone: nothing here has vertices";
                Err(SceneError::at(place, what))
            }
            None => Ok(()),
        }
    }

    /// Gives those of `textures` that wait for them the colours of the vertices of the shape `id`.
    pub fn bring(
        &mut self,
        textures: &[usize],
        (id, shape): (&str, &Place),
        colours: Option<&[Rgb]>,
    ) -> Result<(), SceneError> {
        for &t in textures {
            if self.list[t].layout != Layout::Vertices {
                continue;
            }
            let Some(Attribute { scale, place }) = self.waiting.remove(&t) else {
                let what = format!(
                    "the vertices of several shapes have colours of their own: give \"{}\" a mesh_attribute of its own",
                    shown(id)
                );
                return Err(SceneError::at(shape, what));
            };
            let Some(colours) = colours else {
                let what = format!(
                    "the vertices of \"{}\" have no colours: a ply has them as properties red, green and blue, or color_0 to color_2",
                    shown(id)
                );
                return Err(SceneError::at(&place, what));
            };
            let texture = &mut self.list[t];
            texture.texels = colours.iter().map(|c| c.map(|v| v * scale)).collect();
            texture.key = format!("{id}.{COLOUR}");
            check(texture, &place)?;
        }
        Ok(())
    }
}
