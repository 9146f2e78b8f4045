//! From a kernel's statements to values.

use super::kind::Kind;
use super::library::Library;
use super::program::{Id, Op, Program};
use super::{Error, refuse};
use std::collections::HashMap;
use syn::spanned::Spanned;
use syn::{Expr, Pat, Stmt};

/// Reads one kernel's body.
pub(super) struct Reader<'a> {
    pub(super) library: &'a Library,
    pub(super) module: &'a str,
    pub(super) program: Program,
    pub(super) scope: HashMap<String, Id>,
}

impl<'a> Reader<'a> {
    pub(super) fn new(library: &'a Library, module: &'a str) -> Self {
        let program = Program::new(library.files[module].taken_names());
        Reader {
            library,
            module,
            program,
            scope: HashMap::new(),
        }
    }

    /// Reads a whole kernel: its arguments' values and its result's.
    pub(super) fn kernel(&mut self, function: &syn::ItemFn) -> Result<(Vec<Id>, Id), Error> {
        let signature =
            &self.library.files[self.module].signatures[&function.sig.ident.to_string()];
        let mut arguments = Vec::new();
        for (name, kind) in &signature.arguments {
            let id = self.program.argument(name, kind.clone());
            self.scope.insert(name.clone(), id);
            arguments.push(id);
        }
        let Some((Stmt::Expr(result, None), statements)) = function.block.stmts.split_last() else {
            return refuse(
                &function.sig.ident,
                "a kernel ends with its result as an expression",
            );
        };
        for statement in statements {
            self.statement(statement)?;
        }
        let id = self.expression(result)?;
        self.expect(result, id, &signature.result)?;
        Ok((arguments, id))
    }

    fn statement(&mut self, statement: &Stmt) -> Result<(), Error> {
        let Stmt::Local(local) = statement else {
            return refuse(
                statement,
                "a kernel is made of `let` statements and a final expression",
            );
        };
        let Some(init) = &local.init else {
            return refuse(local, "a `let` in a kernel has a value");
        };
        if let Some((_, diverge)) = &init.diverge {
            return refuse(diverge, "a kernel has no branches: use select");
        }
        let id = self.expression(&init.expr)?;
        let mut pattern = &local.pat;
        if let Pat::Type(typed) = pattern {
            if !matches!(&*typed.ty, syn::Type::Infer(_)) {
                self.expect(&init.expr, id, &self.library.kind(self.module, &typed.ty)?)?;
            }
            pattern = &typed.pat;
        }
        if self.program.values[id].kind == Kind::Number {
            return refuse(
                &init.expr,
                "an f64 stays inside `splat`, or becomes a `const` of the file",
            );
        }
        self.bind(pattern, id)
    }

    fn bind(&mut self, pattern: &Pat, id: Id) -> Result<(), Error> {
        match pattern {
            Pat::Wild(_) => Ok(()),
            Pat::Paren(inner) => self.bind(&inner.pat, id),
            Pat::Ident(p) if p.mutability.is_some() => refuse(
                p,
                "a kernel has no mutable variables: give each value a name",
            ),
            Pat::Ident(p) if p.by_ref.is_none() && p.subpat.is_none() => {
                let name = p.ident.to_string();
                self.program.bind(id, &name);
                self.scope.insert(name, id);
                Ok(())
            }
            Pat::Tuple(tuple) => {
                let kind = self.program.values[id].kind.clone();
                let Kind::Tuple(kinds) = &kind else {
                    return refuse(
                        tuple,
                        format!("a tuple pattern cannot take apart {}", kind.describe()),
                    );
                };
                if kinds.len() != tuple.elems.len() {
                    return refuse(
                        tuple,
                        format!(
                            "this pattern has {} parts, the value {}",
                            tuple.elems.len(),
                            kinds.len()
                        ),
                    );
                }
                for (index, (pattern, kind)) in tuple.elems.iter().zip(kinds).enumerate() {
                    let part = self.program.push(Op::Part(id, index), kind.clone());
                    self.bind(pattern, part)?;
                }
                Ok(())
            }
            other => refuse(
                other,
                "a `let` in a kernel binds a name, `_`, or a tuple of these",
            ),
        }
    }

    pub(super) fn expect(&self, at: &impl Spanned, id: Id, want: &Kind) -> Result<(), Error> {
        let kind = &self.program.values[id].kind;
        if kind == want {
            return Ok(());
        }
        refuse(
            at,
            format!("this is {}, not {}", kind.describe(), want.describe()),
        )
    }

    pub(super) fn operand(&mut self, expr: &Expr, want: &Kind) -> Result<Id, Error> {
        let id = self.expression(expr)?;
        self.expect(expr, id, want)?;
        Ok(id)
    }

    pub(super) fn kind(&self, id: Id) -> Kind {
        self.program.values[id].kind.clone()
    }
}
