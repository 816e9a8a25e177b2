//! The residual of accelerations in the equations of motion: a bound over the box that small pivots do not spoil.
//!
//! `forward_dynamics` solves B x = r, r = τ - C dq - F - g, by B = L D L', step by step in the text. Every rounding has |δ| ≤ u. Let D be the
//! number of additions on the longest path through a sum, and γ_k = k u / (1 - k u). Then the computed numbers satisfy
//!
//! ```text
//! ŝ_ij = b̂_ij - Σ_k l̂_ik ŝ_jk,  l̂ = fl(ŝ fl(1/d̂))     L* D̂ L*' = B̂ + ΔB,         L* = ŝ/d̂,  |ΔB| ≤ γ_{D+3} |L*| D̂ |L*'|
//! ŷ_i  = r̂_i - Σ_k l̂_ik ŷ_k                             (L* + ΔL) ŷ = r̂,           |ΔL| ≤ γ_{D+3} |L*|
//! x̂_i  = fl(1/d̂_i) ŷ_i - Σ_j l̂_ji x̂_j                   (D̂ L*' + ΔU) x̂ = ŷ,        |ΔU| ≤ γ_{2D+5} D̂ |L*'|
//! ```
//!
//! (Higham, Accuracy and Stability of Numerical Algorithms, 2002, Sect. 9.3 and 10.1). Hence (B + E) x̂ = r + e with
//! |E_ij| ≤ |B̂ - B|_ij + γ_{4D+12} (|L*| D̂ |L*'|)_ij. If all pivots D̂ are positive, the last term is at most √(b_ii b_jj) by the Cauchy-Schwarz
//! inequality. Intervals bound the remaining errors of the entries of B and r. **The accelerations are exact for torques with an error of at most
//! max e + max|x̂| max_i Σ_j |E_ij|**; divided by the smallest eigenvalue of B, this bounds the error of the accelerations.
//!
//! A product fused with an addition has one rounding less than counted here.
//!
//! The form of the text is checked: the value of every step from the reciprocals on identifies it at a random state, to 40 digits, and every sum
//! and every product must have one of the above forms. Otherwise there is no such bound.

use std::collections::{BTreeMap, BTreeSet};

use crate::read::claims::Claims;
use crate::read::reader::Module;
use crate::values::arithmetic::twofold::{self, Pair, Twofold, TwofoldArguments};
use crate::values::arithmetic::wide::{Wide, WideArguments};
use crate::values::element::Element;
use crate::values::enclosure::Float;
use crate::values::float::Arguments;
use crate::values::program::{Argument, Program, Step};
use crate::values::ranges::Range;

/// The returned accelerations x are exact for torques with an error of at most `constant + factor max|x|`, if all pivots are positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Residual {
    /// The part independent of the accelerations.
    pub constant: f64,
    /// Factor of the largest acceleration.
    pub factor: f64,
}

/// The equations that a function solves, from other functions of the module.
#[derive(Clone, Debug)]
pub struct Equations {
    /// B, C and g.
    pub motion: Program,
    /// Exact values of its literals.
    pub motion_literals: Vec<Wide>,
    /// F.
    pub friction: Program,
    /// Exact values of its literals.
    pub friction_literals: Vec<Wide>,
    /// Load-dependent friction, with the exact values of its literals.
    pub load_friction: Option<(Program, Vec<Wide>)>,
}

impl Equations {
    /// The equations for `forward_dynamics` and `forward_dynamics_with`.
    pub fn of(name: &str, module: &Module, claims: &Claims) -> Option<Equations> {
        let suffix = name.strip_prefix("forward_dynamics").filter(|suffix| ["", "_with"].contains(suffix))?;
        let program = |name: &str| {
            let name = format!("{name}{suffix}");
            let program = module.program(&name)?.clone();
            let values = claims.resolve(&name, &program.literals, module.real).values.clone();
            let literals: Option<Vec<Wide>> = program.exact_literals(&values).iter().map(Wide::from_formula).collect();
            Some((program, literals?))
        };
        let (motion, motion_literals) = program("equations_of_motion")?;
        let (friction, friction_literals) = program("friction")?;
        let load_friction = program("load_friction");
        Some(Equations { motion, motion_literals, friction, friction_literals, load_friction })
    }

    /// B x - r in lanes, for accelerations x.
    pub fn residuals(&self, arguments: &TwofoldArguments, x: &[Twofold], scratch: &mut Vec<Twofold>) -> Option<Vec<Twofold>> {
        let n = x.len();
        let mut outputs = |program: &Program, literals: &[Wide]| {
            let pairs: Vec<Pair> = literals.iter().map(twofold::pair).collect();
            twofold::values(program, &pairs, arguments, scratch)?;
            Some(program.outputs.iter().map(|output| scratch[output.step]).collect::<Vec<Twofold>>())
        };
        let motion = outputs(&self.motion, &self.motion_literals)?;
        let mut friction = outputs(&self.friction, &self.friction_literals)?;
        if let Some((load, literals)) = &self.load_friction {
            friction = friction.iter().zip(outputs(load, literals)?).map(|(f, l)| f.plus(&l)).collect();
        }
        let row = |i: usize| {
            let rest = friction[i].plus(&motion[2 * n * n + i]).minus(&arguments.entry(Argument::Tau, i));
            (0..n).fold(rest, |sum, j| {
                let centrifugal = motion[n * n + i * n + j].times(&arguments.entry(Argument::Dq, j));
                sum.plus(&centrifugal).plus(&motion[i * n + j].times(&x[j]))
            })
        };
        Some((0..n).map(row).collect())
    }

    /// B and r at a state.
    fn at(&self, arguments: &Arguments<f64>, wide: &WideArguments) -> Option<(Vec<Vec<Wide>>, Vec<Wide>)> {
        let n = arguments.q.len();
        let motion = self.motion.run(wide, &self.motion_literals).into_iter().collect::<Option<Vec<Wide>>>()?;
        let run = |program: &Program, literals: &[Wide]| program.run(wide, literals).into_iter().collect::<Option<Vec<Wide>>>();
        let mut friction = run(&self.friction, &self.friction_literals)?;
        if let Some((load, literals)) = &self.load_friction {
            friction = friction.iter().zip(run(load, literals)?).map(|(f, l)| f.plus(&l)).collect();
        }
        let square = |first: usize| -> Vec<Vec<Wide>> { motion[first..first + n * n].chunks(n).map(<[Wide]>::to_vec).collect() };
        let (b, c) = (square(0), square(n * n));
        let right = (0..n).map(|i| {
            let rest = friction[i].plus(&motion[2 * n * n + i]);
            let rest = (0..n).fold(rest, |sum, j| sum.plus(&c[i][j].times(&Wide::from_f64(arguments.dq[j]))));
            Wide::from_f64(arguments.tau[i]).minus(&rest)
        });
        Some((b, right.collect()))
    }
}

/// The meaning of a step; the numbers are row and column, with the column left of the diagonal.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Quantity {
    Pivot(usize),
    Reciprocal(usize),
    Schur(usize, usize),
    Ratio(usize, usize),
    Forward(usize),
    Scaled(usize),
    Solution(usize),
}

use Quantity::{Forward, Pivot, Ratio, Reciprocal, Scaled, Schur, Solution};

/// All nonzero quantities at a state.
fn quantities(b: &[Vec<Wide>], right: &[Wide]) -> Option<BTreeMap<Quantity, Wide>> {
    let n = right.len();
    let mut found = BTreeMap::new();
    let mut l = vec![vec![Wide::from_f64(0.0); n]; n];
    let mut s = l.clone();
    let mut reciprocals = Vec::new();
    for j in 0..n {
        for i in j..n {
            s[i][j] = (0..j).fold(b[i][j], |sum, k| sum.minus(&l[i][k].times(&s[j][k])));
        }
        let reciprocal = s[j][j].inverse()?;
        found.insert(Pivot(j), s[j][j]);
        found.insert(Reciprocal(j), reciprocal);
        for i in j + 1..n {
            l[i][j] = s[i][j].times(&reciprocal);
            found.insert(Schur(i, j), s[i][j]);
            found.insert(Ratio(i, j), l[i][j]);
        }
        reciprocals.push(reciprocal);
    }
    let mut y: Vec<Wide> = Vec::new();
    for i in 0..n {
        let value = (0..i).fold(right[i], |sum, k| sum.minus(&l[i][k].times(&y[k])));
        found.insert(Forward(i), value);
        found.insert(Scaled(i), value.times(&reciprocals[i]));
        y.push(value);
    }
    let mut x = vec![Wide::from_f64(0.0); n];
    for i in (0..n).rev() {
        x[i] = (i + 1..n).fold(y[i].times(&reciprocals[i]), |sum, j| sum.minus(&l[j][i].times(&x[j])));
        found.insert(Solution(i), x[i]);
    }
    let largest = found.values().fold(0.0f64, |a, value| a.max(value.to_f64().abs()));
    found.retain(|_, value| value.to_f64().abs() > 1e-40 * largest);
    Some(found)
}

/// A summand of a sum: its step, its sign, and the number of additions above it.
struct Leaf {
    step: usize,
    negative: bool,
    additions: usize,
}

/// A program whose steps are being identified.
struct Reading<'a> {
    program: &'a Program,
    values: &'a [Wide],
    /// Whether a step depends on a reciprocal.
    divided: Vec<bool>,
    known: &'a BTreeMap<Quantity, Wide>,
}

impl Reading<'_> {
    fn is(&self, step: usize, quantity: Quantity) -> bool {
        let value = &self.values[step];
        let same = |right: &Wide| {
            let size = right.to_f64().abs() * 1e-40;
            value.minus(right).to_f64().abs() <= size || value.plus(right).to_f64().abs() <= size
        };
        self.known.get(&quantity).is_some_and(same)
    }

    fn is_zero(&self, quantity: Quantity) -> bool {
        !self.known.contains_key(&quantity)
    }

    /// The step without leading minus signs, which do not round.
    fn bare(&self, mut step: usize) -> usize {
        while let Step::Negate(a) = self.program.steps[step] {
            step = a;
        }
        step
    }

    fn leaves(&self, step: usize, negative: bool, additions: usize, into: &mut Vec<Leaf>) {
        match self.program.steps[step] {
            Step::Negate(a) if self.divided[step] => self.leaves(a, !negative, additions, into),
            Step::Add(a, b) if self.divided[step] => {
                self.leaves(a, negative, additions + 1, into);
                self.leaves(b, negative, additions + 1, into);
            }
            Step::Subtract(a, b) if self.divided[step] => {
                self.leaves(a, negative, additions + 1, into);
                self.leaves(b, !negative, additions + 1, into);
            }
            _ => into.push(Leaf { step, negative, additions }),
        }
    }

    /// Two summands that are the same product with opposite signs; the first in order comes first.
    fn opposites(&self, leaves: &[Leaf]) -> Option<(usize, usize)> {
        let pair = |(i, a): (usize, &Leaf)| {
            let same = |b: &Leaf| b.step == a.step && b.negative != a.negative && self.divided[a.step];
            Some((i, i + 1 + leaves[i + 1..].iter().position(same)?))
        };
        leaves.iter().enumerate().find_map(pair)
    }

    /// Row and column of a product l_ik s_jk, and its factors.
    fn product(&self, step: usize) -> Option<((usize, usize), [(usize, Quantity); 2])> {
        let (Step::Multiply(a, b) | Step::Product(a, b)) = self.program.steps[step] else { return None };
        let n = self.program.outputs.len();
        let told = |a: usize, b: usize| {
            let ratio = |&known: &Quantity| {
                let Ratio(i, k) = known else { return None };
                let j = self.is(a, known).then(|| (k + 1..n).find(|&j| self.is(b, Schur(j, k))))??;
                Some(((i, j), [(a, known), (b, Schur(j, k))]))
            };
            self.known.keys().find_map(ratio)
        };
        told(a, b).or_else(|| told(b, a))
    }

    /// The permitted factors of products in the sum of a quantity; each pair belongs to another k.
    fn allowed(&self, quantity: Quantity) -> Vec<(usize, [(Quantity, Quantity); 2])> {
        let twice = |a, b| [(a, b), (a, b)];
        let n = self.program.outputs.len();
        let schur = |i: usize, j: usize, k: usize| (k, [(Ratio(i, k), Schur(j, k)), (Ratio(j, k), Schur(i, k))]);
        match quantity {
            Pivot(j) => (0..j).map(|k| schur(j, j, k)).collect(),
            Schur(i, j) => (0..j).map(|k| schur(i, j, k)).collect(),
            Forward(i) => (0..i).map(|k| (k, [(Ratio(i, k), Forward(k)), (Schur(i, k), Scaled(k))])).collect(),
            Solution(i) => {
                let own = (i, twice(Reciprocal(i), Forward(i)));
                std::iter::once(own).chain((i + 1..n).map(|j| (j, twice(Ratio(j, i), Solution(j))))).collect()
            }
            Reciprocal(_) | Ratio(..) | Scaled(_) => Vec::new(),
        }
    }
}

/// A sum of the text. `plain` are its summands without reciprocals; `cancelled` are row and column of products that occur with both signs, in sums
/// shared by two entries; `additions` is the longest path through it.
struct Sum {
    plain: Vec<Leaf>,
    cancelled: Vec<(usize, usize)>,
    additions: usize,
}

/// The sums of all quantities that the entries use; `None` if a step has another form.
fn sums(reading: &Reading<'_>) -> Option<BTreeMap<Quantity, Sum>> {
    let mut open: Vec<(usize, Quantity)> =
        reading.program.outputs.iter().enumerate().map(|(i, output)| (output.step, Solution(i))).collect();
    let (mut steps, mut done) = (BTreeMap::new(), BTreeSet::new());
    let mut sums = BTreeMap::new();
    while let Some((step, quantity)) = open.pop() {
        let step = reading.bare(step);
        if !done.insert((step, quantity)) {
            continue;
        }
        if !reading.is(step, quantity) {
            return None;
        }
        match quantity {
            // A constant reciprocal belongs to a joint without coupling to earlier joints, so its pivot is the entry of B.
            Reciprocal(j) if matches!(reading.program.steps[step], Step::Literal(_)) => {
                if (0..j).any(|k| !reading.is_zero(Ratio(j, k))) {
                    return None;
                }
            }
            Reciprocal(j) => {
                let Step::Divide(one, divisor) = reading.program.steps[step] else { return None };
                let Step::Literal(literal) = reading.program.steps[one] else { return None };
                if reading.program.literals[literal].value != 1.0 {
                    return None;
                }
                open.push((divisor, Pivot(j)));
            }
            Ratio(..) | Scaled(_) => {
                let Step::Multiply(a, b) = reading.program.steps[step] else { return None };
                let (over, under) = match quantity {
                    Ratio(i, j) => (Schur(i, j), Reciprocal(j)),
                    Scaled(i) => (Forward(i), Reciprocal(i)),
                    _ => return None,
                };
                let (a, b) = if reading.is(b, under) { (a, b) } else { (b, a) };
                open.extend([(a, over), (b, under)]);
            }
            _ => {
                // A quantity must have a single step: two differently rounded steps would mean two matrices.
                if steps.insert(quantity, step).is_some_and(|other| other != step) {
                    return None;
                }
                sums.insert(quantity, sum(reading, step, quantity, &mut open)?);
            }
        }
    }
    Some(sums)
}

fn sum(reading: &Reading<'_>, step: usize, quantity: Quantity, open: &mut Vec<(usize, Quantity)>) -> Option<Sum> {
    let mut leaves = Vec::new();
    reading.leaves(step, false, 0, &mut leaves);
    let additions = leaves.iter().map(|leaf| leaf.additions).max().unwrap_or(0);
    let (mut plain, mut cancelled, mut seen) = (Vec::new(), Vec::new(), BTreeSet::new());
    while let Some((first, second)) = reading.opposites(&leaves) {
        let (entry, factors) = reading.product(leaves[first].step)?;
        cancelled.push(entry);
        open.extend(factors);
        leaves.remove(second);
        leaves.remove(first);
    }
    let allowed = reading.allowed(quantity);
    for leaf in leaves {
        if !reading.divided[leaf.step] {
            plain.push(leaf);
            continue;
        }
        let (Step::Multiply(a, b) | Step::Product(a, b)) = reading.program.steps[leaf.step] else { return None };
        let fits = |(x, y): &(Quantity, Quantity)| {
            let both = |a, b| reading.is(a, *x) && reading.is(b, *y);
            both(a, b).then_some([(a, *x), (b, *y)]).or_else(|| both(b, a).then_some([(b, *x), (a, *y)]))
        };
        let fitting = allowed.iter().find_map(|(k, pairs)| Some((*k, pairs.iter().find_map(fits)?)));
        let (k, factors) = fitting?;
        if !seen.insert(k) {
            return None;
        }
        open.extend(factors);
    }
    // Every nonzero product must occur.
    let missing =
        allowed.iter().any(|(k, pairs)| !seen.contains(k) && !reading.is_zero(pairs[0].0) && !reading.is_zero(pairs[0].1));
    // The solution is a sum of products only.
    let foreign = matches!(quantity, Solution(_)) && !plain.is_empty();
    (!missing && !foreign).then_some(Sum { plain, cancelled, additions })
}

/// The bound for `forward_dynamics` and `forward_dynamics_with`; `ranges` are those of the steps over the box.
pub fn residual(
    program: &Program,
    literals: &[Wide],
    equations: &Equations,
    state: &Arguments<f64>,
    ranges: &[Range],
    real: Float,
) -> Option<Residual> {
    let n = program.outputs.len();
    let wide = WideArguments::new(state)?;
    let (b, right) = equations.at(state, &wide)?;
    let known = quantities(&b, &right)?;
    let values = program.values(&wide, literals).into_iter().collect::<Option<Vec<Wide>>>()?;
    let reading = Reading { program, values: &values, divided: Vec::new(), known: &known };
    // A product with the constant reciprocal of a pivot.
    let constant = |literal: usize, other: usize| {
        let fits = |j: usize| {
            let scaled = (j + 1..n).map(|i| Schur(i, j)).chain([Forward(j)]);
            reading.is(literal, Reciprocal(j)) && scaled.into_iter().any(|quantity| reading.is(other, quantity))
        };
        matches!(program.steps[literal], Step::Literal(_)) && (0..n).any(fits)
    };
    let mut divided: Vec<bool> = Vec::new();
    for step in &program.steps {
        divided.push(match step {
            _ if program.divisor(step).is_some() => true,
            Step::Negate(a) | Step::SignOf(a) => divided[*a],
            Step::Multiply(a, b) | Step::Product(a, b) if constant(*a, *b) || constant(*b, *a) => true,
            Step::Add(a, b) | Step::Subtract(a, b) | Step::Multiply(a, b) | Step::Product(a, b) => divided[*a] || divided[*b],
            _ => false,
        });
    }
    let reading = Reading { divided, ..reading };
    let sums = sums(&reading)?;

    let u = real.unit();
    let gamma = |k: usize| k as f64 * u / (1.0 - k as f64 * u);
    let plain_error = |quantity: Quantity| {
        let Some(sum) = sums.get(&quantity) else { return 0.0 };
        let of = |leaf: &Leaf| {
            let range = &ranges[leaf.step];
            range.error + gamma(leaf.additions) * (range.size() + range.error)
        };
        sum.plain.iter().map(of).sum::<f64>()
    };
    let most = |j: usize| {
        let Some(sum) = sums.get(&Pivot(j)) else {
            return known.get(&Pivot(j)).map_or(f64::INFINITY, |value| value.to_f64());
        };
        let high = |leaf: &Leaf| if leaf.negative { -ranges[leaf.step].low } else { ranges[leaf.step].high };
        sum.plain.iter().map(high).sum::<f64>() + plain_error(Pivot(j))
    };
    let additions = sums.values().map(|sum| sum.additions).max().unwrap_or(0);
    // The diagonal of L* D L*' equals that of B up to rounding; cancelling products are at most as large as its largest entry.
    let (g, high) = (gamma(additions + 4), (0..n).map(|j| most(j).max(0.0)).collect::<Vec<f64>>());
    let idle = |j: usize| sums.get(&Pivot(j)).map_or(0, |sum| sum.cancelled.len()) as f64;
    let left = 1.0 - g * (1.0 + 2.0 * (0..n).map(idle).fold(0.0, f64::max));
    if left.is_nan() || left <= 0.0 {
        return None;
    }
    let largest = high.iter().copied().fold(0.0, f64::max) / left;
    let diagonal: Vec<f64> = (0..n).map(|j| (high[j] + 2.0 * g * idle(j) * largest) / (1.0 - g)).collect();
    let error = |quantity: Quantity| {
        let Some(sum) = sums.get(&quantity) else { return 0.0 };
        let twice = |&(i, j): &(usize, usize)| 2.0 * g * (diagonal[i] * diagonal[j]).sqrt();
        plain_error(quantity) + sum.cancelled.iter().map(twice).sum::<f64>()
    };
    let entry = |i: usize, j: usize| match i.cmp(&j) {
        std::cmp::Ordering::Equal => error(Pivot(i)),
        std::cmp::Ordering::Greater => error(Schur(i, j)),
        std::cmp::Ordering::Less => error(Schur(j, i)),
    };
    let row =
        |i: usize| -> f64 { (0..n).map(|j| entry(i, j) + gamma(4 * additions + 12) * (diagonal[i] * diagonal[j]).sqrt()).sum() };
    // A margin for the roundings of these sums, and for underflow.
    let outward = 1.0 + 1e-9;
    let constant = (0..n).map(|i| error(Forward(i))).fold(0.0, f64::max) * outward + 1e-30;
    let factor = (0..n).map(row).fold(0.0, f64::max) * outward;
    (constant.is_finite() && factor.is_finite()).then_some(Residual { constant, factor })
}
