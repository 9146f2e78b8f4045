//! Which file uses which: every path in it, followed to the file that defines what the path names.

use super::faces::Tree;
use super::modules::{Names, is_hash, is_of_tests, modules};
use crate::sources::Source;
use proc_macro2::{Delimiter, TokenStream, TokenTree};
use std::collections::BTreeMap;

/// The files that each file uses, with a path by which it does.
#[derive(Default)]
pub struct Graph {
    pub edges: BTreeMap<String, BTreeMap<String, String>>,
}

impl Graph {
    pub fn of(sources: &[Source]) -> Self {
        let tree = Tree(modules(sources));
        let mut graph = Self::default();
        for (place, module) in &tree.0 {
            graph.edges.entry(module.file.clone()).or_default();
            for import in module.imports.iter().filter(|import| !import.is_face) {
                graph.add(&tree, place, &import.target);
            }
            for tokens in &module.tokens {
                graph.read(&tree, place, tokens.clone());
            }
        }
        graph
    }

    fn add(&mut self, tree: &Tree, place: &Names, path: &[String]) {
        let from = &tree.0[place].file;
        if let Some(to) = tree.file_of(place, path).filter(|to| to != from) {
            let uses = self.edges.entry(from.clone()).or_default();
            uses.entry(to).or_insert_with(|| path.join("::"));
        }
    }

    /// All paths in the tokens: also those that macros are given.
    fn read(&mut self, tree: &Tree, place: &Names, tokens: TokenStream) {
        let trees: Vec<TokenTree> = tokens.into_iter().collect();
        let mut at = 0;
        while at < trees.len() {
            match &trees[at] {
                TokenTree::Group(group) => self.read(tree, place, group.stream()),
                TokenTree::Ident(_) => {
                    let path = path_at(&trees, at);
                    if begins(&trees, at) {
                        self.add(tree, place, &path);
                    }
                    at += 3 * (path.len() - 1);
                }
                hash if is_hash(hash) && trees.get(at + 1).is_some_and(is_of_tests) => {
                    at += trees[at..].iter().position(ends_item).unwrap_or(0);
                }
                _ => {}
            }
            at += 1;
        }
    }
}

fn mark(trees: &[TokenTree], at: usize) -> Option<char> {
    match trees.get(at)? {
        TokenTree::Punct(punct) => Some(punct.as_char()),
        _ => None,
    }
}

/// The names from here that `::` joins.
fn path_at(trees: &[TokenTree], mut at: usize) -> Names {
    let mut path = vec![trees[at].to_string()];
    while mark(trees, at + 1) == Some(':')
        && mark(trees, at + 2) == Some(':')
        && let Some(TokenTree::Ident(word)) = trees.get(at + 3)
    {
        path.push(word.to_string());
        at += 3;
    }
    path
}

/// Whether a path begins here: not a field or method, a lifetime, a variable of a macro, the rest
/// of another path.
fn begins(trees: &[TokenTree], at: usize) -> bool {
    let before = |steps: usize| at.checked_sub(steps).and_then(|at| mark(trees, at));
    match before(1) {
        Some('.') => before(2) == Some('.'),
        Some(':') => before(2) != Some(':'),
        Some('\'' | '$' | '#') => false,
        _ => true,
    }
}

fn ends_item(tree: &TokenTree) -> bool {
    match tree {
        TokenTree::Group(group) => group.delimiter() == Delimiter::Brace,
        TokenTree::Punct(punct) => punct.as_char() == ';',
        _ => false,
    }
}
