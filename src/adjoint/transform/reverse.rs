//! The reverse sweep: from the cotangent of the result to those of the arguments.
//!
//! Each value gathers terms from every later use before its own turn comes, so a cotangent is one
//! sum, bound once, and a value nobody differentiates costs nothing.

use super::gathered::{Gathered, Term, atom, minus, term};
use super::kind::{Kind, ident};
use super::program::{Id, Op, Program};
use super::signature::Signature;
use proc_macro2::TokenStream;
use quote::{ToTokens, quote};

/// The statements of the sweep, the arguments' cotangents, and which values they read.
pub struct Reverse<'a> {
    program: &'a mut Program,
    gathered: Vec<Gathered>,
    pub needed: Vec<bool>,
    pub statements: Vec<TokenStream>,
}

impl<'a> Reverse<'a> {
    pub fn new(program: &'a mut Program) -> Self {
        let count = program.values.len();
        Reverse {
            program,
            gathered: vec![Gathered::default(); count],
            needed: vec![false; count],
            statements: Vec::new(),
        }
    }

    /// Walks back from the result and gives each active argument's cotangent.
    pub fn sweep(&mut self, arguments: &[Id], result: Id, result_bar: &str) -> Vec<TokenStream> {
        self.give(result, atom(ident(result_bar).into_token_stream()));
        for id in (0..self.gathered.len()).rev() {
            if self.program.values[id].active && !self.gathered[id].is_empty() {
                self.step(id);
            }
        }
        let active: Vec<Id> = arguments
            .iter()
            .copied()
            .filter(|&a| self.program.values[a].active)
            .collect();
        active.into_iter().map(|a| self.settle(a)).collect()
    }

    /// The cotangent of a value, complete by now; zero if nothing contributed.
    fn settle(&mut self, id: Id) -> TokenStream {
        let gathered = std::mem::take(&mut self.gathered[id]);
        let kind = self.program.values[id].kind.clone();
        let name = self.program.values[id].name.clone();
        let name = name.unwrap_or_else(|| format!("v{id}"));
        self.sum(gathered, &kind, &name)
    }

    fn sum(&mut self, gathered: Gathered, kind: &Kind, name: &str) -> TokenStream {
        if gathered.is_empty() {
            return kind.zero();
        }
        let by_part = gathered.parts.iter().any(|p| !p.is_empty());
        if !by_part {
            return self.let_bar(name, &gathered.whole);
        }
        let whole = (!gathered.whole.is_empty()).then(|| self.let_bar(name, &gathered.whole));
        let mut parts = Vec::new();
        for (index, mut part) in gathered.parts.into_iter().enumerate() {
            if let Some(whole) = &whole {
                part.whole.insert(0, atom(kind.access(whole, index)));
            }
            let part_name = match kind {
                Kind::Vec3 => format!("{name}_{}", ["x", "y", "z"][index]),
                Kind::Struct { fields, .. } => format!("{name}_{}", fields[index].0),
                _ => format!("{name}_{index}"),
            };
            parts.push(self.sum(part, &kind.part(index), &part_name));
        }
        let built = kind.build(&parts);
        self.let_bar(name, &[term(built)])
    }

    fn let_bar(&mut self, name: &str, terms: &[Term]) -> TokenStream {
        if let [only] = terms
            && only.atomic
            && !only.negative
        {
            return only.tokens.clone();
        }
        let bar = ident(&self.program.fresh(&format!("{name}_bar")));
        // Positive terms first: the sum then needs no negation of its own.
        let (negative, positive): (Vec<&Term>, Vec<&Term>) = terms.iter().partition(|t| t.negative);
        let mut sum = TokenStream::new();
        for t in positive.into_iter().chain(negative) {
            let tokens = &t.tokens;
            sum = match (sum.is_empty(), t.negative) {
                (true, false) => quote!(#tokens),
                (true, true) if t.atomic => quote!(-#tokens),
                (true, true) => quote!(-(#tokens)),
                (false, false) => quote!(#sum + #tokens),
                (false, true) => quote!(#sum - #tokens),
            };
        }
        self.statements.push(quote!(let #bar = #sum;));
        bar.into_token_stream()
    }

    /// Adds a term to a value's cotangent, if it has one.
    fn give(&mut self, id: Id, term: Term) {
        let value = &self.program.values[id];
        if value.active {
            let kind = value.kind.clone();
            self.gathered[id].add(&kind, term);
        }
    }

    fn active(&self, id: Id) -> bool {
        self.program.values[id].active
    }

    /// Refers to a primal value, which therefore has to be recomputed.
    fn read(&mut self, id: Id) -> TokenStream {
        self.need(id);
        self.program.text(id)
    }

    fn need(&mut self, id: Id) {
        if !self.needed[id] {
            self.needed[id] = true;
            for operand in self.program.values[id].op.operands() {
                self.need(operand);
            }
        }
    }

    /// Passes one value's cotangent on to what it was made from.
    fn step(&mut self, id: Id) {
        let kind = self.program.values[id].kind.clone();
        match self.program.values[id].op.clone() {
            Op::Argument | Op::Constant(_) | Op::And(..) | Op::Or(..) | Op::Not(_) => {}
            Op::Part(whole, index) => {
                let gathered = std::mem::take(&mut self.gathered[id]);
                let whole_kind = self.program.values[whole].kind.clone();
                self.gathered[whole]
                    .part(&whole_kind, index)
                    .absorb(gathered);
            }
            Op::Build(made_of) => {
                let Gathered { whole, parts } = std::mem::take(&mut self.gathered[id]);
                for (part, from) in made_of.iter().zip(parts) {
                    if self.active(*part) {
                        self.gathered[*part].absorb(from);
                    }
                }
                if !whole.is_empty() {
                    let name = self.program.values[id].name.clone().unwrap_or_default();
                    let bar = self.let_bar(&name, &whole);
                    for (index, part) in made_of.iter().enumerate() {
                        self.give(*part, atom(kind.access(&bar, index)));
                    }
                }
            }
            op => {
                let bar = self.settle(id);
                self.apply(id, op, bar, &kind);
            }
        }
    }

    fn apply(&mut self, id: Id, op: Op, bar: TokenStream, kind: &Kind) {
        match op {
            Op::Add(a, b) => {
                self.give(a, atom(bar.clone()));
                self.give(b, atom(bar));
            }
            Op::Sub(a, b) => {
                self.give(a, atom(bar.clone()));
                self.give(b, minus(atom(bar)));
            }
            Op::Neg(a) => self.give(a, minus(atom(bar))),
            Op::Mul(a, b) => {
                if self.active(a) {
                    let factor = self.read(b);
                    self.give(a, term(quote!(#bar * #factor)));
                }
                if self.active(b) {
                    let factor = self.read(a);
                    let product = if *kind == Kind::Vec3 {
                        quote!(#bar.dot(#factor))
                    } else {
                        quote!(#bar * #factor)
                    };
                    self.give(b, term(product));
                }
            }
            Op::Div(a, b) => {
                let divisor = self.read(b);
                let name = self.program.values[id].name.clone().unwrap_or_default();
                let share = self.let_bar(
                    &format!("{name}_per_unit"),
                    &[term(quote!(#bar / #divisor))],
                );
                self.give(a, atom(share.clone()));
                if self.active(b) {
                    let quotient = self.read(id);
                    self.give(b, minus(term(quote!(#share * #quotient))));
                }
            }
            Op::Select(mask, yes, no) => {
                for (side, when) in [(yes, quote!(when)), (no, quote!(unless))] {
                    if self.active(side) {
                        let mask = self.read(mask);
                        self.give(side, term(quote!(ops::#when(#mask, #bar))));
                    }
                }
            }
            Op::Method(name, a, b) => self.method(id, name, a, b, bar),
            Op::Call(callee, arguments) => self.call(&callee, &arguments, bar),
            _ => unreachable!("handled where it needs no cotangent of its own"),
        }
    }

    fn method(&mut self, id: Id, name: &str, a: Id, b: Option<Id>, bar: TokenStream) {
        if let Some(b) = b {
            for (to, other, left) in [(a, b, true), (b, a, false)] {
                if !self.active(to) {
                    continue;
                }
                let given = match name {
                    "min" | "max" => {
                        let (x, y) = (self.read(a), self.read(b));
                        let takes_left = ident(if name == "min" { "le" } else { "ge" });
                        let side = ident(if left { "when" } else { "unless" });
                        quote!(ops::#side(#x.#takes_left(#y), #bar))
                    }
                    "cross" => {
                        let other = self.read(other);
                        if left {
                            quote!(#other.cross(#bar))
                        } else {
                            quote!(#bar.cross(#other))
                        }
                    }
                    "dot" => {
                        let other = self.read(other);
                        quote!(#other * #bar)
                    }
                    "times" => {
                        let other = self.read(other);
                        quote!(#bar.times(#other))
                    }
                    _ => unreachable!("comparisons are passive"),
                };
                self.give(to, term(given));
            }
            return;
        }
        // What each derivative is cheapest to write in: the argument, the result, or both.
        let rule = ident(&format!("{name}_adjoint"));
        let argument = matches!(name, "abs" | "ln" | "length" | "normalize").then(|| self.read(a));
        let result = matches!(name, "sqrt" | "exp" | "length" | "normalize").then(|| self.read(id));
        let inputs = argument.into_iter().chain(result);
        self.give(a, term(quote!(ops::#rule(#(#inputs,)* #bar))));
    }

    fn call(&mut self, callee: &Signature, arguments: &[Id], bar: TokenStream) {
        let inputs: Vec<TokenStream> = arguments.iter().map(|&a| self.read(a)).collect();
        let mut names = Vec::new();
        for (&argument, (name, kind)) in arguments.iter().zip(&callee.arguments) {
            if kind.differentiable() {
                let wanted = self.active(argument);
                let name = wanted
                    .then(|| ident(&self.program.fresh(&format!("{}_{name}_bar", callee.name))));
                if let Some(name) = &name {
                    self.give(argument, atom(name.into_token_stream()));
                }
                names.push(name.map_or(quote!(_), |n| n.into_token_stream()));
            }
        }
        let pattern = tuple_or_single(&names);
        let (module, adjoint) = (
            ident(&callee.module),
            ident(&format!("{}_adjoint", callee.name)),
        );
        self.statements
            .push(quote!(let #pattern = crate::adjoint::#module::#adjoint(#(#inputs,)* #bar);));
    }
}

/// Several things as a tuple, one as itself.
pub fn tuple_or_single(parts: &[TokenStream]) -> TokenStream {
    match parts {
        [only] => only.clone(),
        _ => quote!((#(#parts),*)),
    }
}
