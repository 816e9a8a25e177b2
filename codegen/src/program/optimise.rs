//! Common factors and shared partial sums.
//!
//! The shared graph of expressions is taken apart into sums and products of any number of operands ([`circuit`]), each with its
//! fingerprint. What saves operations is then done as often as it is found, the greatest gain first:
//!
//! - sines and cosines of sums of angles about parallel axes become inputs ([`angles`]),
//! - what cancels in every output is left out ([`idle`]),
//! - x y + x z becomes x (y + z) ([`share`]),
//! - constants of a sum or a product become one ([`tidy`]),
//! - a sum is formed from another one and what is missing ([`sums`]),
//! - a pair of terms that several sums hold, and a pair of factors that several products hold, is computed once ([`share`]),
//! - a node that is the sum, difference or product of two others that are there anyway is computed from these ([`resubstitute`]).
//!
//! Every step leaves the value of every output as it is: the fingerprints say so.

mod angles;
mod circuit;
mod idle;
mod resubstitute;
mod share;
mod sums;
mod tidy;

use super::{Pass, Passes};
use crate::ring::{ExprId, Pool};
use circuit::Circuit;

/// Expressions of more gates than this, those of arms with more than some ten joints, are left as they are: the work grows faster than with
/// the square of their number.
const GATES: usize = 8000;

/// The same expressions with fewer operations, in a pool of their own. `parallel` has for each joint the one before it on a parallel axis, and
/// whether that points the other way.
pub(super) fn optimise(
    pool: &Pool,
    entries: &[ExprId],
    parallel: &[Option<(u16, bool)>],
    without: Passes,
) -> (Pool, Vec<ExprId>) {
    let mut circuit = Circuit::of(pool, entries);
    if circuit.gates.len() > GATES {
        return (pool.clone(), entries.to_vec());
    }
    let has = |pass| !without.contains(pass);
    if has(Pass::AngleSums) {
        angles::sums_of_angles(&mut circuit, parallel);
    }
    if has(Pass::Idle) && idle::drop_idle(&mut circuit) > 0 {
        // Gates that have become equal are one again.
        let (pool, entries) = circuit.to_pool();
        circuit = Circuit::of(&pool, &entries);
    }
    loop {
        let mut gain = 0;
        if has(Pass::Sharing) {
            circuit.tidy();
            share::share(&mut circuit);
        }
        if has(Pass::Sums) {
            gain += sums::sums_from_sums(&mut circuit);
            gain += sums::shift_constants(&mut circuit);
            if has(Pass::Sharing) {
                gain += sums::write_out(&mut circuit);
            }
        }
        if has(Pass::Resubstitution) {
            gain += resubstitute::resubstitute(&mut circuit);
        }
        if gain == 0 {
            break;
        }
    }
    let built = circuit.to_pool();
    for (&before, &after) in entries.iter().zip(&built.1) {
        assert_eq!(pool.fingerprint(before), built.0.fingerprint(after), "an optimised expression is the one that it replaces");
    }
    built
}
