//! From a formula's tree to its exact form.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Pow, Signed, ToPrimitive, Zero};

use super::polynomial::{Angle, Atom, Polynomial};
use super::{Exact, Names};
use crate::formula::{self, Formula};

/// Largest power of ten, power of an expression and multiple of an angle: well above any formula, well below a hang.
const LARGEST: i64 = 1000;
/// Roots are factored by trial up to here.
const LARGEST_FACTOR: u32 = 100_000;

pub(super) fn read(text: &str, names: &Names) -> Result<Exact, String> {
    exact(&formula::parse(text)?, names)
}

fn exact(formula: &Formula, names: &Names) -> Result<Exact, String> {
    Ok(match formula {
        Formula::Number(digits) => Polynomial::constant(decimal(digits)?).into(),
        Formula::Name(name) => match names.get(name) {
            Some(value) => value.clone(),
            None if name == "pi" => Polynomial::atom(Atom::Pi).into(),
            None => Polynomial::atom(Atom::Name(name.clone())).into(),
        },
        Formula::Call(function, argument) => {
            let x = exact(argument, names)?;
            match function.as_str() {
                "sin" => sine_and_cosine(&x)?.0,
                "cos" => sine_and_cosine(&x)?.1,
                "sqrt" => root(&x)?,
                "sign" => sign(&x)?,
                "exp" | "abs" => Polynomial::atom(Atom::Name(format!("{function}({x})"))).into(),
                _ => return Err(format!("unknown function {function}")),
            }
        }
        Formula::Negative(x) => -&exact(x, names)?,
        Formula::Binary(operator, a, b) => {
            let (a, b) = (exact(a, names)?, exact(b, names)?);
            match operator {
                '+' => &a + &b,
                '-' => &a - &b,
                '*' => &a * &b,
                '/' => a.over(&b)?,
                _ => power(&a, &b)?,
            }
        }
    })
}

/// The rational number of a decimal.
fn decimal(digits: &str) -> Result<BigRational, String> {
    let (mantissa, exponent) = digits.split_once(['e', 'E']).unwrap_or((digits, "0"));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let number: BigInt = format!("0{whole}{fraction}").parse().map_err(|_| format!("{digits} is no number"))?;
    let exponent: i64 = exponent.parse().map_err(|_| format!("{digits} is out of range"))?;
    let shift = exponent - fraction.len() as i64;
    if shift.abs() > LARGEST {
        return Err(format!("{digits} is out of range"));
    }
    let ten = BigRational::from_integer(10.into());
    Ok(BigRational::from_integer(number) * Pow::pow(&ten, shift as i32))
}

/// The polynomial of an expression without a denominator.
fn whole(x: &Exact) -> Option<&Polynomial> {
    (x.denominator == Polynomial::integer(1)).then_some(&x.numerator)
}

fn power(base: &Exact, exponent: &Exact) -> Result<Exact, String> {
    let n = whole(exponent).and_then(Polynomial::rational).filter(BigRational::is_integer).and_then(|n| n.to_i64());
    let n = n.filter(|n| n.abs() <= LARGEST).ok_or_else(|| format!("the power {exponent} is no small integer"))?;
    let mut result = Exact::integer(1);
    for _ in 0..n.abs() {
        result = &result * base;
    }
    match n < 0 {
        true => Exact::integer(1).over(&result),
        false => Ok(result),
    }
}

fn sign(x: &Exact) -> Result<Exact, String> {
    match whole(x).and_then(Polynomial::linear).as_deref() {
        Some([(Some(Atom::Name(name)), factor)]) => {
            let atom: Exact = Polynomial::atom(Atom::Sign(name.clone())).into();
            Ok(if factor.is_negative() { -&atom } else { atom })
        }
        _ => Err(format!("the sign of {x}, which is no name")),
    }
}

/// √(n/d) = √(n d) / d, with the squares drawn out of n d.
fn root(x: &Exact) -> Result<Exact, String> {
    let value = whole(x).and_then(Polynomial::rational).filter(|value| !value.is_negative());
    let value = value.ok_or_else(|| format!("the root of {x}, which is no rational number >= 0"))?;
    if value.is_zero() {
        return Ok(Exact::integer(0));
    }
    let mut rest = value.numer() * value.denom();
    let mut rational = BigRational::new(BigInt::one(), value.denom().clone());
    let mut roots = Polynomial::integer(1);
    let mut by_prime = |p: &BigInt, odd: bool, squares: u32| {
        rational *= BigRational::from_integer(Pow::pow(p, squares));
        if odd {
            roots = &roots * &Polynomial::atom(Atom::Root(p.clone()));
        }
    };
    for p in 2..LARGEST_FACTOR {
        let p = BigInt::from(p);
        if &p * &p > rest {
            break;
        }
        let mut count = 0;
        while (&rest % &p).is_zero() {
            rest /= &p;
            count += 1;
        }
        by_prime(&p, count % 2 == 1, count / 2);
    }
    let whole_root = rest.sqrt();
    if &whole_root * &whole_root == rest {
        by_prime(&whole_root, false, 1);
    } else {
        by_prime(&rest, true, 0);
    }
    Ok(roots.scaled(&rational).into())
}

type Pair = (Exact, Exact);

/// Sine and cosine of a + b, by the addition theorem.
fn sum((sa, ca): &Pair, (sb, cb): &Pair) -> Pair {
    (&(sa * cb) + &(ca * sb), &(ca * cb) - &(sa * sb))
}

/// The pair of n times the angle.
fn multiple(pair: &Pair, n: i64) -> Pair {
    let mut result = (Exact::integer(0), Exact::integer(1));
    for _ in 0..n.abs() {
        result = sum(&result, pair);
    }
    if n < 0 {
        result.0 = -&result.0;
    }
    result
}

/// The pair of an angle that is an indeterminate of its own.
fn pair(angle: Angle) -> Pair {
    (Polynomial::atom(Atom::Sine(angle.clone())).into(), Polynomial::atom(Atom::Cosine(angle)).into())
}

/// The pair of a constant angle, sign drawn out.
fn constant(angle: fn(BigRational) -> Angle, value: &BigRational) -> Pair {
    multiple(&pair(angle(value.abs())), if value.is_negative() { -1 } else { 1 })
}

fn sine_and_cosine(x: &Exact) -> Result<Pair, String> {
    let unfit = || format!("the angle {x} is no integer combination of names plus a constant");
    let mut result = (Exact::integer(0), Exact::integer(1));
    for (atom, factor) in whole(x).and_then(Polynomial::linear).ok_or_else(unfit)? {
        let part = match atom {
            None => constant(Angle::Radians, factor),
            Some(Atom::Pi) => of_pi(factor),
            Some(Atom::Name(name)) if factor.is_integer() => {
                let n = factor.to_integer().to_i64().filter(|n| n.abs() <= LARGEST).ok_or_else(unfit)?;
                multiple(&pair(Angle::Name(name.clone())), n)
            }
            Some(_) => return Err(unfit()),
        };
        result = sum(&result, &part);
    }
    Ok(result)
}

/// The pair of factor · pi.
fn of_pi(factor: &BigRational) -> Pair {
    let turn = BigRational::from_integer(2.into());
    let factor = factor - (factor / &turn).round() * &turn;
    let twelfths = &factor * BigRational::from_integer(12.into());
    if !twelfths.is_integer() {
        return constant(Angle::Pi, &factor);
    }
    let root = |p: u32| Polynomial::atom(Atom::Root(p.into()));
    let (root2, root6) = (root(2), &root(2) * &root(3));
    let quarter = BigRational::new(1.into(), 4.into());
    let twelfth = ((&root6 - &root2).scaled(&quarter).into(), (&root6 + &root2).scaled(&quarter).into());
    multiple(&twelfth, twelfths.to_integer().to_i64().expect("at most 12"))
}
