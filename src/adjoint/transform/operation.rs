//! From calls of methods, of functions and of other kernels to values.

use super::body::Reader;
use super::kind::{Kind, ident};
use super::program::{Id, Op};
use super::{Error, refuse};
use proc_macro2::TokenStream;
use quote::{ToTokens, quote};
use syn::{BinOp, Expr, UnOp};

/// Methods of `F` that give `F`, and those that give a mask, with how many arguments they take.
const REAL_METHODS: [(&str, usize); 7] = [
    ("sqrt", 0),
    ("abs", 0),
    ("exp", 0),
    ("ln", 0),
    ("signum", 0),
    ("min", 1),
    ("max", 1),
];
const COMPARISONS: [&str; 4] = ["lt", "le", "gt", "ge"];
/// Methods of `V3<F>`, with how many arguments they take and what they give.
const VECTOR_METHODS: [(&str, usize, Kind); 5] = [
    ("dot", 1, Kind::Real),
    ("length", 0, Kind::Real),
    ("cross", 1, Kind::Vec3),
    ("times", 1, Kind::Vec3),
    ("normalize", 0, Kind::Vec3),
];

impl Reader<'_> {
    pub(super) fn method(&mut self, call: &syn::ExprMethodCall) -> Result<Id, Error> {
        let receiver = self.expression(&call.receiver)?;
        let kind = self.kind(receiver);
        let name = call.method.to_string();
        let known = match kind {
            Kind::Real => {
                let real = REAL_METHODS
                    .iter()
                    .find(|m| m.0 == name)
                    .map(|m| (m.0, m.1, Kind::Real));
                real.or(COMPARISONS
                    .iter()
                    .find(|m| **m == name)
                    .map(|m| (*m, 1, Kind::Mask)))
            }
            Kind::Vec3 => VECTOR_METHODS.iter().find(|m| m.0 == name).cloned(),
            _ => None,
        };
        let Some((name, count, result)) = known else {
            return refuse(
                &call.method,
                format!(
                    "{} has no method `{name}` with a known adjoint",
                    kind.describe()
                ),
            );
        };
        if call.args.len() != count || call.turbofish.is_some() {
            return refuse(&call.method, format!("`{name}` takes {count} argument(s)"));
        }
        let argument = call
            .args
            .first()
            .map(|a| self.operand(a, &kind))
            .transpose()?;
        Ok(self
            .program
            .push(Op::Method(name, receiver, argument), result))
    }

    pub(super) fn call(&mut self, call: &syn::ExprCall) -> Result<Id, Error> {
        let Expr::Path(path) = &*call.func else {
            return refuse(&call.func, "a kernel calls other kernels by name");
        };
        let text = path
            .to_token_stream()
            .to_string()
            .replace(' ', "")
            .replace("V3::<F>", "V3");
        let arguments: Vec<&Expr> = call.args.iter().collect();
        match (text.as_str(), arguments.as_slice()) {
            ("F::splat" | "V3::splat", [number]) => {
                let number = self.number(number)?;
                let kind = if text == "F::splat" {
                    Kind::Real
                } else {
                    Kind::Vec3
                };
                let ty = ident(&text[..text.len() - "::splat".len()]);
                Ok(self
                    .program
                    .push(Op::Constant(quote!(#ty::splat(#number))), kind))
            }
            ("V3::new", [x, y, z]) => {
                let parts = [x, y, z].map(|e| self.operand(e, &Kind::Real));
                let parts = parts.into_iter().collect::<Result<_, _>>()?;
                Ok(self.program.push(Op::Build(parts), Kind::Vec3))
            }
            ("F::select" | "V3::select", [mask, yes, no]) => {
                let kind = if text == "F::select" {
                    Kind::Real
                } else {
                    Kind::Vec3
                };
                let mask = self.operand(mask, &Kind::Mask)?;
                let (yes, no) = (self.operand(yes, &kind)?, self.operand(no, &kind)?);
                Ok(self.program.push(Op::Select(mask, yes, no), kind))
            }
            _ => self.kernel_call(call, path, &text),
        }
    }

    fn kernel_call(
        &mut self,
        call: &syn::ExprCall,
        path: &syn::ExprPath,
        text: &str,
    ) -> Result<Id, Error> {
        let found = self.library.resolve(self.module, &path.path);
        let callee = found.and_then(|(m, n)| self.library.files.get(&m)?.signatures.get(&n));
        let Some(callee) = callee.cloned() else {
            return refuse(
                path,
                format!("`{text}` is neither a kernel nor an operation with a known adjoint"),
            );
        };
        if call.args.len() != callee.arguments.len() {
            return refuse(
                path,
                format!("`{text}` takes {} argument(s)", callee.arguments.len()),
            );
        }
        let mut arguments = Vec::new();
        for (argument, (_, kind)) in call.args.iter().zip(&callee.arguments) {
            arguments.push(match kind {
                Kind::Number => {
                    let number = self.number(argument)?;
                    self.program.push(Op::Constant(number), Kind::Number)
                }
                kind => self.operand(argument, kind)?,
            });
        }
        let result = callee.result.clone();
        Ok(self
            .program
            .push(Op::Call(Box::new(callee), arguments), result))
    }

    pub(super) fn structure(&mut self, literal: &syn::ExprStruct) -> Result<Id, Error> {
        let ty: syn::Type = {
            let path = &literal.path;
            syn::parse_quote!(#path<F>)
        };
        let Ok(kind @ Kind::Struct { .. }) = self.library.kind(self.module, &ty) else {
            return refuse(&literal.path, "this is not a struct of a kernel file");
        };
        if let Some(rest) = &literal.rest {
            return refuse(rest, "a struct in a kernel is written with all its fields");
        }
        let mut parts = vec![None; kind.part_count()];
        for field in &literal.fields {
            let Some(index) = kind.part_named(&field.member.to_token_stream().to_string()) else {
                return refuse(
                    &field.member,
                    format!("{} has no such field", kind.describe()),
                );
            };
            parts[index] = Some(self.operand(&field.expr, &kind.part(index))?);
        }
        match parts.into_iter().collect::<Option<Vec<_>>>() {
            Some(parts) => Ok(self.program.push(Op::Build(parts), kind)),
            None => refuse(
                literal,
                "a struct in a kernel is written with all its fields",
            ),
        }
    }

    /// An `f64` expression: it is a constant of the kernel, and copied as it stands.
    pub(super) fn number(&self, expr: &Expr) -> Result<TokenStream, Error> {
        let fine = match expr {
            Expr::Lit(_) => true,
            Expr::Paren(inner) => self.number(&inner.expr).is_ok(),
            Expr::Unary(u) => matches!(u.op, UnOp::Neg(_)) && self.number(&u.expr).is_ok(),
            Expr::Binary(b) => {
                let arithmetic = matches!(
                    b.op,
                    BinOp::Add(_) | BinOp::Sub(_) | BinOp::Mul(_) | BinOp::Div(_)
                );
                arithmetic && self.number(&b.left).is_ok() && self.number(&b.right).is_ok()
            }
            Expr::Path(path) => match path.path.get_ident().map(|i| i.to_string()) {
                Some(name) => match self.scope.get(&name) {
                    Some(id) => self.program.values[*id].kind == Kind::Number,
                    None => self.library.files[self.module].may_be_constant(&name),
                },
                None => matches!(
                    path.path.segments[0].ident.to_string().as_str(),
                    "std" | "core" | "f64"
                ),
            },
            _ => false,
        };
        if fine {
            return Ok(expr.to_token_stream());
        }
        refuse(
            expr,
            "only literals, constants and f64 arguments can stand here",
        )
    }
}
