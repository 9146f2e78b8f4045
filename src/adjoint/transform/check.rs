//! The table by which tests check every adjoint without naming any.

use super::emit::pretty;
use super::kind::{Kind, ident};
use super::library::Library;
use super::signature::Signature;
use super::{Error, in_file, refuse};
use proc_macro2::{Literal, TokenStream};
use quote::quote;

/// Where random inputs are drawn from when a kernel does not say.
const DEFAULT_RANGE: (f64, f64) = (0.2, 1.5);

/// Source of `pub fn checks() -> Vec<Check>`, with an entry for each kernel that has an adjoint.
///
/// Numbers are drawn from 0.2..1.5, components of vectors with a random sign as well. A doc line of
/// the kernel can say otherwise: `/// inputs: 0.1..0.9` for all, `/// inputs: alpha 0.1..1, w
/// -1..1` for some arguments.
pub fn check_source(library: &Library) -> Result<String, Error> {
    let mut functions = TokenStream::new();
    let mut entries = Vec::new();
    for (module, file) in &library.files {
        for function in &file.functions {
            let signature = &file.signatures[&function.sig.ident.to_string()];
            if signature.differentiable() {
                let (function, entry) = in_file(entry(module, function, signature), &file.path)?;
                functions.extend(function);
                entries.push(entry);
            }
        }
    }
    Ok(pretty(quote! {
        #[allow(unused_imports)]
        use crate::lanes::{Dual, Lane, Mask, Real, V3};
        #functions
        /// One entry for each kernel that has an adjoint.
        pub fn checks() -> Vec<Check> {
            Vec::from([#(#entries),*])
        }
    }))
}

fn entry(
    module: &str,
    function: &syn::ItemFn,
    signature: &Signature,
) -> Result<(TokenStream, TokenStream), Error> {
    let ranges = declared_ranges(function, signature)?;
    let mut inputs = Inputs::default();
    let mut arguments = Vec::new();
    let mut cotangents = Vec::new();
    let several = signature
        .arguments
        .iter()
        .filter(|(_, k)| k.differentiable())
        .count()
        > 1;
    let mut place = 0usize;
    for ((_, kind), range) in signature.arguments.iter().zip(ranges) {
        arguments.push(inputs.take(kind, range));
        if kind.differentiable() {
            let index = syn::Index::from(place);
            let whole = if several {
                quote!(bars.#index)
            } else {
                quote!(bars)
            };
            flatten(kind, &whole, true, &mut cotangents);
            place += 1;
        } else {
            flatten(kind, &TokenStream::new(), true, &mut cotangents);
        }
    }
    let mut outputs = Vec::new();
    flatten(&signature.result, &quote!(result), false, &mut outputs);
    let mut bar = Inputs {
        array: "out_bar",
        ..Inputs::default()
    };
    let bar_argument = bar.cotangent(&signature.result);

    let (module_name, kernel) = (ident(module), ident(&signature.name));
    let primal = ident(&format!("{module}_{}", signature.name));
    let adjoint = ident(&format!("{module}_{}_adjoint", signature.name));
    let kernel_adjoint = ident(&format!("{}_adjoint", signature.name));
    let functions = quote! {
        fn #primal<F: Real>(x: &[F]) -> Vec<F> {
            let result = crate::kernels::#module_name::#kernel(#(#arguments),*);
            vec![#(#outputs),*]
        }
        fn #adjoint<F: Real>(x: &[F], out_bar: &[F]) -> Vec<F> {
            let bars = crate::adjoint::#module_name::#kernel_adjoint(#(#arguments,)* #bar_argument);
            vec![#(#cotangents),*]
        }
    };
    let (name, count) = (format!("{module}::{}", signature.name), outputs.len());
    let ranges = inputs.ranges;
    let entry = quote! {
        Check {
            name: #name,
            ranges: &[#(#ranges),*],
            outputs: #count,
            primal: #primal::<f64>,
            dual: #primal::<Dual<f64>>,
            lanes: #primal::<Lane>,
            adjoint: #adjoint::<f64>,
            adjoint_lanes: #adjoint::<Lane>,
        }
    };
    Ok((functions, entry))
}

/// The flat array that arguments are read from, and the range each number comes from.
struct Inputs {
    array: &'static str,
    next: usize,
    ranges: Vec<TokenStream>,
}

impl Default for Inputs {
    fn default() -> Self {
        Inputs {
            array: "x",
            next: 0,
            ranges: Vec::new(),
        }
    }
}

impl Inputs {
    fn number(&mut self, range: Option<(f64, f64)>, signed: bool) -> TokenStream {
        let (low, high) = range.unwrap_or(DEFAULT_RANGE);
        let signed = signed && range.is_none();
        let (low, high) = (
            Literal::f64_unsuffixed(low.abs()),
            Literal::f64_unsuffixed(high.abs()),
        )
            .sign(low, high);
        self.ranges.push(quote!((#low, #high, #signed)));
        let (array, index) = (ident(self.array), Literal::usize_unsuffixed(self.next));
        self.next += 1;
        quote!(#array[#index])
    }

    /// An argument, made of the next numbers.
    fn take(&mut self, kind: &Kind, range: Option<(f64, f64)>) -> TokenStream {
        match kind {
            Kind::Real => self.number(range, false),
            Kind::Vec3 => {
                let parts: Vec<_> = (0..3).map(|_| self.number(range, true)).collect();
                kind.build(&parts)
            }
            Kind::Mask => {
                let number = self.number(None, true);
                quote!(#number.gt(F::splat(0.0)))
            }
            Kind::Number => quote!(0.75),
            _ => {
                let parts: Vec<_> = (0..kind.part_count())
                    .map(|i| self.take(&kind.part(i), range))
                    .collect();
                kind.build(&parts)
            }
        }
    }

    /// A result's cotangent, made of the next numbers; masks in it are ignored.
    fn cotangent(&mut self, kind: &Kind) -> TokenStream {
        match kind {
            Kind::Mask | Kind::Number => kind.zero(),
            Kind::Real => self.number(None, false),
            _ => {
                let parts: Vec<_> = (0..kind.part_count())
                    .map(|i| self.cotangent(&kind.part(i)))
                    .collect();
                kind.build(&parts)
            }
        }
    }
}

/// Puts the signs back on two literals, which cannot carry one themselves.
trait Signed {
    fn sign(self, low: f64, high: f64) -> (TokenStream, TokenStream);
}

impl Signed for (Literal, Literal) {
    fn sign(self, low: f64, high: f64) -> (TokenStream, TokenStream) {
        let signed = |literal: Literal, value: f64| {
            if value < 0.0 {
                quote!(-#literal)
            } else {
                quote!(#literal)
            }
        };
        (signed(self.0, low), signed(self.1, high))
    }
}

/// The numbers a value is made of; a mask in an argument keeps its slot, with nothing in it.
fn flatten(kind: &Kind, whole: &TokenStream, masks: bool, into: &mut Vec<TokenStream>) {
    match kind {
        Kind::Real => into.push(whole.clone()),
        Kind::Mask if masks => into.push(quote!(F::splat(0.0))),
        Kind::Mask | Kind::Number => {}
        _ => {
            for index in 0..kind.part_count() {
                flatten(&kind.part(index), &kind.access(whole, index), masks, into);
            }
        }
    }
}

/// What the doc line `inputs:` says about each argument.
fn declared_ranges(
    function: &syn::ItemFn,
    signature: &Signature,
) -> Result<Vec<Option<(f64, f64)>>, Error> {
    let mut ranges = vec![None; signature.arguments.len()];
    for attribute in &function.attrs {
        let syn::Meta::NameValue(meta) = &attribute.meta else {
            continue;
        };
        let syn::Expr::Lit(syn::ExprLit {
            lit: syn::Lit::Str(text),
            ..
        }) = &meta.value
        else {
            continue;
        };
        let line = text.value();
        let Some(said) = line.trim().strip_prefix("inputs:") else {
            continue;
        };
        for clause in said.split(',') {
            let words: Vec<&str> = clause.split_whitespace().collect();
            let range = words
                .last()
                .and_then(|r| r.split_once(".."))
                .and_then(|(low, high)| {
                    let (low, high): (f64, f64) = (low.parse().ok()?, high.parse().ok()?);
                    (low < high).then_some((low, high))
                });
            let named = |name: &str| signature.arguments.iter().position(|(n, _)| n == name);
            match (words.as_slice(), range) {
                ([_], Some(_)) => ranges.fill(range),
                ([name, _], Some(_)) if named(name).is_some() => {
                    ranges[named(name).expect("just found")] = range
                }
                _ => {
                    return refuse(
                        text,
                        "an inputs line reads `inputs: 0.2..1.5` or `inputs: a 0.1..0.9, b -1..1`",
                    );
                }
            }
        }
    }
    Ok(ranges)
}
