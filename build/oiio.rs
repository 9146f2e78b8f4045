//! Compiles the shim over OpenImageIO, for the feature `oiio`.

use crate::shim::{bind, preprocess, rerun_if_replaced, stop};

const HEADER: &str = "OpenImageIO/imageio.h";
const NEEDS: &str = "install what is missing with: sudo apt-get install --no-install-recommends libopenimageio-dev libclang-dev";

/// Compiles and links `ffi/oiio_shim.cpp`; ends the build with one sentence where something is
/// missing.
pub fn build() {
    println!("cargo::rerun-if-changed=build/oiio.rs");
    if preprocess(&mut compiler(), "any_compiler.cpp", "").is_none() {
        stop("no C++ compiler is installed: sudo apt-get install build-essential");
    }
    let source = format!("#include <{HEADER}>\n");
    match preprocess(&mut compiler(), "has_oiio.cpp", &source) {
        Some(text) => rerun_if_replaced(&text, HEADER),
        None => stop(&format!(
            "the feature oiio is on and OpenImageIO is not installed: {NEEDS}"
        )),
    }
    let mut shim = compiler();
    shim.file("ffi/oiio_shim.cpp")
        .warnings(true)
        .extra_warnings(true)
        // Its headers are not ours to mend.
        .flag_if_supported("-Wno-unused-parameter");
    if let Err(e) = shim.try_compile("warpath_oiio") {
        stop(&format!("the shim over OpenImageIO does not compile: {e}"));
    }
    println!("cargo::rustc-link-lib=OpenImageIO");
    println!("cargo::rustc-link-lib=OpenImageIO_Util");
    bind("oiio_shim", NEEDS);
}

fn compiler() -> cc::Build {
    let mut compiler = cc::Build::new();
    compiler.cpp(true).std("gnu++17");
    compiler
}
