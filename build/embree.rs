//! Finds Embree 4 or else 3, compiles the shim against its header and binds the shim's own header.

use std::{env, panic, path::PathBuf, process};

const NEEDS: &str = "install what is missing with: sudo apt-get install libembree-dev libclang-dev";

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
    bind();
}

/// `"4"` or `"3"`, whichever header the C compiler finds first.
fn installed_version() -> &'static str {
    if preprocess("any_compiler.c", "").is_none() {
        stop("no C compiler is installed: sudo apt-get install build-essential");
    }
    for version in ["4", "3"] {
        let header = format!("embree{version}/rtcore.h");
        let source = format!("#include <{header}>\n");
        if let Some(text) = preprocess(&format!("has_embree{version}.c"), &source) {
            // Another version of Embree in its place must be built against anew.
            let mut paths = text.split('"').filter(|path| path.ends_with(&header));
            if let Some(path) = paths.next() {
                println!("cargo::rerun-if-changed={path}");
            }
            return version;
        }
    }
    stop(&format!(
        "neither Embree 4 nor Embree 3 is installed: {NEEDS}"
    ))
}

/// What the C preprocessor makes of `source`, if it takes it.
fn preprocess(name: &str, source: &str) -> Option<String> {
    let probe = out_dir().join(name);
    if let Err(e) = std::fs::write(&probe, source) {
        stop(&format!("cannot write {}: {e}", probe.display()));
    }
    let mut compiler = cc::Build::new();
    compiler.cargo_metadata(false).cargo_warnings(false);
    let text = compiler.file(&probe).try_expand().ok()?;
    Some(String::from_utf8_lossy(&text).into_owned())
}

fn out_dir() -> PathBuf {
    PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"))
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

fn bind() {
    let builder = bindgen::Builder::default()
        .header("ffi/embree_shim.h")
        .use_core();
    // Without libclang bindgen panics, with several lines about paths: one sentence is enough.
    panic::set_hook(Box::new(|_| {}));
    let bindings = panic::catch_unwind(panic::AssertUnwindSafe(|| builder.generate()));
    let _ = panic::take_hook();
    match bindings {
        Err(_) => stop(&format!(
            "bindgen found no libclang, which reads ffi/embree_shim.h for it: {NEEDS}"
        )),
        Ok(Err(e)) => stop(&format!("bindgen cannot read ffi/embree_shim.h: {e}")),
        Ok(Ok(bindings)) => {
            let path = out_dir().join("embree_shim.rs");
            if let Err(e) = bindings.write_to_file(&path) {
                stop(&format!("cannot write {}: {e}", path.display()));
            }
        }
    }
}

fn stop(sentence: &str) -> ! {
    println!("cargo::error={sentence}");
    process::exit(1)
}
