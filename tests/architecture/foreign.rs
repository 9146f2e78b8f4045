//! `unsafe` stays where foreign functions are called.

use crate::names::Findings;
use crate::sources::of_the_crate;

/// Where the compiler's promises are made by hand: folders and files.
const UNSAFE: [&str; 2] = ["src/trace/", "src/picture/ffi.rs"];

#[test]
fn unsafe_stays_with_foreign_functions() {
    let may = |path: &str| UNSAFE.iter().any(|place| path.starts_with(place));
    let wrong: Vec<String> = of_the_crate()
        .into_iter()
        .filter(|source| !may(&source.path) && Findings::of(source).is_unsafe)
        .map(|source| source.path)
        .collect();
    assert!(wrong.is_empty(), "unsafe code in {wrong:?}");
}
