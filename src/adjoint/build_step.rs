//! The part of the build that derives adjoints: reads kernel files, writes `OUT_DIR/adjoint/`.

mod transform;

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::{env, fs, io};

/// Kernels of the crate, and kernels only tests use, with the folder of `OUT_DIR` each goes to.
const SOURCES: [(&str, &str); 2] = [
    ("src/kernels", "adjoint"),
    ("tests/adjoint/kernels", "test_adjoint"),
];

/// Derives all adjoints. What lies outside the subset fails the build with its place and one
/// sentence.
pub fn derive_adjoints() {
    println!("cargo:rerun-if-changed=src/adjoint/build_step.rs");
    println!("cargo:rerun-if-changed=src/adjoint/transform");
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    for (from, to) in SOURCES {
        println!("cargo:rerun-if-changed={from}");
        // Packaged without its tests, the crate still builds.
        if Path::new(from).is_dir()
            && let Err(message) = derive(Path::new(from), &out.join(to))
        {
            println!("cargo::error={message}");
        }
    }
}

fn derive(from: &Path, to: &Path) -> Result<(), String> {
    let sources = kernel_sources(from).map_err(|e| format!("{}: {e}", from.display()))?;
    let library = transform::Library::read(&sources).map_err(|e| e.to_string())?;
    let mut all = String::new();
    let folder = to.file_name().expect("a named folder").to_string_lossy();
    let mut texts = Vec::new();
    for module in library.modules() {
        let text = transform::adjoint_source(&library, module).map_err(|e| e.to_string())?;
        texts.push((module.to_string(), text));
        let path = format!("/{folder}/{module}.rs");
        writeln!(
            all,
            "/// Adjoints of the kernels in `{module}`.\n\
             #[allow(unused_imports, unused_variables, dead_code, clippy::all)]\n\
             pub mod {module} {{\n    include!(concat!(env!(\"OUT_DIR\"), {path:?}));\n}}"
        )
        .expect("writing to a string");
    }
    texts.push(("all".into(), all));
    texts.push((
        "check".into(),
        transform::check_source(&library).map_err(|e| e.to_string())?,
    ));
    fs::create_dir_all(to).map_err(|e| format!("{}: {e}", to.display()))?;
    for (name, text) in texts {
        let path = to.join(format!("{name}.rs"));
        fs::write(&path, text).map_err(|e| format!("{}: {e}", path.display()))?;
    }
    Ok(())
}

/// (module name, path, text) of each kernel file, in order of name.
fn kernel_sources(folder: &Path) -> io::Result<Vec<(String, String, String)>> {
    let mut paths = fs::read_dir(folder)?
        .map(|entry| Ok(entry?.path()))
        .collect::<io::Result<Vec<_>>>()?;
    paths.sort();
    let mut sources = Vec::new();
    for path in paths {
        let module = path
            .file_stem()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned();
        let is_rust = path.extension().is_some_and(|e| e == "rs");
        if !is_rust || module == "mod" {
            continue;
        }
        if matches!(
            module.as_str(),
            "ops" | "all" | "check" | "transform" | "build_step"
        ) {
            return Err(io::Error::other(format!(
                "a kernel file cannot be called {module}.rs: the adjoints use that name"
            )));
        }
        let text = fs::read_to_string(&path)?;
        sources.push((module, path.to_string_lossy().into_owned(), text));
    }
    Ok(sources)
}
