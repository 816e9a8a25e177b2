//! Counts solutions: at random poses in prime fields, and real ones at rational poses.

use dashu_int::IBig;

use super::chain::Chain;
use super::forms::{of_loop, System};
use super::modular::{Frame, Modulus};
use super::points::{posture, Constants};
use super::quotient::{Quotient, Step};
use super::sturm::{residues_of, roots, Residues, Roots};
use crate::textbook::equations::pose::Pose;
use crate::textbook::equations::state::State;
use crate::values::float::Arguments;
use crate::values::formula::{Formula, Rational};
use crate::values::stream::Stream;
use armgen_description::manipulator::Manipulator;

/// A traversal of the loop: its first joint and its direction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Way {
    pub(super) start: usize,
    pub(super) backward: bool,
    /// Whether the target is a point.
    pub(super) point: bool,
}

/// Degree bounds of products, and of the part that is kept.
type Shape = (Vec<u8>, Vec<u8>);

/// The combination of sines, cosines and slides whose minimal polynomial is computed; it only has to separate the solutions.
const COMBINATION: [i64; 8] = [1, 3, -2, 5, 4, -7, 6, -1];

impl Way {
    /// All traversals for an arm.
    pub(super) fn all(joints: usize, point: bool) -> Vec<Way> {
        let backward: &[bool] = if point { &[false] } else { &[false, true] };
        let starts = if point { 1 } else { joints };
        (0..starts).flat_map(|start| backward.iter().map(move |backward| Way { start, backward: *backward, point })).collect()
    }

    /// The arm's joints in the order of the loop.
    pub(super) fn order(self, joints: usize) -> Vec<usize> {
        let place = |i| (self.start + i) % joints;
        (0..joints).map(|i| if self.backward { joints - 1 - place(i) } else { place(i) }).collect()
    }

    fn system(self, chain: &Chain, pose: &Frame) -> Option<System> {
        if self.backward {
            of_loop(&chain.reversed(), &chain.modulus.inverse_frame(pose), self.start, self.point)
        } else {
            of_loop(chain, pose, self.start, self.point)
        }
    }
}

/// Shapes that give the number of solutions with a criterion of correctness.
fn exact_shapes(places: usize) -> Vec<Shape> {
    [(2, 2), (3, 2), (3, 3), (4, 3)].map(|(bound, kept)| (vec![bound; places], vec![kept; places])).to_vec()
}

/// Smaller shapes that give the same number.
fn small_shapes(places: usize) -> Vec<Shape> {
    let mut shapes = vec![(vec![2; places], vec![2; places])];
    for place in 0..places {
        let (mut bound, mut kept) = (vec![2; places], vec![1; places]);
        (bound[place], kept[place]) = (3, 2);
        shapes.push((bound, kept));
    }
    shapes.extend([(vec![3; places], vec![2; places]), (vec![3; places], vec![3; places])]);
    shapes
}

fn exact(m: Modulus, system: &System) -> Option<Quotient> {
    let shapes = exact_shapes(system.slides.len()).into_iter();
    shapes.filter_map(|(bound, kept)| Quotient::of(m, system, &bound, &kept, None)).find(|quotient| quotient.exact)
}

/// The number of solutions at random poses.
#[derive(Clone, Debug)]
pub(super) struct Generic {
    pub(super) solutions: usize,
    pub(super) way: Way,
    shape: Shape,
    /// The given joint, whose value is an input.
    given: Option<usize>,
}

/// The arm without the given joint.
fn others(chain: &Chain, given: Option<usize>, posture: &[[u64; 2]]) -> Chain {
    given.map_or_else(|| chain.clone(), |joint| chain.without(joint, posture[joint]))
}

/// The number of solutions at random poses of two prime fields, by the first traversal that determines it.
pub(super) fn generic(
    manipulator: &Manipulator,
    constants: &Constants,
    (ways, given): (&[Way], Option<usize>),
    stream: &mut Stream,
) -> Result<Generic, String> {
    let mut points = Vec::new();
    for _ in 0..2 {
        let mut field = constants.field(stream)?;
        let chain = Chain::of(manipulator, &field).ok_or("a constant of the description divides by zero")?;
        let posture = posture(&chain, &mut field);
        let pose = chain.pose(&posture);
        points.push((others(&chain, given, &posture), pose));
    }
    for way in ways {
        let systems: Option<Vec<_>> = points.iter().map(|(chain, pose)| way.system(chain, pose)).collect();
        let Some(systems) = systems else { continue };
        let modulus = |i: usize| points[i].0.modulus;
        let Some(solutions) = exact(modulus(0), &systems[0]).map(|quotient| quotient.dimension) else { continue };
        // Exact counts need many primes, so the smaller shapes serve them; the criterion gives the number.
        let small = small_shapes(systems[0].slides.len()).into_iter().find(|(bound, kept)| {
            let quotient = Quotient::of(modulus(0), &systems[0], bound, kept, None);
            quotient.is_some_and(|q| q.dimension == solutions && q.minimal_polynomial(&COMBINATION).len() == solutions)
        });
        let Some(shape) = small else { continue };
        let again = exact(modulus(1), &systems[1]).map(|quotient| quotient.dimension);
        if again != Some(solutions) {
            return Err(format!("the number of solutions is {solutions} at one random pose, {again:?} at another"));
        }
        return Ok(Generic { solutions, way: *way, shape, given });
    }
    Err("no arrangement of the loop gives the number of solutions".into())
}

/// A rational pose.
#[derive(Clone, Debug)]
pub(super) struct RationalPose {
    /// Numerators and denominators of the half-angle tangents, or of the slides.
    pub(super) values: Vec<(i64, i64)>,
    /// Displacement of the end effector along each axis, m, to put it out of reach.
    pub(super) away: i64,
}

impl RationalPose {
    /// Poses of random postures. Every fourth has special joint values such as 0 and half turns, every eighth is out of reach. Arms with `few`
    /// joints have another eighth near a reachable pose.
    pub(super) fn some(joints: usize, count: usize, (length, few): (f64, bool), stream: &mut Stream) -> Vec<RationalPose> {
        let mut poses = Vec::new();
        for number in 0..count {
            let mut value = || {
                if number % 4 == 3 && stream.below(2) == 0 {
                    return ([0, 1, -1][stream.below(3) as usize], 1);
                }
                let denominator = 1 + stream.below(5) as i64;
                (stream.below(12 * denominator as u64) as i64 - 6 * denominator, denominator)
            };
            let values = (0..joints).map(|_| value()).collect();
            let away = match number % 8 {
                5 => (20.0 * length).ceil() as i64 + 100,
                1 if few => 1,
                _ => 0,
            };
            poses.push(RationalPose { values, away });
        }
        poses
    }

    /// The arm without the given joint, and the pose.
    fn modular(&self, chain: &Chain, given: Option<usize>) -> (Chain, Frame) {
        let m = chain.modulus;
        let value = |(slides, (n, d)): (&bool, &(i64, i64))| {
            let t = m.times(m.integer(*n), m.inverse(m.integer(*d)));
            if *slides {
                return [t, 0];
            }
            let square = m.times(t, t);
            let over = m.inverse(m.plus(m.one, square));
            [m.times(m.minus(m.one, square), over), m.times(m.plus(t, t), over)]
        };
        let values: Vec<[u64; 2]> = chain.slides.iter().zip(&self.values).map(value).collect();
        let mut pose = chain.pose(&values);
        for row in &mut pose {
            row[3] = m.plus(row[3], m.integer(self.away));
        }
        (others(chain, given, &values), pose)
    }

    /// The exact pose.
    pub(super) fn exact(&self, constants: &Constants) -> [[Formula; 4]; 3] {
        let arm = &constants.arm;
        let number = |x: Rational| Formula::Rational(x);
        let tangent = |(n, d): &(i64, i64)| Rational::from(*n) / Rational::from(*d);
        let angle = |pair: &(i64, i64)| {
            let t = tangent(pair);
            let over = Rational::ONE / (Rational::ONE + &t * &t);
            (number(Rational::from(2) * &t * &over), number((Rational::ONE - &t * &t) * &over))
        };
        let q: Vec<Formula> = self.values.iter().map(|pair| number(tangent(pair))).collect();
        let zeros = vec![number(Rational::ZERO); q.len()];
        let arguments = Arguments {
            pi: Vec::new(),
            q,
            dq: zeros.clone(),
            ddq: zeros.clone(),
            dqr: zeros.clone(),
            ddqr: zeros.clone(),
            tau: zeros.clone(),
            g0: Vec::new(),
        };
        let state =
            State::of(arguments, self.values.iter().map(angle).collect(), zeros, [number(Rational::ZERO), number(Rational::ONE)]);
        let tool = Pose::new(arm, &state).tools.swap_remove(0);
        let away = number(Rational::from(self.away));
        std::array::from_fn(|i| {
            std::array::from_fn(|j| match j {
                3 => crate::values::element::Element::plus(&tool.origin[i], &away),
                _ => tool.rotation[i][j].clone(),
            })
        })
    }
}

/// The proved count for a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Count {
    /// There are finitely many solutions.
    Finite(Roots),
    /// Unknown: there may be infinitely many, or some have moved to infinity, where no angle is.
    Undecided,
}

/// The arm in as many prime fields as needed so far.
pub(super) struct Counter<'a> {
    manipulator: &'a Manipulator,
    constants: &'a Constants,
    generic: Generic,
    stream: Stream,
    chains: Vec<Chain>,
}

/// Maximum number of primes of 62 bits for a pose.
const MOST_PRIMES: usize = 400;

impl<'a> Counter<'a> {
    pub(super) fn new(manipulator: &'a Manipulator, constants: &'a Constants, generic: Generic, stream: Stream) -> Counter<'a> {
        Counter { manipulator, constants, generic, stream, chains: Vec::new() }
    }

    fn chain(&mut self, number: usize) -> Result<&Chain, String> {
        while self.chains.len() <= number {
            let field = self.constants.field(&mut self.stream)?;
            // A prime that divides a denominator is skipped.
            self.chains.extend(Chain::of(self.manipulator, &field));
        }
        Ok(&self.chains[number])
    }

    /// The solutions at a pose of an arm with rational constants.
    pub(super) fn at(&mut self, pose: &RationalPose) -> Result<Count, String> {
        let (way, mut shape, mut solutions) = (self.generic.way, self.generic.shape.clone(), self.generic.solutions);
        let given = self.generic.given;
        let chain = self.chain(0)?;
        let m = chain.modulus;
        let (chain, at) = pose.modular(chain, given);
        let Some(system) = way.system(&chain, &at) else { return Ok(Count::Undecided) };
        let mut first = Quotient::of(m, &system, &shape.0, &shape.1, None);
        let mut degree = first.as_ref().map_or(0, |q| q.minimal_polynomial(&COMBINATION).len());
        if degree != solutions {
            // A special pose.
            let shapes = exact_shapes(system.slides.len()).into_iter();
            let mut all = shapes.filter_map(|shape| Some((Quotient::of(m, &system, &shape.0, &shape.1, None)?, shape)));
            let Some((quotient, found)) = all.find(|(quotient, _)| quotient.exact) else { return Ok(Count::Undecided) };
            degree = quotient.minimal_polynomial(&COMBINATION).len();
            (solutions, shape, first) = (quotient.dimension, found, Some(quotient));
        }
        let Some(first) = first else { return Ok(Count::Undecided) };
        let recipe: Vec<Step> = first.recipe;
        let mut residues = Residues::new(degree);
        let mut found: Option<Vec<IBig>> = None;
        let mut taken = 0;
        for number in 0..MOST_PRIMES {
            let chain = self.chain(number)?;
            let m = chain.modulus;
            let (chain, at) = pose.modular(chain, given);
            let Some(system) = way.system(&chain, &at) else { continue };
            let Some(quotient) = Quotient::of(m, &system, &shape.0, &shape.1, Some(&recipe)) else { continue };
            let polynomial = quotient.minimal_polynomial(&COMBINATION);
            if quotient.dimension != solutions || polynomial.len() != degree {
                continue;
            }
            let values: Vec<u64> = polynomial.iter().map(|x| m.value(*x)).collect();
            if let Some(candidate) = &found {
                if residues_of(candidate, m.prime) == values {
                    return Ok(Count::Finite(roots(candidate)));
                }
            }
            residues.add(m.prime, &values);
            taken += 1;
            found = if taken % 4 == 0 { residues.fractions() } else { None };
        }
        // The numbers of the arm are so long that they need more primes.
        Ok(Count::Undecided)
    }
}
