//! Modules depend on each other in one direction.

use crate::names::Findings;
use crate::sources::of_the_crate;
use std::collections::BTreeSet;

/// Each module may use those before it.
const ORDER: [&str; 22] = [
    "room",
    "files",
    "lanes",
    "picture",
    "statistics",
    "scene",
    "trace",
    "kernels",
    "adjoint",
    "discontinuity",
    "paths",
    "gradient",
    "boundary",
    "warp",
    "methods",
    "output",
    "jobs",
    "bench",
    "batch",
    "optimize",
    "study",
    "cli",
];

/// Modules that may use less than the order allows.
const ONLY: [(&str, &[&str]); 4] = [
    ("picture", &["room", "files", "picture"]),
    ("kernels", &["lanes", "kernels"]),
    // The two meet in the stored boundary samples alone.
    (
        "boundary",
        &[
            "lanes",
            "scene",
            "trace",
            "kernels",
            "discontinuity",
            "paths",
            "boundary",
        ],
    ),
    // Nor does what moves samples know of either.
    (
        "warp",
        &["lanes", "scene", "trace", "discontinuity", "paths", "warp"],
    ),
];

/// The top module that a file belongs to; `lib.rs` and `main.rs` belong to none.
fn module(path: &str) -> Option<String> {
    let first = path.split('/').nth(1).expect("below src");
    let first = first.trim_end_matches(".rs");
    (first != "lib" && first != "main").then(|| first.to_string())
}

fn place(module: &str) -> Option<usize> {
    ORDER.iter().position(|m| *m == module)
}

#[test]
fn modules_use_only_what_comes_before_them() {
    let mut wrong = Vec::new();
    let mut met = BTreeSet::new();
    for source in of_the_crate() {
        let path = &source.path;
        let Some(module) = module(path) else {
            continue;
        };
        met.insert(module.clone());
        let Some(own) = place(&module) else {
            wrong.push(format!("{path}: {module} has no place in the order"));
            continue;
        };
        let only = ONLY.iter().find(|o| o.0 == module).map(|o| o.1);
        for used in Findings::of(&source).modules {
            let is_allowed = match place(&used) {
                Some(other) => only.map_or(other <= own, |names| names.contains(&used.as_str())),
                None => false,
            };
            if !is_allowed {
                wrong.push(format!("{path}: {module} uses {used}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    let missing: Vec<_> = ORDER.iter().filter(|m| !met.contains(**m)).collect();
    assert!(
        missing.is_empty(),
        "no sources of {missing:?}: the order names what is not there"
    );
}
