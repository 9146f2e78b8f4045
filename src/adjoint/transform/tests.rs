//! The source transformation itself: what it writes, what it refuses, and where it says so.

use super::{Library, adjoint_source, check_source};

fn library(files: &[(&str, &str)]) -> Result<Library, String> {
    let files: Vec<_> = files
        .iter()
        .map(|(name, text)| (name.to_string(), format!("k/{name}.rs"), text.to_string()))
        .collect();
    Library::read(&files).map_err(|e| e.to_string())
}

fn transformed(text: &str) -> Result<String, String> {
    let library = library(&[("one", text)])?;
    let module = library.modules().next().expect("one file");
    adjoint_source(&library, module).map_err(|e| e.to_string())
}

/// The statements of the one adjoint in a generated file.
fn body(generated: &str) -> Vec<&str> {
    let lines = generated
        .lines()
        .skip_while(|l| !l.starts_with("pub fn"))
        .skip(1);
    lines.take_while(|l| *l != "}").map(str::trim).collect()
}

#[test]
fn a_product_differentiates_to_products() {
    let text = transformed("pub fn f<F: Real>(a: F, b: F) -> F { let c = a * b; c * c }").unwrap();
    assert!(
        text.contains("pub fn f_adjoint<F: Real>(a: F, b: F, out_bar: F) -> (F, F) {"),
        "{text}"
    );
    let want = [
        "let c = a * b;",
        "let c_bar = out_bar * c + out_bar * c;",
        "let a_bar = c_bar * b;",
        "let b_bar = c_bar * a;",
        "(a_bar, b_bar)",
    ];
    assert_eq!(body(&text), want);
}

#[test]
fn what_nobody_reads_gets_no_code() {
    let text = transformed(
        "pub fn f<F: Real>(a: F, unread: V3<F>) -> F {
            let dead = a.exp();
            let also_dead = dead * dead;
            let sum = a + F::splat(2.0);
            sum - F::splat(1.0) * F::splat(3.0)
        }",
    );
    assert_eq!(body(&text.unwrap()), ["(out_bar, V3::splat(0.0))"]);
}

#[test]
fn a_call_asks_only_for_what_is_active() {
    let text = transformed(
        "pub fn g<F: Real>(a: F, m: F::Mask, b: F) -> F { F::select(m, a, b) }
         pub fn f<F: Real>(a: F) -> F { g(F::splat(1.0), a.lt(F::splat(0.0)), a) }",
    );
    let text = text.unwrap();
    let call = "let (_, g_b_bar) = crate::adjoint::one::g_adjoint(";
    assert!(text.contains(call), "{text}");
    assert!(
        text.contains("pub fn f_adjoint<F: Real>(a: F, out_bar: F) -> F {"),
        "{text}"
    );
}

#[test]
fn calls_are_found_in_other_files() {
    let files = [
        (
            "one",
            "use super::two::{self, g as h};\npub fn f<F: Real>(a: F) -> F { h(two::g(crate::kernels::two::g(a))) }",
        ),
        ("two", "pub fn g<F: Real>(a: F) -> F { a * a }"),
    ];
    let text = adjoint_source(&library(&files).unwrap(), "one").unwrap();
    assert_eq!(
        text.matches("crate::adjoint::two::g_adjoint").count(),
        3,
        "{text}"
    );
}

#[test]
fn constants_keep_their_names_and_test_code_is_left_out() {
    let text = transformed(
        "use std::f64::consts::PI;
         pub const TWO: f64 = 2.0;
         pub fn f<F: Real>(a: F) -> F { a * F::splat(TWO * PI) }
         #[cfg(test)]
         mod tests { fn anything() { loop {} } }",
    );
    let text = text.unwrap();
    for part in [
        "use std::f64::consts::PI;",
        "const TWO: f64 = 2.0;",
        "out_bar * F::splat(TWO * PI)",
    ] {
        assert!(text.contains(part), "{part} is not in {text}");
    }
    assert!(!text.contains("loop"), "{text}");
}

#[test]
fn the_table_lists_kernels_that_have_adjoints() {
    let files = [(
        "one",
        "/// Says its range.\n///\n/// inputs: -1..2, b 0.5..0.6\n\
         pub fn f<F: Real>(a: V3<F>, b: F) -> F { a.x * b }\n\
         pub fn inside<F: Real>(a: F) -> F::Mask { a.lt(F::splat(1.0)) }",
    )];
    let text = check_source(&library(&files).unwrap()).unwrap();
    assert!(
        text.contains("\"one::f\"") && !text.contains("one::inside"),
        "{text}"
    );
    assert_eq!(text.matches("(-1.0, 2.0, false)").count(), 3, "{text}");
    assert_eq!(text.matches("(0.5, 0.6, false)").count(), 1, "{text}");
}

#[test]
fn a_bad_range_is_refused() {
    for range in ["2..1", "q 0..1", "a 0.1", "a..b"] {
        let text = format!("/// inputs: {range}\npub fn f<F: Real>(a: F) -> F {{ a }}");
        let error = check_source(&library(&[("one", &text)]).unwrap())
            .unwrap_err()
            .to_string();
        assert!(
            error.starts_with("k/one.rs:1:1: an inputs line reads"),
            "{error}"
        );
    }
}

/// The rest of a kernel around one line, which stands on line 3.
fn kernel(line: &str) -> String {
    format!(
        "pub fn f<F: Real>(a: V3<F>, b: F, m: F::Mask, k: f64) -> F {{\n    let c = b * b;\n    {line}\n    c\n}}"
    )
}

#[test]
fn statements_outside_the_subset_are_refused_where_they_stand() {
    let cases = [
        ("let d = if true { b } else { c };", 13, "no branches"),
        ("let d = match k { _ => b };", 13, "no branches"),
        ("if true { }", 5, "made of `let` statements"),
        ("for i in 0..3 { }", 5, "made of `let` statements"),
        ("let d = loop { };", 13, "no loops"),
        ("let d = |x: F| x;", 13, "no closures"),
        ("println!();", 5, "made of `let` statements"),
        ("let d = todo!();", 13, "no macros"),
        ("let mut d = b;", 9, "no mutable variables"),
        ("c += b;", 5, "made of `let` statements"),
        ("return b;", 5, "made of `let` statements"),
        ("let d;", 5, "has a value"),
        ("let Some(d) = b;", 9, "binds a name"),
        ("let (d, e) = a;", 9, "cannot take apart V3<F>"),
        ("let d = b.sin();", 15, "F has no method `sin`"),
        ("let d = a.sqrt();", 15, "V3<F> has no method `sqrt`"),
        ("let d = m.any();", 15, "F::Mask has no method `any`"),
        ("let d = a.w;", 15, "V3<F> has no field `w`"),
        ("let d = a / b;", 15, "`/` does not apply to V3<F> and F"),
        ("let d = b * a;", 15, "`*` does not apply to F and V3<F>"),
        ("let d = b < c;", 15, "use lt, le, gt or ge"),
        ("let d = -m;", 13, "`-` does not apply to F::Mask"),
        ("let d = a.dot(b);", 19, "this is F, not V3<F>"),
        ("let d = b.min();", 15, "`min` takes 1 argument"),
        ("let d = b * 2.0;", 17, "written F::splat"),
        ("let d = b * k;", 15, "`*` does not apply to F and f64"),
        (
            "let d = F::splat(b);",
            22,
            "only literals, constants and f64 arguments",
        ),
        ("let d = k;", 13, "stays inside `splat`"),
        ("let d: V3<F> = b;", 20, "this is F, not V3<F>"),
        ("let d = missing(b);", 13, "`missing` is neither a kernel"),
        ("let d = crate::warp::g(b);", 13, "is neither a kernel"),
        ("let d = e;", 13, "`e` is not a value"),
        ("let d = F::select(b, b, c);", 23, "this is F, not F::Mask"),
        ("let d = { b };", 13, "outside the subset"),
        ("let d = &b;", 13, "outside the subset"),
        (
            "let d = Frame { s: b };",
            13,
            "not a struct of a kernel file",
        ),
    ];
    for (line, column, message) in cases {
        let error = transformed(&kernel(line)).expect_err(line);
        let place = format!("k/one.rs:3:{column}: ");
        assert!(
            error.starts_with(&place),
            "{line}: {error} is not at {place}"
        );
        assert!(error.contains(message), "{line}: {error}");
        assert!(
            !error.contains('\n'),
            "{line}: more than one sentence: {error}"
        );
    }
    // The frame around them is itself fine.
    transformed(&kernel("let d = c;")).unwrap();
}

#[test]
fn items_outside_the_subset_are_refused_where_they_stand() {
    let cases = [
        ("fn f<F: Real>(a: F) -> F { a }", "1:4", "is `pub`"),
        ("pub fn f(a: f64) -> f64 { a }", "1:8", "one type parameter"),
        (
            "pub fn f<F: Real, G: Real>(a: F) -> F { a }",
            "1:8",
            "one type parameter",
        ),
        (
            "pub unsafe fn f<F: Real>(a: F) -> F { a }",
            "1:5",
            "plain `pub fn`",
        ),
        (
            "pub fn f<F: Real>(mut a: F) -> F { a }",
            "1:19",
            "plain name",
        ),
        (
            "pub fn f<F: Real>(a: &F) -> F { a }",
            "1:22",
            "a kernel's types are",
        ),
        (
            "pub fn f<F: Real>(a: Vec<F>) -> F { a }",
            "1:22",
            "`Vec<F>` is not a type",
        ),
        ("pub fn f<F: Real>(a: F) { a; }", "1:8", "returns a value"),
        (
            "pub fn f<F: Real>(a: F) -> F { let b = a; }",
            "1:8",
            "ends with its result",
        ),
        (
            "pub fn f<F: Real>(a: F) -> V3<F> { a }",
            "1:36",
            "this is F, not V3<F>",
        ),
        ("\nuse super::two::*;", "2:17", "imports by name"),
        ("impl<F: Real> S<F> { }", "1:1", "holds only"),
        (
            "pub struct S<F: Real> { a: F }",
            "1:12",
            "named `pub` fields",
        ),
        (
            "pub fn f<F: Real>(a: F) -> F {\n    a +\n}",
            "3:1",
            "expected an expression",
        ),
    ];
    for (text, place, message) in cases {
        let error = transformed(text).expect_err(text);
        assert!(
            error.starts_with(&format!("k/one.rs:{place}: ")),
            "{text}: {error} is not at {place}"
        );
        assert!(error.contains(message), "{text}: {error}");
    }
}
