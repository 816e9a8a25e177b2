//! The parameter vector: what its entries are, the arm with given entries, and the regressor, column by column.
//!
//! Standard parameters are ten per link in its link frame, then what the description gives of rotors and friction, then ten of the payload.
//! Base parameters are named after standard ones, those of links in their *joint frames*; a name that ends in R carries others with it.
//! The matrix M of pi_base = M phi_standard is found from Y_standard = Y_base M at random states.

use armgen_codegen::manipulator::{Manipulator, RegressorChoice};

use super::arm::{Arm, Body};
use super::lagrange::friction;
use super::newton_euler::{body, ten, Carrier, Reference};
use super::pose::Pose;
use super::state::State;
use super::vector::solve;
use crate::arithmetic::{Arithmetic, Element};

/// A standard parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Standard {
    /// One of the ten of a link.
    Link(usize, usize),
    /// Inertia of a joint's rotor.
    RotorInertia(usize),
    /// Viscous friction at a joint's rotor.
    RotorViscous(usize),
    /// Viscous friction at a joint.
    Viscous(usize),
    /// Coulomb friction at a joint.
    Coulomb(usize),
    /// One of the ten of the payload.
    Payload(usize),
}

const TEN: [&str; 10] = ["m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz"];

impl Standard {
    /// All of an arm, in the order of the format.
    pub fn all(manipulator: &Manipulator) -> Vec<Standard> {
        let n = manipulator.joints.len();
        let mut all: Vec<Standard> = (0..n).flat_map(|i| (0..10).map(move |k| Standard::Link(i, k))).collect();
        for (i, joint) in manipulator.joints.iter().enumerate() {
            let motor = joint.motor.as_ref();
            let given = [
                (motor.is_some_and(|m| m.inertia.is_some()), Standard::RotorInertia(i)),
                (motor.is_some_and(|m| m.viscous.is_some()), Standard::RotorViscous(i)),
                (joint.viscous.is_some(), Standard::Viscous(i)),
                (joint.coulomb.is_some(), Standard::Coulomb(i)),
            ];
            all.extend(given.iter().filter(|(given, _)| *given).map(|(_, parameter)| *parameter));
        }
        if manipulator.payload.is_some() {
            all.extend((0..10).map(Standard::Payload));
        }
        all
    }

    /// Its name.
    pub fn name(self) -> String {
        match self {
            Standard::Link(i, k) => format!("{}{}", TEN[k], i + 1),
            Standard::RotorInertia(i) => format!("Im{}", i + 1),
            Standard::RotorViscous(i) => format!("Fm{}", i + 1),
            Standard::Viscous(i) => format!("Fv{}", i + 1),
            Standard::Coulomb(i) => format!("Fc{}", i + 1),
            Standard::Payload(k) => format!("{}p", TEN[k]),
        }
    }

    /// Its value in an arm.
    pub fn value<E: Element>(self, arm: &Arm<E>) -> E {
        let motor = |i: usize| arm.joints[i].motor.as_ref();
        match self {
            Standard::Link(i, k) => ten(&arm.joints[i].link)[k].clone(),
            Standard::RotorInertia(i) => motor(i).map_or(arm.zero.clone(), |m| m.inertia.clone()),
            Standard::RotorViscous(i) => motor(i).map_or(arm.zero.clone(), |m| m.viscous.clone()),
            Standard::Viscous(i) => arm.joints[i].viscous.clone(),
            Standard::Coulomb(i) => arm.joints[i].coulomb.clone(),
            Standard::Payload(k) => arm.payload.as_ref().map_or(arm.zero.clone(), |p| ten(p)[k].clone()),
        }
    }
}

/// The arm with other standard parameters; `None` if a body with moments has no mass.
pub fn with_standard<E: Element>(arm: &Arm<E>, columns: &[Standard], values: &[E]) -> Option<Arm<E>> {
    let mut arm = arm.clone();
    let (n, zero) = (arm.dof(), arm.zero.clone());
    let mut tens = vec![vec![zero.clone(); 10]; n + 1];
    for (column, value) in columns.iter().zip(values) {
        match *column {
            Standard::Link(i, k) => tens[i][k] = value.clone(),
            Standard::Payload(k) => tens[n][k] = value.clone(),
            Standard::RotorInertia(i) => arm.joints[i].motor.as_mut()?.inertia = value.clone(),
            Standard::RotorViscous(i) => arm.joints[i].motor.as_mut()?.viscous = value.clone(),
            Standard::Viscous(i) => arm.joints[i].viscous = value.clone(),
            Standard::Coulomb(i) => arm.joints[i].coulomb = value.clone(),
        }
    }
    let nothing = Body { mass: zero.clone(), com: arm.nothing(), inertia: [0; 3].map(|_| arm.nothing()) };
    let of = |ten: &[E]| if ten.iter().all(Element::is_zero) { Some(nothing.clone()) } else { body(ten) };
    let load = tens.pop()?;
    for (joint, ten) in arm.joints.iter_mut().zip(&tens) {
        joint.link = of(ten)?;
    }
    if arm.payload.is_some() {
        arm.payload = Some(of(&load)?);
    }
    Some(arm)
}

/// In which frame the ten parameters of a link are meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkFrames {
    /// The link frame of the description.
    Described,
    /// The joint frame, whose z axis is the joint axis.
    Joint,
}

/// Y(q, dq, dqr, ddqr) for some standard parameters, column by column: the torques of a unit of each.
pub fn standard_columns<E: Element>(arm: &Arm<E>, state: &State<E>, columns: &[Standard], frames: LinkFrames) -> Vec<Vec<E>> {
    let described = Pose::new(arm, state);
    // The frames of bodies alone: places and axes of rotors, and the load's frame, stay what the description says.
    let pose = match frames {
        LinkFrames::Described => described.clone(),
        LinkFrames::Joint => described.clone().with_links_in_joint_frames(),
    };
    let reference = Reference::new(arm, &pose, &state.dq, &state.dqr, &state.ddqr);
    let of_rotors = Reference::new(arm, &described, &state.dq, &state.dqr, &state.ddqr);
    let unit = |k: usize| -> Vec<E> { (0..10).map(|i| if i == k { arm.one.clone() } else { arm.zero.clone() }).collect() };
    let single = |i: usize, value: E| {
        let mut column = vec![arm.zero.clone(); arm.dof()];
        column[i] = value;
        column
    };
    columns
        .iter()
        .map(|column| match *column {
            Standard::Link(i, k) => {
                let unit = unit(k);
                reference.torques(&|moving, torques| moving.add_body(Carrier::Link(i), &unit, torques))
            }
            Standard::Payload(k) => {
                let unit = unit(k);
                of_rotors.torques(&|moving, torques| moving.add_body(Carrier::Tool, &unit, torques))
            }
            Standard::RotorInertia(i) => of_rotors.torques(&|moving, torques| moving.add_rotor_inertia(i, &arm.one, torques)),
            Standard::RotorViscous(i) => {
                let square = arm.joints[i].motor.as_ref().map_or(arm.zero.clone(), |m| m.ratio.times(&m.ratio));
                single(i, square.times(&state.dqr[i]))
            }
            Standard::Viscous(i) => single(i, state.dqr[i].clone()),
            Standard::Coulomb(i) => single(i, state.signs[i].clone()),
        })
        .collect()
}

/// B ddqr + C(q, dq) dqr + F + g of an arm, friction with dqr and the signs of dq.
pub fn reference_torques<E: Element>(arm: &Arm<E>, state: &State<E>) -> Vec<E> {
    let pose = Pose::new(arm, state);
    let torques = Reference::new(arm, &pose, &state.dq, &state.dqr, &state.ddqr).whole();
    torques.iter().zip(friction(arm, &state.dqr, &state.signs)).map(|(a, b)| a.plus(&b)).collect()
}

/// What the entries of the parameter vector are.
#[derive(Clone, Debug, PartialEq)]
pub enum Vector {
    /// Named quantities of the description, by their numbers.
    Names(Vec<usize>),
    /// All standard parameters.
    Standard(Vec<Standard>),
    /// Base parameters: the standard ones after which they are named, and whether others are carried along; all standard ones.
    Base(Vec<(Standard, bool)>, Vec<Standard>),
}

impl Vector {
    /// The vector of a description. The choice of base parameters is free: it is read from the names in the module.
    pub fn of(manipulator: &Manipulator, names: &[String]) -> Result<Vector, String> {
        match &manipulator.regressor {
            RegressorChoice::Names(ids) => Ok(Vector::Names(ids.iter().map(|id| id.0 as usize).collect())),
            RegressorChoice::Standard => Ok(Vector::Standard(Standard::all(manipulator))),
            RegressorChoice::Base => Ok(Vector::Base(base_parameters(manipulator, names)?, Standard::all(manipulator))),
        }
    }

    /// The names of the entries, where they are not free.
    pub fn names(&self, manipulator: &Manipulator) -> Option<Vec<String>> {
        match self {
            Vector::Names(ids) => Some(ids.iter().map(|&id| manipulator.parameters[id].name.clone()).collect()),
            Vector::Standard(columns) => Some(columns.iter().map(|c| c.name()).collect()),
            Vector::Base(..) => None,
        }
    }
}

/// Base parameters by their names, each with whether it carries others.
pub fn base_parameters(manipulator: &Manipulator, names: &[String]) -> Result<Vec<(Standard, bool)>, String> {
    let all = Standard::all(manipulator);
    let find = |name: &str| all.iter().copied().find(|p| p.name() == name);
    let base = |name: &String| {
        let carrying = || Some((find(name.strip_suffix('R')?)?, true));
        find(name).map(|p| (p, false)).or_else(carrying).ok_or(format!("`{name}` is no base parameter's name"))
    };
    names.iter().map(base).collect()
}

/// The matrix M of pi_base = M phi_standard, row by row; an error if the base columns are not independent or do not span all others.
pub fn base_map<K: Arithmetic>(
    arithmetic: &mut K,
    arm: &Arm<K::Element>,
    base: &[Standard],
    all: &[Standard],
) -> Result<Vec<Vec<K::Element>>, String> {
    let n = arm.dof();
    let states = base.len().div_ceil(n) + 3;
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for _ in 0..states {
        let state = State::draw(arithmetic, n);
        let y = standard_columns(arm, &state, base, LinkFrames::Joint);
        let full = standard_columns(arm, &state, all, LinkFrames::Described);
        for row in 0..n {
            left.push(y.iter().map(|column| column[row].clone()).collect::<Vec<_>>());
            right.push(full.iter().map(|column| column[row].clone()).collect::<Vec<_>>());
        }
    }
    // Rows that make the left side regular, then all rows as a test.
    let mut chosen: Vec<usize> = Vec::new();
    let mut echelon: Vec<(usize, Vec<K::Element>)> = Vec::new();
    for (index, row) in left.iter().enumerate() {
        let mut row = row.clone();
        for (pivot, known) in &echelon {
            let factor = row[*pivot].clone();
            if !factor.is_zero() {
                row.iter_mut().zip(known).for_each(|(x, k)| *x = x.minus(&factor.times(k)));
            }
        }
        let Some(pivot) = row.iter().position(|x| !x.is_zero()) else { continue };
        let inverse = row[pivot].inverse().ok_or("a pivot without an inverse")?;
        row.iter_mut().for_each(|x| *x = x.times(&inverse));
        echelon.push((pivot, row));
        chosen.push(index);
    }
    if chosen.len() < base.len() {
        return Err("the base parameters are not independent: a motion cannot tell them apart".into());
    }
    let a: Vec<Vec<K::Element>> = chosen.iter().map(|&i| left[i].clone()).collect();
    let r: Vec<Vec<K::Element>> = chosen.iter().map(|&i| right[i].clone()).collect();
    let map = solve(&a, &r).ok_or("a regular system without a solution")?;
    for (y, full) in left.iter().zip(&right) {
        for (column, entry) in full.iter().enumerate() {
            let mut sum = arm.zero.clone();
            for (k, y) in y.iter().enumerate() {
                sum = sum.plus(&y.times(&map[k][column]));
            }
            if sum != *entry {
                return Err(format!("the base parameters do not carry the effect of `{}`", all[column].name()));
            }
        }
    }
    Ok(map)
}
