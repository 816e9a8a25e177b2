//! The functions known to the checker: their arguments and results, and their values at a random state, from the equations.

use std::collections::BTreeMap;

use armgen_description::manipulator::Manipulator;

use crate::textbook::equations::angles::Angles;
use crate::textbook::equations::arm::{Arm, Frame, Tip};
use crate::textbook::equations::lagrange::{
    accelerations, along_joints, coriolis_matrix, friction, gravity, has_load_friction, inertia_derivatives, inertia_matrix,
    load_friction, potential_energy, spring_torques, times_vector, Parts,
};
use crate::textbook::equations::newton_euler::{ArmMotion, Motion};
use crate::textbook::equations::parameters::{
    base_map, reference_torques, standard_columns, with_standard, KeptAlone, LinkFrames, Standard, Vector,
};
use crate::textbook::equations::pose::Pose;
use crate::textbook::equations::state::State;
use crate::textbook::equations::vector::{solve, Vector as Vector3};
use crate::values::arithmetic::dual::Dual;
use crate::values::arithmetic::Arithmetic;
use crate::values::contract::{Array, Length, Promise, Returned};
use crate::values::divisors::{Matrix, Pivots};
use crate::values::element::Element;

/// The function without an entry-by-entry comparison: its columns belong to the parameters that the module itself names.
pub const BASE_REGRESSOR: &str = "base_regressor";

const N: Length = Length::Dof;
const SQUARE: Array = &[N, N];
const VECTOR: Array = &[N];
const FRAME: Array = &[Length::Of(4), Length::Of(4)];
const JACOBIAN: Array = &[Length::Of(6), N];

const fn promise(name: &'static str, arguments: &'static [&'static str], returned: Returned) -> Promise {
    Promise { name, arguments, returned, required: true, parameters: false, of_tip: false }
}

impl Promise {
    const fn with_parameters(self) -> Promise {
        Promise { parameters: true, ..self }
    }

    /// Marks a function of an end effector.
    const fn of_an_end_effector(self) -> Promise {
        Promise { of_tip: true, ..self }
    }

    /// Marks a function that an arm may lack.
    const fn not_of_every_arm(self) -> Promise {
        Promise { required: false, ..self }
    }
}

/// All functions known to the checker, independent of the generator's catalogue; a test compares the two.
pub const PROMISES: [Promise; 25] = [
    promise("direct_kinematics", &["q"], Returned::One(FRAME)).of_an_end_effector(),
    promise("link_frames", &["q"], Returned::One(&[Length::Joints, Length::Of(4), Length::Of(4)])),
    promise("geometric_jacobian", &["q"], Returned::One(JACOBIAN)).of_an_end_effector(),
    promise("geometric_jacobian_dot", &["q", "dq"], Returned::One(JACOBIAN)).of_an_end_effector(),
    promise("link_jacobians", &["q"], Returned::One(&[Length::Joints, Length::Of(6), N])),
    promise("joint_variables", &["q"], Returned::One(&[Length::Joints])).not_of_every_arm(),
    promise("inertia_matrix", &["q"], Returned::One(SQUARE)).with_parameters(),
    promise("coriolis_matrix", &["q", "dq"], Returned::One(SQUARE)).with_parameters(),
    promise("gravity", &["g0", "q"], Returned::One(VECTOR)).with_parameters(),
    promise("friction", &["dq"], Returned::One(VECTOR)).with_parameters(),
    promise("load_friction", &["g0", "q", "dq"], Returned::One(VECTOR)).with_parameters().not_of_every_arm(),
    promise(
        "equations_of_motion",
        &["g0", "q", "dq"],
        Returned::Fields("EquationsOfMotion", &[("inertia", SQUARE), ("coriolis", SQUARE), ("gravity", VECTOR)]),
    )
    .with_parameters(),
    promise("inverse_dynamics", &["g0", "q", "dq", "ddq"], Returned::One(VECTOR)).with_parameters(),
    promise("forward_dynamics", &["g0", "q", "dq", "tau"], Returned::One(VECTOR)).with_parameters(),
    promise("regressor", &["g0", "q", "dq", "dqr", "ddqr"], Returned::One(&[N, Length::Parameters])),
    promise("known_torque", &["g0", "q", "dq", "dqr", "ddqr"], Returned::One(VECTOR)),
    promise("kinetic_energy", &["q", "dq"], Returned::One(&[])).with_parameters(),
    promise("potential_energy", &["g0", "q"], Returned::One(&[])).with_parameters(),
    promise("center_of_mass", &["q"], Returned::One(&[Length::Of(3)])).with_parameters().not_of_every_arm(),
    promise("momentum", &["q", "dq"], Returned::One(VECTOR)),
    promise("coriolis_transpose_times", &["q", "dq"], Returned::One(VECTOR)),
    promise(BASE_REGRESSOR, &["g0", "q", "dq", "ddq"], Returned::One(&[N, Length::BaseParameters])),
    promise("operational_inertia", &["q"], Returned::One(&[Length::Task, Length::Task])).not_of_every_arm().of_an_end_effector(),
    promise("inverse_dynamics_derivatives", &["g0", "q", "dq", "ddq"], Returned::List(&[SQUARE, SQUARE])),
    promise("forward_dynamics_derivatives", &["g0", "q", "dq", "tau"], Returned::List(&[SQUARE, SQUARE, SQUARE])),
];

impl Promise {
    /// The promise for a function name, and whether the name is the form with parameters. The name of an end effector may precede that of a
    /// function of an end effector.
    pub fn of(name: &str) -> Option<(&'static Promise, bool)> {
        let plain = PROMISES.iter().find(|p| p.name == name).map(|p| (p, false));
        let base = name.strip_suffix("_with");
        let of_tip = |p: &&Promise| p.of_tip && name.strip_suffix(p.name).is_some_and(|tip| tip.len() > 1 && tip.ends_with('_'));
        plain
            .or_else(|| PROMISES.iter().find(|p| p.parameters && Some(p.name) == base).map(|p| (p, true)))
            .or_else(|| PROMISES.iter().find(of_tip).map(|p| (p, false)))
    }

    /// Names of the functions that every module must have, with these beginnings for those of end effectors: one that is empty, or names.
    pub fn required(tips: &[String]) -> Vec<String> {
        PROMISES.iter().filter(|promise| promise.required).flat_map(|promise| promise.names(tips)).collect()
    }

    /// Names of the functions that an arm may lack.
    pub fn optional(tips: &[String]) -> impl Iterator<Item = String> + use<'_> {
        PROMISES.iter().filter(|promise| !promise.required).flat_map(|promise| promise.names(tips))
    }

    /// The names of the function and of its form with parameters.
    pub(crate) fn names(&self, tips: &[String]) -> Vec<String> {
        let with = self.parameters.then(|| format!("{}_with", self.name));
        match self.of_tip {
            true => tips.iter().map(|tip| format!("{tip}{}", self.name)).collect(),
            false => [self.name.to_string()].into_iter().chain(with).collect(),
        }
    }
}

/// Values of all functions by name.
pub type Values<E> = BTreeMap<String, Vec<E>>;

/// A random state with the required values of each function there, and the data for base parameters.
#[derive(Clone, Debug)]
pub struct Reference<E> {
    /// The state, with a random parameter vector.
    pub state: State<E>,
    /// Values by function.
    pub values: Values<E>,
    /// Another configuration with the same parameters, and its potential energy; with base parameters U is only defined up to a constant.
    pub elsewhere: Option<(State<E>, E)>,
    /// The nominal parameter vector, if it follows from the bodies: for standard and for base parameters.
    pub nominal: Option<Vec<E>>,
    /// Whether the torques by Lagrange and by Newton and Euler agree.
    pub two_derivations_agree: bool,
    /// The permitted divisors, if wanted: at the state, and at another state with other parameters.
    pub pivots: Option<(Pivots<E>, State<E>, Pivots<E>)>,
}

/// Computes the quantities of an arm; returns whether its torques by Newton and Euler agree.
fn quantities<E: Element>(arm: &Arm<E>, state: &State<E>, values: &mut Values<E>, suffix: &str) -> Option<bool> {
    let parts = Parts {
        b: inertia_matrix(arm, state),
        c: coriolis_matrix(&inertia_derivatives(arm, state), &state.dq, &arm.half()),
        g: gravity(arm, state),
        f: friction(arm, state, &state.dq),
        u: potential_energy(arm, state),
    };
    let without_friction = of_parts(arm, state, parts, values, suffix)?;
    let pose = Pose::new(arm, state);
    let motion = Motion { rates: state.dq.clone(), accelerations: state.ddq.clone(), gravity: arm.gravity.clone() };
    let torques = ArmMotion::new(arm, &pose, motion).torques();
    let torques: Vec<E> = torques.iter().zip(spring_torques(arm, &state.q)).map(|(a, b)| a.plus(&b)).collect();
    Some(torques == without_friction)
}

/// The quantities that follow from these parts, with torques without friction.
fn of_parts<E: Element>(arm: &Arm<E>, state: &State<E>, parts: Parts<E>, values: &mut Values<E>, suffix: &str) -> Option<Vec<E>> {
    let mut put = |name: &str, value: Vec<E>| values.insert(format!("{name}{suffix}"), value);
    let (half, Parts { b, c, g, f, u }) = (arm.half(), parts);
    let sum = |a: &[E], b: &[E]| -> Vec<E> { a.iter().zip(b).map(|(a, b)| a.plus(b)).collect() };
    let mut rest = sum(&sum(&times_vector(&c, &state.dq), &f), &g);
    if let Some(load) = load_friction(arm, state, &g) {
        rest = sum(&rest, &load);
        put("load_friction", load);
    }
    let without_friction = sum(&sum(&times_vector(&b, &state.ddq), &times_vector(&c, &state.dq)), &g);
    let momentum = times_vector(&b, &state.dq);
    let kinetic = state.dq.iter().zip(&momentum).fold(arm.zero.clone(), |t, (rate, p)| t.plus(&rate.times(p))).times(&half);
    let right: Vec<E> = state.tau.iter().zip(&rest).map(|(tau, rest)| tau.minus(rest)).collect();
    let forward = accelerations(&b, &right)?;

    put("inertia_matrix", b.concat());
    put("coriolis_matrix", c.concat());
    put("gravity", g.clone());
    put("friction", f);
    put("equations_of_motion", [b.concat(), c.concat(), g].concat());
    put("inverse_dynamics", sum(&times_vector(&b, &state.ddq), &rest));
    put("forward_dynamics", forward.clone());
    put("kinetic_energy", vec![kinetic]);
    put("potential_energy", vec![u]);
    put("momentum", momentum);
    if let Some(point) = center_of_mass(arm, state) {
        put("center_of_mass", point);
    }
    let transposed: Vec<Vec<E>> = (0..arm.dof()).map(|i| c.iter().map(|row| row[i].clone()).collect()).collect();
    put("coriolis_transpose_times", times_vector(&transposed, &state.dq));
    Some(without_friction)
}

/// Σ m.
fn mass<E: Element>(arm: &Arm<E>) -> E {
    let links = arm.joints.iter().map(|joint| &joint.link.mass);
    let rotors = arm.joints.iter().filter_map(|joint| joint.motor.as_ref()).map(|motor| &motor.mass);
    let load = arm.tips.iter().filter_map(|tip| tip.payload.as_ref()).map(|body| &body.mass);
    links.chain(rotors).chain(load).fold(arm.zero.clone(), |sum, mass| sum.plus(mass))
}

/// Σ m p / Σ m: the numerator is -U for unit gravity along an axis. `None` without mass.
fn center_of_mass<E: Element>(arm: &Arm<E>, state: &State<E>) -> Option<Vec<E>> {
    let total = mass(arm);
    let along = |axis: usize| {
        let mut falling = arm.clone();
        falling.joints.iter_mut().for_each(|joint| joint.stiffness = arm.zero.clone());
        falling.gravity = [0, 1, 2].map(|i| if i == axis { arm.one.clone() } else { arm.zero.clone() });
        potential_energy(&falling, state).negated().over(&total)
    };
    (0..3).map(along).collect()
}

/// The variable of a torque derivative.
#[derive(Clone, Copy, PartialEq, Eq)]
enum By {
    Variables,
    Rates,
}

/// ∂τ/∂q or ∂τ/∂q̇ row by row, by dual numbers through the Newton-Euler method.
fn torque_derivatives<E: Element>(arm: &Arm<E>, state: &State<E>, by: By) -> Vec<Vec<E>> {
    let n = arm.dof();
    let moving_arm = arm.map(&|e| Dual::constant(e));
    let still = vec![arm.zero.clone(); n];
    let columns: Vec<Vec<E>> = along_joints(arm, &|unit| {
        let state = match by {
            By::Variables => state.moving(unit, &still),
            By::Rates => state.moving(&still, unit),
        };
        let pose = Pose::new(&moving_arm, &state);
        let motion = Motion { rates: state.dq.clone(), accelerations: state.ddq.clone(), gravity: moving_arm.gravity.clone() };
        let torques = ArmMotion::new(&moving_arm, &pose, motion).torques();
        let friction = friction(&moving_arm, &state, &state.dq);
        let springs = spring_torques(&moving_arm, &state.q);
        let rates = torques.iter().zip(friction).zip(springs).map(|((t, f), s)| t.plus(&f).plus(&s).rate);
        let of_load = has_load_friction(arm).then(|| load_friction(&moving_arm, &state, &gravity(&moving_arm, &state))).flatten();
        match of_load {
            Some(load) => rates.zip(load).map(|(rate, load)| rate.plus(&load.rate)).collect(),
            None => rates.collect(),
        }
    });
    (0..n).map(|i| columns.iter().map(|column| column[i].clone()).collect()).collect()
}

fn identity<E: Element>(arm: &Arm<E>, n: usize) -> Vec<Vec<E>> {
    (0..n).map(|i| (0..n).map(|j| if i == j { arm.one.clone() } else { arm.zero.clone() }).collect()).collect()
}

/// J B^-1 J' for these rows of the geometric Jacobian.
fn mobility<E: Element>(jacobian: &[E], inverse: &[Vec<E>], task: &[usize]) -> Vec<Vec<E>> {
    let n = inverse.len();
    let rows: Vec<&[E]> = task.iter().map(|&row| &jacobian[row * n..(row + 1) * n]).collect();
    let dot = |a: &[E], b: &[E]| a.iter().zip(b).map(|(a, b)| a.times(b)).reduce(|a, b| a.plus(&b)).expect("at least one joint");
    let column = |j: usize| -> Vec<E> { inverse.iter().map(|row| row[j].clone()).collect() };
    let half_way = |row: &&[E]| -> Vec<E> { (0..n).map(|j| dot(row, &column(j))).collect() };
    rows.iter().map(half_way).map(|along| rows.iter().map(|row| dot(&along, row)).collect()).collect()
}

/// The permitted divisors at a state, as pivots.
fn pivots<E: Element>(arm: &Arm<E>, run_time: Option<&Arm<E>>, state: &State<E>) -> Pivots<E> {
    let b = inertia_matrix(arm, state);
    let inverse = solve(&b, &identity(arm, arm.dof()));
    let of_tasks = inverse.iter().flat_map(|inverse| {
        let pose = Pose::new(arm, state);
        let of_task = move |(number, tip): (usize, &Tip<E>)| {
            (Matrix::Mobility(number), mobility(&pose.geometric_jacobian(number, tip.link), inverse, &tip.task))
        };
        arm.tips.iter().enumerate().map(of_task)
    });
    let of_tasks: Vec<_> = of_tasks.collect();
    let with = run_time.map(|arm| (Matrix::InertiaWith, inertia_matrix(arm, state)));
    let mass = Some((Matrix::Mass, vec![vec![mass(arm)]]));
    let mass_with = run_time.map(|arm| (Matrix::MassWith, vec![vec![self::mass(arm)]]));
    let others = [Some((Matrix::Inertia, b)), with].into_iter().chain(of_tasks.into_iter().map(Some)).chain([mass, mass_with]);
    Pivots::of(others.flatten().collect(), arm.tips.iter().map(|tip| tip.prefix.clone()).collect())
}

/// The derivatives of the dynamics, and the inertia in the task rows if the arm moves these independently.
fn derivatives_and_tasks<E: Element>(arm: &Arm<E>, state: &State<E>, values: &mut Values<E>) -> Option<()> {
    let n = arm.dof();
    let b = inertia_matrix(arm, state);
    let inverse = solve(&b, &identity(arm, n))?;
    let product = |a: &[Vec<E>], b: &dyn Fn(usize, usize) -> E, columns: usize| -> Vec<Vec<E>> {
        a.iter()
            .map(|row| {
                (0..columns)
                    .map(|j| row.iter().enumerate().fold(arm.zero.clone(), |sum, (k, x)| sum.plus(&x.times(&b(k, j)))))
                    .collect()
            })
            .collect()
    };
    for Tip { prefix, task, .. } in &arm.tips {
        let mobility = mobility(&values[&format!("{prefix}geometric_jacobian")], &inverse, task);
        if let Some(inertia) = solve(&mobility, &identity(arm, task.len())) {
            values.insert(format!("{prefix}operational_inertia"), inertia.concat());
        }
    }
    let (by_q, by_dq) = (torque_derivatives(arm, state, By::Variables), torque_derivatives(arm, state, By::Rates));
    values.insert("inverse_dynamics_derivatives".into(), [by_q.concat(), by_dq.concat()].concat());
    let mut accelerated = state.clone();
    accelerated.ddq.clone_from(&values["forward_dynamics"]);
    // B ddq does not depend on rates, so the derivatives by rates are those from above.
    let by_q = torque_derivatives(arm, &accelerated, By::Variables);
    let negative: Vec<Vec<E>> = inverse.iter().map(|row| row.iter().map(Element::negated).collect()).collect();
    let by_q = product(&negative, &|k, j| by_q[k][j].clone(), n);
    let by_dq = product(&negative, &|k, j| by_dq[k][j].clone(), n);
    values.insert("forward_dynamics_derivatives".into(), [by_q.concat(), by_dq.concat(), inverse.concat()].concat());
    Some(())
}

fn kinematics<E: Element>(arm: &Arm<E>, state: &State<E>, values: &mut Values<E>) {
    let pose = Pose::new(arm, state);
    let frames = pose.links.iter().flat_map(|frame| pose.homogeneous(frame, &arm.one)).collect();
    values.insert("link_frames".into(), frames);
    if arm.coupling.is_some() {
        values.insert("joint_variables".into(), arm.joint_variables(&state.q));
    }
    let of_link = |(i, link): (usize, &Frame<E>)| {
        let columns = pose.jacobian(Some(i), &link.origin);
        let rows = |of: fn(&(Vector3<E>, Vector3<E>)) -> &Vector3<E>| -> Vec<E> {
            (0..3).flat_map(|row| columns.iter().map(move |column| of(column)[row].clone())).collect()
        };
        [rows(|column| &column.0), rows(|column| &column.1)].concat()
    };
    values.insert("link_jacobians".into(), pose.links.iter().enumerate().flat_map(of_link).collect());
    let moving = arm.map(&|e| Dual::constant(e));
    let along = state.moving(&state.dq, &vec![arm.zero.clone(); arm.dof()]);
    let moving = Pose::new(&moving, &along);
    for (number, Tip { prefix, link, .. }) in arm.tips.iter().enumerate() {
        values.insert(format!("{prefix}direct_kinematics"), pose.homogeneous(&pose.tools[number], &arm.one));
        values.insert(format!("{prefix}geometric_jacobian"), pose.geometric_jacobian(number, *link));
        let rates = moving.geometric_jacobian(number, *link).into_iter().map(|entry| entry.rate);
        values.insert(format!("{prefix}geometric_jacobian_dot"), rates.collect());
    }
}

/// The wanted parts of a reference.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// The method for functions with run-time base parameters.
    pub base: BaseParameters,
    /// Whether to compute the permitted divisors.
    pub pivots: bool,
}

/// Base parameters follow from the standard ones by a matrix, the solution of a system of equations. It is the identity on the standard
/// parameters in their names: an arm whose other parameters are 0 has its standard parameters as base parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BaseParameters {
    /// From the solved matrix.
    Solved,
    /// Independent of the standard ones; suitable for bounds on degrees.
    Free,
    /// The standard parameters of an arm whose others are 0.
    Kept,
    /// Omitted.
    LeftOut,
}

impl<E: Element> Reference<E> {
    /// The reference at a random state of an arithmetic.
    pub fn new<K: Arithmetic<Element = E>>(
        arithmetic: &mut K,
        manipulator: &Manipulator,
        vector: &Vector,
        wanted: Wanted,
    ) -> Result<Reference<E>, String> {
        let decays = manipulator.coordinates().into_iter().map(|of| of.joint.decay_velocity().is_some());
        let state = State::draw(arithmetic, &Angles::of(manipulator)).with_decays(arithmetic, decays);
        let state = state.with_gravity(arithmetic, manipulator.gravity_is_argument);
        Reference::at(arithmetic, manipulator, vector, state, wanted)
    }

    /// The reference at a state; draws an empty parameter vector.
    pub fn at<K: Arithmetic<Element = E>>(
        arithmetic: &mut K,
        manipulator: &Manipulator,
        vector: &Vector,
        mut state: State<E>,
        wanted: Wanted,
    ) -> Result<Reference<E>, String> {
        let nominal_values = Arm::nominal(arithmetic, manipulator).ok_or_else(divided)?;
        let arm = Arm::new(arithmetic, manipulator, &nominal_values).ok_or_else(divided)?.under(&state.g0);
        let n = arm.dof();
        state = arm.with_friction(state);
        let mut values = Values::new();
        kinematics(&arm, &state, &mut values);
        if manipulator.is_massless() {
            // Without accelerations, only the equations of kinematics apply.
            let none = || Pivots::of(Vec::new(), Vec::new());
            let pivots = wanted.pivots.then(|| (none(), State::draw(arithmetic, &arm.angles), none()));
            return Ok(Reference { state, values, elsewhere: None, nominal: None, two_derivations_agree: true, pivots });
        }
        let mut agree = quantities(&arm, &state, &mut values, "").ok_or_else(singular)?;
        derivatives_and_tasks(&arm, &state, &mut values).ok_or_else(singular)?;

        let Linear { columns, known, run_time, other, nominal, elsewhere } = match vector {
            Vector::Names(ids) => of_names(arithmetic, manipulator, &arm, &nominal_values, ids, &mut state, wanted)?,
            Vector::Standard(all) => of_standard(arithmetic, &arm, all, &mut state, wanted)?,
            Vector::Base(base, all) => of_base(arithmetic, &arm, (base, all), &mut state, &mut values, wanted)?,
        };
        let y = (0..n).flat_map(|i| columns.iter().map(move |column| column[i].clone())).collect();
        values.insert("regressor".into(), y);
        values.insert("known_torque".into(), known);
        if let Some(arm) = &run_time {
            agree &= quantities(arm, &state, &mut values, "_with").ok_or_else(singular)?;
        }
        if matches!(vector, Vector::Base(..)) {
            // The total mass does not follow from base parameters.
            values.remove("center_of_mass_with");
        }
        let pivots = wanted.pivots.then(|| {
            let (other, pi) = other.unzip();
            let drawn = State::draw(arithmetic, &arm.angles).with_gravity(arithmetic, manipulator.gravity_is_argument);
            let there = State { pi: pi.unwrap_or_default(), ..drawn };
            let at = |run_time: Option<&Arm<E>>, state: &State<E>| pivots(&arm, run_time, state);
            (at(run_time.as_ref(), &state), there.clone(), at(other.as_ref(), &there))
        });
        Ok(Reference { state, values, elsewhere, nominal, two_derivations_agree: agree, pivots })
    }
}

fn divided() -> String {
    "a constant of the description divides by zero here".into()
}

fn singular() -> String {
    "the inertia matrix is singular at a random state".into()
}

/// The torques of the four-argument form as a function of a parameter vector, with further data of the vector.
struct Linear<E> {
    /// Columns of the regressor.
    columns: Vec<Vec<E>>,
    /// The torque without any parameter.
    known: Vec<E>,
    /// The arm with the parameters of the state.
    run_time: Option<Arm<E>>,
    /// The arm with other parameters, if pivots are wanted.
    other: Option<(Arm<E>, Vec<E>)>,
    /// The nominal values.
    nominal: Option<Vec<E>>,
    /// Another configuration with the same parameters, and its potential energy.
    elsewhere: Option<(State<E>, E)>,
}

fn draws<K: Arithmetic>(arithmetic: &mut K, count: usize) -> Vec<K::Element> {
    (0..count).map(|_| arithmetic.draw()).collect()
}

/// Named quantities of the description: columns are differences, because the torques are affine in them.
fn of_names<E: Element, K: Arithmetic<Element = E>>(
    arithmetic: &mut K,
    manipulator: &Manipulator,
    arm: &Arm<E>,
    names: &[E],
    ids: &[usize],
    state: &mut State<E>,
    wanted: Wanted,
) -> Result<Linear<E>, String> {
    if state.pi.is_empty() {
        state.pi = draws(arithmetic, ids.len());
    }
    let other = wanted.pivots.then(|| draws(arithmetic, ids.len()));
    let gravity = state.g0.clone();
    let at = |pi: &[E]| -> Result<Arm<E>, String> {
        let mut names = names.to_vec();
        ids.iter().zip(pi).for_each(|(&id, value)| names[id] = value.clone());
        Ok(Arm::new(arithmetic, manipulator, &names).ok_or_else(divided)?.under(&gravity))
    };
    let zero = vec![arm.zero.clone(); ids.len()];
    let known = reference_torques(&at(&zero)?, state);
    let mut columns = Vec::new();
    for k in 0..ids.len() {
        let mut unit = zero.clone();
        unit[k] = arm.one.clone();
        let torques = reference_torques(&at(&unit)?, state);
        columns.push(torques.iter().zip(&known).map(|(a, b)| a.minus(b)).collect::<Vec<E>>());
    }
    let other = other.map(|pi| Ok::<_, String>((at(&pi)?, pi))).transpose()?;
    let run_time = Some(at(&state.pi)?);
    Ok(Linear { columns, known, run_time, other, nominal: None, elsewhere: None })
}

/// All standard parameters.
fn of_standard<E: Element, K: Arithmetic<Element = E>>(
    arithmetic: &mut K,
    arm: &Arm<E>,
    all: &[Standard],
    state: &mut State<E>,
    wanted: Wanted,
) -> Result<Linear<E>, String> {
    if state.pi.is_empty() {
        state.pi = draws(arithmetic, all.len());
    }
    let other = wanted.pivots.then(|| draws(arithmetic, all.len()));
    let at = |pi: &[E]| with_standard(arm, all, pi).ok_or_else(divided);
    Ok(Linear {
        columns: standard_columns(arm, state, all, LinkFrames::Described),
        known: known_torque(arm, state, all)?,
        run_time: Some(at(&state.pi)?),
        other: other.map(|pi| Ok::<_, String>((at(&pi)?, pi))).transpose()?,
        nominal: Some(all.iter().map(|parameter| parameter.value(arm)).collect()),
        elsewhere: None,
    })
}

/// Base parameters, with the standard ones in their names.
fn of_base<E: Element, K: Arithmetic<Element = E>>(
    arithmetic: &mut K,
    arm: &Arm<E>,
    (base, all): (&[(Standard, bool)], &[Standard]),
    state: &mut State<E>,
    values: &mut Values<E>,
    wanted: Wanted,
) -> Result<Linear<E>, String> {
    let kept: Vec<Standard> = base.iter().map(|(parameter, _)| *parameter).collect();
    let columns = standard_columns(arm, state, &kept, LinkFrames::Joint);
    let known = known_torque(arm, state, all)?;
    let mut linear = Linear { columns, known, run_time: None, other: None, nominal: None, elsewhere: None };
    if wanted.base == BaseParameters::LeftOut {
        return Ok(linear);
    }
    // Needs the potential energy at another configuration, once the parameters are known.
    let elsewhere = |arithmetic: &mut K, state: &State<E>, energy: &dyn Fn(&State<E>) -> E| {
        let mut there = State::draw(arithmetic, &arm.angles);
        there.pi.clone_from(&state.pi);
        // The constant of the energy is one for each gravity.
        there.g0.clone_from(&state.g0);
        let energy = energy(&there);
        Some((there, energy))
    };
    if wanted.base == BaseParameters::Kept {
        state.pi = draws(arithmetic, kept.len());
        let pi = state.pi.clone();
        let alone = KeptAlone { arm, kept: &kept, all, pi: &pi };
        of_parts(arm, state, alone.parts(state), values, "_with").ok_or_else(singular)?;
        linear.elsewhere = elsewhere(arithmetic, state, &|there| alone.potential_energy(there));
        return Ok(linear);
    }
    let phi = draws(arithmetic, all.len());
    state.pi = if wanted.base == BaseParameters::Solved {
        let map = base_map(arithmetic, arm, &kept, all, !state.g0.is_empty())?;
        check_names(&map, base, all, arm)?;
        let standard: Vec<E> = all.iter().map(|parameter| parameter.value(arm)).collect();
        linear.nominal = Some(times_vector(&map, &standard));
        if wanted.pivots {
            let phi = draws(arithmetic, all.len());
            linear.other = Some((with_standard(arm, all, &phi).ok_or_else(divided)?, times_vector(&map, &phi)));
        }
        times_vector(&map, &phi)
    } else {
        draws(arithmetic, base.len())
    };
    let run_time = with_standard(arm, all, &phi).ok_or_else(divided)?;
    linear.elsewhere = elsewhere(arithmetic, state, &|there| potential_energy(&run_time, there));
    linear.run_time = Some(run_time);
    Ok(linear)
}

/// The torque without the standard parameters: from the masses of rotors.
fn known_torque<E: Element>(arm: &Arm<E>, state: &State<E>, all: &[Standard]) -> Result<Vec<E>, String> {
    let none = vec![arm.zero.clone(); all.len()];
    let bare = with_standard(arm, all, &none).ok_or("an arm without bodies")?;
    Ok(reference_torques(&bare, state))
}

/// Checks that a base parameter without R in its name equals that standard parameter alone.
fn check_names<E: Element>(map: &[Vec<E>], base: &[(Standard, bool)], all: &[Standard], arm: &Arm<E>) -> Result<(), String> {
    for (row, (parameter, carries)) in map.iter().zip(base) {
        let alone =
            row.iter().zip(all).all(|(entry, column)| if column == parameter { *entry == arm.one } else { entry.is_zero() });
        if alone == *carries {
            let name = parameter.name();
            return Err(if alone {
                format!("base parameter `{name}R` carries no other: its name is `{name}`")
            } else {
                format!("base parameter `{name}` carries others: its name is `{name}R`")
            });
        }
    }
    Ok(())
}
