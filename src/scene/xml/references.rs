//! `<ref>` elements and named files, once everything is read.

use super::properties::{Object, Tree};
use super::reader::{Reader, Reference};
use crate::scene::error::SceneError;
use crate::scene::nearest::{known_hint, shown};
use crate::scene::source::FileSource;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// What a reference means that leads into something that was not read.
fn unknown(reference: &Reference) -> Object {
    Object {
        tag: "bsdf",
        plugin: "unknown".to_string(),
        is_supported: false,
        id: None,
        place: reference.place.clone(),
        folder: Arc::default(),
        properties: Vec::new(),
        children: Vec::new(),
    }
}

impl Reader<'_> {
    /// Finds the object of every reference.
    pub(super) fn resolve_references(&mut self) -> Result<(), SceneError> {
        // What it is may stand in something that was not read.
        let is_partial = self.tree.objects.iter().any(|o| !o.is_supported);
        for reference in &self.references {
            let Some(&target) = self.ids.get(&reference.id) else {
                if is_partial {
                    self.tree.objects.push(unknown(reference));
                    let object = self.tree.objects.len() - 1;
                    let children = &mut self.tree.objects[reference.parent].children;
                    children[reference.position].object = object;
                    continue;
                }
                let what = format!(
                    "no object has the id \"{}\"{}",
                    shown(&reference.id),
                    known_hint(&reference.id, self.ids.keys().map(String::as_str))
                );
                return Err(SceneError::at(&reference.place, what));
            };
            let child = &mut self.tree.objects[reference.parent].children[reference.position];
            child.object = target;
            child.name.clone_from(&reference.name);
        }
        self.refuse_cycles()
    }

    /// An object that contains itself would never be finished. Objects in place are younger than
    /// what they are in, so every cycle goes through a reference.
    fn refuse_cycles(&self) -> Result<(), SceneError> {
        #[derive(Clone, Copy, PartialEq)]
        enum State {
            New,
            Open,
            Done,
        }
        let mut states = vec![State::New; self.tree.objects.len()];
        // (object, next child to visit): an explicit stack, for chains of references can be long.
        let mut stack = vec![(0, 0)];
        while let Some((object, next)) = stack.pop() {
            states[object] = State::Open;
            let Some(child) = self.tree.objects[object].children.get(next) else {
                states[object] = State::Done;
                continue;
            };
            stack.push((object, next + 1));
            match states[child.object] {
                State::New => stack.push((child.object, 0)),
                State::Done => {}
                State::Open => {
                    let what = "the reference makes the object contain itself";
                    return Err(SceneError::at(&child.place, what));
                }
            }
        }
        Ok(())
    }
}

impl Tree {
    /// The path of a file named in an element of a file in `folder`; the error is a sentence.
    pub fn find_file(
        &self,
        files: &dyn FileSource,
        folder: &Path,
        name: &str,
    ) -> Result<PathBuf, String> {
        if name.is_empty() {
            return Err("the file name is empty".to_string());
        }
        let folders = self.search_folders.iter().map(PathBuf::as_path);
        let folders = folders.chain([folder, &self.scene_folder]);
        // Joining an absolute path gives that path.
        let mut tried = folders.map(|f| f.join(name));
        tried.find(|path| files.exists(path)).ok_or_else(|| {
            format!(
                "file \"{}\" is not there (looked in {}{})",
                shown(name),
                if folder.as_os_str().is_empty() {
                    "."
                } else {
                    ""
                },
                folder.display()
            )
        })
    }
}
