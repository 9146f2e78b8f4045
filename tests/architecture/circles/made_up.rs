//! The graph of sources that are made up: circles that are there are found, and no others.

use super::circles;
use super::graph::Graph;
use crate::sources::Source;

/// The circles among files below `src/`, each as its files.
fn found(files: &[(&str, &str)]) -> Vec<String> {
    let source = |(path, text): &(&str, &str)| Source {
        path: format!("src/{path}"),
        text: text.to_string(),
    };
    let sources: Vec<Source> = files.iter().map(source).collect();
    let graph = Graph::of(&sources);
    let names = |circle: std::collections::BTreeSet<&str>| {
        let names: Vec<&str> = circle.iter().map(|f| &f["src/".len()..]).collect();
        names.join(" ")
    };
    circles(&graph).into_iter().map(names).collect()
}

const ROOT: (&str, &str) = ("lib.rs", "mod a; mod b;");

#[test]
fn one_way_is_no_circle() {
    let files = [
        ROOT,
        ("a.rs", "pub fn f() { crate::b::g(); }"),
        ("b.rs", "pub fn g() {}"),
    ];
    assert!(found(&files).is_empty());
}

#[test]
fn imports_and_paths_make_circles() {
    for use_of_a in [
        "use crate::a::f; pub fn g() { f(); }",
        "use super::a; pub fn g() { a::f(); }",
        "use crate::a as other; pub fn g() { other::f(); }",
        "pub fn g() { assert!(super::a::f()); }",
        "pub fn g() { use crate::a::*; f(); }",
        "pub struct S; impl S { fn g() -> bool { crate::a::f() } }",
        "mod inner { pub fn g() { super::super::a::f(); } } pub use inner::g;",
    ] {
        let files = [
            ROOT,
            ("a.rs", "use crate::b::g; pub fn f() -> bool { g(); true }"),
            ("b.rs", use_of_a),
        ];
        assert_eq!(found(&files), ["a.rs b.rs"], "{use_of_a}");
    }
}

#[test]
fn long_circles_are_one() {
    let files = [
        ("lib.rs", "mod a; mod b; mod c; mod d;"),
        ("a.rs", "pub struct A(crate::b::B);"),
        ("b.rs", "pub struct B(Vec<crate::c::C>);"),
        ("c.rs", "pub struct C(crate::a::A, crate::d::D);"),
        ("d.rs", "pub struct D;"),
    ];
    assert_eq!(found(&files), ["a.rs b.rs c.rs"]);
}

/// Within a folder its own face is another name for the file behind it, and `mod` is no use.
#[test]
fn faces_are_seen_through() {
    let files = [
        ("lib.rs", "mod a;"),
        (
            "a/mod.rs",
            "mod one; mod two; pub use one::f; pub use two::*;",
        ),
        ("a/one.rs", "pub fn f() { crate::a::g(); super::two::g(); }"),
        ("a/two.rs", "pub fn g() {}"),
    ];
    assert!(found(&files).is_empty());
}

#[test]
fn what_a_folder_does_with_its_files_is_use() {
    let files = [
        ("lib.rs", "mod a;"),
        ("a/mod.rs", "mod one; pub use one::f; pub fn h() { f(); }"),
        ("a/one.rs", "pub fn f() { super::h(); }"),
    ];
    assert_eq!(found(&files), ["a/mod.rs a/one.rs"]);
}

/// What another folder shows is the file behind it: `b` uses `a/one`, which uses nothing.
#[test]
fn faces_of_others_are_seen_through() {
    let files = [
        ROOT,
        ("a/mod.rs", "mod one; mod two; pub use self::one::f;"),
        ("a/one.rs", "pub fn f() {}"),
        ("a/two.rs", "use crate::b::g; pub fn h() { g(); }"),
        ("b.rs", "use crate::a::f; pub fn g() { f(); }"),
    ];
    assert!(found(&files).is_empty());
}

#[test]
fn tests_may_look_back() {
    let files = [
        ROOT,
        (
            "a.rs",
            "pub fn f() {} #[cfg(test)] mod tests { use crate::b::g; #[test] fn t() { g(); } }",
        ),
        ("b.rs", "pub fn g() { crate::a::f(); }"),
        ("a/tests.rs", "use crate::b::g;"),
    ];
    assert!(found(&files).is_empty());
}

/// Fields, methods and variables of the name are no use of it.
#[test]
fn words_alike_are_no_use() {
    let files = [
        ROOT,
        (
            "a.rs",
            "pub use crate::b::g; pub fn f(x: crate::b::X) -> u8 { x.g }",
        ),
        ("b.rs", "pub struct X { pub g: u8 } pub fn g() {}"),
    ];
    assert!(found(&files).is_empty());
}
