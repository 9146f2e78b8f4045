//! What can go wrong while a scene is loaded or a parameter is named, always with the place.

use crate::files::plain;
use std::fmt;
use std::sync::Arc;
use thiserror::Error;

/// A position in a scene file: of the file the element is written in, also inside an include.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// As it was found: the path given, or the one it was resolved to.
    pub file: Arc<str>,
    /// From 1.
    pub line: u32,
    /// From 1, in characters.
    pub column: u32,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:{}:{}", self.file, self.line, self.column)
    }
}

/// Why a scene could not be loaded, or a parameter not be used.
#[derive(Debug, Error)]
pub enum SceneError {
    /// The scene file is wrong at this place.
    #[error("{place}: {what}")]
    Scene {
        /// Where.
        place: Place,
        /// What is wrong, and what would be right.
        what: String,
    },
    /// Several things are wrong.
    #[error("{}", lines(.all))]
    Several {
        /// In the order in which they were found.
        all: Vec<SceneError>,
    },
    /// A mesh file is wrong.
    #[error("{file}{at}: {what} (mesh of the shape at {used_at})")]
    Mesh {
        /// The mesh file, as it was found.
        file: String,
        /// `:line`, `, face 12`, `, vertex 3`, or nothing.
        at: String,
        /// What is wrong, and what would be right.
        what: String,
        /// The shape that reads the file.
        used_at: Place,
    },
    /// A file is not there, or is no file: named on the command line or by a scene.
    #[error("{what}")]
    Missing {
        /// Which, and why it cannot be one.
        what: String,
    },
    /// A `-D name=value` that nothing uses.
    #[error("{what}")]
    Define {
        /// Which, and what there is instead.
        what: String,
    },
    /// A parameter key or its values are wrong.
    #[error("{what}")]
    Parameter {
        /// Which, why, and the nearest key that exists.
        what: String,
    },
    /// The file is there and cannot be read.
    #[error("{file}: {}", plain(.source))]
    Io {
        /// The file, as it was found.
        file: String,
        /// What the system says.
        source: std::io::Error,
    },
}

impl SceneError {
    /// Whether the system failed (exit code 4) rather than the input being bad (exit code 3).
    pub fn is_io(&self) -> bool {
        match self {
            SceneError::Io { .. } => true,
            SceneError::Several { all } => all.iter().all(SceneError::is_io),
            _ => false,
        }
    }

    /// All that is wrong, each once; nothing if nothing is.
    pub fn all(errors: Vec<SceneError>) -> Result<(), SceneError> {
        let mut all: Vec<SceneError> = Vec::new();
        for error in errors {
            let text = error.to_string();
            if all.iter().all(|e| e.to_string() != text) {
                all.push(error);
            }
        }
        match all.pop() {
            None => Ok(()),
            Some(only) if all.is_empty() => Err(only),
            Some(last) => {
                all.push(last);
                Err(SceneError::Several { all })
            }
        }
    }

    /// The scene file is wrong at `place`.
    pub fn at(place: &Place, what: impl Into<String>) -> Self {
        SceneError::Scene {
            place: place.clone(),
            what: what.into(),
        }
    }

    /// A parameter key or its values are wrong.
    pub fn parameter(what: impl Into<String>) -> Self {
        SceneError::Parameter { what: what.into() }
    }
}

/// More than these are counted, not printed.
const ERRORS_PRINTED: usize = 20;

/// One a line.
fn lines(all: &[SceneError]) -> String {
    let mut lines: Vec<String> = all
        .iter()
        .take(ERRORS_PRINTED)
        .map(SceneError::to_string)
        .collect();
    if all.len() > ERRORS_PRINTED {
        lines.push(format!("and {} more", all.len() - ERRORS_PRINTED));
    }
    lines.join("\n")
}
