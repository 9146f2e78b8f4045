//! Paths are followed through faces, `pub use` in another file, to what they name.

use super::modules::{Module, Names};
use std::collections::BTreeMap;

/// A chain of faces longer than this goes round.
const MOST_FACES: usize = 20;

pub struct Tree(pub BTreeMap<Names, Module>);

/// What a path names.
enum Named {
    /// A module, or nothing of the crate's.
    Module,
    /// Something defined in this file.
    Item(String),
    /// Something in this file's module that is not written down: a build or a macro makes it.
    Unknown(String),
}

impl Tree {
    /// The file of what a path names, as it is written in a module; none of modules and of what
    /// is foreign.
    pub fn file_of(&self, place: &Names, path: &[String]) -> Option<String> {
        let found = match self.absolute(place, path) {
            Some(path) => Some(self.follow(&path, 0)),
            None => self.by_glob(place, path),
        };
        match found? {
            Named::Module => None,
            Named::Item(file) | Named::Unknown(file) => Some(file),
        }
    }

    /// The path from the root of the crate, if it is one of the crate's and no glob brings it.
    fn absolute(&self, place: &Names, path: &[String]) -> Option<Names> {
        let mut base = place.clone();
        let mut rest = path;
        match path.first()?.as_str() {
            "crate" => {
                base.clear();
                rest = &path[1..];
            }
            "self" | "super" => {
                while let Some(("self" | "super", after)) = rest
                    .split_first()
                    .map(|(first, after)| (first.as_str(), after))
                {
                    if rest[0] == "super" {
                        base.pop()?;
                    }
                    rest = after;
                }
            }
            first => {
                let is_child = self.0.contains_key(&[&place[..], &path[..1]].concat());
                let is_import = self.0[place].imports.iter().any(|i| i.name == first);
                let is_known = is_import || (is_child && path.len() > 1);
                if !is_known {
                    return None;
                }
            }
        }
        base.extend_from_slice(rest);
        Some(base)
    }

    /// What a glob brings, if nothing of the module's own has the name.
    fn by_glob(&self, place: &Names, path: &[String]) -> Option<Named> {
        let module = &self.0[place];
        if module.items.contains(path.first()?) {
            return None;
        }
        self.in_globs(place, path, 0)
    }

    fn in_globs(&self, place: &Names, path: &[String], faces: usize) -> Option<Named> {
        let globs = self.0[place].globs.iter();
        let mut found = globs
            .filter_map(|glob| self.absolute_of_import(place, glob))
            .map(|glob| self.follow(&[&glob[..], path].concat(), faces + 1))
            .filter(|named| !matches!(named, Named::Unknown(_)));
        found.next()
    }

    /// Imports may begin with a child of their module.
    fn absolute_of_import(&self, place: &Names, target: &[String]) -> Option<Names> {
        let child = [&place[..], &target[..1]].concat();
        match self.0.contains_key(&child) {
            true => Some([&place[..], target].concat()),
            false => self.absolute(place, target),
        }
    }

    /// Where a path from the root ends.
    fn follow(&self, path: &[String], faces: usize) -> Named {
        let mut depth = 0;
        while depth < path.len() && self.0.contains_key(&path[..=depth]) {
            depth += 1;
        }
        let (place, rest) = path.split_at(depth);
        let Some(first) = rest.first() else {
            return Named::Module;
        };
        let place = &place.to_vec();
        let Some(module) = self.0.get(place) else {
            return Named::Unknown(String::new());
        };
        if module.items.contains(first) {
            return Named::Item(module.file.clone());
        }
        if faces > MOST_FACES {
            return Named::Unknown(module.file.clone());
        }
        if let Some(import) = module.imports.iter().find(|import| import.name == *first) {
            return match self.absolute_of_import(place, &import.target) {
                Some(target) => self.follow(&[&target[..], &rest[1..]].concat(), faces + 1),
                // Foreign.
                None => Named::Module,
            };
        }
        let globbed = self.in_globs(place, rest, faces);
        globbed.unwrap_or_else(|| Named::Unknown(module.file.clone()))
    }
}
