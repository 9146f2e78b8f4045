//! The text of one scene file, its places, and the attributes of its elements.

use super::plugins;
use super::positions::Positions;
use crate::scene::error::{Place, SceneError};
use crate::scene::nearest::{known_hint, shown};
use roxmltree::Node;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// One file while its elements are read.
pub(super) struct File {
    pub name: Arc<str>,
    pub folder: Arc<PathBuf>,
    positions: Positions,
    pub text: String,
}

/// The attributes of an element after substitution.
pub(super) struct Attributes(pub Vec<(String, String)>);

impl Attributes {
    pub fn get(&self, name: &str) -> Option<String> {
        let found = self.0.iter().find(|(n, _)| n == name);
        found.map(|(_, value)| value.clone())
    }

    /// Present: checked by `expect`.
    pub fn text(&self, name: &str) -> String {
        self.get(name).unwrap_or_default()
    }
}

pub(super) fn folder_of(path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).to_path_buf()
}

impl File {
    pub fn new(path: &Path, text: String) -> Self {
        Self {
            name: path.display().to_string().into(),
            folder: Arc::new(folder_of(path)),
            positions: Positions::of(&text),
            text,
        }
    }

    pub fn place(&self, node: &Node) -> Place {
        self.place_of_byte(node.range().start)
    }

    pub fn place_of_byte(&self, at: usize) -> Place {
        let (line, column) = self.positions.of_byte(&self.text, at);
        Place {
            file: self.name.clone(),
            line,
            column,
        }
    }
}

pub(super) fn utf8(path: &Path, bytes: Vec<u8>) -> Result<String, SceneError> {
    String::from_utf8(bytes).map_err(|e| {
        let good = &e.as_bytes()[..e.utf8_error().valid_up_to()];
        let line_start = good
            .iter()
            .rposition(|&b| b == b'\n')
            .map_or(0, |at| at + 1);
        let place = Place {
            file: path.display().to_string().into(),
            line: good.iter().filter(|&&b| b == b'\n').count() as u32 + 1,
            column: String::from_utf8_lossy(&good[line_start..]).chars().count() as u32 + 1,
        };
        SceneError::at(&place, "the file is not UTF-8 text")
    })
}

pub(super) fn unknown_tag(place: &Place, tag: &str) -> SceneError {
    let hint = known_hint(tag, plugins::all_tags());
    SceneError::at(place, format!("unknown element <{}>{hint}", shown(tag)))
}

pub(super) fn no_elements_inside(file: &File, node: Node, tag: &str) -> Result<(), SceneError> {
    if tag == "transform" {
        return Ok(());
    }
    match node.children().find(Node::is_element) {
        None => Ok(()),
        Some(child) => {
            let inner = shown(child.tag_name().name());
            let what = format!("<{inner}> cannot stand inside <{}>", shown(tag));
            Err(SceneError::at(&file.place(&child), what))
        }
    }
}
