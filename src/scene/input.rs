//! What a scene is loaded from: its elements, and files read along the way.

use super::error::{Place, SceneError};
use super::source::{FileSource, Fnv1a, read_file};
use super::xml::{Object, Tree};
use std::collections::HashSet;
use std::path::PathBuf;

/// The elements of a scene file, and where it finds its other files.
pub(super) struct Input<'a> {
    pub tree: &'a Tree,
    pub files: &'a dyn FileSource,
    /// Of every file read so far.
    pub hash: Fnv1a,
    /// Objects that stand directly in the scene.
    in_scene: HashSet<usize>,
    /// Objects that stand in others.
    in_objects: HashSet<usize>,
}

/// A file that an object names.
pub(super) struct NamedFile {
    pub path: PathBuf,
    pub bytes: Vec<u8>,
}

impl<'a> Input<'a> {
    pub fn new(tree: &'a Tree, files: &'a dyn FileSource, hash: Fnv1a) -> Self {
        let children_of = |objects: &'a [Object]| {
            let children = objects.iter().flat_map(|o| &o.children);
            children.map(|c| c.object).collect()
        };
        let (root, others) = tree.objects.split_at(1);
        Self {
            tree,
            files,
            hash,
            in_scene: children_of(root),
            in_objects: children_of(others),
        }
    }

    /// The id of an object that stands directly in the scene, if it has one: parameters are listed
    /// under it.
    pub fn scene_id(&self, object: usize) -> Option<&'a str> {
        let id = self.tree.objects[object].id.as_deref();
        id.filter(|_| self.in_scene.contains(&object))
    }

    /// Whether an object that stands in the scene is part of another object as well.
    pub fn is_referenced(&self, object: usize) -> bool {
        self.in_objects.contains(&object)
    }

    /// Reads the file of the property `filename`; `example` is how such a name ends.
    pub fn named_file(&mut self, object: &Object, example: &str) -> Result<NamedFile, SceneError> {
        let Some(name) = object.string("filename")? else {
            let what = format!(
                "{} has no \"filename\"; give <string name=\"filename\" value=\"….{example}\"/>",
                object.shown()
            );
            return Err(object.error(what));
        };
        let path = self
            .tree
            .find_file(self.files, &object.folder, &name)
            .map_err(|what| object.property_error("filename", what))?;
        let bytes = read_file(self.files, &path).map_err(|error| match error {
            SceneError::Missing { what } => object.property_error("filename", what),
            other => other,
        })?;
        self.hash.write(&bytes);
        Ok(NamedFile { path, bytes })
    }
}

/// `"name" was already given`, for a slot that holds both a property and a texture, or two
/// textures.
pub(super) fn given_twice(place: &Place, name: &str) -> SceneError {
    SceneError::at(place, format!("\"{name}\" is given twice"))
}
