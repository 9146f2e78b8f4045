//! Files and functions are short, or say why not.

use crate::sources::{Source, all};
use syn::spanned::Spanned;
use syn::visit::{self, Visit};

const LONGEST_FILE: usize = 450;
const MEDIAN_FILE: usize = 150;
const LONGEST_FUNCTION: usize = 80;
const WIDEST_COMMENT: usize = 100;

#[test]
fn files_are_short() {
    let sources = all();
    let mut lengths: Vec<usize> = sources.iter().map(|s| s.text.lines().count()).collect();
    let long: Vec<String> = sources
        .iter()
        .zip(&lengths)
        .filter(|(_, lines)| **lines > LONGEST_FILE)
        .map(|(source, lines)| format!("{}: {lines} lines", source.path))
        .collect();
    assert!(long.is_empty(), "{}", long.join("\n"));
    lengths.sort_unstable();
    let median = lengths[lengths.len() / 2];
    assert!(
        median <= MEDIAN_FILE,
        "half of all files have more than {median} lines"
    );
}

#[test]
fn comments_are_narrow() {
    let is_wide =
        |line: &str| line.trim_start().starts_with("//") && line.chars().count() > WIDEST_COMMENT;
    let of = |source: &Source| -> Vec<String> {
        let lines = source.text.lines().enumerate();
        let wide = lines.filter(|(_, line)| is_wide(line));
        wide.map(|(at, _)| format!("{}:{}", source.path, at + 1))
            .collect()
    };
    let wide: Vec<String> = all().iter().flat_map(of).collect();
    assert!(wide.is_empty(), "{}", wide.join("\n"));
}

#[test]
fn functions_are_short_or_say_why_not() {
    let long: Vec<String> = all().iter().flat_map(long_functions).collect();
    assert!(
        long.is_empty(),
        "write the reason above, as `// Long: <reason>`:\n{}",
        long.join("\n")
    );
}

/// The functions of a file that are too long without a reason.
fn long_functions(source: &Source) -> Vec<String> {
    let file = syn::parse_file(&source.text);
    let file = file.unwrap_or_else(|e| panic!("{}: {e}", source.path));
    let mut functions = Functions::default();
    functions.visit_file(&file);
    let lines: Vec<&str> = source.text.lines().collect();
    let too_long = functions
        .0
        .into_iter()
        .filter(|f| f.last - f.first >= LONGEST_FUNCTION && !has_reason(&lines[..f.first - 1]));
    too_long
        .map(|f| {
            let length = f.last - f.first + 1;
            format!("{}:{}: {}, {length} lines", source.path, f.first, f.name)
        })
        .collect()
}

/// Whether the comments and attributes that these lines end with hold a reason.
fn has_reason(before: &[&str]) -> bool {
    let above = before.iter().rev().map(|line| line.trim());
    above
        .take_while(|line| line.starts_with("//") || line.starts_with("#["))
        .any(|line| {
            let reason = line.trim_start_matches('/').trim().strip_prefix("Long: ");
            line.starts_with("//") && reason.is_some_and(|reason| !reason.trim().is_empty())
        })
}

/// Lines are counted from 1.
struct Function {
    name: String,
    first: usize,
    last: usize,
}

#[derive(Default)]
struct Functions(Vec<Function>);

impl Functions {
    /// From the line of the signature to that of the last brace.
    fn add(&mut self, signature: &syn::Signature, body: &syn::Block) {
        self.0.push(Function {
            name: signature.ident.to_string(),
            first: signature.span().start().line,
            last: body.span().end().line,
        });
    }
}

impl<'ast> Visit<'ast> for Functions {
    fn visit_item_fn(&mut self, item: &'ast syn::ItemFn) {
        self.add(&item.sig, &item.block);
        visit::visit_item_fn(self, item);
    }

    fn visit_impl_item_fn(&mut self, item: &'ast syn::ImplItemFn) {
        self.add(&item.sig, &item.block);
        visit::visit_impl_item_fn(self, item);
    }

    fn visit_trait_item_fn(&mut self, item: &'ast syn::TraitItemFn) {
        if let Some(body) = &item.default {
            self.add(&item.sig, body);
        }
        visit::visit_trait_item_fn(self, item);
    }
}

#[test]
fn long_functions_are_found_but_for_those_with_a_reason() {
    let body = "    g();\n".repeat(LONGEST_FUNCTION - 1);
    let found = |before: &str| {
        let text = format!("{before}fn f() {{\n{body}}}\nfn g() {{}}\n");
        long_functions(&Source {
            path: "made_up.rs".into(),
            text,
        })
    };
    for without in ["", "/// Does f.\n", "// Long:\n", "// Long: a table.\n\n"] {
        let line = without.lines().count() + 1;
        assert_eq!(found(without), [format!("made_up.rs:{line}: f, 81 lines")]);
    }
    for with in [
        "// Long: a table.\n",
        "/// Does f.\n// Long: a table.\n#[test]\n",
    ] {
        assert!(found(with).is_empty(), "{with}");
    }
}
