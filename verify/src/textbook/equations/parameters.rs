//! The parameter vector: its entries, the arm with given entries, and the regressor, column by column.
//!
//! Standard parameters are ten per link in its link frame, then those of rotors and friction in the description, then ten of the payload.
//! Base parameters have names of standard parameters, those of links in their *joint frames*; a final R marks a combination.
//! The matrix M of pi_base = M phi_standard follows from Y_standard = Y_base M at random states.

use armgen_description::manipulator::{Manipulator, RegressorChoice};

use super::arm::{Arm, Body, Joint};
use super::lagrange::{friction, spring_energy, spring_torques, Parts};
use super::newton_euler::{body, ten, Carrier, ReferenceMotion};
use super::pose::Pose;
use super::state::State;
use super::vector::{add, dot, scale, solve};
use crate::values::arithmetic::Arithmetic;
use crate::values::element::Element;

/// A standard parameter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Standard {
    /// One of the ten of a link.
    Link(usize, usize),
    /// Inertia of a joint's rotor.
    RotorInertia(usize),
    /// Inertia that acts on a single joint.
    Armature(usize),
    /// Viscous friction at a joint's rotor.
    RotorViscous(usize),
    /// Viscous friction at a joint.
    Viscous(usize),
    /// Coulomb friction at a joint.
    Coulomb(usize),
    /// Constant torque of a joint, independent of its rate.
    Offset(usize),
    /// Cubic friction at a joint.
    Cubic(usize),
    /// Stribeck friction at a joint.
    Stribeck(usize),
    /// Stiffness of a joint's spring.
    Stiffness(usize),
    /// One of the ten of the payload of an end effector, by its number.
    Payload(usize, usize),
}

/// The unit of a parameter, or a unit of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Unit {
    /// kg
    Mass,
    /// kg m
    Moment,
    /// kg m²
    Inertia,
    /// The unit of the parameter with this number.
    Own(usize),
}

const TEN: [&str; 10] = ["m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz"];

impl Standard {
    /// The unit of this parameter, which has this number.
    pub fn unit(self, number: usize) -> Unit {
        match self {
            Standard::Link(_, 0) | Standard::Payload(_, 0) => Unit::Mass,
            Standard::Link(_, 1..=3) | Standard::Payload(_, 1..=3) => Unit::Moment,
            Standard::Link(..) | Standard::Payload(..) => Unit::Inertia,
            _ => Unit::Own(number),
        }
    }

    /// Whether its torque is friction.
    fn is_friction(self) -> bool {
        use Standard::*;
        matches!(self, RotorViscous(_) | Viscous(_) | Coulomb(_) | Offset(_) | Cubic(_) | Stribeck(_))
    }

    /// All parameters of an arm, in the order of the format.
    pub fn all(manipulator: &Manipulator) -> Vec<Standard> {
        let n = manipulator.joints.len();
        let mut all: Vec<Standard> = (0..n).flat_map(|i| (0..10).map(move |k| Standard::Link(i, k))).collect();
        for (i, joint) in manipulator.joints.iter().enumerate() {
            let motor = joint.motor.as_ref();
            let given = [
                (motor.is_some_and(|m| m.inertia.is_some()), Standard::RotorInertia(i)),
                (joint.armature.is_some(), Standard::Armature(i)),
                (motor.is_some_and(|m| m.viscous.is_some()), Standard::RotorViscous(i)),
                (joint.viscous.is_some(), Standard::Viscous(i)),
                (joint.coulomb.is_some(), Standard::Coulomb(i)),
                (joint.offset.is_some(), Standard::Offset(i)),
                (joint.cubic.is_some(), Standard::Cubic(i)),
                (joint.stribeck.is_some(), Standard::Stribeck(i)),
                (joint.spring.is_some(), Standard::Stiffness(i)),
            ];
            all.extend(given.iter().filter(|(given, _)| *given).map(|(_, parameter)| *parameter));
        }
        for load in manipulator.loads() {
            all.extend((0..10).map(|k| Standard::Payload(load.end, k)));
        }
        all
    }

    /// Its name.
    pub fn name(self) -> String {
        match self {
            Standard::Link(i, k) => format!("{}{}", TEN[k], i + 1),
            Standard::RotorInertia(i) => format!("Im{}", i + 1),
            Standard::Armature(i) => format!("Ia{}", i + 1),
            Standard::RotorViscous(i) => format!("Fm{}", i + 1),
            Standard::Viscous(i) => format!("Fv{}", i + 1),
            Standard::Coulomb(i) => format!("Fc{}", i + 1),
            Standard::Offset(i) => format!("F0_{}", i + 1),
            Standard::Cubic(i) => format!("F3_{}", i + 1),
            Standard::Stribeck(i) => format!("Fs{}", i + 1),
            Standard::Stiffness(i) => format!("ks{}", i + 1),
            Standard::Payload(_, k) => format!("{}p", TEN[k]),
        }
    }

    /// The same with the name of the end effector before that of a payload's, where it has a name.
    fn full_name(self, manipulator: &Manipulator) -> String {
        let tip = match self {
            Standard::Payload(tip, _) => manipulator.tips.get(tip),
            _ => None,
        };
        tip.map_or(String::new(), |tip| format!("{}_", tip.name)) + &self.name()
    }

    /// Its value for an arm.
    pub fn value<E: Element>(self, arm: &Arm<E>) -> E {
        let motor = |i: usize| arm.joints[i].motor.as_ref();
        match self {
            Standard::Link(i, k) => ten(&arm.joints[i].link)[k].clone(),
            Standard::RotorInertia(i) => motor(i).map_or(arm.zero.clone(), |m| m.inertia.clone()),
            Standard::Armature(i) => arm.joints[i].armature.clone(),
            Standard::RotorViscous(i) => motor(i).map_or(arm.zero.clone(), |m| m.viscous.clone()),
            Standard::Viscous(i) => arm.joints[i].viscous.clone(),
            Standard::Coulomb(i) => arm.joints[i].coulomb.clone(),
            Standard::Offset(i) => arm.joints[i].offset.clone(),
            Standard::Cubic(i) => arm.joints[i].cubic.clone(),
            Standard::Stribeck(i) => arm.joints[i].stribeck.clone(),
            Standard::Stiffness(i) => arm.joints[i].stiffness.clone(),
            Standard::Payload(tip, k) => arm.tips[tip].payload.as_ref().map_or(arm.zero.clone(), |p| ten(p)[k].clone()),
        }
    }
}

/// The arm with other standard parameters; `None` if a body has moments but no mass.
pub fn with_standard<E: Element>(arm: &Arm<E>, columns: &[Standard], values: &[E]) -> Option<Arm<E>> {
    let mut arm = arm.clone();
    let (n, zero) = (arm.joints.len(), arm.zero.clone());
    let mut tens = vec![vec![zero.clone(); 10]; n + arm.tips.len()];
    for (column, value) in columns.iter().zip(values) {
        match *column {
            Standard::Link(i, k) => tens[i][k] = value.clone(),
            Standard::Payload(tip, k) => tens[n + tip][k] = value.clone(),
            Standard::RotorInertia(i) => arm.joints[i].motor.as_mut()?.inertia = value.clone(),
            Standard::Armature(i) => arm.joints[i].armature = value.clone(),
            Standard::RotorViscous(i) => arm.joints[i].motor.as_mut()?.viscous = value.clone(),
            Standard::Viscous(i) => arm.joints[i].viscous = value.clone(),
            Standard::Coulomb(i) => arm.joints[i].coulomb = value.clone(),
            Standard::Offset(i) => arm.joints[i].offset = value.clone(),
            Standard::Cubic(i) => arm.joints[i].cubic = value.clone(),
            Standard::Stribeck(i) => arm.joints[i].stribeck = value.clone(),
            Standard::Stiffness(i) => arm.joints[i].stiffness = value.clone(),
        }
    }
    let nothing = Body { mass: zero.clone(), com: arm.nothing(), inertia: [0; 3].map(|_| arm.nothing()) };
    let of = |ten: &[E]| if ten.iter().all(Element::is_zero) { Some(nothing.clone()) } else { body(ten) };
    let loads = tens.split_off(n);
    for (joint, ten) in arm.joints.iter_mut().zip(&tens) {
        joint.link = of(ten)?;
    }
    for (tip, load) in arm.tips.iter_mut().zip(&loads).filter(|(tip, _)| tip.payload.is_some()) {
        tip.payload = Some(of(load)?);
    }
    Some(arm)
}

/// The frame for the ten parameters of a link.
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
    // Only bodies move to other frames; positions and axes of rotors, and the load's frame, stay as described.
    let pose = match frames {
        LinkFrames::Described => described.clone(),
        LinkFrames::Joint => described.clone().with_links_in_joint_frames(),
    };
    let reference = ReferenceMotion::new(arm, &pose, &state.dq, &state.dqr, &state.ddqr);
    let of_rotors = ReferenceMotion::new(arm, &described, &state.dq, &state.dqr, &state.ddqr);
    let unit = |k: usize| -> Vec<E> { (0..10).map(|i| if i == k { arm.one.clone() } else { arm.zero.clone() }).collect() };
    let single = |i: usize, value: E| {
        let mut column = vec![arm.zero.clone(); arm.joints.len()];
        column[i] = value;
        arm.of_coordinates(column)
    };
    let state = arm.state_of_joints(state);
    columns
        .iter()
        .map(|column| match *column {
            Standard::Link(i, k) => {
                let unit = unit(k);
                reference.torques(&|moving, torques| moving.add_body(Carrier::Link(i), &unit, torques))
            }
            Standard::Payload(tip, k) => {
                let unit = unit(k);
                of_rotors.torques(&|moving, torques| moving.add_body(Carrier::Tool(tip), &unit, torques))
            }
            Standard::RotorInertia(i) => of_rotors.torques(&|moving, torques| moving.add_rotor_inertia(i, &arm.one, torques)),
            Standard::Armature(i) => single(i, state.ddqr[i].clone()),
            Standard::RotorViscous(i) => {
                let mut column = vec![arm.zero.clone(); arm.joints.len()];
                arm.joints[i].motor.iter().for_each(|motor| motor.add_torque(&motor.spin(&arm.zero, &state.dqr), &mut column));
                arm.of_coordinates(column)
            }
            Standard::Viscous(i) => single(i, state.dqr[i].clone()),
            Standard::Coulomb(i) => single(i, state.directions[i].clone()),
            Standard::Offset(i) => single(i, arm.one.clone()),
            Standard::Cubic(i) => single(i, state.dq[i].times(&state.dq[i]).times(&state.dqr[i])),
            Standard::Stribeck(i) => single(i, state.directions[i].times(&state.stribeck[i])),
            Standard::Stiffness(i) => single(i, state.q[i].minus(&arm.joints[i].rest)),
        })
        .collect()
}

/// An arm with only some standard parameters and links in joint frames: its equations are linear in these and need no centre of mass.
pub struct KeptAlone<'a, E> {
    /// The geometry, and the masses of rotors.
    pub arm: &'a Arm<E>,
    /// The parameters to keep.
    pub kept: &'a [Standard],
    /// All parameters; those not kept are 0.
    pub all: &'a [Standard],
    /// Values of the kept parameters.
    pub pi: &'a [E],
}

impl<E: Element> KeptAlone<'_, E> {
    fn of(&self, parameter: Standard, otherwise: &E) -> E {
        let kept = self.kept.iter().position(|k| *k == parameter).map(|at| &self.pi[at]);
        let zero = self.all.contains(&parameter).then_some(&self.arm.zero);
        kept.or(zero).unwrap_or(otherwise).clone()
    }

    /// The end effectors with payloads.
    fn loaded(&self) -> impl Iterator<Item = usize> + '_ {
        self.arm.tips.iter().enumerate().filter(|(_, tip)| tip.payload.is_some()).map(|(number, _)| number)
    }

    fn ten(&self, of: impl Fn(usize) -> Standard) -> Vec<E> {
        (0..10).map(|k| self.of(of(k), &self.arm.zero)).collect()
    }

    /// B ddqr + C(q, dq) dqr + g.
    fn torques(&self, poses: (&Pose<E>, &Pose<E>), dq: &[E], dqr: &[E], ddqr: &[E]) -> Vec<E> {
        let (described, joint_frames) = poses;
        let of_links = ReferenceMotion::new(self.arm, joint_frames, dq, dqr, ddqr).torques(&|moving, torques| {
            for i in 0..self.arm.joints.len() {
                moving.add_body(Carrier::Link(i), &self.ten(|k| Standard::Link(i, k)), torques);
            }
        });
        let of_others = ReferenceMotion::new(self.arm, described, dq, dqr, ddqr).torques(&|moving, torques| {
            for (i, joint) in self.arm.joints.iter().enumerate() {
                moving.add_rotor_mass(i, torques);
                moving.add_armature(i, &self.of(Standard::Armature(i), &joint.armature), torques);
                if let Some(motor) = &joint.motor {
                    moving.add_rotor_inertia(i, &self.of(Standard::RotorInertia(i), &motor.inertia), torques);
                }
            }
            for tip in self.loaded() {
                moving.add_body(Carrier::Tool(tip), &self.ten(|k| Standard::Payload(tip, k)), torques);
            }
        });
        of_links.iter().zip(&of_others).map(|(a, b)| a.plus(b)).collect()
    }

    /// B, C and g from the torques of unit accelerations and rates.
    pub fn parts(&self, state: &State<E>) -> Parts<E> {
        let (n, zero) = (self.arm.dof(), &self.arm.zero);
        let described = Pose::new(self.arm, state);
        let joint_frames = described.clone().with_links_in_joint_frames();
        let still = vec![zero.clone(); n];
        let torques = |dqr: &[E], ddqr: &[E]| self.torques((&described, &joint_frames), &state.dq, dqr, ddqr);
        let g = torques(&still, &still);
        let unit = |j: usize| -> Vec<E> { (0..n).map(|i| if i == j { self.arm.one.clone() } else { zero.clone() }).collect() };
        let without_gravity = |column: Vec<E>| -> Vec<E> { column.iter().zip(&g).map(|(x, g)| x.minus(g)).collect() };
        let rows = |columns: Vec<Vec<E>>| -> Vec<Vec<E>> {
            (0..n).map(|i| columns.iter().map(|column| column[i].clone()).collect()).collect()
        };
        let b = rows((0..n).map(|j| without_gravity(torques(&still, &unit(j)))).collect());
        let c = rows((0..n).map(|j| without_gravity(torques(&unit(j), &still))).collect());
        let at_joints = self.arm.state_of_joints(state);
        let friction = |(i, joint): (usize, &Joint<E>)| {
            let viscous = self.of(Standard::Viscous(i), &joint.viscous);
            let coulomb = self.of(Standard::Coulomb(i), &joint.coulomb);
            let (offset, cubic) = (self.of(Standard::Offset(i), &joint.offset), self.of(Standard::Cubic(i), &joint.cubic));
            let rate = &at_joints.dq[i];
            let steep = cubic.times(rate).times(rate).times(rate);
            let fading = self.of(Standard::Stribeck(i), &joint.stribeck).times(&at_joints.stribeck[i]);
            viscous.times(rate).plus(&coulomb.plus(&fading).times(&at_joints.directions[i])).plus(&offset).plus(&steep)
        };
        let stiffness = |i: usize, joint: &Joint<E>| self.of(Standard::Stiffness(i), &joint.stiffness);
        let spring = |(i, joint): (usize, &Joint<E>)| stiffness(i, joint).times(&at_joints.q[i].minus(&joint.rest));
        let springs = self.arm.of_coordinates(self.arm.joints.iter().enumerate().map(spring).collect());
        let g = g.iter().zip(springs).map(|(g, s)| g.plus(&s)).collect();
        let mut f: Vec<E> = self.arm.joints.iter().enumerate().map(friction).collect();
        for (i, motor) in self.arm.joints.iter().enumerate().filter_map(|(i, joint)| Some((i, joint.motor.as_ref()?))) {
            let viscous = self.of(Standard::RotorViscous(i), &motor.viscous);
            motor.add_torque(&viscous.times(&motor.spin(zero, &at_joints.dq)), &mut f);
        }
        let f = self.arm.of_coordinates(f);
        Parts { b, c, g, f, u: self.potential_energy(state) }
    }

    /// U(q) = -Σ g0'(m p + R h) + Σ ½ k (q - rest)², with the first moment h in a frame at p.
    pub fn potential_energy(&self, state: &State<E>) -> E {
        let described = Pose::new(self.arm, state);
        let links = (0..self.arm.joints.len()).map(|i| (&described.chosen[i], self.ten(|k| Standard::Link(i, k))));
        let loads = self.loaded().map(|tip| (&described.tools[tip], self.ten(|k| Standard::Payload(tip, k))));
        let of_bodies = links.chain(loads).fold(self.arm.zero.clone(), |sum, (frame, ten)| {
            let h = [1, 2, 3].map(|k| ten[k].clone());
            sum.minus(&dot(&self.arm.gravity, &add(&scale(&ten[0], &frame.origin), &frame.direction(&h))))
        });
        let of_masses = self.arm.joints.iter().filter_map(|joint| joint.motor.as_ref()).fold(of_bodies, |sum, motor| {
            let place = motor.carrier.map_or_else(|| motor.position.clone(), |p| described.links[p].point(&motor.position));
            sum.minus(&motor.mass.times(&dot(&self.arm.gravity, &place)))
        });
        let springs = spring_energy(self.arm, state, |i, joint| self.of(Standard::Stiffness(i), &joint.stiffness));
        of_masses.plus(&springs)
    }
}

/// B ddqr + C(q, dq) dqr + F + g of an arm. Friction uses dqr, the squares of dq and the signs of dq.
pub fn reference_torques<E: Element>(arm: &Arm<E>, state: &State<E>) -> Vec<E> {
    let pose = Pose::new(arm, state);
    let torques = ReferenceMotion::new(arm, &pose, &state.dq, &state.dqr, &state.ddqr).whole();
    let friction = friction(arm, state, &state.dqr);
    let springs = spring_torques(arm, &state.q);
    torques.iter().zip(friction).zip(springs).map(|((a, b), c)| a.plus(&b).plus(&c)).collect()
}

/// The kinds of parameter vectors.
#[derive(Clone, Debug, PartialEq)]
pub enum Vector {
    /// Named quantities of the description, by number.
    Names(Vec<usize>),
    /// All standard parameters.
    Standard(Vec<Standard>),
    /// Base parameters: the standard parameters in their names with a flag for combinations; and all standard parameters.
    Base(Vec<(Standard, bool)>, Vec<Standard>),
}

impl Vector {
    /// The vector of a description. Base parameters are a free choice, read from the names in the module.
    pub fn of(manipulator: &Manipulator, names: &[String]) -> Result<Vector, String> {
        match &manipulator.regressor {
            RegressorChoice::Names(ids) => Ok(Vector::Names(ids.iter().map(|id| id.0 as usize).collect())),
            RegressorChoice::Standard => Ok(Vector::Standard(Standard::all(manipulator))),
            RegressorChoice::Base => Ok(Vector::Base(base_parameters(manipulator, names)?, Standard::all(manipulator))),
        }
    }

    /// The units of the entries.
    pub fn units(&self) -> Vec<Unit> {
        match self {
            Vector::Names(ids) => (0..ids.len()).map(Unit::Own).collect(),
            Vector::Standard(all) => units(all.iter().copied()),
            Vector::Base(base, _) => units(base.iter().map(|(parameter, _)| *parameter)),
        }
    }

    /// The names of the entries, if they are not a free choice.
    pub fn names(&self, manipulator: &Manipulator) -> Option<Vec<String>> {
        match self {
            Vector::Names(ids) => Some(ids.iter().map(|&id| manipulator.parameters[id].name.clone()).collect()),
            Vector::Standard(columns) => Some(columns.iter().map(|c| c.full_name(manipulator)).collect()),
            Vector::Base(..) => None,
        }
    }
}

/// The units of standard parameters.
pub fn units(parameters: impl Iterator<Item = Standard>) -> Vec<Unit> {
    parameters.enumerate().map(|(number, parameter)| parameter.unit(number)).collect()
}

/// Base parameters from their names, each with a flag for combinations.
pub fn base_parameters(manipulator: &Manipulator, names: &[String]) -> Result<Vec<(Standard, bool)>, String> {
    let all = Standard::all(manipulator);
    let find = |name: &str| all.iter().copied().find(|p| p.full_name(manipulator) == name);
    let base = |name: &String| {
        let carrying = || Some((find(name.strip_suffix('R')?)?, true));
        find(name).map(|p| (p, false)).or_else(carrying).ok_or(format!("`{name}` is no base parameter's name"))
    };
    names.iter().map(base).collect()
}

/// The matrix M of pi_base = M phi_standard, row by row, separately for friction and the rest. An error if the base columns are dependent or do
/// not span all others.
pub fn base_map<K: Arithmetic>(
    arithmetic: &mut K,
    arm: &Arm<K::Element>,
    base: &[Standard],
    all: &[Standard],
    gravity_is_argument: bool,
) -> Result<Vec<Vec<K::Element>>, String> {
    let n = arm.dof();
    let states = base.len().div_ceil(n) + 3;
    let (mut left, mut right) = (Vec::new(), Vec::new());
    for _ in 0..states {
        let state = State::draw(arithmetic, &arm.angles)
            .with_decays(arithmetic, arm.decays())
            .with_gravity(arithmetic, gravity_is_argument);
        let state = arm.with_friction(state);

        let arm = arm.clone().under(&state.g0);
        let y = standard_columns(&arm, &state, base, LinkFrames::Joint);
        let full = standard_columns(&arm, &state, all, LinkFrames::Described);
        // Friction and the rest separately: friction is never part of a weight, although both may be constant on a prismatic joint.
        for (row, friction) in (0..n).flat_map(|row| [(row, false), (row, true)]) {
            let part = |columns: &[Vec<K::Element>], of: &[Standard]| {
                let entries = columns.iter().zip(of);
                entries
                    .map(|(column, p)| if p.is_friction() == friction { column[row].clone() } else { arm.zero.clone() })
                    .collect::<Vec<_>>()
            };
            left.push(part(&y, base));
            right.push(part(&full, all));
        }
    }
    // Rows that make the left side regular; then all rows as a test.
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
