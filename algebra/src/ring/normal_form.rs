//! The normal form for people: a sum of sines and cosines of integer combinations of the joint angles.
//!
//! Every polynomial in the sines and cosines of angles is one such sum, in exactly one way, because products of harmonics are sums of
//! harmonics:
//!
//! ```text
//! 2 cos a cos b = cos(a - b) + cos(a + b),   2 sin a sin b = cos(a - b) - cos(a + b),   2 sin a cos b = sin(a + b) + sin(a - b)
//! ```
//!
//! The coefficients are polynomials in the remaining symbols. The form grows exponentially with the joints that take part, so it is
//! computed up to a number of terms and given up beyond.

use std::cmp::Reverse;
use std::collections::btree_map::Entry;
use std::collections::BTreeMap;
use std::rc::Rc;

use super::turn::Turn;
use super::{AngleSum, Elementary, ExprId, Node, Pool, Symbol};
use crate::exact::{Number, Rational};

/// cos or sin of an integer combination of joint angles; the first coefficient that is not 0 is positive.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Harmonic {
    /// Angle index and its coefficient, by index; empty for the constant harmonic 1 (= cos 0).
    pub angles: Vec<(u16, i32)>,
    /// Whether this is a sine.
    pub sine: bool,
}

/// Powers of the symbols that are no sines or cosines, by symbol.
pub type Powers = Vec<(Symbol, u32)>;

/// A sum of terms: coefficient · factors · harmonic.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct NormalForm {
    terms: BTreeMap<(Harmonic, Powers), Number>,
}

impl Harmonic {
    /// The constant 1.
    pub fn one() -> Harmonic {
        Harmonic { angles: Vec::new(), sine: false }
    }

    /// Sum of the absolute values of the coefficients.
    pub fn order(&self) -> i32 {
        self.angles.iter().map(|(_, k)| k.abs()).sum()
    }
}

impl NormalForm {
    /// The terms, in a fixed order.
    pub fn terms(&self) -> impl Iterator<Item = (&Harmonic, &Powers, &Number)> {
        self.terms.iter().map(|((harmonic, factors), coefficient)| (harmonic, factors, coefficient))
    }

    /// Number of terms.
    pub fn len(&self) -> usize {
        self.terms.len()
    }

    /// Number of terms with those of the coefficients multiplied out: a coefficient of several roots or general angles is a sum itself.
    pub fn size(&self) -> usize {
        self.terms.values().map(Number::terms_multiplied_out).fold(0, usize::saturating_add)
    }

    /// Whether this is 0.
    pub fn is_empty(&self) -> bool {
        self.terms.is_empty()
    }

    /// The terms gathered by harmonic, those of the highest order first: what a reader expects of `10 cos q2 + 10763/500`.
    pub fn by_harmonic(&self) -> Vec<(&Harmonic, Vec<(&Powers, &Number)>)> {
        let mut groups: BTreeMap<&Harmonic, Vec<(&Powers, &Number)>> = BTreeMap::new();
        for (harmonic, factors, coefficient) in self.terms() {
            groups.entry(harmonic).or_default().push((factors, coefficient));
        }
        let mut groups: Vec<_> = groups.into_iter().collect();
        groups.sort_by_key(|(harmonic, _)| (Reverse(harmonic.order()), harmonic.sine));
        groups
    }

    /// The angles that occur in a harmonic.
    pub fn angles(&self) -> Vec<u16> {
        let mut angles: Vec<u16> = self.terms.keys().flat_map(|(harmonic, _)| harmonic.angles.iter().map(|(i, _)| *i)).collect();
        angles.sort_unstable();
        angles.dedup();
        angles
    }

    /// The form of a single term.
    pub fn term(harmonic: Harmonic, factors: Powers, coefficient: Number) -> NormalForm {
        let mut form = NormalForm::default();
        form.add_term(harmonic, factors, coefficient);
        form
    }

    /// Adds a term; `harmonic` is in its canonical form.
    pub fn add_term(&mut self, harmonic: Harmonic, factors: Powers, coefficient: Number) {
        match self.terms.entry((harmonic, factors)) {
            Entry::Vacant(place) => {
                if !coefficient.is_zero() {
                    place.insert(coefficient);
                }
            }
            Entry::Occupied(mut own) => {
                let sum = own.get().plus(&coefficient);
                if sum.is_zero() {
                    own.remove();
                } else {
                    own.insert(sum);
                }
            }
        }
    }

    /// self + sign · other.
    fn plus(mut self, other: &NormalForm, negate: bool) -> NormalForm {
        for ((harmonic, factors), c) in &other.terms {
            self.add_term(harmonic.clone(), factors.clone(), if negate { -c } else { c.clone() });
        }
        self
    }

    /// -self.
    pub fn negated(&self) -> NormalForm {
        NormalForm { terms: self.terms.iter().map(|(key, c)| (key.clone(), -c)).collect() }
    }

    /// c times it.
    pub fn scaled(&self, c: &Number) -> NormalForm {
        let mut scaled = NormalForm::default();
        self.terms().for_each(|(harmonic, factors, own)| scaled.add_term(harmonic.clone(), factors.clone(), own.times(c)));
        scaled
    }

    /// The product, or `None` beyond `limit` terms, those of the coefficients counted one by one.
    pub fn times(&self, other: &NormalForm, limit: usize) -> Option<NormalForm> {
        let half = Number::from(Rational::from_parts(1.into(), 2u8.into()));
        let mut product = NormalForm::default();
        for ((harmonic_a, factors_a), ca) in &self.terms {
            for ((harmonic_b, factors_b), cb) in &other.terms {
                let factors = merge(factors_a, factors_b);
                let c = ca.times(cb);
                if harmonic_a.angles.is_empty() || harmonic_b.angles.is_empty() {
                    let harmonic = if harmonic_a.angles.is_empty() { harmonic_b } else { harmonic_a };
                    product.add_term(harmonic.clone(), factors, c);
                    continue;
                }
                let c = &c * &half;
                // A product with one sine is a sum of sines, with none or two a sum of cosines.
                let (a, b) =
                    if !harmonic_a.sine && harmonic_b.sine { (harmonic_b, harmonic_a) } else { (harmonic_a, harmonic_b) };
                let sine = a.sine != b.sine;
                for (sign, plus) in [(1, true), (-1, false)] {
                    let negative = a.sine && b.sine && plus;
                    add_harmonic(
                        &mut product,
                        combine(a, b, sign),
                        sine,
                        factors.clone(),
                        if negative { -&c } else { c.clone() },
                    );
                }
            }
            if product.size() > limit {
                return None;
            }
        }
        Some(product)
    }
}

/// Adds c · sin or cos(angles), whatever the sign of the leading coefficient.
fn add_harmonic(form: &mut NormalForm, mut angles: Vec<(u16, i32)>, sine: bool, factors: Powers, c: Number) {
    let negative = angles.first().is_some_and(|(_, k)| *k < 0);
    if negative {
        angles.iter_mut().for_each(|(_, k)| *k = -*k);
    }
    if angles.is_empty() && sine {
        return;
    }
    form.add_term(Harmonic { angles, sine }, factors, if negative && sine { -&c } else { c });
}

fn combine(a: &Harmonic, b: &Harmonic, sign: i32) -> Vec<(u16, i32)> {
    let mut sum = a.angles.clone();
    for &(i, k) in &b.angles {
        match sum.binary_search_by_key(&i, |(i, _)| *i) {
            Ok(at) => sum[at].1 += sign * k,
            Err(at) => sum.insert(at, (i, sign * k)),
        }
    }
    sum.retain(|(_, k)| *k != 0);
    sum
}

fn merge(a: &Powers, b: &Powers) -> Powers {
    let mut powers = a.clone();
    for &(symbol, power) in b {
        match powers.binary_search_by_key(&symbol, |(symbol, _)| *symbol) {
            Ok(at) => powers[at].1 += power,
            Err(at) => powers.insert(at, (symbol, power)),
        }
    }
    // sign(dq)² is not 1 at rest, but sign(dq)³ is sign(dq).
    for (symbol, power) in &mut powers {
        if matches!(symbol, Symbol::OfRate(Elementary::Sign, _)) && *power > 2 {
            *power = 2 - *power % 2;
        }
    }
    powers
}

impl Pool {
    /// The normal forms of expressions; `None` for one that needs, on the way or at the end, more than `limit` terms or a reciprocal.
    pub fn normal_forms(&self, exprs: &[ExprId], limit: usize) -> Vec<Option<NormalForm>> {
        self.normal_forms_while(exprs, limit, |_| true)
    }

    /// All normal forms, or `None` as soon as one is missing.
    pub fn all_normal_forms(&self, exprs: &[ExprId], limit: usize) -> Option<Vec<NormalForm>> {
        self.normal_forms_while(exprs, limit, |form| form).into_iter().collect()
    }

    /// The expressions in another pool, with other meanings of the symbols.
    pub fn rewritten(
        &self,
        exprs: &[ExprId],
        to: &mut Pool,
        meaning: &mut dyn FnMut(&mut Pool, Symbol) -> ExprId,
    ) -> Vec<ExprId> {
        let needed = self.needed(exprs);
        let mut done = vec![ExprId::ZERO; self.len()];
        for index in (0..self.len()).filter(|&i| needed[i]) {
            let of = |e: ExprId| done[e.index()].signed(e.is_negated());
            done[index] = match self.nodes[index] {
                Node::Constant(_) => to.constant_of(self, self.expr(index)),
                Node::Symbol(symbol) => meaning(to, symbol),
                Node::Add(a, b) => to.add(of(a), of(b)),
                Node::Mul(a, b) => to.mul(of(a), of(b)),
                Node::Reciprocal(a) => to.reciprocal(of(a)),
            };
        }
        exprs.iter().map(|e| done[e.index()].signed(e.is_negated())).collect()
    }

    /// Which nodes the expressions need.
    fn needed(&self, exprs: &[ExprId]) -> Vec<bool> {
        let mut needed = vec![false; self.len()];
        exprs.iter().for_each(|e| needed[e.index()] = true);
        for index in (0..self.len()).rev() {
            if needed[index] {
                match self.nodes[index] {
                    Node::Add(a, b) | Node::Mul(a, b) => {
                        needed[a.index()] = true;
                        needed[b.index()] = true;
                    }
                    Node::Reciprocal(a) => needed[a.index()] = true,
                    Node::Constant(_) | Node::Symbol(_) => {}
                }
            }
        }
        needed
    }

    fn normal_forms_while(&self, exprs: &[ExprId], limit: usize, go_on: impl Fn(bool) -> bool) -> Vec<Option<NormalForm>> {
        let mut needed = vec![false; self.len()];
        exprs.iter().for_each(|e| needed[e.index()] = true);
        for index in (0..self.len()).rev() {
            if needed[index] {
                if let Node::Add(a, b) | Node::Mul(a, b) = self.nodes[index] {
                    needed[a.index()] = true;
                    needed[b.index()] = true;
                }
            }
        }
        // How often each form is still asked for: the last asks for it itself, not for a copy.
        let mut left = vec![0usize; self.len()];
        exprs.iter().for_each(|e| left[e.index()] += 1);
        for index in (0..self.len()).filter(|&i| needed[i]) {
            if let Node::Add(a, b) | Node::Mul(a, b) = self.nodes[index] {
                left[a.index()] += 1;
                left[b.index()] += 1;
            }
        }
        let mut forms: Vec<Option<Rc<NormalForm>>> = vec![None; self.len()];
        for index in (0..self.len()).filter(|&i| needed[i]) {
            let mut of = |e: ExprId| {
                left[e.index()] -= 1;
                if left[e.index()] == 0 {
                    forms[e.index()].take()
                } else {
                    forms[e.index()].clone()
                }
            };
            let form = match self.nodes[index] {
                Node::Constant(id) => {
                    let value = &self.constants[id.0 as usize];
                    (!value.is_zero())
                        .then(|| NormalForm::term(Harmonic::one(), Vec::new(), (**value).clone()))
                        .or(Some(NormalForm::default()))
                }
                Node::Symbol(symbol) => Some(symbol_form(symbol, self.field().turn())),
                Node::Add(a, b) => {
                    let both = of(a).zip(of(b));
                    both.map(|(a, fb)| Rc::unwrap_or_clone(a).plus(&fb, b.is_negated())).filter(|sum| sum.len() <= limit)
                }
                Node::Mul(a, b) => {
                    let both = of(a).zip(of(b));
                    both.and_then(|(a, b)| a.times(&b, limit))
                }
                Node::Reciprocal(_) => None,
            };
            if !go_on(form.is_some()) {
                return vec![None; exprs.len()];
            }
            forms[index] = form.map(Rc::new);
        }
        exprs
            .iter()
            .map(|e| forms[e.index()].as_ref().map(|f| if e.is_negated() { f.negated() } else { NormalForm::clone(f) }))
            .collect()
    }
}

fn symbol_form(symbol: Symbol, turn: Option<&Turn>) -> NormalForm {
    let (harmonic, factors) = match symbol {
        Symbol::Sine(i) => (Harmonic { angles: vec![(i, 1)], sine: true }, vec![]),
        Symbol::Cosine(i) => (Harmonic { angles: vec![(i, 1)], sine: false }, vec![]),
        Symbol::SineOf(sum) | Symbol::CosineOf(sum) => return sum_form(sum, matches!(symbol, Symbol::SineOf(_)), turn),
        other => (Harmonic::one(), vec![(other, 1)]),
    };
    NormalForm::term(harmonic, factors, Number::one())
}

/// The sine or cosine of a sum of angles; of a turned one by the addition theorem.
fn sum_form(sum: AngleSum, sine: bool, turn: Option<&Turn>) -> NormalForm {
    let (unsigned, flipped) = sum.unsigned();
    let mut angles: Vec<(u16, i32)> = unsigned.terms().map(|(i, minus)| (i, if minus { -1 } else { 1 })).collect();
    angles.sort_unstable();
    let harmonic = |sine: bool, factor: &Number| {
        let factor = if flipped && sine { -factor } else { factor.clone() };
        NormalForm::term(Harmonic { angles: angles.clone(), sine }, vec![], factor)
    };
    match turn.filter(|_| sum.turned) {
        None => harmonic(sine, &Number::one()),
        Some(turn) => harmonic(sine, &turn.cosine).plus(&harmonic(!sine, &turn.sine), !sine),
    }
}

/// How a normal form becomes shared products again; which order is cheapest depends on what else is computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrangement {
    /// Each term as ((coefficient · harmonic) · factors): harmonics scaled by numbers are shared.
    ScaledHarmonics,
    /// Each harmonic once, times the sum of its coefficients and factors.
    ByHarmonic,
    /// Each term as ((harmonic · factors) · coefficient).
    BareProducts,
}

impl Arrangement {
    /// All of them.
    pub const ALL: [Arrangement; 3] = [Arrangement::ScaledHarmonics, Arrangement::ByHarmonic, Arrangement::BareProducts];
}

impl Pool {
    /// The expression of a normal form.
    pub fn from_normal_form(&mut self, form: &NormalForm, arrangement: Arrangement) -> ExprId {
        self.from_normal_form_in(form, arrangement, &mut |pool, symbol| pool.symbol(symbol))
    }

    /// The same, `meaning` telling what each symbol beside the sines and cosines stands for.
    pub fn from_normal_form_in(
        &mut self,
        form: &NormalForm,
        arrangement: Arrangement,
        meaning: &mut dyn FnMut(&mut Pool, Symbol) -> ExprId,
    ) -> ExprId {
        let mut sum = ExprId::ZERO;
        for (harmonic, group) in form.by_harmonic() {
            let harmonic = self.harmonic(harmonic);
            let mut inner = ExprId::ZERO;
            for (factors, coefficient) in group {
                let coefficient = self.constant(coefficient);
                let start = match arrangement {
                    Arrangement::ScaledHarmonics => self.mul(coefficient, harmonic),
                    Arrangement::ByHarmonic => coefficient,
                    Arrangement::BareProducts => harmonic,
                };
                let mut term = start;
                for &(symbol, power) in factors {
                    let symbol = meaning(self, symbol);
                    for _ in 0..power {
                        term = self.mul(term, symbol);
                    }
                }
                if arrangement == Arrangement::BareProducts {
                    term = self.mul(coefficient, term);
                }
                inner = self.add(inner, term);
            }
            if arrangement == Arrangement::ByHarmonic {
                inner = self.mul(inner, harmonic);
            }
            sum = self.add(sum, inner);
        }
        sum
    }

    /// sin or cos of a combination of angles, by the addition theorems from the sines and cosines of single angles.
    pub fn harmonic(&mut self, harmonic: &Harmonic) -> ExprId {
        let (sine, cosine) = self.sine_cosine_of(&harmonic.angles);
        if harmonic.sine {
            sine
        } else {
            cosine
        }
    }

    fn sine_cosine_of(&mut self, angles: &[(u16, i32)]) -> (ExprId, ExprId) {
        let Some((&(index, k), rest)) = angles.split_last() else { return (ExprId::ZERO, ExprId::ONE) };
        let (s, c) = (self.symbol(Symbol::Sine(index)).signed(k < 0), self.symbol(Symbol::Cosine(index)));
        let mut before = rest.to_vec();
        if k.abs() > 1 {
            before.push((index, k - k.signum()));
        }
        let (sb, cb) = self.sine_cosine_of(&before);
        (self.dot(&[sb, cb], &[c, s]), self.dot(&[cb, sb], &[c, -s]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ring::field::Field;

    #[test]
    fn products_of_waves_become_sums_and_back() {
        let mut p = Pool::new(Field::for_constants([]));
        let mut expr = p.fraction(3, 7);
        for i in 0..3 {
            let (s, c, x) = (p.symbol(Symbol::Sine(i)), p.symbol(Symbol::Cosine(i)), p.symbol(Symbol::Rate(i)));
            let cx = p.mul(c, x);
            let sum = p.sub(s, cx);
            let square = p.mul(sum, sum);
            let product = p.mul(expr, square);
            expr = p.add(product, s);
        }
        let form = p.normal_forms(&[expr], 10_000)[0].clone().expect("short enough");
        for arrangement in Arrangement::ALL {
            assert_eq!(p.from_normal_form(&form, arrangement), expr);
        }
        assert_eq!(p.normal_forms(&[expr], 20)[0], None);
    }

    #[test]
    fn equal_expressions_have_one_form() {
        let mut p = Pool::new(Field::for_constants([]));
        let (s, c) = (p.symbol(Symbol::Sine(0)), p.symbol(Symbol::Cosine(0)));
        let (ss, cc) = (p.mul(s, s), p.mul(c, c));
        let difference = p.sub(cc, ss);
        let double = Harmonic { angles: vec![(0, 2)], sine: false };
        assert_eq!(p.normal_forms(&[difference], 10)[0], Some(NormalForm::term(double, vec![], Number::one())));
    }
}
