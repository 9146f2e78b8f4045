//! What building any shim over a library of the system needs.

use std::{env, panic, path::PathBuf, process};

/// What the preprocessor makes of `source` in a file of this `name`, if it takes it.
pub fn preprocess(compiler: &mut cc::Build, name: &str, source: &str) -> Option<String> {
    let probe = out_dir().join(name);
    if let Err(e) = std::fs::write(&probe, source) {
        stop(&format!("cannot write {}: {e}", probe.display()));
    }
    compiler.cargo_metadata(false).cargo_warnings(false);
    let text = compiler.file(&probe).try_expand().ok()?;
    Some(String::from_utf8_lossy(&text).into_owned())
}

/// Builds anew when the `header` that the preprocessed `text` included changes: another version of
/// the library may be in its place.
pub fn rerun_if_replaced(text: &str, header: &str) {
    if let Some(path) = text.split('"').find(|path| path.ends_with(header)) {
        println!("cargo::rerun-if-changed={path}");
    }
}

/// Writes what Rust needs to call `ffi/NAME.h` to `NAME.rs`; `needs` says how to install libclang.
pub fn bind(name: &str, needs: &str) {
    let header = format!("ffi/{name}.h");
    let builder = bindgen::Builder::default()
        .header(&header)
        .derive_default(true)
        .use_core();
    // Without libclang bindgen panics, with several lines about paths: one sentence is enough.
    panic::set_hook(Box::new(|_| {}));
    let bindings = panic::catch_unwind(panic::AssertUnwindSafe(|| builder.generate()));
    let _ = panic::take_hook();
    match bindings {
        Err(_) => stop(&format!(
            "bindgen found no libclang, which reads {header} for it: {needs}"
        )),
        Ok(Err(e)) => stop(&format!("bindgen cannot read {header}: {e}")),
        Ok(Ok(bindings)) => {
            let path = out_dir().join(format!("{name}.rs"));
            if let Err(e) = bindings.write_to_file(&path) {
                stop(&format!("cannot write {}: {e}", path.display()));
            }
        }
    }
}

/// Where the build writes.
fn out_dir() -> PathBuf {
    PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"))
}

/// Ends the build with one sentence.
pub fn stop(sentence: &str) -> ! {
    println!("cargo::error={sentence}");
    process::exit(1)
}
