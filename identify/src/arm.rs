//! An arm as its identification sees it: torques linear in base parameters, and these in the standard parameters.
//!
//! ```text
//! tau = Y_b(q, dq, ddq) T phi + tau_known,      phi: ten of each link, then rotor inertias
//! ```
//!
//! T and the choice of base parameters are exact, from `armgen-codegen`. Friction is not part of Y_b; `dependent` has the terms that depend on it. What is known is the torque of the masses
//! of rotors, of springs, armatures and of the viscous friction of rotors.

use armgen_codegen::derive::base::base_combinations;
use armgen_codegen::derive::parameters::{nominal, StandardParameter};
use armgen_codegen::exact::{Number, Polynomial};
use armgen_codegen::kinds::JointKind;
use armgen_codegen::manipulator::{Body, Manipulator, PlacedBody, RegressorChoice};
use armgen_codegen::schedule::{self, Options, Selection};
use armgen_codegen::Model;
use armgen_evaluate::{function, Function, Program};
use nalgebra::{DMatrix, DVector, Matrix3, Vector3};

mod apart;

pub use apart::Dependent;

use crate::body::{self, Ten};

/// A joint.
#[derive(Clone, Debug)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// Whether it slides.
    pub slides: bool,
    /// Lowest and highest position, where the file has them.
    pub position: Option<[f64; 2]>,
    /// Highest torque or force; infinite where the file has none.
    pub effort: f64,
    /// Highest rate; infinite where the file has none.
    pub velocity: f64,
    /// Drive gain, N m/A or N/A.
    pub gain: Option<f64>,
    /// Friction of the file; none for what the file does not give.
    pub friction: [Option<f64>; 6],
    /// The velocity of Stribeck friction.
    pub stribeck_velocity: f64,
    /// ratio² times the viscous friction of the rotor.
    rotor_viscous: f64,
    armature: f64,
    stiffness: f64,
    rest: f64,
    /// Whether it has a motor whose inertia is a parameter.
    pub has_rotor: bool,
    /// Inertia of the rotor.
    pub rotor: f64,
}

/// A link: its own body, and the sum of the bodies that are attached to it.
#[derive(Clone, Debug)]
pub struct Link {
    /// Of the file, in the link frame.
    pub own: Ten,
    /// The same as the file gives it: mass, centre of mass, inertia about that in `axes`: xx, xy, yy, xz, yz, zz.
    pub given: [f64; 10],
    /// Of the file, in the link frame; known.
    pub attached: Ten,
    /// Bodies that are attached to it.
    pub attachments: usize,
    /// The origins of its joint frame and of the next one, or of the end effector, in the link frame.
    pub ends: [Vector3<f64>; 2],
    /// The axes in which the file has the inertia, in the link frame.
    pub axes: Matrix3<f64>,
}

/// A base parameter.
#[derive(Clone, Debug)]
pub struct Base {
    /// Its name.
    pub name: String,
    /// The combination of standard parameters.
    pub meaning: String,
}

/// An arm.
#[derive(Debug)]
pub struct Arm {
    /// The robot.
    pub name: String,
    /// Joints from base to tip.
    pub joints: Vec<Joint>,
    /// Their links.
    pub links: Vec<Link>,
    /// Base parameters.
    pub base: Vec<Base>,
    /// Names of the standard parameters.
    pub standard: Vec<String>,
    /// T.
    pub combination: DMatrix<f64>,
    /// What the ten of a load in the end-effector frame add to the base parameters.
    pub load: DMatrix<f64>,
    /// The load of the file.
    pub payload: Option<Ten>,
    /// Joints with a rotor, in the order of phi.
    pub rotors: Vec<usize>,
    /// Terms of friction that no motion tells from other parameters.
    pub dependent: Vec<Dependent>,
    /// The steps of Y_b, for derivatives of it.
    pub(crate) steps: Function<f64>,
    regressor: Program<f64>,
    known: Option<Program<f64>>,
}

fn number(manipulator: &Manipulator, value: &Polynomial) -> f64 {
    nominal(manipulator, value).to_f64()
}

fn ten_of(manipulator: &Manipulator, body: &Body) -> Ten {
    let of = |value: &Polynomial| number(manipulator, value);
    let inertia: Vec<f64> = body.inertia.iter().map(of).collect();
    let com = Vector3::from_iterator(body.com.iter().map(of));
    body::ten(of(&body.mass), com, &body::symmetric(&inertia))
}

fn sum(manipulator: &Manipulator, bodies: &[PlacedBody]) -> Ten {
    bodies.iter().fold([0.0; 10], |sum, placed| {
        let ten = ten_of(manipulator, &placed.body);
        std::array::from_fn(|k| sum[k] + ten[k])
    })
}

/// Joints, as many states, of a state-by-state vector.
type States<'a> = &'a [f64];

impl Arm {
    /// The arm of a description. `link_side`: torques are measured behind the gear, where rotors are not felt. `None`: nothing has mass.
    pub fn new(given: &Manipulator, link_side: bool) -> Option<Arm> {
        if given.is_massless() {
            return None;
        }
        let given = &given.with_one_end_effector();
        let mut manipulator = given.clone();
        manipulator.regressor = RegressorChoice::Base;
        manipulator.payload = None;
        for joint in &mut manipulator.joints {
            (joint.viscous, joint.coulomb, joint.offset, joint.cubic) = (None, None, None, None);
            (joint.load, joint.stribeck, joint.spring, joint.armature) = (None, None, None, None);
            if let Some(motor) = &mut joint.motor {
                motor.viscous = None;
                motor.inertia = if link_side { None } else { Some(motor.inertia.clone().unwrap_or_else(Polynomial::zero)) };
            }
        }
        let of = |value: &Option<Polynomial>| value.as_ref().map(|value| number(given, value));
        let joints: Vec<Joint> = given
            .joints
            .iter()
            .map(|joint| {
                let ratio = joint.motor.as_ref().map_or(0.0, |motor| number(given, &motor.ratio));
                let rotor_viscous = joint.motor.as_ref().and_then(|motor| of(&motor.viscous)).unwrap_or(0.0);
                let stribeck = joint.stribeck.as_ref();
                Joint {
                    name: joint.name.clone(),
                    slides: joint.kind == JointKind::Prismatic,
                    position: joint.limits.position.as_ref().map(|limits| [0, 1].map(|end| limits[end].to_f64())),
                    effort: joint.limits.effort.as_ref().map_or(f64::INFINITY, Number::to_f64),
                    velocity: joint.limits.velocity.as_ref().map_or(f64::INFINITY, Number::to_f64),
                    gain: joint.motor.as_ref().and_then(|motor| motor.gain.as_ref()).map(Number::to_f64),
                    friction: [
                        of(&joint.viscous),
                        of(&joint.coulomb),
                        of(&joint.offset),
                        joint.load.as_ref().map(Number::to_f64),
                        of(&joint.cubic),
                        stribeck.map(|stribeck| number(given, &stribeck.torque)),
                    ],
                    stribeck_velocity: stribeck.map_or(0.1, |stribeck| stribeck.velocity.to_f64()),
                    rotor_viscous: ratio * ratio * rotor_viscous,
                    armature: of(&joint.armature).unwrap_or(0.0),
                    stiffness: joint.spring.as_ref().map_or(0.0, |spring| number(given, &spring.stiffness)),
                    rest: joint.spring.as_ref().map_or(0.0, |spring| number(given, &spring.rest)),
                    has_rotor: joint.motor.is_some() && !link_side,
                    rotor: joint.motor.as_ref().and_then(|motor| of(&motor.inertia)).unwrap_or(0.0),
                }
            })
            .collect();
        let translation = |of: &[Polynomial; 3]| Vector3::from_iterator(of.iter().map(|x| number(given, x)));
        let links = (0..joints.len())
            .map(|i| {
                let bodies = &given.joints[i].link;
                let next = given.joints.iter().position(|joint| joint.parent.is_some_and(|parent| parent.index() == i));
                let joint_frame = given.joints[i].link_frame.inverse();
                let end = match next {
                    Some(next) => translation(&joint_frame.then(&given.joints[next].placement).translation),
                    None if given.tip.index() == i => translation(&given.tool.frame.translation),
                    None => Vector3::zeros(),
                };
                let axes = bodies.first().map(|body| &body.axes.frame.rotation);
                Link {
                    own: bodies.first().map_or([0.0; 10], |body| ten_of(given, &body.body)),
                    given: bodies.first().map_or([0.0; 10], |body| {
                        let values = std::iter::once(&body.given.mass).chain(&body.given.com).chain(&body.given.inertia);
                        let values: Vec<f64> = values.map(|value| number(given, value)).collect();
                        std::array::from_fn(|k| values[k])
                    }),
                    attached: sum(given, bodies.get(1..).unwrap_or_default()),
                    attachments: bodies.len().saturating_sub(1),
                    ends: [translation(&joint_frame.translation), end],
                    axes: axes.map_or_else(Matrix3::identity, |axes| Matrix3::from_fn(|i, j| axes[i][j].to_f64())),
                }
            })
            .collect();
        let standard = StandardParameter::all(&manipulator);
        let rotors = standard
            .iter()
            .filter_map(|parameter| match parameter {
                StandardParameter::RotorInertia(i) => Some(usize::from(*i)),
                _ => None,
            })
            .collect();
        let names: Vec<String> = standard.iter().map(|parameter| parameter.name()).collect();
        let has_rotor_masses =
            manipulator.joints.iter().filter_map(|joint| joint.motor.as_ref()).any(|motor| !motor.mass.is_zero());
        let wanted = if has_rotor_masses { vec!["regressor", "known_torque"] } else { vec!["regressor"] };
        let model = Model::new(manipulator);
        let (vector, combinations) = base_combinations(&model.manipulator, &model.field)?;
        let dependent = apart::dependent_friction(&model, &vector);
        let combination = DMatrix::from_fn(vector.len(), names.len(), |row, column| combinations[row][column].to_f64());
        let functions = Selection::named(wanted).expect("functions of every arm with mass");
        let module = schedule::module(&model, &Options { functions, ..Options::default() });
        let mut programs = armgen_evaluate::programs(&module).into_iter();
        let steps = function(&module, &module.functions[0]);
        let regressor = programs.next().expect("an arm with mass has a regressor");
        // A load is a body that the last link carries.
        let tool = &given.tool.frame;
        let rotation = Matrix3::from_fn(|i, j| tool.rotation[i][j].to_f64());
        let carried = DMatrix::from_columns(
            &(0..10)
                .map(|k| {
                    let unit: Ten = std::array::from_fn(|i| if i == k { 1.0 } else { 0.0 });
                    DVector::from_row_slice(&body::moved(&unit, &rotation, translation(&tool.translation)))
                })
                .collect::<Vec<_>>(),
        );
        let tip = given.tip.index();
        let load = combination.columns(10 * tip, 10) * carried;
        Some(Arm {
            name: given.name.clone(),
            joints,
            links,
            base: vector.entries.iter().map(|entry| Base { name: entry.name.clone(), meaning: entry.meaning.clone() }).collect(),
            standard: names,
            combination,
            load,
            payload: given.payload.as_ref().map(|payload| ten_of(given, &payload.body)),
            rotors,
            dependent,
            steps,
            regressor,
            known: programs.next(),
        })
    }

    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// phi of the file: each link's own body and those attached, then rotor inertias.
    pub fn nominal(&self) -> DVector<f64> {
        let links = self.links.iter().flat_map(|link| (0..10).map(|k| link.own[k] + link.attached[k]));
        let rotors = self.rotors.iter().map(|&i| self.joints[i].rotor);
        DVector::from_iterator(self.standard.len(), links.chain(rotors))
    }

    /// Y_b of states, state by state, row by row.
    pub fn regressor(&self, q: States<'_>, dq: States<'_>, ddq: States<'_>) -> Vec<f64> {
        let states = q.len() / self.dof();
        let mut y = vec![0.0; states * self.regressor.outputs()];
        let arguments = [q, dq, dq, ddq];
        self.regressor.run(&arguments, &mut y, &mut self.regressor.workspace()).expect("four vectors for each state");
        y
    }

    /// Torques that are known, state by state.
    pub fn known(&self, q: States<'_>, dq: States<'_>, ddq: States<'_>) -> Vec<f64> {
        let mut tau = vec![0.0; q.len()];
        if let Some(program) = &self.known {
            program.run(&[q, dq, dq, ddq], &mut tau, &mut program.workspace()).expect("four vectors for each state");
        }
        let n = self.dof();
        for (k, tau) in tau.iter_mut().enumerate() {
            let joint = &self.joints[k % n];
            *tau += joint.rotor_viscous * dq[k] + joint.armature * ddq[k] + joint.stiffness * (q[k] - joint.rest);
        }
        tau
    }

    /// Torques Y_b pi of states, state by state, without what is known.
    pub fn torque(&self, q: States<'_>, dq: States<'_>, ddq: States<'_>, pi: &[f64]) -> Vec<f64> {
        // In blocks that stay in a processor's cache.
        let block = self.dof() * 128;
        let mut tau = Vec::with_capacity(q.len());
        for ((q, dq), ddq) in q.chunks(block).zip(dq.chunks(block)).zip(ddq.chunks(block)) {
            let rows = self.regressor(q, dq, ddq);
            tau.extend(rows.chunks_exact(pi.len()).map(|row| row.iter().zip(pi).map(|(y, pi)| y * pi).sum::<f64>()));
        }
        tau
    }

    /// g(q) of states, state by state: the gravity torque of base parameters, with that of rotor masses and without springs.
    pub fn gravity(&self, q: States<'_>, pi: &[f64]) -> Vec<f64> {
        let zero = vec![0.0; q.len()];
        let mut g = self.torque(q, &zero, &zero, pi);
        if self.known.is_some() {
            for (k, (g, known)) in g.iter_mut().zip(self.known(q, &zero, &zero)).enumerate() {
                let joint = &self.joints[k % self.dof()];
                *g += known - joint.stiffness * (q[k] - joint.rest);
            }
        }
        g
    }
}
