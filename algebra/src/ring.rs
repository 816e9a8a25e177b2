//! Expressions: an exact ring with shared nodes and fingerprints.
//!
//! Every quantity of an arm is a polynomial in sines and cosines of joint variables, joint variables of prismatic joints, rates,
//! accelerations and parameters, with exact constants as coefficients; forward dynamics adds reciprocals of pivots. So a node is
//!
//! ```text
//! Constant | Symbol | Add(a, b) | Mul(a, b) | Reciprocal(a)
//! ```
//!
//! Sine and cosine are inputs, and d sin/dq = cos, d cos/dq = -sin is all of calculus.
//!
//! **Signs are edges.** An [`ExprId`] is a node and a sign, so that x and -x share their node and a sign change costs nothing.
//!
//! **Fingerprints.** Each node carries its value at two fixed points of a prime field ([`field`]), where each (sine, cosine) is a
//! point of the circle. Two polynomials of degree d that differ agree at a random point with odds d/p, at two with (d/p)²,
//! which is below 2^-110 here: equal fingerprints mean equal expressions. A new node equal to an old one (or to its negative) *is*
//! the old one: that finds sin² + cos² = 1, distributivity and the addition theorems without a rewrite rule, and it makes every
//! identity between expressions an exact test. The points are fixed: the same expressions on every machine, in every run.
//!
//! **Computed angles**, sums of coordinates with factors that are no whole numbers, have sines and cosines that are inputs, too; the field
//! relates those of one unit ([`field::computed`]).
//!
//! **Constants** are interned by their form. Two of different forms are the same where their values in the field are equal and enclosures of
//! 96 bits overlap.

pub mod field;
pub mod matrix;
pub mod normal_form;
pub mod print;
pub mod turn;

mod calculus;
mod constants;
pub mod count;
mod dependence;
mod elementary;
mod evaluate;

use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::hash::BuildHasherDefault;
use std::sync::Arc;

use crate::exact::{Number, Polynomial};
use crate::scramble::scramble;
pub use elementary::Elementary;
use field::{Element, Field};

/// What the arguments of an emitted function are; joint i has index i - 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Symbol {
    /// sin(q_i).
    Sine(u16),
    /// cos(q_i).
    Cosine(u16),
    /// The sine of a sum of joint variables.
    SineOf(AngleSum),
    /// Its cosine.
    CosineOf(AngleSum),
    /// q_i itself (prismatic joints).
    Position(u16),
    /// dq_i.
    Rate(u16),
    /// A function of dq_i: an input here, tied to dq_i by nothing but its derivative.
    OfRate(Elementary, u16),
    /// |g_i(q)|: an input here, tied to q by nothing but its derivative; the pool keeps g_i ([`Pool::set_gravity`]).
    GravitySize(u16),
    /// sign(g_i(q)), with sign(0) = 0: likewise, of derivative 0.
    GravitySign(u16),
    /// ddq_i.
    Acceleration(u16),
    /// dqr_i, the reference rate.
    ReferenceRate(u16),
    /// ddqr_i, the reference acceleration.
    ReferenceAcceleration(u16),
    /// tau_i.
    Torque(u16),
    /// A named parameter of the description, or an entry of the parameter vector pi.
    Parameter(u16),
    /// A coordinate of the acceleration of free fall in the base frame, where that is an argument: 0, 1, 2 along x, y, z.
    Gravity(u16),
}

/// A sum of joint variables, some of them taken away, a bit for each joint; and the constant angle of the field ([`turn::Turn`]), if that
/// is added.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct AngleSum {
    /// Joints whose variables are added.
    pub plus: u32,
    /// Joints whose variables are taken away.
    pub minus: u32,
    /// Whether the constant angle is added.
    pub turned: bool,
}

impl AngleSum {
    /// As many joints as there are bits for.
    pub const MOST_JOINTS: usize = u32::BITS as usize;

    /// The joints, and whether their variables are taken away; those that are added first.
    pub fn terms(self) -> impl Iterator<Item = (u16, bool)> {
        let of = |set: u32, minus: bool| (0..u32::BITS as u16).filter(move |&i| set >> i & 1 == 1).map(move |i| (i, minus));
        of(self.plus, false).chain(of(self.minus, true))
    }

    /// A joint variable.
    pub const fn of(joint: u16) -> AngleSum {
        AngleSum { plus: 1 << joint, minus: 0, turned: false }
    }

    /// The sum of two that share no joint, at most one of them turned.
    pub fn plus(self, other: AngleSum) -> AngleSum {
        AngleSum { plus: self.plus | other.plus, minus: self.minus | other.minus, turned: self.turned || other.turned }
    }

    /// The joint variables alone.
    pub fn unturned(self) -> AngleSum {
        AngleSum { turned: false, ..self }
    }

    /// How many additions form the sum.
    pub fn additions(self) -> usize {
        self.terms().count() - 1 + usize::from(self.turned)
    }

    /// A sum of joint variables alone without its sign: the first joint is added. And whether the sign changed.
    pub fn unsigned(self) -> (AngleSum, bool) {
        let flip = self.minus.trailing_zeros() < self.plus.trailing_zeros();
        (if flip { AngleSum { plus: self.minus, minus: self.plus, ..self } } else { self }, flip)
    }

    /// Sine and cosine of the sum from those of its terms.
    pub fn circle<T>(
        self,
        zero: (T, T),
        of: impl Fn(u16) -> (T, T),
        turn: impl FnOnce() -> (T, T),
        plus: impl Fn(&(T, T), &(T, T), bool) -> (T, T),
    ) -> (T, T) {
        let sum = self.terms().fold(zero, |sum, (i, minus)| plus(&sum, &of(i), minus));
        if self.turned {
            plus(&sum, &turn(), false)
        } else {
            sum
        }
    }
}

/// The angle of a sine or cosine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Angle {
    /// A joint variable, or an angle that a function computes.
    One(u16),
    /// A sum of joint variables.
    Sum(AngleSum),
}

impl Angle {
    /// The joints or computed angles, and whether they are taken away.
    pub fn terms(self) -> impl Iterator<Item = (u16, bool)> {
        let (one, sum) = match self {
            Angle::One(i) => (Some((i, false)), None),
            Angle::Sum(sum) => (None, Some(sum)),
        };
        one.into_iter().chain(sum.into_iter().flat_map(AngleSum::terms))
    }

    /// How many additions form the sum.
    pub fn additions(self) -> usize {
        match self {
            Angle::One(_) => 0,
            Angle::Sum(sum) => sum.additions(),
        }
    }

    /// Its sine and its cosine.
    pub fn circle(self) -> [Symbol; 2] {
        match self {
            Angle::One(i) => [Symbol::Sine(i), Symbol::Cosine(i)],
            Angle::Sum(sum) => [Symbol::SineOf(sum), Symbol::CosineOf(sum)],
        }
    }
}

impl Symbol {
    /// The angle that this is the sine or cosine of.
    pub fn angle(self) -> Option<Angle> {
        match self {
            Symbol::Sine(i) | Symbol::Cosine(i) => Some(Angle::One(i)),
            Symbol::SineOf(sum) | Symbol::CosineOf(sum) => Some(Angle::Sum(sum)),
            _ => None,
        }
    }

    /// The index of its joint, parameter or coordinate; that of its first joint.
    pub fn index(self) -> u16 {
        match self {
            Symbol::Sine(i)
            | Symbol::Cosine(i)
            | Symbol::Position(i)
            | Symbol::Rate(i)
            | Symbol::OfRate(_, i)
            | Symbol::GravitySize(i)
            | Symbol::GravitySign(i)
            | Symbol::Acceleration(i)
            | Symbol::ReferenceRate(i)
            | Symbol::ReferenceAcceleration(i)
            | Symbol::Torque(i)
            | Symbol::Parameter(i)
            | Symbol::Gravity(i) => i,
            Symbol::SineOf(sum) | Symbol::CosineOf(sum) => (sum.plus | sum.minus).trailing_zeros() as u16,
        }
    }
}

/// A node and a sign.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ExprId(u32);

/// A node. Operands always stand before it in the pool.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Node {
    /// An exact constant, not negative in its leading coefficient.
    Constant(ConstantId),
    /// An input.
    Symbol(Symbol),
    /// a + b; at most the second is negated.
    Add(ExprId, ExprId),
    /// a b; neither is negated.
    Mul(ExprId, ExprId),
    /// 1/a; a is not negated.
    Reciprocal(ExprId),
}

/// Index of an exact constant in its pool.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct ConstantId(u32);

/// Values at the two points of the field.
pub type Fingerprint = [Element; 2];

/// A hash for fingerprints: they are random already.
#[derive(Clone, Copy, Default)]
pub(crate) struct FingerprintHasher(u64);

impl std::hash::Hasher for FingerprintHasher {
    fn finish(&self) -> u64 {
        self.0
    }
    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.write_u64(u64::from(byte));
        }
    }
    fn write_u64(&mut self, value: u64) {
        self.0 = self.0.rotate_left(5) ^ value;
    }
    fn write_usize(&mut self, _: usize) {}
}

/// The arena of expressions.
#[derive(Clone)]
pub struct Pool {
    field: Field,
    nodes: Vec<Node>,
    fingerprints: Vec<Fingerprint>,
    constants: Vec<Arc<Number>>,
    constant_nodes: BTreeMap<Arc<Number>, ExprId>,
    /// By the lesser of a value and its negative. Look-up only: its order reaches nothing.
    known: HashMap<Fingerprint, ExprId, BuildHasherDefault<FingerprintHasher>>,
    at_origin: Vec<Option<Arc<Number>>>,
    symbols: BTreeMap<Symbol, ExprId>,
    /// g_i of the symbols that stand for its size and its sign.
    gravity: BTreeMap<u16, ExprId>,
    /// Whether constants are known by their fingerprints alone.
    fingerprints_only: bool,
}

impl ExprId {
    /// 0, in every pool.
    pub const ZERO: ExprId = ExprId(0);
    /// 1, in every pool.
    pub const ONE: ExprId = ExprId(2);

    fn new(index: usize) -> ExprId {
        ExprId(u32::try_from(index << 1).expect("a pool holds less than 2^31 nodes"))
    }

    /// Index of the node.
    pub fn index(self) -> usize {
        (self.0 >> 1) as usize
    }

    /// Whether the node is negated.
    pub fn is_negated(self) -> bool {
        self.0 & 1 == 1
    }

    /// The node without the sign.
    pub fn unsigned(self) -> ExprId {
        ExprId(self.0 & !1)
    }

    /// Negated if `negate`.
    pub fn signed(self, negate: bool) -> ExprId {
        if self == ExprId::ZERO {
            self
        } else {
            ExprId(self.0 ^ u32::from(negate))
        }
    }
}

impl std::ops::Neg for ExprId {
    type Output = ExprId;
    fn neg(self) -> ExprId {
        self.signed(true)
    }
}

impl std::fmt::Debug for ExprId {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}#{}", if self.is_negated() { "-" } else { "" }, self.index())
    }
}

impl Pool {
    /// An empty pool over a field that has the roots its constants need.
    pub fn new(field: Field) -> Pool {
        let mut pool = Pool {
            field,
            nodes: Vec::new(),
            fingerprints: Vec::new(),
            constants: Vec::new(),
            constant_nodes: BTreeMap::new(),
            known: HashMap::default(),
            at_origin: Vec::new(),
            symbols: BTreeMap::new(),
            gravity: BTreeMap::new(),
            fingerprints_only: false,
        };
        assert_eq!((pool.constant(&Number::zero()), pool.constant(&Number::one())), (ExprId::ZERO, ExprId::ONE));
        pool
    }

    /// A copy to try things in: constants are known by their fingerprints alone, so that arithmetic with them costs nothing. What is
    /// derived there has the operations that it has in an exact pool (but for one over a constant without a simple inverse, which costs nothing
    /// here), and no values to print.
    pub fn fingerprints_only(&self) -> Pool {
        let mut copy = self.clone();
        copy.fingerprints_only = true;
        copy
    }

    /// Whether constants have values here, not fingerprints alone.
    pub fn knows_values(&self) -> bool {
        !self.fingerprints_only
    }

    /// Says what g_i is, of whose size and sign there are symbols.
    pub fn set_gravity(&mut self, joint: u16, torque: ExprId) {
        self.gravity.insert(joint, torque);
    }

    /// g_i, where it is known.
    pub fn gravity(&self, joint: u16) -> Option<ExprId> {
        self.gravity.get(&joint).copied()
    }

    /// The expressions, and behind them g_i of each joint whose size or sign they use, with these joints: all that is computed for the expressions.
    pub fn with_gravity(&self, exprs: &[ExprId]) -> (Vec<ExprId>, Vec<u16>) {
        if self.gravity.is_empty() {
            return (exprs.to_vec(), Vec::new());
        }
        let needed = self.reachable(exprs);
        let symbol = |index: usize| match self.nodes[index] {
            Node::Symbol(Symbol::GravitySize(i) | Symbol::GravitySign(i)) => Some(i),
            _ => None,
        };
        let used: BTreeSet<u16> = (0..self.len()).filter(|&index| needed[index]).filter_map(symbol).collect();
        let (joints, torques): (Vec<u16>, Vec<ExprId>) = used.into_iter().filter_map(|i| Some((i, self.gravity(i)?))).unzip();
        (exprs.iter().copied().chain(torques).collect(), joints)
    }

    /// Takes from expressions what [`Pool::with_gravity`] put behind them.
    pub fn take_gravity(&mut self, exprs: &mut Vec<ExprId>, joints: &[u16]) {
        let torques = exprs.split_off(exprs.len() - joints.len());
        self.gravity = joints.iter().copied().zip(torques).collect();
    }

    /// Makes room for so many nodes in all.
    pub fn reserve(&mut self, nodes: usize) {
        let more = nodes.saturating_sub(self.nodes.len());
        self.nodes.reserve(more);
        self.fingerprints.reserve(more);
        self.at_origin.reserve(more);
        self.known.reserve(more);
    }

    /// The node behind an expression; its sign is the caller's to add.
    pub fn node(&self, expr: ExprId) -> Node {
        self.nodes[expr.index()]
    }

    /// The node of an index, positive.
    pub fn expr(&self, index: usize) -> ExprId {
        debug_assert!(index < self.nodes.len());
        ExprId::new(index)
    }

    /// Number of nodes.
    pub fn len(&self) -> usize {
        self.nodes.len()
    }

    /// Whether there are no nodes: never, since 0 and 1 are always there.
    pub fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }

    /// The field of the fingerprints.
    pub fn field(&self) -> &Field {
        &self.field
    }

    /// The fingerprint, sign included: equal fingerprints mean equal expressions, across pools over the same field too.
    pub fn fingerprint(&self, expr: ExprId) -> Fingerprint {
        let fingerprint = self.fingerprints[expr.index()];
        if expr.is_negated() {
            self.negated(fingerprint)
        } else {
            fingerprint
        }
    }

    fn negated(&self, fingerprint: Fingerprint) -> Fingerprint {
        fingerprint.map(|x| self.field.neg(x))
    }

    /// An input.
    pub fn symbol(&mut self, symbol: Symbol) -> ExprId {
        if let Some(&known) = self.symbols.get(&symbol) {
            return known;
        }
        let expr = self.new_symbol(symbol);
        self.symbols.insert(symbol, expr);
        expr
    }

    fn new_symbol(&mut self, symbol: Symbol) -> ExprId {
        let fingerprint = [0, 1].map(|point| self.symbol_value(symbol, point));
        self.known(fingerprint).unwrap_or_else(|| self.push(Node::Symbol(symbol), fingerprint))
    }

    /// An input, even if another node has its value.
    pub fn input(&mut self, symbol: Symbol) -> ExprId {
        let fingerprint = [0, 1].map(|point| self.symbol_value(symbol, point));
        self.push(Node::Symbol(symbol), fingerprint)
    }

    fn symbol_value(&self, symbol: Symbol, point: u64) -> Element {
        let value = |kind: u64, index: u16| self.field.from_u64(scramble(scramble(kind << 20 | u64::from(index)) ^ (point + 1)));
        match symbol {
            Symbol::Sine(i) => self.field.point(i, |unit| value(1, unit)).0,
            Symbol::Cosine(i) => self.field.point(i, |unit| value(1, unit)).1,
            Symbol::SineOf(sum) => self.field.circle_of(sum, |i| self.field.point(i, |unit| value(1, unit))).0,
            Symbol::CosineOf(sum) => self.field.circle_of(sum, |i| self.field.point(i, |unit| value(1, unit))).1,
            Symbol::Position(i) => value(2, i),
            Symbol::Rate(i) => value(3, i),
            Symbol::OfRate(of, i) => value(of.kind(), i),
            Symbol::Acceleration(i) => value(5, i),
            Symbol::ReferenceRate(i) => value(6, i),
            Symbol::ReferenceAcceleration(i) => value(7, i),
            Symbol::Torque(i) => value(8, i),
            Symbol::Parameter(i) => value(9, i),
            Symbol::GravitySize(i) => value(11, i),
            Symbol::GravitySign(i) => value(12, i),
            Symbol::Gravity(i) => value(13, i),
        }
    }

    /// A polynomial of the description: its parameters become what `parameter` says.
    pub fn polynomial(&mut self, polynomial: &Polynomial, parameter: &dyn Fn(&mut Pool, u32) -> ExprId) -> ExprId {
        let mut sum = ExprId::ZERO;
        for (powers, coefficient) in polynomial.terms() {
            let mut term = self.constant(coefficient);
            for (id, &power) in powers {
                let base = parameter(self, id.0);
                for _ in 0..power {
                    term = self.mul(term, base);
                }
            }
            sum = self.add(sum, term);
        }
        sum
    }

    /// Forms a sum before anything needs it, so that a later sum of the same value is found to be this node.
    pub fn intern_sum(&mut self, a: ExprId, b: ExprId) {
        let _ = self.add(a, b);
    }

    /// a + b.
    pub fn add(&mut self, a: ExprId, b: ExprId) -> ExprId {
        if a == ExprId::ZERO {
            return b;
        }
        if b == ExprId::ZERO {
            return a;
        }
        if self.is_constant(a) && self.is_constant(b) {
            return self.sum_of_constants(a, b);
        }
        // The node holds the sum with its first operand positive: x - y, never -x + y or -x - y.
        let (a, b) = if a.is_negated() && !b.is_negated() { (b, a) } else { (a, b) };
        let negate = a.is_negated();
        let (a, b) = (a.signed(negate), b.signed(negate));
        let (fa, fb) = (self.fingerprint(a), self.fingerprint(b));
        let fingerprint = [0, 1].map(|i| self.field.add(fa[i], fb[i]));
        self.find_or_push(Node::Add(a, b), fingerprint).signed(negate)
    }

    /// a - b.
    pub fn sub(&mut self, a: ExprId, b: ExprId) -> ExprId {
        self.add(a, -b)
    }

    /// a b.
    pub fn mul(&mut self, a: ExprId, b: ExprId) -> ExprId {
        let mut negate = a.is_negated() != b.is_negated();
        let (mut a, mut b) = (a.unsigned(), b.unsigned());
        if self.is_constant(b) && !self.is_constant(a) {
            (a, b) = (b, a);
        }
        // Constant factors in a row are one, unless their product is none.
        while a != ExprId::ZERO && a != ExprId::ONE && self.is_constant(a) {
            let (factor, rest) = match self.node(b) {
                Node::Constant(_) => (b, ExprId::ONE),
                Node::Mul(factor, rest) if self.is_constant(factor) => (factor, rest),
                _ => break,
            };
            if factor == ExprId::ZERO {
                return ExprId::ZERO;
            }
            if factor == ExprId::ONE {
                break;
            }
            let Some(product) = self.product_of_constants(a, factor) else { break };
            negate ^= product.is_negated();
            (a, b) = (product.unsigned(), rest);
        }
        if a == ExprId::ZERO || b == ExprId::ZERO {
            return ExprId::ZERO;
        }
        if a == ExprId::ONE {
            return b.signed(negate);
        }
        if b == ExprId::ONE {
            return a.signed(negate);
        }
        let (fa, fb) = (self.fingerprint(a), self.fingerprint(b));
        let fingerprint = [0, 1].map(|i| self.field.mul(fa[i], fb[i]));
        self.find_or_push(Node::Mul(a, b), fingerprint).signed(negate)
    }

    /// 1/a. The caller knows that a is not identically zero.
    pub fn reciprocal(&mut self, a: ExprId) -> ExprId {
        assert_ne!(a, ExprId::ZERO, "one over 0");
        let negate = a.is_negated();
        let a = a.unsigned();
        if self.fingerprints_only && self.is_constant(a) {
            let inverse = self.field.inverse(self.fingerprint(a)[0]);
            return self.by_fingerprint(inverse).signed(negate);
        }
        // A number 1/n that only stands for itself would grow with every pivot that it enters, and n (1/n) - 1 would not be seen to be 0; as a
        // node it is found by its fingerprint.
        let fingerprint = self.fingerprint(a).map(|x| self.field.inverse(x));
        let inverse = self.as_constant(a).and_then(|value| value.simple_inverse());
        if let Some(constant) = inverse.and_then(|inverse| self.folded(&inverse, fingerprint[0])) {
            return constant.signed(negate);
        }
        self.find_or_push(Node::Reciprocal(a), fingerprint).signed(negate)
    }

    /// Whether two expressions are equal: an exact test with the odds of a miss given above.
    pub fn equal(&self, a: ExprId, b: ExprId) -> bool {
        self.fingerprint(a) == self.fingerprint(b)
    }

    fn find_or_push(&mut self, node: Node, fingerprint: Fingerprint) -> ExprId {
        if fingerprint.iter().all(|&x| x == self.field.zero()) {
            return ExprId::ZERO;
        }
        if let Some(expr) = self.known(fingerprint) {
            return expr;
        }
        // The two points differ in every symbol: where both give the same, no symbol is left in the polynomial.
        if fingerprint[0] == fingerprint[1] {
            if self.fingerprints_only {
                return self.by_fingerprint(fingerprint[0]);
            }
            let value = self.value_at_origin(node);
            if self.field.number(&value) == fingerprint[0] {
                return self.constant(&value);
            }
        }
        self.push(node, fingerprint)
    }

    fn push(&mut self, node: Node, fingerprint: Fingerprint) -> ExprId {
        let expr = ExprId::new(self.nodes.len());
        self.nodes.push(node);
        self.fingerprints.push(fingerprint);
        self.at_origin.push(None);
        let (size, negative) = self.field.size(fingerprint);
        self.known.entry(size).or_insert(expr.signed(negative));
        expr
    }

    /// The expression of a value.
    fn known(&self, fingerprint: Fingerprint) -> Option<ExprId> {
        let (size, negative) = self.field.size(fingerprint);
        self.known.get(&size).map(|expr| expr.signed(negative))
    }

    /// a + b + ...
    pub fn sum(&mut self, terms: impl IntoIterator<Item = ExprId>) -> ExprId {
        terms.into_iter().fold(ExprId::ZERO, |sum, term| self.add(sum, term))
    }

    /// a_1 b_1 + a_2 b_2 + ...
    pub fn dot(&mut self, a: &[ExprId], b: &[ExprId]) -> ExprId {
        a.iter().zip(b).fold(ExprId::ZERO, |sum, (&x, &y)| {
            let product = self.mul(x, y);
            self.add(sum, product)
        })
    }
}

#[cfg(test)]
mod tests;
