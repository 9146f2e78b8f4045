//! The tree of modules: what each defines, imports and says.

use crate::sources::Source;
use proc_macro2::{TokenStream, TokenTree};
use quote::ToTokens;
use std::collections::{BTreeMap, BTreeSet};
use syn::{Item, UseTree, Visibility};

/// Names from the root of the crate or, as written, from where they stand.
pub type Names = Vec<String>;

/// A name that `use` gives to something else.
pub struct Import {
    pub name: String,
    /// As written.
    pub target: Names,
    /// Given on to others, which alone is no use of it.
    pub is_face: bool,
}

/// A module in a file of its own, or within one.
#[derive(Default)]
pub struct Module {
    pub file: String,
    pub items: BTreeSet<String>,
    pub imports: Vec<Import>,
    /// `use x::*`.
    pub globs: Vec<Names>,
    /// All items but imports and modules.
    pub tokens: Vec<TokenStream>,
}

/// All modules of a crate but those of tests, by their path.
pub fn modules(sources: &[Source]) -> BTreeMap<Names, Module> {
    let mut tree = BTreeMap::new();
    for source in sources {
        if let Some(path) = path_of(&source.path) {
            let file = syn::parse_file(&source.text);
            let file = file.unwrap_or_else(|e| panic!("{}: {e}", source.path));
            add(&mut tree, path, &source.path, &file.items);
        }
    }
    tree
}

/// The path of a file's module. The program's own file and those of tests have none.
fn path_of(file: &str) -> Option<Names> {
    let inside = file.strip_prefix("src/")?.strip_suffix(".rs")?;
    let mut names: Names = inside.split('/').map(String::from).collect();
    let is_test = |name: &String| name == "tests" || name.ends_with("_tests");
    if inside == "main" || names.iter().any(is_test) {
        return None;
    }
    if inside == "lib" || names.last().is_some_and(|name| name == "mod") {
        names.pop();
    }
    Some(names)
}

fn add(tree: &mut BTreeMap<Names, Module>, path: Names, file: &str, items: &[Item]) {
    let mut module = Module {
        file: file.to_string(),
        ..Module::default()
    };
    for item in items {
        let tokens = item.to_token_stream();
        if starts_with_test(&tokens) {
            continue;
        }
        match item {
            Item::Use(item) => module.import(&item.tree, &item.vis),
            Item::Mod(inner) => {
                if let Some((_, items)) = &inner.content {
                    let path = [&path[..], &[inner.ident.to_string()]].concat();
                    add(tree, path, file, items);
                }
            }
            _ => {
                module.items.extend(name_of(item));
                module.inner_imports(&tokens);
                module.tokens.push(tokens);
            }
        }
    }
    tree.insert(path, module);
}

fn name_of(item: &Item) -> Option<String> {
    let name = match item {
        Item::Const(item) => &item.ident,
        Item::Enum(item) => &item.ident,
        Item::Fn(item) => &item.sig.ident,
        Item::Static(item) => &item.ident,
        Item::Struct(item) => &item.ident,
        Item::Trait(item) => &item.ident,
        Item::Type(item) => &item.ident,
        Item::Union(item) => &item.ident,
        Item::Macro(item) => item.ident.as_ref()?,
        _ => return None,
    };
    Some(name.to_string())
}

/// `#[cfg(test)]`, alone or with more, among the attributes that come first.
fn starts_with_test(tokens: &TokenStream) -> bool {
    let trees: Vec<TokenTree> = tokens.clone().into_iter().collect();
    let attributes = trees.chunks(2).take_while(|pair| is_hash(&pair[0]));
    attributes.into_iter().any(|pair| is_of_tests(&pair[1]))
}

pub fn is_hash(tree: &TokenTree) -> bool {
    matches!(tree, TokenTree::Punct(punct) if punct.as_char() == '#')
}

/// The brackets of an attribute that leaves something to tests.
pub fn is_of_tests(brackets: &TokenTree) -> bool {
    let text = brackets.to_string().replace(' ', "");
    text == "[cfg(test)]" || text.starts_with("[cfg(all(test,")
}

impl Module {
    fn import(&mut self, tree: &UseTree, visibility: &Visibility) {
        let is_face = !matches!(visibility, Visibility::Inherited);
        self.flatten(&mut Vec::new(), tree, is_face);
    }

    fn flatten(&mut self, before: &mut Names, tree: &UseTree, is_face: bool) {
        match tree {
            UseTree::Path(path) => {
                before.push(path.ident.to_string());
                self.flatten(before, &path.tree, is_face);
                before.pop();
            }
            UseTree::Group(group) => {
                for tree in &group.items {
                    self.flatten(before, tree, is_face);
                }
            }
            UseTree::Glob(_) => self.globs.push(before.clone()),
            UseTree::Name(name) => self.name(before, &name.ident, &name.ident, is_face),
            UseTree::Rename(name) => self.name(before, &name.ident, &name.rename, is_face),
        }
    }

    /// `use before::{self as name}` is `use before as name`.
    fn name(&mut self, before: &Names, of: &syn::Ident, name: &syn::Ident, is_face: bool) {
        let mut target = before.clone();
        if of != "self" {
            target.push(of.to_string());
        }
        let name = match name == "self" {
            true => target.last().cloned().unwrap_or_default(),
            false => name.to_string(),
        };
        self.imports.push(Import {
            name,
            target,
            is_face,
        });
    }

    /// Imports within functions.
    fn inner_imports(&mut self, tokens: &TokenStream) {
        let mut trees = tokens.clone().into_iter();
        while let Some(tree) = trees.next() {
            match tree {
                TokenTree::Group(group) => self.inner_imports(&group.stream()),
                TokenTree::Ident(word) if word == "use" => {
                    let end = |tree: &TokenTree| tree.to_string() == ";";
                    let rest: TokenStream = trees.by_ref().take_while(|t| !end(t)).collect();
                    // `use<'a>` in a type is no import.
                    if let Ok(tree) = syn::parse2::<UseTree>(rest) {
                        self.import(&tree, &Visibility::Inherited);
                    }
                }
                _ => {}
            }
        }
    }
}
