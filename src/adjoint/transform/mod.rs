//! The source transformation: from kernels in a subset of Rust to their reverse-mode twins.
//!
//! [`Library::read`] reads every kernel file, [`adjoint_source`] writes the adjoints of one of them
//! and [`check_source`] the table by which tests compare each adjoint with finite differences and
//! forward mode. All three are pure functions of text.
//!
//! A kernel `pub fn foo<F: Real>(a: V3<F>, b: F, m: F::Mask) -> R` gets `pub fn foo_adjoint<F:
//! Real>(a: V3<F>, b: F, m: F::Mask, out_bar: R) -> (V3<F>, F)`: one cotangent for each argument
//! that can have one, in order (the plain value where there is only one). The generated body
//! recomputes what it needs of the kernel and then walks it backwards.
//!
//! # The subset
//!
//! A kernel file holds `use`, `const`, `pub struct`, `pub fn` and items under `#[cfg(test)]`.
//!
//! - Types: `F`, `V3<F>`, `F::Mask`, `f64` (arguments only), tuples, fixed arrays (`[V3<F>; 3]`),
//!   and structs of these with public named fields and the one parameter `F`. Arguments of type
//!   `F::Mask` and `f64` are passive: they have no cotangent. A mask inside a result keeps its
//!   place in `out_bar`, where it is ignored.
//! - Statements: `let` with a name, `_`, or a tuple of these, with or without a type; then the
//!   result as the final expression. Shadowing is fine.
//! - Numbers: `+ - * /` and unary `-` on `F`; `+`, `-`, unary `-` on `V3<F>`, and `V3 * F`; the
//!   methods of `Real` and `V3`; `F::splat`, `V3::splat` of an `f64` expression made of literals,
//!   constants and `f64` arguments; `V3::new`; `.x .y .z`, `.0`, fields and `[0]`; tuples, arrays
//!   and struct literals.
//! - Masks: `lt le gt ge`, `& | !`, and `F::select`, `V3::select`. They are passive.
//! - Calls of kernels in the same file, or in another one by `use crate::kernels::file::name`.
//!
//! Anything else is refused with its place and one sentence; nothing is ever skipped silently.
//!
//! # Derivatives at the edges of their domain
//!
//! Derivatives are exactly what mathematics says, with no epsilon hidden in them: that of `sqrt` at
//! zero is infinite. `select` gives the side it did not take a cotangent of exactly zero, so an
//! infinite *value* there never leaks. But an infinite *derivative* further up does: zero times
//! infinity is NaN. Where one side of a select is not differentiable for the lanes that take the
//! other, make both sides finite first (the double-where idiom):
//!
//! ```text
//! let inside = x.gt(F::splat(0.0));
//! let safe = F::select(inside, x, F::splat(1.0));            // finite on both sides
//! let root = F::select(inside, safe.sqrt(), F::splat(0.0));  // not: select(inside, x.sqrt(), 0)
//! ```
//!
//! At ties `min` and `max` follow their left argument, and `abs` has derivative 1 at zero.
//! `signum` has derivative zero.

mod body;
mod check;
mod emit;
mod expression;
mod file;
mod gathered;
mod kind;
mod library;
mod operation;
mod program;
mod reverse;
mod signature;
#[cfg(test)]
mod tests;

pub use check::check_source;
pub use emit::adjoint_source;
pub use library::Library;

use std::fmt;
use syn::spanned::Spanned;

/// Why a kernel cannot be transformed, and where.
#[derive(Clone, Debug, PartialEq)]
pub struct Error {
    pub file: String,
    /// Counted from one.
    pub line: usize,
    /// Counted from one.
    pub column: usize,
    pub message: String,
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        let Error {
            file,
            line,
            column,
            message,
        } = self;
        write!(f, "{file}:{line}:{column}: {message}")
    }
}

impl std::error::Error for Error {}

/// An error whose file is filled in by whoever knows it.
fn refuse<T>(at: &impl Spanned, message: impl Into<String>) -> Result<T, Error> {
    Err(refusal(at.span(), message))
}

fn refusal(span: proc_macro2::Span, message: impl Into<String>) -> Error {
    let start = span.start();
    Error {
        file: String::new(),
        line: start.line,
        column: start.column + 1,
        message: message.into(),
    }
}

fn in_file<T>(result: Result<T, Error>, path: &str) -> Result<T, Error> {
    result.map_err(|mut e| {
        if e.file.is_empty() {
            e.file = path.to_string();
        }
        e
    })
}
