//! From expressions of the subset to values.

use super::body::Reader;
use super::kind::Kind;
use super::program::{Id, Op};
use super::{Error, refuse};
use quote::ToTokens;
use syn::{BinOp, Expr, Member, UnOp};

impl Reader<'_> {
    pub(super) fn expression(&mut self, expr: &Expr) -> Result<Id, Error> {
        match expr {
            Expr::Paren(inner) => self.expression(&inner.expr),
            Expr::Group(inner) => self.expression(&inner.expr),
            Expr::Path(path) => self.name(path),
            Expr::Unary(unary) => self.unary(unary),
            Expr::Binary(binary) => self.binary(binary),
            Expr::MethodCall(call) => self.method(call),
            Expr::Call(call) => self.call(call),
            Expr::Field(field) => {
                let base = self.expression(&field.base)?;
                let name = match &field.member {
                    Member::Named(name) => name.to_string(),
                    Member::Unnamed(index) => index.index.to_string(),
                };
                let kind = self.kind(base);
                match kind.part_named(&name) {
                    Some(index) => Ok(self.program.push(Op::Part(base, index), kind.part(index))),
                    None => refuse(
                        &field.member,
                        format!("{} has no field `{name}`", kind.describe()),
                    ),
                }
            }
            Expr::Index(index) => {
                let base = self.expression(&index.expr)?;
                match (self.kind(base), literal_index(&index.index)) {
                    (Kind::Array(kind, length), Some(i)) if i < length => {
                        Ok(self.program.push(Op::Part(base, i), *kind))
                    }
                    (Kind::Array(..), _) => refuse(
                        &index.index,
                        "an array in a kernel is indexed by a literal within its length",
                    ),
                    (kind, _) => {
                        refuse(&index.expr, format!("{} is not an array", kind.describe()))
                    }
                }
            }
            Expr::Tuple(tuple) if !tuple.elems.is_empty() => {
                let parts = tuple
                    .elems
                    .iter()
                    .map(|e| self.expression(e))
                    .collect::<Result<Vec<_>, _>>()?;
                let kind = Kind::Tuple(parts.iter().map(|&p| self.kind(p)).collect());
                Ok(self.program.push(Op::Build(parts), kind))
            }
            Expr::Array(array) if !array.elems.is_empty() => {
                let first = self.expression(&array.elems[0])?;
                let kind = self.kind(first);
                let mut parts = vec![first];
                for element in array.elems.iter().skip(1) {
                    parts.push(self.operand(element, &kind)?);
                }
                let kind = Kind::Array(Box::new(kind), parts.len());
                Ok(self.program.push(Op::Build(parts), kind))
            }
            Expr::Struct(literal) => self.structure(literal),
            Expr::Lit(literal) => refuse(literal, "a number in a kernel is written F::splat(…)"),
            Expr::If(_) | Expr::Match(_) => refuse(expr, "a kernel has no branches: use select"),
            Expr::ForLoop(_) | Expr::While(_) | Expr::Loop(_) => {
                refuse(expr, "a kernel has no loops: write the steps out")
            }
            Expr::Closure(_) => refuse(expr, "a kernel has no closures: make it a `pub fn` kernel"),
            Expr::Macro(_) => refuse(expr, "a kernel calls no macros"),
            Expr::Assign(_) => refuse(
                expr,
                "a kernel has no mutable variables: give each value a name",
            ),
            Expr::Return(_) | Expr::Try(_) => refuse(
                expr,
                "a kernel has no early return: its result is the final expression",
            ),
            other => refuse(
                other,
                "this expression is outside the subset the adjoint transformation reads",
            ),
        }
    }

    fn name(&mut self, path: &syn::ExprPath) -> Result<Id, Error> {
        if let Some(id) = path
            .path
            .get_ident()
            .and_then(|name| self.scope.get(&name.to_string()))
        {
            return Ok(*id);
        }
        if self.number(&Expr::Path(path.clone())).is_ok() {
            return refuse(path, "a constant in a kernel is written F::splat(…)");
        }
        refuse(
            path,
            format!(
                "`{}` is not a value of this kernel",
                path.to_token_stream().to_string().replace(' ', "")
            ),
        )
    }

    fn unary(&mut self, unary: &syn::ExprUnary) -> Result<Id, Error> {
        let id = self.expression(&unary.expr)?;
        let kind = self.kind(id);
        match (&unary.op, &kind) {
            (UnOp::Neg(_), Kind::Real | Kind::Vec3) => Ok(self.program.push(Op::Neg(id), kind)),
            (UnOp::Not(_), Kind::Mask) => Ok(self.program.push(Op::Not(id), kind)),
            (op, _) => refuse(
                unary,
                format!(
                    "`{}` does not apply to {}",
                    op.to_token_stream(),
                    kind.describe()
                ),
            ),
        }
    }

    fn binary(&mut self, binary: &syn::ExprBinary) -> Result<Id, Error> {
        let sign = binary.op.to_token_stream().to_string();
        match binary.op {
            BinOp::Lt(_)
            | BinOp::Le(_)
            | BinOp::Gt(_)
            | BinOp::Ge(_)
            | BinOp::Eq(_)
            | BinOp::Ne(_) => {
                return refuse(
                    &binary.op,
                    format!("`{sign}` does not compare lanes: use lt, le, gt or ge"),
                );
            }
            BinOp::AddAssign(_)
            | BinOp::SubAssign(_)
            | BinOp::MulAssign(_)
            | BinOp::DivAssign(_) => {
                return refuse(
                    &binary.op,
                    "a kernel has no mutable variables: give each value a name",
                );
            }
            _ => {}
        }
        let a = self.expression(&binary.left)?;
        let b = self.expression(&binary.right)?;
        let (left, right) = (self.kind(a), self.kind(b));
        let op =
            match (&binary.op, &left, &right) {
                (BinOp::Add(_), Kind::Real, Kind::Real)
                | (BinOp::Add(_), Kind::Vec3, Kind::Vec3) => Op::Add(a, b),
                (BinOp::Sub(_), Kind::Real, Kind::Real)
                | (BinOp::Sub(_), Kind::Vec3, Kind::Vec3) => Op::Sub(a, b),
                (BinOp::Mul(_), Kind::Real | Kind::Vec3, Kind::Real) => Op::Mul(a, b),
                (BinOp::Div(_), Kind::Real, Kind::Real) => Op::Div(a, b),
                (BinOp::BitAnd(_), Kind::Mask, Kind::Mask) => Op::And(a, b),
                (BinOp::BitOr(_), Kind::Mask, Kind::Mask) => Op::Or(a, b),
                _ => {
                    let (left, right) = (left.describe(), right.describe());
                    return refuse(
                        &binary.op,
                        format!("`{sign}` does not apply to {left} and {right}"),
                    );
                }
            };
        Ok(self.program.push(op, left))
    }
}

fn literal_index(expr: &Expr) -> Option<usize> {
    match expr {
        Expr::Lit(syn::ExprLit {
            lit: syn::Lit::Int(i),
            ..
        }) => i.base10_parse().ok(),
        _ => None,
    }
}
