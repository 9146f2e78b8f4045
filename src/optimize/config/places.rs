//! Where keys are written, for what only the scene and the pictures can tell.

use crate::jobs::config::document::{Node, Value};
use crate::jobs::failure::Failure;
use std::collections::BTreeMap;

/// The places of keys, by their dotted names.
#[derive(Clone, Debug)]
pub struct Places {
    file: String,
    places: BTreeMap<String, String>,
}

impl Places {
    /// Of a whole document.
    pub fn of(root: &Node, file: String) -> Self {
        let mut places = BTreeMap::new();
        collect(root, "", &mut places);
        Self { file, places }
    }

    /// Refuses what a key says, at its place.
    pub fn wrong(&self, key: &str, what: impl std::fmt::Display) -> Failure {
        let place = self.places.get(key).unwrap_or(&self.file);
        Failure::Input(format!("{place}: {key}: {what}"))
    }
}

fn collect(node: &Node, path: &str, places: &mut BTreeMap<String, String>) {
    if let Value::Table(entries) = &node.value {
        for (key, entry) in entries {
            let dotted = match path {
                "" => key.clone(),
                path => format!("{path}.{key}"),
            };
            places.insert(dotted.clone(), entry.node.place.clone());
            collect(&entry.node, &dotted, places);
        }
    }
}
