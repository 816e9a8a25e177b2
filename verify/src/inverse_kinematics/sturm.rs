//! Reconstructs rational polynomials from residues, and counts their real roots by Sturm's theorem.

use dashu_base::{Gcd, Signed, SquareRoot, UnsignedAbs};
use dashu_int::{IBig, UBig};

/// Coefficients known modulo a product of primes.
#[derive(Clone, Debug)]
pub(super) struct Residues {
    modulus: UBig,
    values: Vec<UBig>,
}

fn remainder(value: &UBig, prime: u64) -> u64 {
    u64::try_from(value % UBig::from(prime)).unwrap_or(0)
}

impl Residues {
    pub(super) fn new(count: usize) -> Residues {
        Residues { modulus: UBig::ONE, values: vec![UBig::ZERO; count] }
    }

    /// Adds the residues modulo another prime (Chinese remainder theorem).
    pub(super) fn add(&mut self, prime: u64, residues: &[u64]) {
        let field = super::modular::Modulus::new(prime);
        let over = field.inverse(field.of(remainder(&self.modulus, prime)));
        for (value, residue) in self.values.iter_mut().zip(residues) {
            let difference = field.minus(field.of(*residue), field.of(remainder(value, prime)));
            *value += &self.modulus * field.value(field.times(difference, over));
        }
        self.modulus *= prime;
    }

    /// The fractions with these residues, over their common denominator, which comes last; `None` if numerators or denominators are too large for
    /// the primes so far.
    pub(super) fn fractions(&self) -> Option<Vec<IBig>> {
        let bound = (&self.modulus >> 1usize).sqrt();
        let mut common = UBig::ONE;
        // Per value: the numerator, and the common denominator at that time.
        let mut found: Vec<(IBig, UBig)> = Vec::new();
        for value in &self.values {
            // Euclid's algorithm: r = t x mod M with r and t both small.
            let (mut r, mut next) = (IBig::from(self.modulus.clone()), IBig::from(value * &common % &self.modulus));
            let (mut t, mut t_next) = (IBig::ZERO, IBig::ONE);
            while next.clone().unsigned_abs() > bound {
                let quotient = &r / &next;
                (r, next) = (next.clone(), r - &quotient * &next);
                (t, t_next) = (t_next.clone(), t - &quotient * &t_next);
            }
            if t_next.is_negative() {
                (next, t_next) = (-next, -t_next);
            }
            common *= t_next.unsigned_abs();
            if common > bound {
                return None;
            }
            found.push((next, common.clone()));
        }
        let mut all: Vec<IBig> = found.into_iter().map(|(numerator, at)| numerator * IBig::from(&common / at)).collect();
        all.push(common.into());
        Some(all)
    }
}

/// The residues of integers divided by the last of them.
pub(super) fn residues_of(coefficients: &[IBig], prime: u64) -> Vec<u64> {
    let field = super::modular::Modulus::new(prime);
    let of = |x: &IBig| {
        let size = field.of(remainder(&x.clone().unsigned_abs(), prime));
        if x.is_negative() {
            field.negated(size)
        } else {
            size
        }
    };
    let Some((last, rest)) = coefficients.split_last() else { return Vec::new() };
    let over = field.inverse(of(last));
    rest.iter().map(|x| field.value(field.times(of(x), over))).collect()
}

/// Root counts from Sturm's theorem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Roots {
    /// Number of distinct roots, including complex ones.
    pub(super) distinct: usize,
    /// Number of distinct real roots.
    pub(super) real: usize,
    /// Number of multiple roots among the real roots.
    pub(super) multiple: usize,
}

fn primitive(mut p: Vec<IBig>) -> Vec<IBig> {
    while p.last().is_some_and(IBig::is_zero) {
        p.pop();
    }
    let mut content = UBig::ZERO;
    for c in &p {
        content = if content.is_zero() { c.clone().unsigned_abs() } else { content.gcd(c.clone().unsigned_abs()) };
        if content.is_one() {
            return p;
        }
    }
    if !content.is_zero() {
        let content = IBig::from(content);
        p.iter_mut().for_each(|c| *c = &*c / &content);
    }
    p
}

fn derivative(p: &[IBig]) -> Vec<IBig> {
    p.iter().enumerate().skip(1).map(|(k, c)| c * IBig::from(k)).collect()
}

/// The polynomial, its derivative and the negated remainders, each up to a positive factor; lowest coefficients first.
fn sequence(p: &[IBig]) -> Vec<Vec<IBig>> {
    let mut all = vec![primitive(p.to_vec()), primitive(derivative(p))];
    while let [.., a, b] = all.as_slice() {
        let Some(leading) = b.last().filter(|_| b.len() > 1) else { break };
        let size = IBig::from(leading.clone().unsigned_abs());
        let mut rest = a.clone();
        while rest.len() >= b.len() {
            let Some(top) = rest.last().cloned() else { break };
            let factor = if leading.is_negative() { -top } else { top };
            let shift = rest.len() - b.len();
            rest.iter_mut().for_each(|x| *x *= &size);
            for (x, y) in rest[shift..].iter_mut().zip(b) {
                *x -= &factor * y;
            }
            rest.pop();
        }
        let next = primitive(rest.into_iter().map(|x| -x).collect());
        if next.is_empty() {
            break;
        }
        all.push(next);
    }
    all.retain(|p| !p.is_empty());
    all
}

/// The roots of a nonzero polynomial, lowest coefficient first.
pub(super) fn roots(p: &[IBig]) -> Roots {
    let all = sequence(p);
    let changes = |at_minus: bool| {
        let sign = |q: &Vec<IBig>| q.last().is_some_and(Signed::is_negative) != (at_minus && q.len().is_multiple_of(2));
        all.windows(2).filter(|pair| sign(&pair[0]) != sign(&pair[1])).count()
    };
    let real = changes(true) - changes(false);
    let (degree, common) = (all[0].len() - 1, all.last().map_or(&[][..], Vec::as_slice));
    // The last remainder is the greatest common divisor with the derivative.
    let multiple = if common.len() > 1 { roots(common).real } else { 0 };
    Roots { distinct: degree + 1 - common.len().max(1), real, multiple }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn product(factors: &[&[i64]]) -> Vec<IBig> {
        factors.iter().fold(vec![IBig::ONE], |p, factor| {
            let mut q = vec![IBig::ZERO; p.len() + factor.len() - 1];
            for (i, x) in p.iter().enumerate() {
                for (j, y) in factor.iter().enumerate() {
                    q[i + j] += x * IBig::from(*y);
                }
            }
            q
        })
    }

    #[test]
    fn roots_of_products() {
        let of = |factors: &[&[i64]]| {
            let Roots { distinct, real, multiple } = roots(&product(factors));
            (distinct, real, multiple)
        };
        assert_eq!(of(&[&[-1, 1], &[2, 1], &[-3, 7]]), (3, 3, 0));
        assert_eq!(of(&[&[-1, 1], &[1, 0, 1], &[5, 1, 3]]), (5, 1, 0));
        assert_eq!(of(&[&[-1, 1], &[-1, 1], &[1, 0, 1], &[4, 1]]), (4, 2, 1));
        assert_eq!(of(&[&[1, 0, 1], &[1, 0, 1], &[4, 1]]), (3, 1, 0));
        assert_eq!(of(&[&[0, -5]]), (1, 1, 0));
        assert_eq!(of(&[&[7]]), (0, 0, 0));
        // Wilkinson's polynomial with 14 roots, times a factor without real roots.
        let mut factors: Vec<Vec<i64>> = (1..15).map(|k| vec![-k, 1]).collect();
        factors.push(vec![1, 1, 1]);
        let factors: Vec<&[i64]> = factors.iter().map(Vec::as_slice).collect();
        assert_eq!(of(&factors), (16, 14, 0));
    }

    #[test]
    fn fractions_from_residues() {
        let primes = [(1u64 << 61) - 1, 4_611_686_018_427_388_039, 4_611_686_018_427_388_073];
        let exact: Vec<IBig> = [-355i64, 113 * 7, 0, 1 << 40, 113 * 9].map(IBig::from).to_vec();
        let mut residues = Residues::new(4);
        assert!(primes.iter().all(|p| p % 2 == 1));
        for prime in &primes[..2] {
            residues.add(*prime, &residues_of(&exact, *prime));
        }
        let found = residues.fractions().expect("enough primes");
        assert_eq!(residues_of(&found, primes[2]), residues_of(&exact, primes[2]));
        let ratio = |x: &[IBig]| &x[3] * &exact[4] == &exact[3] * &x[4];
        assert!(ratio(&found) && found[2].is_zero());
    }
}
