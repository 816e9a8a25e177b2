//! Neighbouring elements: arrays, slices and parts of them as a pointer and a count.

use super::program::last;
use super::scopes::{Bound, Lower};
use super::translator::Found;
use super::types::{Length, Type};
use super::values::{Count, View};

impl<'a> Lower<'a, '_> {
    /// The neighbours that an array, a slice or a part of one is.
    pub(super) fn view(&mut self, value: &'a syn::Expr) -> Found<View> {
        use syn::Expr;
        match value {
            Expr::Reference(inner) => return self.view(&inner.expr),
            Expr::Paren(inner) => return self.view(&inner.expr),
            Expr::Path(path) => {
                if let Some(Bound::View(view)) = self.lookup(&last(&path.path))? {
                    return Ok(view);
                }
            }
            Expr::Index(index) => {
                if let Expr::Range(range) = &*index.index {
                    return self.part(&index.expr, range);
                }
            }
            Expr::MethodCall(call) if call.method == "as_flattened" || call.method == "as_flattened_mut" => {
                let outer = self.view(&call.receiver)?;
                return match (&outer.of, &outer.count) {
                    (Type::Array(of, Length::Known(size)), Count::Known(count)) => {
                        let (of, count) = ((**of).clone(), Count::Known(count * size));
                        Ok(View { of, count, within: Some(*size), ..outer })
                    }
                    _ => Err("what is flattened is of no known size".into()),
                };
            }
            _ => {}
        }
        let ty = self.ty(value)?;
        let found = self.expression(value)?;
        let found = self.placed(found, &ty, "values")?;
        match ty.behind() {
            Type::Array(of, Length::Known(size)) => Ok(View {
                pointer: found.member("at").text,
                offset: None,
                count: Count::Known(*size),
                of: (**of).clone(),
                within: None,
            }),
            Type::Slice(of) => {
                let count = Count::Text(found.member("count").text);
                Ok(View { pointer: found.member("at").text, offset: None, count, of: (**of).clone(), within: None })
            }
            other => Err(format!("{other:?} has no elements")),
        }
    }

    fn part(&mut self, of: &'a syn::Expr, range: &'a syn::ExprRange) -> Found<View> {
        let mut view = self.view(of)?;
        let start = match &range.start {
            Some(start) => self.stable(start)?,
            None => "0".into(),
        };
        let end = match &range.end {
            Some(end) => Some(self.stable(end)?),
            None => None,
        };
        let known = |text: &str| text.parse::<usize>().ok();
        view.count = match (end, &view.count, known(&start)) {
            (Some(end), _, Some(start)) if known(&end).is_some() => Count::Known(known(&end).unwrap_or(0).saturating_sub(start)),
            (Some(end), _, Some(0)) => Count::Text(end),
            (None, Count::Known(count), Some(start)) => Count::Known(count.saturating_sub(start)),
            _ => return Err("a part of an array whose length is not known".into()),
        };
        view.offset = Some(super::values::sum(view.offset.as_deref(), &start));
        Ok(view)
    }

    /// An argument that is a slice.
    pub(super) fn slice(&mut self, value: &'a syn::Expr, ty: &Type) -> Found<String> {
        let view = match (value, ty.behind()) {
            // C has no arrays without elements.
            (syn::Expr::Reference(inner), Type::Slice(of)) if matches!(&*inner.expr, syn::Expr::Array(all) if all.elems.is_empty()) => {
                View { pointer: String::new(), offset: None, count: Count::Known(0), of: (**of).clone(), within: None }
            }
            _ => self.view(value)?,
        };
        if let (None, Count::Text(_), Some(whole)) = (&view.offset, &view.count, view.pointer.strip_suffix(".at")) {
            return Ok(whole.to_owned());
        }
        let variable = self.variable("slice");
        let declaration = self.tr.declarator(ty, &variable)?;
        let start = if view.count == Count::Known(0) { "NULL".into() } else { view.start() };
        self.line(&format!("const {declaration} = {{{start}, {}}};", view.count.text()));
        Ok(variable)
    }
}
