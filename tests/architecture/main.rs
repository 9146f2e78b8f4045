//! Modules depend on each other in one direction, and `unsafe` stays where foreign functions are called.

mod references;

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};

/// Each module may use those before it.
const ORDER: [&str; 18] = [
    "room",
    "files",
    "lanes",
    "picture",
    "statistics",
    "scene",
    "trace",
    "kernels",
    "adjoint",
    "warp",
    "paths",
    "gradient",
    "methods",
    "output",
    "jobs",
    "bench",
    "batch",
    "cli",
];

/// Modules that may use less than the order allows.
const ONLY: [(&str, &[&str]); 2] = [
    ("picture", &["room", "files", "picture"]),
    ("kernels", &["lanes", "kernels"]),
];

/// Where the compiler's promises are made by hand: folders and files below `src`.
const UNSAFE: [&str; 2] = ["trace", "picture/ffi.rs"];

fn rust_files(folder: &Path, out: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).expect("a folder of sources") {
        let path = entry.expect("an entry").path();
        if path.is_dir() {
            rust_files(&path, out);
        } else if path.extension().is_some_and(|e| e == "rs") {
            out.push(path);
        }
    }
}

/// The sources of the library with the top module each belongs to; `lib.rs` and `main.rs` belong to none.
fn sources() -> Vec<(String, PathBuf)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&root, &mut files);
    let module = |path: &Path| {
        let inside = path.strip_prefix(&root).expect("below src");
        let first = inside
            .components()
            .next()
            .expect("a name")
            .as_os_str()
            .to_string_lossy();
        first.trim_end_matches(".rs").to_string()
    };
    files
        .into_iter()
        .map(|path| (module(&path), path))
        .collect()
}

/// What a file says of other modules and of `unsafe`.
#[derive(Default)]
struct Findings {
    /// First names after `crate::`.
    modules: BTreeSet<String>,
    is_unsafe: bool,
}

impl Findings {
    fn of(path: &Path) -> Self {
        let text = std::fs::read_to_string(path).expect("a source file");
        let file = syn::parse_file(&text).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
        let mut findings = Self::default();
        findings.visit_file(&file);
        // What macros are given is no syntax tree: look at the words.
        findings.visit_tokens(text.parse().expect("tokens"));
        findings
    }

    /// `crate::name` and `unsafe` anywhere in the tokens.
    fn visit_tokens(&mut self, tokens: proc_macro2::TokenStream) {
        use proc_macro2::TokenTree::{Group, Ident, Punct};
        let trees: Vec<_> = tokens.into_iter().collect();
        for (i, tree) in trees.iter().enumerate() {
            match tree {
                Group(group) => self.visit_tokens(group.stream()),
                Ident(word) if word == "unsafe" => self.is_unsafe = true,
                Ident(word) if word == "crate" => {
                    if let (Some(Punct(colon)), Some(Ident(name))) =
                        (trees.get(i + 1), trees.get(i + 3))
                        && colon.as_char() == ':'
                    {
                        self.modules.insert(name.to_string());
                    }
                }
                _ => {}
            }
        }
    }
}

impl<'ast> Visit<'ast> for Findings {
    /// `use crate::{a::…, b::…}` names several.
    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        if let syn::UseTree::Path(path) = &item.tree
            && path.ident == "crate"
        {
            self.first_names(&path.tree);
        }
        visit::visit_item_use(self, item);
    }
}

impl Findings {
    fn first_names(&mut self, tree: &syn::UseTree) {
        match tree {
            syn::UseTree::Path(path) => drop(self.modules.insert(path.ident.to_string())),
            syn::UseTree::Name(name) => drop(self.modules.insert(name.ident.to_string())),
            syn::UseTree::Rename(name) => drop(self.modules.insert(name.ident.to_string())),
            syn::UseTree::Group(group) => {
                group.items.iter().for_each(|tree| self.first_names(tree))
            }
            syn::UseTree::Glob(_) => drop(self.modules.insert("*".into())),
        }
    }
}

fn place(module: &str) -> Option<usize> {
    ORDER.iter().position(|m| *m == module)
}

#[test]
fn modules_use_only_what_comes_before_them() {
    let mut wrong = Vec::new();
    let mut met = BTreeSet::new();
    for (module, path) in sources() {
        if module == "lib" || module == "main" {
            continue;
        }
        met.insert(module.clone());
        let Some(own) = place(&module) else {
            wrong.push(format!(
                "{}: {module} has no place in the order",
                path.display()
            ));
            continue;
        };
        let only = ONLY.iter().find(|o| o.0 == module).map(|o| o.1);
        for used in Findings::of(&path).modules {
            let is_allowed = match place(&used) {
                Some(other) => only.map_or(other <= own, |names| names.contains(&used.as_str())),
                None => false,
            };
            if !is_allowed {
                wrong.push(format!("{}: {module} uses {used}", path.display()));
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

#[test]
fn unsafe_stays_with_foreign_functions() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let may = |path: &Path| {
        UNSAFE
            .iter()
            .any(|place| path.starts_with(root.join(place)))
    };
    let wrong: Vec<String> = sources()
        .into_iter()
        .filter(|(_, path)| !may(path) && Findings::of(path).is_unsafe)
        .map(|(_, path)| path.display().to_string())
        .collect();
    assert!(wrong.is_empty(), "unsafe code in {wrong:?}");
}
