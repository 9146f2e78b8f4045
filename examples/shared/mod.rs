//! What the examples that measure have in common.
#![allow(dead_code)] // each of them needs some of it

pub mod accuracy;
pub mod program;
