//! Intervals with ends that are multiples of 2^-bits, rounded outwards.

use dashu_base::Signed;
use dashu_int::IBig;

/// The interval from a/2^bits to b/2^bits, for two integers a and b.
#[derive(Clone, Debug)]
pub(crate) struct Interval {
    pub(crate) low: IBig,
    pub(crate) high: IBig,
}

pub(crate) fn floor_shift(n: IBig, bits: usize) -> IBig {
    n >> bits
}

pub(crate) fn ceil_shift(n: IBig, bits: usize) -> IBig {
    -((-n) >> bits)
}

pub(crate) fn floor_div(a: &IBig, b: &IBig) -> IBig {
    let quotient = a / b;
    if &quotient * b != *a && (a.is_negative() != b.is_negative()) {
        quotient - IBig::ONE
    } else {
        quotient
    }
}

pub(crate) fn multiply(a: &Interval, b: &Interval, bits: usize) -> Interval {
    let products = [&a.low * &b.low, &a.low * &b.high, &a.high * &b.low, &a.high * &b.high];
    let low = products.iter().min().expect("four products").clone();
    let high = products.iter().max().expect("four products").clone();
    Interval { low: floor_shift(low, bits), high: ceil_shift(high, bits) }
}

pub(crate) fn invert(a: &Interval, bits: usize) -> Option<Interval> {
    if a.low.is_zero() || a.high.is_zero() || a.low.is_negative() != a.high.is_negative() {
        return None;
    }
    let one = IBig::ONE << (2 * bits);
    Some(Interval { low: floor_div(&one, &a.high), high: -floor_div(&-one, &a.low) })
}
