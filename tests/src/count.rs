//! The operations in an emitted text, counted independently of the generator by parsing the text.

use std::collections::BTreeMap;

use syn::visit::{self, Visit};

use crate::signatures::{INTO, OF_PARAMETERS};

/// Operations in the body of a function.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Operations {
    /// `*`
    pub mul: usize,
    /// `+` and binary `-`
    pub add: usize,
    /// `/`
    pub div: usize,
    /// Sign changes of anything but a literal.
    pub neg: usize,
    /// Calls of `sin_cos`.
    pub sincos: usize,
    /// Calls of `stribeck`.
    pub exp: usize,
}

/// Operations of every public function of a module. They include its parts, `NAME_part_1` and so on, and the writer of its
/// result, `NAME_into`. Functions that every module has word for word are left out.
///
/// Panics where the text is not Rust, or holds a construct that no emitted function may hold. Such constructs are other operators
/// or calls, an index that is no literal, loops, branches, macros and unsafe blocks.
pub fn count(text: &str) -> BTreeMap<String, Operations> {
    let file = syn::parse_file(text).expect("the emitted text is Rust");
    let mut counted: BTreeMap<String, Operations> = BTreeMap::new();
    for item in &file.items {
        let syn::Item::Fn(function) = item else { continue };
        let name = function.sig.ident.to_string();
        if OF_PARAMETERS.contains(&name.as_str()) {
            continue;
        }
        let public = matches!(function.vis, syn::Visibility::Public(_));
        let whole = name.strip_suffix(INTO).or(if public { Some(name.as_str()) } else { part_of(&name) });
        let Some(whole) = whole else { continue };
        counted.entry(whole.to_owned()).or_default().visit_block(&function.block);
    }
    counted
}

/// The function that a private function holds a part of.
fn part_of(name: &str) -> Option<&str> {
    let (whole, number) = name.rsplit_once("_part_")?;
    number.parse::<usize>().is_ok().then_some(whole)
}

impl<'a> Visit<'a> for Operations {
    fn visit_expr(&mut self, expr: &'a syn::Expr) {
        use syn::{BinOp, Expr, UnOp};
        match expr {
            Expr::Binary(binary) => match binary.op {
                BinOp::Mul(_) => self.mul += 1,
                BinOp::Add(_) | BinOp::Sub(_) => self.add += 1,
                BinOp::Div(_) => self.div += 1,
                _ => panic!("an operator that is not + - * /"),
            },
            Expr::Unary(unary) => {
                assert!(matches!(unary.op, UnOp::Neg(_)), "a unary operator that is not -");
                self.neg += usize::from(!matches!(*unary.expr, Expr::Lit(_)));
            }
            Expr::Call(call) => {
                let Expr::Path(path) = &*call.func else { panic!("a call of something that has no name") };
                match path.path.get_ident().map(ToString::to_string).as_deref() {
                    Some("sin_cos") => self.sincos += 1,
                    Some("stribeck") => self.exp += 1,
                    Some("sign" | "barrier") => (),
                    Some(name) if part_of(name).is_some() || name.ends_with(INTO) => (),
                    _ => panic!("a call of something else than sin_cos, sign, stribeck and barrier"),
                }
            }
            Expr::Index(index) => assert!(matches!(*index.index, Expr::Lit(_)), "an index that is no literal"),
            Expr::Array(_)
            | Expr::Assign(_)
            | Expr::Field(_)
            | Expr::Lit(_)
            | Expr::Paren(_)
            | Expr::Path(_)
            | Expr::Struct(_)
            | Expr::Tuple(_) => (),
            // A function calls its result writer with a reference to an array of zeros.
            Expr::Reference(_) | Expr::Repeat(_) => (),
            _ => panic!("an expression that has no place in an emitted function"),
        }
        visit::visit_expr(self, expr);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[track_caller]
    fn check(body: &str, [mul, add, div, neg, sincos, exp]: [usize; 6]) {
        let counted = count(&format!("pub fn f() {{ {body} }} fn private() {{ 1 * 2 }}"));
        assert_eq!(counted, BTreeMap::from([("f".to_owned(), Operations { mul, add, div, neg, sincos, exp })]), "{body}");
    }

    #[test]
    fn operations_are_counted() {
        check("let (s1, _) = sin_cos(q[0]); let t = s1 * q[1] - 2.0 + -0.5 * x / y; [-t, t, -1.0]", [2, 2, 1, 1, 1, 0]);
        check("let _ = q; [0.0]", [0; 6]);
        check("E { a: [[x + y * z; 1][0]], b: -(x + sign(dq[0])) }".replace("; 1][0]", "]").as_str(), [1, 2, 0, 1, 0, 0]);
        check("by_q[0][1] = -t1; barrier(); by_dq[1] = t1 + 2.0;", [0, 1, 0, 1, 0, 0]);
        check("let mut result = ([[0.0; P]; DOF], [0.0; P]); f_into(q, &mut result.0, &mut result.1); result", [0; 6]);
        check("let t1 = stribeck(dq[0], 0.05); [t1 * 2.0, -t1]", [1, 0, 0, 1, 0, 1]);
    }

    #[test]
    fn what_has_no_place_is_refused() {
        for body in ["q[i]", "if x { y } else { z }", "x.sin()", "f(x)", "x % y", "loop {}", "!x", "unsafe { x }", "m!(x)"] {
            let text = format!("pub fn f() {{ let t = {body}; t }}");
            assert!(std::panic::catch_unwind(|| count(&text)).is_err(), "{body}");
        }
    }
}
