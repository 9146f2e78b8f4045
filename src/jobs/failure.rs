//! Every way a command or a job can end, and its code.

use crate::methods::EngineError;
use crate::output::FileError;
use crate::output::results::NotFinite;
use crate::scene::SceneError;

/// Why a command or a job did not do what was asked. The text tells the user what would be right.
#[derive(Clone, Debug, thiserror::Error)]
pub enum Failure {
    /// A check said no. It has already said why.
    #[error("{0}")]
    Disagreement(String),
    /// A check cannot tell: what it looks for is lost in noise.
    #[error("{0}")]
    Unsure(String),
    /// Wrong usage.
    #[error("{0}")]
    Usage(String),
    /// The scene, a parameter or a file is bad.
    #[error("{0}")]
    Input(String),
    /// The system failed: files, memory.
    #[error("{0}")]
    System(String),
    /// A batch finished, and so many of its jobs failed.
    #[error("{0} of {1} jobs failed")]
    Jobs(usize, usize),
    /// The user's signal, by its number.
    #[error("interrupted")]
    Interrupted(u8),
    /// Whoever reads stdout has had enough: nobody's failure.
    #[error("stdout was closed")]
    BrokenPipe,
}

impl Failure {
    /// The program's exit code.
    pub fn code(&self) -> u8 {
        match self {
            Failure::BrokenPipe => 0,
            Failure::Disagreement(_) => 1,
            Failure::Usage(_) => 2,
            Failure::Input(_) => 3,
            Failure::System(_) => 4,
            Failure::Jobs(..) => 5,
            Failure::Unsure(_) => 6,
            // The shells' convention for a process ended by a signal.
            Failure::Interrupted(signal) => 128 + signal,
        }
    }

    /// The same, with the place at which it was found before it.
    pub fn at(self, place: &str) -> Self {
        let at = |what: String| format!("{place}: {what}");
        match self {
            Failure::Input(what) => Failure::Input(at(what)),
            Failure::System(what) => Failure::System(at(what)),
            other => other,
        }
    }

    /// What the engine said, given the signal that may have stopped it.
    pub fn from_engine(error: EngineError, signal: Option<u8>) -> Self {
        match error {
            EngineError::Refused(what) => Failure::Input(what),
            EngineError::Failed(what) => Failure::System(what),
            EngineError::Interrupted => Failure::Interrupted(signal.unwrap_or(2)),
        }
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        match error {
            FileError::Io { .. } => Failure::System(error.to_string()),
            FileError::Contents { .. } => Failure::Input(error.to_string()),
        }
    }
}

impl From<NotFinite> for Failure {
    fn from(error: NotFinite) -> Self {
        Failure::Input(error.to_string())
    }
}

impl From<SceneError> for Failure {
    fn from(error: SceneError) -> Self {
        if error.is_io() {
            Failure::System(error.to_string())
        } else {
            Failure::Input(error.to_string())
        }
    }
}

impl From<std::io::Error> for Failure {
    /// Errors of stdout: all other files are written through [`crate::output`].
    fn from(error: std::io::Error) -> Self {
        match error.kind() {
            std::io::ErrorKind::BrokenPipe => Failure::BrokenPipe,
            _ => Failure::System(format!("stdout: {}", crate::output::plain(&error))),
        }
    }
}
