//! `base_regressor`: checks a regressor of base parameters for any choice of these parameters.
//!
//! Base parameters are not unique. The author may shift origins along joint axes and rotate frames about them, and choose the share of a
//! link's second moment along its axis. A parameter whose value is 0 in the description has no column. The check does not repeat these
//! choices. Let Y_k(q, dq, ddq) be the torque of a unit of the standard parameter k, with links in their joint frames. The conditions are
//!
//! ```text
//! (a)  column c of Y_b = Σ x_k Y_k, x constant, over the parameters of the kind of name c
//! (b)  the columns of Y_b are independent
//! (c)  Y_b pi_b = B ddq + C dq + F + g
//! ```
//!
//! A kind contains the combinations that arise from one parameter by shifts, rotations and the second moment along the axis ([`kind`]).
//! A rotor or friction parameter forms a kind of its own, with x = 1.
//!
//! For (a), x comes from [`FITTED`] states in a prime field, at most as many as there are unknowns. The equation is then tested at a further
//! state, drawn independently of x. A combination with variable coefficients passes with odds of degree/p, like any other wrong function.
//! For (b), the rank of Y_b stacked over states never exceeds the true rank; if it equals the number of columns, they are independent.
//! (c) is tested at all these states and at a rational state.
//!
//! So each column is the torque of a definite combination of inertial parameters, no column is redundant, and the nominal values give the
//! torque of the description: omitted parameters contribute nothing there. The check does not ask whether a further parameter needs a column.

use std::collections::BTreeMap;

use armgen_description::manipulator::Manipulator;

use crate::textbook::equations::angles::Angles;
use crate::textbook::equations::arm::Arm;
use crate::textbook::equations::lagrange::{friction, spring_torques};
use crate::textbook::equations::newton_euler::{ArmMotion, Carrier, Motion};
use crate::textbook::equations::parameters::{Standard, Vector};
use crate::textbook::equations::pose::Pose;
use crate::textbook::equations::state::State;
use crate::textbook::reference::{Reference, Values, Wanted, BASE_REGRESSOR};
use crate::values::arithmetic::degree::Degree;
use crate::values::arithmetic::Arithmetic;
use crate::values::element::Element;
use crate::values::formula::Formula;
use crate::values::number::{Erased, Member, Numbers};
use crate::values::program::{Argument, Program, Step};

/// The base parameters of a module: the standard parameters in their names, a flag for combined parameters, and their claimed values.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnParameters {
    /// The standard parameter of each name, and whether the name denotes a combination.
    pub named: Vec<(Standard, bool)>,
    /// Exact values.
    pub nominal: Vec<Formula>,
}

/// The standard parameters that may be combined under this name. The set is closed under rotation of the joint frame about its axis, shift
/// along it, and change of the second moment along it, (Ixx + Iyy - Izz)/2.
pub fn kind(parameter: Standard) -> Vec<Standard> {
    // In the order m, mcx, mcy, mcz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz.
    let of_link: &[usize] = match parameter {
        Standard::Link(_, 0) => &[0, 3, 4, 6],
        Standard::Link(_, 1 | 2) => &[1, 2, 7, 8],
        Standard::Link(_, 3) => &[3, 4, 6],
        Standard::Link(_, 4 | 5 | 6 | 9) => &[4, 5, 6, 9],
        Standard::Link(..) => &[7, 8],
        alone => return vec![alone],
    };
    let Standard::Link(i, _) = parameter else { unreachable!("all others stand alone") };
    of_link.iter().map(|&k| Standard::Link(i, k)).collect()
}

/// Whether a column must equal the column of its parameter.
fn is_alone(parameter: Standard) -> bool {
    !matches!(parameter, Standard::Link(..))
}

/// Number of states that determine the coefficients: the number of parameters of a kind, for a link that loads a single joint.
pub const FITTED: usize = 4;

/// A state with its torques and the columns of single parameters.
#[derive(Clone, Debug)]
struct Sample<E> {
    state: State<E>,
    torques: Vec<E>,
    columns: BTreeMap<Standard, Vec<E>>,
}

/// Random states of an arm.
#[derive(Clone, Debug)]
pub struct Samples<E>(Vec<Sample<E>>);

/// A wrong entry `[joint][column]`, with the reason.
pub type Fault = (String, String);

/// Columns of single parameters at a state, with links in their joint frames, and the torques.
fn sample<E: Element>(arm: &Arm<E>, state: State<E>, named: &[(Standard, bool)]) -> Sample<E> {
    let motion = || Motion { rates: state.dq.clone(), accelerations: state.ddq.clone(), gravity: arm.gravity.clone() };
    let described = Pose::new(arm, &state);
    let in_joint_frames = described.clone().with_links_in_joint_frames();
    // Rotors and the load keep their frames of the description.
    let (whole, links) = (ArmMotion::new(arm, &described, motion()), ArmMotion::new(arm, &in_joint_frames, motion()));
    let nothing = || vec![arm.zero.clone(); arm.joints.len()];
    let at_joints = arm.state_of_joints(&state);
    let unit = |k: usize| -> Vec<E> { (0..10).map(|i| if i == k { arm.one.clone() } else { arm.zero.clone() }).collect() };
    let column = |parameter: Standard| {
        let mut column = nothing();
        match parameter {
            Standard::Link(i, k) => links.add_body(Carrier::Link(i), &unit(k), &mut column),
            Standard::Payload(tip, k) => whole.add_body(Carrier::Tool(tip), &unit(k), &mut column),
            Standard::RotorInertia(i) => whole.add_rotor_inertia(i, &arm.one, &mut column),
            Standard::Armature(i) => whole.add_armature(i, &arm.one, &mut column),
            Standard::RotorViscous(i) => {
                let motor = arm.joints[i].motor.iter();
                motor.for_each(|motor| motor.add_torque(&motor.spin(&arm.zero, &at_joints.dq), &mut column));
            }
            Standard::Viscous(i) => column[i].clone_from(&at_joints.dq[i]),
            Standard::Coulomb(i) => column[i].clone_from(&at_joints.directions[i]),
            Standard::Stribeck(i) => column[i] = at_joints.directions[i].times(&at_joints.stribeck[i]),
            Standard::Offset(i) => column[i].clone_from(&arm.one),
            Standard::Cubic(i) => column[i] = at_joints.dq[i].times(&at_joints.dq[i]).times(&at_joints.dq[i]),
            Standard::Stiffness(i) => column[i] = at_joints.q[i].minus(&arm.joints[i].rest),
        }
        arm.of_coordinates(column)
    };
    let mut columns = BTreeMap::new();
    for parameter in named.iter().flat_map(|(parameter, _)| kind(*parameter)) {
        columns.entry(parameter).or_insert_with(|| column(parameter));
    }
    let friction = friction(arm, &state, &state.dq);
    let springs = spring_torques(arm, &state.q);
    let torques = whole.torques().iter().zip(friction).zip(springs).map(|((a, b), c)| a.plus(&b).plus(&c)).collect();
    Sample { torques, columns, state }
}

/// For each entry of a base regressor, the sum over its kind: at least as large, and of at least the same degree.
pub fn sums_of_kinds<E: Element>(arm: &Arm<E>, state: &State<E>, named: &[(Standard, bool)]) -> Vec<E> {
    let columns = sample(arm, state.clone(), named).columns;
    let entry = |i: usize, parameter: Standard| {
        kind(parameter).iter().map(|k| columns[k][i].clone()).reduce(|a, b| a.plus(&b)).unwrap_or(arm.zero.clone())
    };
    (0..arm.dof()).flat_map(|i| named.iter().map(move |(parameter, _)| entry(i, *parameter)).collect::<Vec<E>>()).collect()
}

/// Values of all functions at a state; for `base_regressor` those of [`sums_of_kinds`] if its parameters are given.
pub fn values<K: Arithmetic>(
    arithmetic: &mut K,
    manipulator: &Manipulator,
    vector: &Vector,
    named: Option<&[(Standard, bool)]>,
    state: State<K::Element>,
    wanted: Wanted,
) -> Result<Values<K::Element>, String>
where
    K::Element: Member,
{
    let mut erased = Erased(arithmetic);
    let mut numbers: Numbers<'_> = &mut erased;
    let state = state.map(&Member::into_number);
    let mut values = Reference::at(&mut numbers, manipulator, vector, state.clone(), wanted)?.values;
    if let Some(named) = named {
        let arm = Arm::nominal(&numbers, manipulator).and_then(|names| Arm::new(&numbers, manipulator, &names));
        let arm = arm.ok_or("a constant of the description divides by zero")?.under(&state.g0);
        values.insert(BASE_REGRESSOR.into(), sums_of_kinds(&arm, &state, named));
    }
    Ok(values.into_iter().map(|(name, entries)| (name, entries.into_iter().map(Member::of).collect())).collect())
}

impl<E> Samples<E> {
    /// The same samples in another number type.
    pub fn map<F>(self, of: &dyn Fn(E) -> F) -> Samples<F> {
        let all = |values: Vec<E>| values.into_iter().map(of).collect::<Vec<F>>();
        let each = |sample: Sample<E>| Sample {
            state: sample.state.map(of),
            torques: all(sample.torques),
            columns: sample.columns.into_iter().map(|(parameter, column)| (parameter, all(column))).collect(),
        };
        Samples(self.0.into_iter().map(each).collect())
    }
}

impl<E: Element> Samples<E> {
    /// The state of a reference and `more` further states, each with the columns for these parameters.
    pub fn draw<K: Arithmetic<Element = E>>(
        arithmetic: &mut K,
        manipulator: &Manipulator,
        named: &[(Standard, bool)],
        reference: &Reference<E>,
        more: usize,
    ) -> Option<Samples<E>> {
        let names = Arm::nominal(arithmetic, manipulator)?;
        let arm = Arm::new(arithmetic, manipulator, &names)?;
        let under = |state: State<E>| sample(&arm.clone().under(&state.g0), state, named);
        let mut samples = vec![under(reference.state.clone())];
        for _ in 0..more {
            let state = State::draw(arithmetic, &arm.angles).with_decays(arithmetic, arm.decays());
            samples.push(under(arm.with_friction(state).with_gravity(arithmetic, manipulator.gravity_is_argument)));
        }
        Some(Samples(samples))
    }

    /// The state of a reference with only its torques.
    pub fn torques(reference: &Reference<E>) -> Option<Samples<E>> {
        let mut torques = reference.values.get("inverse_dynamics")?.clone();
        // Load-dependent friction is no combination of columns.
        if let Some(load) = reference.values.get("load_friction") {
            torques = torques.iter().zip(load).map(|(torque, load)| torque.minus(load)).collect();
        }
        Some(Samples(vec![Sample { state: reference.state.clone(), torques, columns: BTreeMap::new() }]))
    }

    /// The first entry that violates (a) or (c).
    pub fn fault(&self, program: &Program, literals: &[E], named: &[(Standard, bool)], nominal: &[E]) -> Option<Fault> {
        let mut values = Vec::new();
        for sample in &self.0 {
            let entries = program.run(&sample.state, literals);
            if let Some(entry) = entries.iter().position(Option::is_none) {
                return Some((program.outputs[entry].place.clone(), program.without_value(&sample.state, literals).into()));
            }
            values.push(entries.into_iter().flatten().collect::<Vec<E>>());
        }
        let y = Y::new(&self.0, values, nominal);
        let columns = named.iter().enumerate().filter(|_| !self.0[0].columns.is_empty());
        let off = columns.filter_map(|(c, (parameter, carries))| Some((y.wrong_row(c, *parameter)?, c, *parameter, *carries)));
        if let Some((i, c, parameter, carries)) = off.min_by_key(|(i, c, ..)| (*i, *c)) {
            let name = format!("{}{}", parameter.name(), if carries { "R" } else { "" });
            let kin: Vec<String> = kind(parameter).into_iter().map(Standard::name).collect();
            return Some((
                format!("[{i}][{c}]"),
                format!("differs: column `{name}` is no combination of the torques of {}", kin.join(", ")),
            ));
        }
        let i = y.joints().find(|&i| y.is_wrong(i))?;
        let place = y.proportional().map_or(format!("[{i}]"), |(i, c)| format!("[{i}][{c}]"));
        Some((place, "differs: with NOMINAL_BASE_PARAMETERS it does not give the torque".into()))
    }
}

/// A base regressor at samples.
struct Y<'a, E> {
    samples: &'a [Sample<E>],
    /// Entries at each sample, row by row.
    values: Vec<Vec<E>>,
    columns: usize,
    /// tau - Y_b pi_b at each sample.
    missing: Vec<Vec<E>>,
}

impl<'a, E: Element> Y<'a, E> {
    fn new(samples: &'a [Sample<E>], values: Vec<Vec<E>>, nominal: &[E]) -> Y<'a, E> {
        let columns = nominal.len();
        let rest = |(sample, values): (&Sample<E>, &Vec<E>)| -> Vec<E> {
            let of = |(i, torque): (usize, &E)| {
                let row = values[i * columns..(i + 1) * columns].iter().zip(nominal);
                row.fold(torque.clone(), |rest, (entry, value)| rest.minus(&entry.times(value)))
            };
            sample.torques.iter().enumerate().map(of).collect()
        };
        let missing = samples.iter().zip(&values).map(rest).collect();
        Y { samples, values, columns, missing }
    }

    fn entry(&self, sample: usize, i: usize, c: usize) -> &E {
        &self.values[sample][i * self.columns + c]
    }

    fn joints(&self) -> std::ops::Range<usize> {
        0..self.samples[0].torques.len()
    }

    /// Whether the torque of a joint differs from Y_b pi_b.
    fn is_wrong(&self, i: usize) -> bool {
        self.missing.iter().any(|of| !of[i].is_zero())
    }

    /// The only column proportional to the missing torque, with the first joint that it loads.
    fn proportional(&self) -> Option<(usize, usize)> {
        let places = || self.joints().flat_map(|i| (0..self.samples.len()).map(move |s| (s, i)));
        let parallel = |c: usize| -> Option<usize> {
            let (s, first) = places().find(|&(s, i)| !self.entry(s, i, c).is_zero())?;
            let factor = self.missing[s][first].over(self.entry(s, first, c))?;
            places().all(|(s, i)| self.missing[s][i] == factor.times(self.entry(s, i, c))).then_some(first)
        };
        let mut found = (0..self.columns).filter_map(|c| Some((parallel(c)?, c)));
        let first = found.next()?;
        found.next().is_none().then_some(first)
    }

    /// Whether a column is a combination of its kind at these joints.
    fn is_combination(&self, c: usize, kind: &[Standard], alone: bool, joints: &[usize]) -> bool {
        let at = |s: usize, i: usize, k: usize| &self.samples[s].columns[&kind[k]][i];
        let one = self.samples[0].state.one.clone();
        let coefficients = if alone {
            vec![one]
        } else {
            let fitted = (0..self.samples.len() - 1).flat_map(|s| joints.iter().map(move |&i| (s, i)));
            let equation =
                |(s, i): (usize, usize)| (0..kind.len()).map(|k| at(s, i, k)).chain([self.entry(s, i, c)]).cloned().collect();
            one_solution(fitted.map(equation), kind.len(), &self.samples[0].state.zero)
        };
        let holds = |s: usize, i: usize| {
            let sum = coefficients.iter().enumerate().map(|(k, x)| x.times(at(s, i, k))).reduce(|a, b| a.plus(&b));
            sum.as_ref() == Some(self.entry(s, i, c))
        };
        (0..self.samples.len()).all(|s| joints.iter().all(|&i| holds(s, i)))
    }

    /// For a column that is no combination, a joint where it disagrees with the other joints.
    fn wrong_row(&self, c: usize, parameter: Standard) -> Option<usize> {
        let (kind, alone) = (kind(parameter), is_alone(parameter));
        let all: Vec<usize> = self.joints().collect();
        let holds = |joints: &[usize]| self.is_combination(c, &kind, alone, joints);
        if holds(&all) {
            return None;
        }
        // Joints that are wrong by themselves, or without which the others agree, are the wrong joints; the torques select the first.
        let by_itself = all.iter().copied().find(|&i| !holds(&[i]));
        let without_wrong = || {
            let right: Vec<usize> = all.iter().copied().filter(|&i| !self.is_wrong(i)).collect();
            let first = all.iter().copied().find(|&i| self.is_wrong(i) && !holds(&[right.as_slice(), &[i]].concat()))?;
            holds(&right).then_some(first)
        };
        let without_one = || all.iter().copied().find(|&i| holds(&all.iter().copied().filter(|&j| j != i).collect::<Vec<_>>()));
        Some(by_itself.or_else(without_wrong).or_else(without_one).unwrap_or(0))
    }
}

/// A solution of the independent equations (coefficients, then the right-hand side); free unknowns are 0.
fn one_solution<E: Element>(equations: impl Iterator<Item = Vec<E>>, unknowns: usize, zero: &E) -> Vec<E> {
    let mut echelon = Echelon::default();
    for equation in equations {
        if echelon.0.len() == unknowns {
            break;
        }
        echelon.add(equation, unknowns);
    }
    let mut solution = vec![zero.clone(); unknowns];
    for (pivot, row) in echelon.0.iter().rev() {
        let rest = row[unknowns].clone();
        solution[*pivot] = (0..unknowns).filter(|k| k != pivot).fold(rest, |rest, k| rest.minus(&row[k].times(&solution[k])));
    }
    solution
}

/// Independent rows, each with 1 at its pivot, the first nonzero entry, and 0 at the pivots of the rows before.
struct Echelon<E>(Vec<(usize, Vec<E>)>);

impl<E> Default for Echelon<E> {
    fn default() -> Echelon<E> {
        Echelon(Vec::new())
    }
}

impl<E: Element> Echelon<E> {
    /// Adds a row unless the existing rows span its first `columns` entries.
    fn add(&mut self, mut row: Vec<E>, columns: usize) {
        for (pivot, known) in &self.0 {
            let factor = row[*pivot].clone();
            if !factor.is_zero() {
                row.iter_mut().zip(known).for_each(|(x, k)| *x = x.minus(&factor.times(k)));
            }
        }
        let Some(pivot) = row[..columns].iter().position(|x| !x.is_zero()) else { return };
        if let Some(inverse) = row[pivot].inverse() {
            row.iter_mut().for_each(|x| *x = x.times(&inverse));
            self.0.push((pivot, row));
        }
    }
}

/// (b): the first column in the span of the columns before it, if any. States are drawn from the field until the rank is full.
pub fn dependent_column<K: Arithmetic>(
    mut arithmetic: K,
    program: &Program,
    literals: &[K::Element],
    angles: &Angles,
    columns: usize,
) -> Option<Fault> {
    let mut echelon = Echelon::default();
    // Each state adds at least a row if the rank can grow.
    for _ in 0..columns + 2 {
        if echelon.0.len() == columns {
            return None;
        }
        let decays = (0..angles.coordinates())
            .map(|i| program.steps.iter().any(|step| matches!(step, Step::Stribeck(joint, _) if *joint == i)));
        let state = State::draw(&mut arithmetic, angles).with_decays(&mut arithmetic, decays);
        let state = state.with_gravity(&mut arithmetic, program.arguments.contains(&Argument::Gravity));
        let Some(entries) = program.run(&state, literals).into_iter().collect::<Option<Vec<_>>>() else { continue };
        entries.chunks(columns).for_each(|row| echelon.add(row.to_vec(), columns));
    }
    let missing = (0..columns).find(|c| echelon.0.iter().all(|(pivot, _)| pivot != c))?;
    Some((format!("[0][{missing}]"), "its column depends on those before it: a motion cannot tell these parameters apart".into()))
}

impl Samples<Degree> {
    /// log2 of the odds that a program violating (a) or (c) passes one point; `odds` are those of a polynomial by degree and height.
    pub fn log2_odds(
        &self,
        program: &Program,
        literals: &[Degree],
        parameters: (&[(Standard, bool)], &[Degree]),
        odds: impl Fn(f64, f64) -> f64,
    ) -> f64 {
        let (named, nominal) = parameters;
        let Some(sample) = self.0.first() else { return 0.0 };
        let Some(entries) = program.run(&sample.state, literals).into_iter().collect::<Option<Vec<_>>>() else { return 0.0 };
        let mut worst = f64::NEG_INFINITY;
        for (i, torque) in sample.torques.iter().enumerate() {
            let row = &entries[i * named.len()..(i + 1) * named.len()];
            let mut product = torque.clone();
            for ((entry, value), (parameter, _)) in row.iter().zip(nominal).zip(named) {
                product = product.plus(&entry.times(value));
                let kind = kind(*parameter);
                let sum = kind.iter().fold(entry.clone(), |sum, k| sum.plus(&sample.columns[k][i]));
                let (degree, height) = sum.of_difference(&sum);
                // The coefficients are quotients of minors with at most `rows - 1` rows; a prime that divides a minor one larger misleads.
                let rows = kind.len() as f64 + 1.0;
                worst = worst.max(odds(degree * rows, (height + rows.log2()) * rows));
            }
            let (degree, height) = product.of_difference(torque);
            worst = worst.max(odds(degree, height));
        }
        worst
    }
}
