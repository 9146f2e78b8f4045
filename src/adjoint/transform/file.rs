//! What one kernel file declares: its functions, structs, constants and imports.

use super::kind::ident;
use super::signature::Signature;
use super::{Error, refusal, refuse};
use proc_macro2::TokenStream;
use quote::{ToTokens, quote};
use std::collections::{BTreeMap, BTreeSet};

/// One kernel file, parsed.
pub(super) struct KernelFile {
    /// As messages name it.
    pub path: String,
    pub functions: Vec<syn::ItemFn>,
    pub signatures: BTreeMap<String, Signature>,
    pub structs: BTreeMap<String, syn::ItemStruct>,
    pub constants: Vec<syn::ItemConst>,
    /// Local name to full path, from the `use` items.
    pub imports: BTreeMap<String, Vec<String>>,
}

impl KernelFile {
    pub fn read(module: &str, path: &str, text: &str) -> Result<Self, Error> {
        let parsed = syn::parse_file(text).map_err(|e| refusal(e.span(), e.to_string()))?;
        let mut file = KernelFile {
            path: path.to_string(),
            functions: Vec::new(),
            signatures: BTreeMap::new(),
            structs: BTreeMap::new(),
            constants: Vec::new(),
            imports: BTreeMap::new(),
        };
        for item in parsed.items {
            match item {
                item if for_tests(&item) => {}
                syn::Item::Use(item) => {
                    collect_imports(module, &item.tree, &mut Vec::new(), &mut file.imports)?;
                }
                syn::Item::Const(item) => file.constants.push(item),
                syn::Item::Struct(item) => {
                    let public = |v: &syn::Visibility| matches!(v, syn::Visibility::Public(_));
                    let named = matches!(item.fields, syn::Fields::Named(_));
                    if !named || !public(&item.vis) || !item.fields.iter().all(|f| public(&f.vis)) {
                        return refuse(
                            &item.ident,
                            "a kernel's struct is `pub` with named `pub` fields",
                        );
                    }
                    file.structs.insert(item.ident.to_string(), item);
                }
                syn::Item::Fn(item) => file.functions.push(item),
                other => {
                    return refuse(
                        &other,
                        "a kernel file holds only `use`, `const`, `pub struct` and `pub fn`",
                    );
                }
            }
        }
        Ok(file)
    }

    /// The names a generated local must not take.
    pub fn taken_names(&self) -> BTreeSet<String> {
        let functions = self.functions.iter().map(|f| f.sig.ident.to_string());
        let constants = self.constants.iter().map(|c| c.ident.to_string());
        functions
            .chain(constants)
            .chain(self.imports.keys().cloned())
            .collect()
    }

    /// Whether a name is a constant of this file, or something imported that may be one.
    pub fn may_be_constant(&self, name: &str) -> bool {
        self.constants.iter().any(|c| c.ident == name) || self.imports.contains_key(name)
    }

    /// The head of the generated file: what the kernel file imported, and its constants.
    pub fn preamble(&self, module: &str) -> TokenStream {
        let foreign = |path: &&Vec<String>| !path.starts_with(&["crate".into(), "lanes".into()]);
        let imports = self
            .imports
            .iter()
            .filter(|(_, path)| foreign(path))
            .map(|(name, path)| {
                let alias = (path.last() != Some(name)).then(|| format!(" as {name}"));
                let text = format!("use {}{};", path.join("::"), alias.unwrap_or_default());
                text.parse::<TokenStream>().expect("an import")
            });
        let constants = self.constants.iter().map(|c| {
            let mut c = c.clone();
            c.vis = syn::Visibility::Inherited;
            c.attrs.clear();
            c
        });
        let module = ident(module);
        quote! {
            use crate::lanes::{Mask, Real, V3};
            use crate::kernels::#module::*;
            #(#imports)*
            #(#constants)*
        }
    }
}

/// A path from the crate's root, for one written inside a kernel file.
pub(super) fn absolute(module: &str, mut names: Vec<String>) -> Vec<String> {
    let root = |names: &[&str]| names.iter().map(|n| n.to_string()).collect::<Vec<_>>();
    match names[0].as_str() {
        "self" => names
            .splice(0..1, root(&["crate", "kernels", module]))
            .for_each(drop),
        "super" => names
            .splice(0..1, root(&["crate", "kernels"]))
            .for_each(drop),
        _ => {}
    }
    names
}

fn collect_imports(
    module: &str,
    tree: &syn::UseTree,
    above: &mut Vec<String>,
    imports: &mut BTreeMap<String, Vec<String>>,
) -> Result<(), Error> {
    let mut import = |above: &[String], name: &syn::Ident, alias: &syn::Ident| {
        let mut path = above.to_vec();
        if name != "self" {
            path.push(name.to_string());
        }
        let alias = if alias == "self" {
            path[path.len() - 1].clone()
        } else {
            alias.to_string()
        };
        imports.insert(alias, absolute(module, path));
    };
    match tree {
        syn::UseTree::Path(path) => {
            above.push(path.ident.to_string());
            collect_imports(module, &path.tree, above, imports)?;
            above.pop();
        }
        syn::UseTree::Name(name) => import(above, &name.ident, &name.ident),
        syn::UseTree::Rename(name) => import(above, &name.ident, &name.rename),
        syn::UseTree::Group(group) => {
            for tree in &group.items {
                collect_imports(module, tree, above, imports)?;
            }
        }
        syn::UseTree::Glob(glob) => {
            return refuse(glob, "a kernel file imports by name, not by `*`");
        }
    }
    Ok(())
}

fn for_tests(item: &syn::Item) -> bool {
    let attributes = match item {
        syn::Item::Mod(item) => &item.attrs,
        syn::Item::Fn(item) => &item.attrs,
        syn::Item::Use(item) => &item.attrs,
        _ => return false,
    };
    attributes
        .iter()
        .any(|a| a.to_token_stream().to_string().replace(' ', "") == "#[cfg(test)]")
}
