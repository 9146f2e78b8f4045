//! What tells scenes apart.

use std::path::PathBuf;

/// Which scene: its file and the values of its `$name`s.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct SceneKey {
    pub path: PathBuf,
    pub defines: Vec<(String, String)>,
}
