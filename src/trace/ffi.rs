//! The C interface of `ffi/embree_shim.h`, as bindgen reads it.
#![allow(non_camel_case_types, dead_code, missing_docs, clippy::all)]

include!(concat!(env!("OUT_DIR"), "/embree_shim.rs"));
