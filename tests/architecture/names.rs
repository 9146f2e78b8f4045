//! What a file says of other modules and of `unsafe`, word by word.

use std::collections::BTreeSet;
use syn::visit::{self, Visit};

#[derive(Default)]
pub struct Findings {
    /// First names after `crate::`.
    pub modules: BTreeSet<String>,
    pub is_unsafe: bool,
}

impl Findings {
    pub fn of(source: &crate::sources::Source) -> Self {
        let file = syn::parse_file(&source.text);
        let file = file.unwrap_or_else(|e| panic!("{}: {e}", source.path));
        let mut findings = Self::default();
        findings.visit_file(&file);
        // What macros are given is no syntax tree: look at the words.
        findings.visit_tokens(source.text.parse().expect("tokens"));
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
