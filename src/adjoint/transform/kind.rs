//! What a value in a kernel can be.

use proc_macro2::{Ident, Span, TokenStream};
use quote::{format_ident, quote};

/// The type of a value.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// `F`.
    Real,
    /// `V3<F>`.
    Vec3,
    /// `F::Mask`: never has a cotangent.
    Mask,
    /// `f64`: a constant of the kernel, never has a cotangent.
    Number,
    Tuple(Vec<Kind>),
    Array(Box<Kind>, usize),
    Struct {
        /// The kernel file that declares it.
        module: String,
        name: String,
        fields: Vec<(String, Kind)>,
    },
}

impl Kind {
    /// How a message names it.
    pub fn describe(&self) -> String {
        match self {
            Kind::Real => "F".into(),
            Kind::Vec3 => "V3<F>".into(),
            Kind::Mask => "F::Mask".into(),
            Kind::Number => "f64".into(),
            Kind::Tuple(kinds) => {
                let inner: Vec<String> = kinds.iter().map(Kind::describe).collect();
                format!("({})", inner.join(", "))
            }
            Kind::Array(kind, length) => format!("[{}; {length}]", kind.describe()),
            Kind::Struct { name, .. } => format!("{name}<F>"),
        }
    }

    /// Whether a value of this kind can carry a derivative.
    pub fn differentiable(&self) -> bool {
        match self {
            Kind::Real | Kind::Vec3 => true,
            Kind::Mask | Kind::Number => false,
            _ => (0..self.part_count()).any(|i| self.part(i).differentiable()),
        }
    }

    /// How many components, elements or fields it has.
    pub fn part_count(&self) -> usize {
        match self {
            Kind::Real | Kind::Mask | Kind::Number => 0,
            Kind::Vec3 => 3,
            Kind::Tuple(kinds) => kinds.len(),
            Kind::Array(_, length) => *length,
            Kind::Struct { fields, .. } => fields.len(),
        }
    }

    pub fn part(&self, index: usize) -> Kind {
        match self {
            Kind::Vec3 => Kind::Real,
            Kind::Tuple(kinds) => kinds[index].clone(),
            Kind::Array(kind, _) => (**kind).clone(),
            Kind::Struct { fields, .. } => fields[index].1.clone(),
            Kind::Real | Kind::Mask | Kind::Number => unreachable!("has no parts"),
        }
    }

    /// Which part a field name means, if any.
    pub fn part_named(&self, name: &str) -> Option<usize> {
        match self {
            Kind::Vec3 => ["x", "y", "z"].iter().position(|n| *n == name),
            Kind::Tuple(kinds) => name.parse().ok().filter(|i| *i < kinds.len()),
            Kind::Struct { fields, .. } => fields.iter().position(|(n, _)| n == name),
            _ => None,
        }
    }

    /// The expression for one part of `whole`.
    pub fn access(&self, whole: &TokenStream, index: usize) -> TokenStream {
        match self {
            Kind::Vec3 => {
                let field = format_ident!("{}", ["x", "y", "z"][index]);
                quote!(#whole.#field)
            }
            Kind::Struct { fields, .. } => {
                let field = ident(&fields[index].0);
                quote!(#whole.#field)
            }
            Kind::Array(..) => {
                let index = proc_macro2::Literal::usize_unsuffixed(index);
                quote!(#whole[#index])
            }
            _ => {
                let index = syn::Index::from(index);
                quote!(#whole.#index)
            }
        }
    }

    /// The expression that puts its parts together.
    pub fn build(&self, parts: &[TokenStream]) -> TokenStream {
        match self {
            Kind::Vec3 => quote!(V3::new(#(#parts),*)),
            Kind::Tuple(_) => quote!((#(#parts,)*)),
            Kind::Array(..) => quote!([#(#parts),*]),
            Kind::Struct {
                module,
                name,
                fields,
            } => {
                let (module, name) = (ident(module), ident(name));
                let fields = fields.iter().map(|(n, _)| ident(n));
                quote!(crate::kernels::#module::#name { #(#fields: #parts),* })
            }
            Kind::Real | Kind::Mask | Kind::Number => unreachable!("has no parts"),
        }
    }

    /// The expression for a cotangent of zero.
    pub fn zero(&self) -> TokenStream {
        match self {
            Kind::Real => quote!(F::splat(0.0)),
            Kind::Vec3 => quote!(V3::splat(0.0)),
            Kind::Mask => quote!(Mask::splat(false)),
            Kind::Number => quote!(0.0),
            _ => {
                let parts: Vec<_> = (0..self.part_count())
                    .map(|i| self.part(i).zero())
                    .collect();
                self.build(&parts)
            }
        }
    }

    /// The type as generated code writes it.
    pub fn tokens(&self) -> TokenStream {
        match self {
            Kind::Real => quote!(F),
            Kind::Vec3 => quote!(V3<F>),
            Kind::Mask => quote!(F::Mask),
            Kind::Number => quote!(f64),
            Kind::Tuple(kinds) => {
                let kinds = kinds.iter().map(Kind::tokens);
                quote!((#(#kinds,)*))
            }
            Kind::Array(kind, length) => {
                let kind = kind.tokens();
                quote!([#kind; #length])
            }
            Kind::Struct { module, name, .. } => {
                let (module, name) = (ident(module), ident(name));
                quote!(crate::kernels::#module::#name<F>)
            }
        }
    }
}

pub fn ident(name: &str) -> Ident {
    Ident::new(name, Span::call_site())
}
