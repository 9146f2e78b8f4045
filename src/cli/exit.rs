//! The code that tells scripts how a command ended.

pub use crate::jobs::failure::Failure;
use std::process::ExitCode;

impl From<&Failure> for ExitCode {
    fn from(failure: &Failure) -> Self {
        ExitCode::from(failure.code())
    }
}
