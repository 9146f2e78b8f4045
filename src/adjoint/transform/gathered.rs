//! The terms a cotangent is gathered from.

use super::kind::Kind;
use proc_macro2::TokenStream;

/// One summand of a cotangent.
#[derive(Clone)]
pub struct Term {
    pub tokens: TokenStream,
    pub negative: bool,
    /// A name or a field of one: may be repeated at no cost.
    pub atomic: bool,
}

/// What a value's cotangent is made of so far: terms for the whole, and for its parts.
#[derive(Clone, Default)]
pub struct Gathered {
    pub whole: Vec<Term>,
    pub parts: Vec<Gathered>,
}

impl Gathered {
    pub fn is_empty(&self) -> bool {
        self.whole.is_empty() && self.parts.iter().all(Gathered::is_empty)
    }

    pub fn part(&mut self, kind: &Kind, index: usize) -> &mut Gathered {
        self.parts.resize_with(kind.part_count(), Gathered::default);
        &mut self.parts[index]
    }

    pub fn absorb(&mut self, other: Gathered) {
        self.whole.extend(other.whole);
        if self.parts.len() < other.parts.len() {
            self.parts.resize_with(other.parts.len(), Gathered::default);
        }
        for (mine, theirs) in self.parts.iter_mut().zip(other.parts) {
            mine.absorb(theirs);
        }
    }

    /// Adds a cotangent of the whole. Only numbers and vectors can be summed: others come apart
    /// here.
    pub fn add(&mut self, kind: &Kind, term: Term) {
        match kind {
            Kind::Real | Kind::Vec3 => self.whole.push(term),
            Kind::Mask | Kind::Number => {}
            _ => {
                for index in 0..kind.part_count() {
                    let tokens = kind.access(&term.tokens, index);
                    let part = Term {
                        tokens,
                        ..term.clone()
                    };
                    self.part(kind, index).add(&kind.part(index), part);
                }
            }
        }
    }
}

pub fn atom(tokens: TokenStream) -> Term {
    Term {
        tokens,
        negative: false,
        atomic: true,
    }
}

pub fn term(tokens: TokenStream) -> Term {
    Term {
        tokens,
        negative: false,
        atomic: false,
    }
}

pub fn minus(mut term: Term) -> Term {
    term.negative = !term.negative;
    term
}
