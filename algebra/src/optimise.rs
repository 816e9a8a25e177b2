//! Fewer operations for finished expressions.
//!
//! The shared graph of expressions is taken apart into sums and products of any number of operands (`circuit`), each with its
//! fingerprint. What saves operations is then done as often as it is found, the greatest gain first:
//!
//! - sines and cosines of sums of angles about parallel axes become inputs (`angles`),
//! - what cancels in every output is left out (`cancellation`),
//! - x y + x z becomes x (y + z) (`share`),
//! - constants of a sum or a product become one (`tidy`),
//! - a sum is formed from another one and what is missing (`sums`),
//! - a pair of terms that several sums hold, and a pair of factors that several products hold, is computed once (`share`),
//! - a node that is the sum, difference or product of two others that are there anyway is computed from these (`resubstitute`).
//!
//! Every step leaves the value of every output as it is: the fingerprints say so.

mod angles;
mod cancellation;
mod circuit;
mod resubstitute;
mod share;
mod sums;
mod tidy;

use crate::ring::{ExprId, Pool};
use circuit::Circuit;

/// What is done to expressions, so that each can be left out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rewrite {
    /// Ask for the sines and cosines of sums of angles as such.
    AngleSums,
    /// Leave out what cancels in every output.
    Cancellation,
    /// Take common factors out of sums, and share partial sums and products.
    Sharing,
    /// Form a sum from another one that holds much of it.
    Sums,
    /// Compute a node from two others that are there anyway.
    Resubstitution,
}

/// Expressions of more gates than this, those of arms with more than some ten joints, are left as they are: the work grows faster than with
/// the square of their number.
const GATES: usize = 8000;

/// The same expressions with fewer operations, in a pool of their own; none where they are left as they are. `parallel` has for each joint the
/// one before it on a parallel axis, and whether that points the other way.
pub fn optimise(
    pool: &Pool,
    entries: &[ExprId],
    parallel: &[Option<(u16, bool)>],
    without: &[Rewrite],
) -> Option<(Pool, Vec<ExprId>)> {
    // Torques of gravity are outputs here: their sizes and signs are taken.
    let (all, joints) = pool.with_gravity(entries);
    if pool.reachable(&all).into_iter().filter(|&needed| needed).count() > GATES {
        return None;
    }
    let mut circuit = Circuit::of(pool, &all);
    let has = |rewrite| !without.contains(&rewrite);
    if has(Rewrite::AngleSums) {
        angles::sums_of_angles(&mut circuit, parallel);
    }
    if has(Rewrite::Cancellation) && cancellation::remove_cancelled(&mut circuit) > 0 {
        // Gates that have become equal are one again.
        let (pool, entries) = circuit.to_pool();
        circuit = Circuit::of(&pool, &entries);
    }
    loop {
        let mut gain = 0;
        if has(Rewrite::Sharing) {
            circuit.tidy();
            share::share(&mut circuit);
        }
        if has(Rewrite::Sums) {
            gain += sums::sums_from_sums(&mut circuit);
            gain += sums::shift_constants(&mut circuit);
            if has(Rewrite::Sharing) {
                gain += sums::write_out(&mut circuit);
            }
        }
        if has(Rewrite::Resubstitution) {
            gain += resubstitute::resubstitute(&mut circuit);
        }
        if gain == 0 {
            break;
        }
    }
    let (mut built, mut found) = circuit.to_pool();
    for (&before, &after) in all.iter().zip(&found) {
        assert_eq!(pool.fingerprint(before), built.fingerprint(after), "an optimised expression is the one that it replaces");
    }
    built.take_gravity(&mut found, &joints);
    Some((built, found))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ring::field::Field;
    use crate::ring::Symbol;

    fn pool() -> (Pool, [ExprId; 4]) {
        let mut pool = Pool::new(Field::for_constants([]));
        let rates = [0, 1, 2, 3].map(|i| pool.symbol(Symbol::Rate(i)));
        (pool, rates)
    }

    #[track_caller]
    fn check(
        pool: &Pool,
        entries: &[ExprId],
        parallel: &[Option<(u16, bool)>],
        operations: usize,
        without: Rewrite,
        more: usize,
    ) {
        let count = |without: &[Rewrite]| {
            let (pool, entries) = optimise(pool, entries, parallel, without).expect("few gates");
            pool.operations(&entries, 1)
        };
        assert_eq!(count(&[]), operations);
        assert_eq!(count(&[without]), more, "without {without:?}");
    }

    #[test]
    fn sums_of_angles_are_asked_for_where_they_take_the_place_of_single_ones() {
        let (mut pool, [x, ..]) = pool();
        let [s1, s2] = [0, 1].map(|i| pool.symbol(Symbol::Sine(i)));
        let [c1, c2] = [0, 1].map(|i| pool.symbol(Symbol::Cosine(i)));
        let (sine, cosine) = (pool.dot(&[s1, c1], &[c2, s2]), pool.dot(&[c1, s1], &[c2, -s2]));
        let parallel = [None, Some((0, false))];
        let scaled = pool.mul(x, sine);
        check(&pool, &[s1, scaled, cosine], &parallel, 1, Rewrite::AngleSums, 7);
        // A third pair of sine and cosine would cost more than the addition theorem.
        check(&pool, &[s1, s2, scaled, cosine], &parallel, 7, Rewrite::AngleSums, 7);
        // The other axis the other way: no sum, a difference.
        let parallel = [None, Some((0, true))];
        check(&pool, &[scaled, cosine], &parallel, 7, Rewrite::AngleSums, 7);
        let difference = pool.dot(&[s2, c2], &[c1, -s1]);
        check(&pool, &[difference], &parallel, 0, Rewrite::AngleSums, 3);
    }

    #[test]
    fn sums_that_differ_by_a_constant_are_formed_from_each_other() {
        let (mut pool, [x, y, z, w]) = pool();
        let [one, two, three] = [1, 2, 3].map(|k| pool.integer(k));
        let a = pool.sum([x, y, one]);
        let (b, c) = (pool.add(a, two), pool.sub(a, three));
        let products = [pool.mul(b, z), pool.mul(c, w)];
        check(&pool, &products, &[], 5, Rewrite::Sums, 6);
    }

    #[test]
    fn sums_whose_parts_cancel_are_written_out() {
        let (mut pool, [x, y, z, w]) = pool();
        let [one, two, five] = [1, 2, 5].map(|k| pool.integer(k));
        let (t, u) = (pool.mul(x, y), pool.mul(y, z));
        let a = pool.sum([t, u, u, one]);
        let b = pool.sub(two, t);
        let sum = pool.sum([w, a, b, five]);
        let entries = [pool.mul(a, x), pool.mul(b, z), sum];
        check(&pool, &entries, &[], 10, Rewrite::Sums, 11);
    }
}
