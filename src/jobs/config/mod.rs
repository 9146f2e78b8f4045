//! Configurations in TOML: every value knows its place, and keys that nobody asks for are refused.

pub mod document;
pub mod table;
