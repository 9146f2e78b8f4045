//! The sources as files and as text.

use std::path::{Path, PathBuf};

pub fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// All Rust files below a folder, in order.
pub fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    collect(folder, &mut files);
    files.sort();
    files
}

fn collect(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            collect(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
}

/// One file: its path below the root, and what stands in it.
pub struct Source {
    pub path: String,
    pub text: String,
}

fn read(path: &Path) -> Source {
    let below = path.strip_prefix(root()).expect("below the root");
    Source {
        path: below.to_string_lossy().into_owned(),
        text: std::fs::read_to_string(path).expect("a source file"),
    }
}

/// Everything that is written by hand in Rust.
pub fn all() -> Vec<Source> {
    let folders = ["src", "tests", "build", "examples", "benches", "fuzz"];
    let mut paths = vec![root().join("build.rs")];
    for folder in folders {
        paths.extend(rust_files(&root().join(folder)));
    }
    // What fuzzing leaves there is not ours.
    paths.retain(|path| !path.starts_with(root().join("fuzz/target")));
    paths.iter().map(|path| read(path)).collect()
}

/// The library and the program.
pub fn of_the_crate() -> Vec<Source> {
    let files = rust_files(&root().join("src"));
    files.iter().map(|path| read(path)).collect()
}
