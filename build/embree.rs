//! Finds Embree 4 or else 3, compiles the shim against its header and binds the shim's own header.

use crate::shim::{self, preprocess, rerun_if_replaced, stop};
use std::env;

const NEEDS: &str = "install what is missing with: sudo apt-get install libembree-dev libclang-dev; or do \
                     without Embree: cargo build --release --no-default-features --features obvhs";

/// Compiles and links `ffi/`; ends the build with one sentence where something is missing.
pub fn build() {
    println!("cargo::rerun-if-changed=ffi");
    println!("cargo::rerun-if-changed=build/embree.rs");
    let version = installed_version();
    let mut shim = cc::Build::new();
    shim.file("ffi/embree_shim.c")
        .define("WARPATH_EMBREE", version)
        .std("gnu11")
        .warnings(true)
        .extra_warnings(true)
        // Debug builds trace rays too, and the copies in the shim are on the hot path.
        .opt_level(3);
    for flag in vector_flags() {
        shim.flag_if_supported(flag);
    }
    if let Err(e) = shim.try_compile("warpath_embree") {
        stop(&format!(
            "the shim over Embree {version} does not compile: {e}"
        ));
    }
    println!("cargo::rustc-link-lib=embree{version}");
    shim::bind("embree_shim", NEEDS);
}

/// `"4"` or `"3"`, whichever header the C compiler finds first.
fn installed_version() -> &'static str {
    if preprocess(&mut cc::Build::new(), "any_compiler.c", "").is_none() {
        stop("no C compiler is installed: sudo apt-get install build-essential");
    }
    for version in ["4", "3"] {
        let header = format!("embree{version}/rtcore.h");
        let source = format!("#include <{header}>\n");
        let probe = format!("has_embree{version}.c");
        if let Some(text) = preprocess(&mut cc::Build::new(), &probe, &source) {
            rerun_if_replaced(&text, &header);
            return version;
        }
    }
    stop(&format!(
        "neither Embree 4 nor Embree 3 is installed: {NEEDS}"
    ))
}

/// The vector instructions rustc was told to use, for the C compiler too.
fn vector_flags() -> impl Iterator<Item = &'static str> {
    let features = env::var("CARGO_CFG_TARGET_FEATURE").unwrap_or_default();
    [
        ("avx2", "-mavx2"),
        ("fma", "-mfma"),
        ("avx512f", "-mavx512f"),
        ("avx512vl", "-mavx512vl"),
    ]
    .into_iter()
    .filter(move |(feature, _)| features.split(',').any(|f| f == *feature))
    .map(|(_, flag)| flag)
}
