//! What calls of a kernel need to know of it, without its body.

use super::kind::Kind;

/// What a kernel takes and returns.
#[derive(Clone, Debug)]
pub(super) struct Signature {
    pub module: String,
    pub name: String,
    pub arguments: Vec<(String, Kind)>,
    pub result: Kind,
}

impl Signature {
    /// Whether it has an adjoint: a result to differentiate and an argument to differentiate by.
    pub fn differentiable(&self) -> bool {
        self.result.differentiable() && self.arguments.iter().any(|(_, k)| k.differentiable())
    }
}
