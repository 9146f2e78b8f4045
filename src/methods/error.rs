//! Why the engine gave nothing.

use crate::room::{NoRoom, Unfinished};
use crate::scene::SceneError;

/// Why the engine gave nothing.
#[derive(Clone, Debug, thiserror::Error)]
pub enum EngineError {
    /// The scene, parameter or setting cannot be served.
    #[error("{0}")]
    Refused(String),
    /// [`Progress::cancelled`](super::Progress::cancelled) said so.
    #[error("interrupted")]
    Interrupted,
    /// The machine could not.
    #[error("{0}")]
    Failed(String),
}

impl From<SceneError> for EngineError {
    fn from(error: SceneError) -> Self {
        EngineError::Refused(error.to_string())
    }
}

impl From<NoRoom> for EngineError {
    fn from(error: NoRoom) -> Self {
        EngineError::Failed(error.to_string())
    }
}

impl From<Unfinished> for EngineError {
    fn from(error: Unfinished) -> Self {
        match error {
            Unfinished::NoRoom(error) => error.into(),
            Unfinished::Interrupted => EngineError::Interrupted,
        }
    }
}
