//! All kernel files together: what their functions' signatures and their types and names mean.

use super::file::{KernelFile, absolute};
use super::kind::Kind;
use super::signature::Signature;
use super::{Error, in_file, refusal, refuse};
use quote::ToTokens;
use std::collections::BTreeMap;
use syn::spanned::Spanned;

/// All kernel files, parsed, with their signatures.
pub struct Library {
    pub(super) files: BTreeMap<String, KernelFile>,
}

impl Library {
    /// Reads all kernel files: (module name, path for messages, text) each.
    pub fn read(sources: &[(String, String, String)]) -> Result<Self, Error> {
        let mut files = BTreeMap::new();
        for (module, path, text) in sources {
            files.insert(
                module.clone(),
                in_file(KernelFile::read(module, path, text), path)?,
            );
        }
        let mut library = Library { files };
        let modules: Vec<String> = library.files.keys().cloned().collect();
        for module in modules {
            let file = &library.files[&module];
            let signatures = file.functions.iter().map(|f| {
                let signature = library.signature(&module, f)?;
                Ok((signature.name.clone(), signature))
            });
            let signatures = in_file(signatures.collect(), &file.path)?;
            library
                .files
                .get_mut(&module)
                .expect("just read")
                .signatures = signatures;
        }
        Ok(library)
    }

    /// The modules, in order of name.
    pub fn modules(&self) -> impl Iterator<Item = &str> {
        self.files.keys().map(String::as_str)
    }

    fn signature(&self, module: &str, function: &syn::ItemFn) -> Result<Signature, Error> {
        let sig = &function.sig;
        if !matches!(function.vis, syn::Visibility::Public(_)) {
            return refuse(
                &sig.ident,
                "a kernel is `pub`: its adjoint calls it from another module",
            );
        }
        let word = sig
            .constness
            .map(|t| t.span())
            .or(sig.asyncness.map(|t| t.span()));
        if let Some(span) = word.or(sig.unsafety.map(|t| t.span())) {
            return Err(refusal(span, "a kernel is a plain `pub fn`"));
        }
        if !is_lane_generic(&sig.generics) {
            return refuse(
                &sig.ident,
                "a kernel has the one type parameter `<F: Real>`",
            );
        }
        let mut arguments = Vec::new();
        for input in &sig.inputs {
            let syn::FnArg::Typed(input) = input else {
                return refuse(input, "a kernel is a free function, without `self`");
            };
            match &*input.pat {
                syn::Pat::Ident(p) if p.by_ref.is_none() && p.mutability.is_none() => {
                    arguments.push((p.ident.to_string(), self.kind(module, &input.ty)?));
                }
                pattern => return refuse(pattern, "an argument of a kernel is a plain name"),
            }
        }
        let syn::ReturnType::Type(_, result) = &sig.output else {
            return refuse(&sig.ident, "a kernel returns a value");
        };
        Ok(Signature {
            module: module.to_string(),
            name: sig.ident.to_string(),
            arguments,
            result: self.kind(module, result)?,
        })
    }

    /// The kind a type means in a file.
    pub(super) fn kind(&self, module: &str, ty: &syn::Type) -> Result<Kind, Error> {
        self.kind_within(module, ty, 0)
    }

    fn kind_within(&self, module: &str, ty: &syn::Type, depth: usize) -> Result<Kind, Error> {
        // A struct that holds itself is rustc's to refuse; here it must only not recurse for ever.
        if depth > 16 {
            return refuse(ty, "this type nests too deeply");
        }
        match ty {
            syn::Type::Paren(inner) => self.kind_within(module, &inner.elem, depth),
            syn::Type::Tuple(tuple) if !tuple.elems.is_empty() => {
                let kinds = tuple
                    .elems
                    .iter()
                    .map(|t| self.kind_within(module, t, depth + 1));
                Ok(Kind::Tuple(kinds.collect::<Result<_, _>>()?))
            }
            syn::Type::Array(array) => match &array.len {
                syn::Expr::Lit(syn::ExprLit {
                    lit: syn::Lit::Int(length),
                    ..
                }) => {
                    let length = length
                        .base10_parse()
                        .map_err(|e| refusal(length.span(), e.to_string()))?;
                    Ok(Kind::Array(
                        Box::new(self.kind_within(module, &array.elem, depth + 1)?),
                        length,
                    ))
                }
                length => refuse(length, "the length of an array is a literal"),
            },
            syn::Type::Path(path) if path.qself.is_none() => {
                let text = path.to_token_stream().to_string().replace(' ', "");
                match text.as_str() {
                    "F" => return Ok(Kind::Real),
                    "V3<F>" => return Ok(Kind::Vec3),
                    "F::Mask" => return Ok(Kind::Mask),
                    "f64" => return Ok(Kind::Number),
                    _ => {}
                }
                let parameters = path
                    .path
                    .segments
                    .last()
                    .map(|s| s.arguments.to_token_stream().to_string().replace(' ', ""));
                let found = self
                    .resolve(module, &path.path)
                    .and_then(|(m, n)| Some((self.files.get(&m)?.structs.get(&n)?, m, n)));
                match found {
                    Some((item, module, name)) if parameters.as_deref() == Some("<F>") => {
                        let fields = item.fields.iter().map(|f| {
                            let name = f.ident.as_ref().map(|i| i.to_string()).unwrap_or_default();
                            Ok((name, self.kind_within(&module, &f.ty, depth + 1)?))
                        });
                        let fields = fields.collect::<Result<_, Error>>()?;
                        Ok(Kind::Struct {
                            module,
                            name,
                            fields,
                        })
                    }
                    _ => refuse(ty, format!("`{text}` is not a type a kernel can use")),
                }
            }
            _ => refuse(
                ty,
                "a kernel's types are F, V3<F>, F::Mask, f64, and tuples, arrays and structs of these",
            ),
        }
    }

    /// The kernel file and item a path means, if it leads into a kernel file.
    pub(super) fn resolve(&self, module: &str, path: &syn::Path) -> Option<(String, String)> {
        let mut names: Vec<String> = path.segments.iter().map(|s| s.ident.to_string()).collect();
        let file = self.files.get(module)?;
        if let Some(full) = file.imports.get(&names[0]) {
            names.splice(0..1, full.iter().cloned());
        } else if names.len() == 1 {
            names.insert(0, "self".to_string());
        }
        match absolute(module, names).as_slice() {
            [root, kernels, module, name] if root == "crate" && kernels == "kernels" => {
                Some((module.clone(), name.clone()))
            }
            _ => None,
        }
    }
}

fn is_lane_generic(generics: &syn::Generics) -> bool {
    let parameters = generics
        .params
        .to_token_stream()
        .to_string()
        .replace(' ', "");
    parameters.trim_end_matches(',') == "F:Real" && generics.where_clause.is_none()
}
