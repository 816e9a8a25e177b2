//! Exact constants of a pool: each value once, positive, with its sign on the edge.
//!
//! A [`Number`] is interned by its form. It has no form of its own where sums are shared or long integers under roots have common factors: it is
//! the same as another constant where both are equal in the field and enclosures of 96 bits overlap.

use std::borrow::Cow;
use std::sync::Arc;

use super::field::Element;
use super::{ConstantId, ExprId, Node, Pool};
use crate::exact::{Number, Rational};

impl Pool {
    /// The exact value, if the expression is a constant.
    pub fn as_constant(&self, expr: ExprId) -> Option<Number> {
        match self.node(expr) {
            Node::Constant(id) => {
                let value = &*self.constants[id.0 as usize];
                Some(if expr.is_negated() { -value } else { value.clone() })
            }
            _ => None,
        }
    }

    fn value(&self, expr: ExprId) -> Cow<'_, Number> {
        match self.node(expr) {
            Node::Constant(id) if !expr.is_negated() => Cow::Borrowed(&self.constants[id.0 as usize]),
            _ => Cow::Owned(self.as_constant(expr).expect("asked for constants only")),
        }
    }

    /// Whether the expression is a constant.
    pub fn is_constant(&self, expr: ExprId) -> bool {
        matches!(self.node(expr), Node::Constant(_))
    }

    /// An exact constant.
    pub fn constant(&mut self, value: &Number) -> ExprId {
        if self.fingerprints_only {
            let value = self.field.number(value);
            return self.by_fingerprint(value);
        }
        // Most are known, and their signs with them.
        let minus = -value;
        for (size, negative) in [(value, false), (&minus, true)] {
            if let Some(&expr) = self.constant_nodes.get(size) {
                return expr.signed(negative);
            }
        }
        let element = self.field.number(value);
        self.new_constant(value.clone(), element, None)
    }

    /// An exact integer.
    pub fn integer(&mut self, value: i64) -> ExprId {
        self.constant(&Number::from(value))
    }

    /// An exact fraction.
    pub fn fraction(&mut self, numerator: i64, denominator: i64) -> ExprId {
        self.constant(&Number::from(Rational::from(numerator) / Rational::from(denominator)))
    }

    /// A constant of another pool over the same field.
    pub fn constant_of(&mut self, other: &Pool, expr: ExprId) -> ExprId {
        debug_assert_eq!(self.field.prime(), other.field.prime());
        let element = other.fingerprint(expr.unsigned())[0];
        if self.fingerprints_only {
            return self.by_fingerprint(element).signed(expr.is_negated());
        }
        let size = other.value(expr.unsigned()).into_owned();
        self.interned(size, element, Some(false)).signed(expr.is_negated())
    }

    pub(super) fn sum_of_constants(&mut self, a: ExprId, b: ExprId) -> ExprId {
        let element = self.field.add(self.fingerprint(a)[0], self.fingerprint(b)[0]);
        if self.fingerprints_only {
            return self.by_fingerprint(element);
        }
        let sum = self.value(a).plus(&self.value(b));
        let sign = (a.is_negated() == b.is_negated()).then_some(a.is_negated());
        self.interned(sum, element, sign)
    }

    /// The product of two positive constants; `None` if its value in the field is not that of the factors. It is not where a nested root is
    /// reduced, r r to what stands under the root: its value in the field is one on which nothing is known.
    pub(super) fn product_of_constants(&mut self, a: ExprId, b: ExprId) -> Option<ExprId> {
        let element = self.field.mul(self.fingerprint(a)[0], self.fingerprint(b)[0]);
        if self.fingerprints_only {
            return Some(self.by_fingerprint(element));
        }
        let product = self.value(a).times(&self.value(b));
        if self.value(a).has_roots() && self.value(b).has_roots() {
            return self.folded(&product, element);
        }
        Some(self.interned(product, element, Some(false)))
    }

    /// The constant that an operation on constants comes to, if its value in the field is what the operation gives there.
    pub(super) fn folded(&mut self, value: &Number, expected: Element) -> Option<ExprId> {
        let constant = self.constant(value);
        (self.fingerprint(constant)[0] == expected).then_some(constant)
    }

    /// A constant of a pool that knows constants by fingerprints only.
    pub(super) fn by_fingerprint(&mut self, value: Element) -> ExprId {
        let fingerprint = [value; 2];
        if value == self.field.zero() {
            return ExprId::ZERO;
        }
        self.known(fingerprint).unwrap_or_else(|| self.push(Node::Constant(ConstantId(u32::MAX)), fingerprint))
    }

    /// A constant with its value in the field, and whether it is negative if that is known.
    fn interned(&mut self, value: Number, element: Element, negative: Option<bool>) -> ExprId {
        if self.fingerprints_only {
            return self.by_fingerprint(element);
        }
        let known = |pool: &Pool, size: &Number| pool.constant_nodes.get(size).copied();
        if negative != Some(true) {
            if let Some(expr) = known(self, &value) {
                return expr;
            }
        }
        if negative != Some(false) {
            if let Some(expr) = known(self, &-&value) {
                return -expr;
            }
        }
        self.new_constant(value, element, negative)
    }

    /// A constant that is not known by its form.
    fn new_constant(&mut self, value: Number, element: Element, negative: Option<bool>) -> ExprId {
        if let Some(known) = self.equal_constant(&value, element) {
            return known;
        }
        // By its value, so that what a divisor stands for is positive where the divisor is.
        let negative = negative.unwrap_or_else(|| value.is_negative());
        let (size, element) = if negative { (-&value, self.field.neg(element)) } else { (value, element) };
        let id = ConstantId(self.constants.len() as u32);
        let expr = self.push(Node::Constant(id), [element; 2]);
        let size = Arc::new(size);
        self.constants.push(size.clone());
        self.constant_nodes.insert(size, expr);
        expr.signed(negative)
    }

    /// A constant that has this value and may look different, because not all is multiplied out in one of them.
    fn equal_constant(&self, value: &Number, element: Element) -> Option<ExprId> {
        // The first constant of a pool is 0 itself.
        if element == self.field.zero() && !self.is_empty() && value.is_near(&Number::zero()) {
            return Some(ExprId::ZERO);
        }
        let expr = self.known([element; 2])?;
        let Node::Constant(id) = self.node(expr) else { return None };
        let other = &self.constants[id.0 as usize];
        self.is_near(value, other, expr.is_negated()).then_some(expr)
    }

    fn is_near(&self, value: &Number, size: &Number, negative: bool) -> bool {
        if negative {
            (-value).is_near(size)
        } else {
            value.is_near(size)
        }
    }
}
