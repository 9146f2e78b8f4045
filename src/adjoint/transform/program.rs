//! A kernel's body as a list of values, each made once from earlier ones.

use super::kind::{Kind, ident};
use super::signature::Signature;
use proc_macro2::TokenStream;
use quote::{ToTokens, quote};
use std::collections::BTreeSet;

/// Which value: its place in [`Program::values`].
pub type Id = usize;

/// How a value is made.
#[derive(Clone, Debug)]
pub enum Op {
    Argument,
    /// `F::splat(…)`, or an `f64` expression.
    Constant(TokenStream),
    Add(Id, Id),
    Sub(Id, Id),
    Mul(Id, Id),
    Div(Id, Id),
    And(Id, Id),
    Or(Id, Id),
    Neg(Id),
    Not(Id),
    /// A method of `Real` or `V3`: its name, the receiver, the argument if it has one.
    Method(&'static str, Id, Option<Id>),
    /// Mask, yes, no.
    Select(Id, Id, Id),
    /// A vector, tuple, array or struct put together.
    Build(Vec<Id>),
    Part(Id, usize),
    Call(Box<Signature>, Vec<Id>),
}

impl Op {
    pub fn operands(&self) -> Vec<Id> {
        match self {
            Op::Argument | Op::Constant(_) => vec![],
            Op::Neg(a) | Op::Not(a) | Op::Part(a, _) => vec![*a],
            Op::Add(a, b) | Op::Sub(a, b) | Op::Mul(a, b) | Op::Div(a, b) => vec![*a, *b],
            Op::And(a, b) | Op::Or(a, b) => vec![*a, *b],
            Op::Method(_, a, b) => std::iter::once(*a).chain(*b).collect(),
            Op::Select(m, a, b) => vec![*m, *a, *b],
            Op::Build(parts) | Op::Call(_, parts) => parts.clone(),
        }
    }
}

pub struct Value {
    /// Without a name it is written out wherever it is used.
    pub name: Option<String>,
    pub kind: Kind,
    /// Whether it depends on an argument that has a cotangent.
    pub active: bool,
    pub op: Op,
}

/// The values of a body in order, and the names they use.
pub struct Program {
    pub values: Vec<Value>,
    taken: BTreeSet<String>,
}

impl Program {
    pub fn new(taken: BTreeSet<String>) -> Self {
        Program {
            values: Vec::new(),
            taken,
        }
    }

    /// A name nothing else has, as near to the wish as possible.
    pub fn fresh(&mut self, wish: &str) -> String {
        let mut name = wish.to_string();
        let mut count = 2;
        while !self.taken.insert(name.clone()) {
            name = format!("{wish}_{count}");
            count += 1;
        }
        name
    }

    pub fn argument(&mut self, name: &str, kind: Kind) -> Id {
        self.taken.insert(name.to_string());
        let active = kind.differentiable();
        self.values.push(Value {
            name: Some(name.to_string()),
            kind,
            active,
            op: Op::Argument,
        });
        self.values.len() - 1
    }

    pub fn push(&mut self, op: Op, kind: Kind) -> Id {
        // A part of something just put together is the thing put in.
        if let Op::Part(whole, index) = op
            && let Op::Build(parts) = &self.values[whole].op
        {
            return parts[index];
        }
        let flat = matches!(op, Op::Method("signum", ..));
        let active =
            !flat && kind.differentiable() && op.operands().iter().any(|&i| self.values[i].active);
        self.values.push(Value {
            name: None,
            kind,
            active,
            op,
        });
        self.values.len() - 1
    }

    /// Calls a value what the source calls it, unless it already has a name from there.
    pub fn bind(&mut self, id: Id, name: &str) {
        if self.values[id].name.is_none() {
            self.values[id].name = Some(self.fresh(name));
        }
    }

    /// Names what the source left unnamed, once the whole source is read. Constants and parts of
    /// other values stay without: they are written out.
    pub fn name_temporaries(&mut self) {
        let mut count = 0;
        for id in 0..self.values.len() {
            let value = &self.values[id];
            if value.name.is_none() && !matches!(value.op, Op::Constant(_) | Op::Part(..)) {
                count += 1;
                self.values[id].name = Some(self.fresh(&format!("t{count}")));
            }
        }
    }

    /// How an expression refers to a value.
    pub fn text(&self, id: Id) -> TokenStream {
        match &self.values[id].name {
            Some(name) => ident(name).into_token_stream(),
            None => self.definition(id),
        }
    }

    /// The expression that makes a value.
    pub fn definition(&self, id: Id) -> TokenStream {
        let value = &self.values[id];
        let t = |i: &Id| self.text(*i);
        match &value.op {
            Op::Argument => unreachable!("arguments are given"),
            Op::Constant(tokens) => tokens.clone(),
            Op::Add(a, b) => infix(t(a), quote!(+), t(b)),
            Op::Sub(a, b) => infix(t(a), quote!(-), t(b)),
            Op::Mul(a, b) => infix(t(a), quote!(*), t(b)),
            Op::Div(a, b) => infix(t(a), quote!(/), t(b)),
            Op::And(a, b) => infix(t(a), quote!(&), t(b)),
            Op::Or(a, b) => infix(t(a), quote!(|), t(b)),
            Op::Neg(a) => {
                let a = t(a);
                quote!(-#a)
            }
            Op::Not(a) => {
                let a = t(a);
                quote!(!#a)
            }
            Op::Method(name, a, b) => {
                let (name, a, b) = (ident(name), t(a), b.iter().map(t));
                quote!(#a.#name(#(#b),*))
            }
            Op::Select(m, a, b) => {
                let ty = if value.kind == Kind::Vec3 {
                    quote!(V3)
                } else {
                    quote!(F)
                };
                let (m, a, b) = (t(m), t(a), t(b));
                quote!(#ty::select(#m, #a, #b))
            }
            Op::Build(parts) => value.kind.build(&parts.iter().map(t).collect::<Vec<_>>()),
            Op::Part(whole, index) => self.values[*whole].kind.access(&t(whole), *index),
            Op::Call(callee, arguments) => {
                let (module, name) = (ident(&callee.module), ident(&callee.name));
                let arguments = arguments.iter().map(t);
                quote!(crate::kernels::#module::#name(#(#arguments),*))
            }
        }
    }
}

fn infix(a: TokenStream, op: TokenStream, b: TokenStream) -> TokenStream {
    quote!(#a #op #b)
}
