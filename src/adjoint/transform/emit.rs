//! The generated source of one kernel file's adjoints.

use super::body::Reader;
use super::kind::{Kind, ident};
use super::library::Library;
use super::program::Op;
use super::reverse::{Reverse, tuple_or_single};
use super::signature::Signature;
use super::{Error, in_file};
use proc_macro2::TokenStream;
use quote::quote;

/// The adjoints of the kernels in one file, pretty-printed.
pub fn adjoint_source(library: &Library, module: &str) -> Result<String, Error> {
    let file = &library.files[module];
    let adjoints = file.functions.iter().map(|f| adjoint(library, module, f));
    let adjoints: Vec<TokenStream> = in_file(adjoints.collect(), &file.path)?;
    let preamble = file.preamble(module);
    Ok(pretty(quote! {
        use crate::adjoint::ops;
        #preamble
        #(#adjoints)*
    }))
}

/// Source text of tokens that are whole items.
pub fn pretty(items: TokenStream) -> String {
    prettyplease::unparse(&syn::parse2(items).expect("generated items parse"))
}

fn adjoint(library: &Library, module: &str, function: &syn::ItemFn) -> Result<TokenStream, Error> {
    let signature = &library.files[module].signatures[&function.sig.ident.to_string()];
    let mut reader = Reader::new(library, module);
    // Read it even if it has no adjoint: what lies outside the subset must not hide there.
    let (arguments, result) = reader.kernel(function)?;
    if !signature.differentiable() {
        return Ok(TokenStream::new());
    }
    let mut program = reader.program;
    program.name_temporaries();
    let bar_name = program.fresh("out_bar");
    let mut reverse = Reverse::new(&mut program);
    let cotangents = reverse.sweep(&arguments, result, &bar_name);
    let (needed, backward) = (reverse.needed, reverse.statements);
    let forward = (0..needed.len()).filter(|&id| needed[id]).filter_map(|id| {
        let value = &program.values[id];
        let name = ident(
            value
                .name
                .as_ref()
                .filter(|_| !matches!(value.op, Op::Argument))?,
        );
        let definition = program.definition(id);
        Some(quote!(let #name = #definition;))
    });

    let Signature {
        name,
        arguments,
        result,
        ..
    } = signature;
    let adjoint = ident(&format!("{name}_adjoint"));
    let inputs = arguments.iter().map(|(name, kind)| {
        let (name, kind) = (ident(name), kind.tokens());
        quote!(#name: #kind)
    });
    let active: Vec<&(String, Kind)> = arguments
        .iter()
        .filter(|(_, k)| k.differentiable())
        .collect();
    let outputs: Vec<TokenStream> = active.iter().map(|(_, k)| k.tokens()).collect();
    let listed: Vec<String> = active.iter().map(|(n, _)| format!("`{n}`")).collect();
    let doc = format!(
        " The reverse of `kernels::{module}::{name}`: the cotangent of {} from that of its result.",
        listed.join(", ")
    );
    let (bar_name, result) = (ident(&bar_name), result.tokens());
    let (outputs, cotangents) = (tuple_or_single(&outputs), tuple_or_single(&cotangents));
    Ok(quote! {
        #[doc = #doc]
        #[inline(always)]
        pub fn #adjoint<F: Real>(#(#inputs,)* #bar_name: #result) -> #outputs {
            #(#forward)*
            #(#backward)*
            #cotangents
        }
    })
}
