//! Jobs whose samples are shared out, and how their parts are added up.

pub mod partial;
pub mod share;
pub mod sum;
