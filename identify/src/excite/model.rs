//! The arm as an excitation sees it: columns, torques with and without friction, frames, limits.

use armgen_codegen::derive::parameters::nominal;
use armgen_codegen::exact::{Number, Polynomial};
use armgen_codegen::kinds::JointKind;
use armgen_codegen::manipulator::Manipulator;
use armgen_codegen::schedule::{self, Options, Selection};
use armgen_codegen::Model as Equations;
use armgen_evaluate::{function, Function, Program};

use super::tape::Tape;
use crate::arm::Arm;
use crate::prepare::Friction;

/// Limits of the joints; infinite where there are none.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Limits {
    /// Lowest and highest positions, rad or m.
    pub position: Vec<[f64; 2]>,
    /// rad/s or m/s.
    pub velocity: Vec<f64>,
    /// rad/s² or m/s².
    pub acceleration: Vec<f64>,
    /// N m or N.
    pub effort: Vec<f64>,
}

impl Limits {
    /// Those of a description.
    pub fn of(manipulator: &Manipulator) -> Limits {
        let of = |number: &Option<Number>| number.as_ref().map_or(f64::INFINITY, Number::to_f64);
        let joints = &manipulator.joints;
        Limits {
            position: joints
                .iter()
                .map(|joint| match &joint.limits.position {
                    Some(both) => both.each_ref().map(Number::to_f64),
                    None => [f64::NEG_INFINITY, f64::INFINITY],
                })
                .collect(),
            velocity: joints.iter().map(|joint| of(&joint.limits.velocity)).collect(),
            acceleration: joints.iter().map(|joint| of(&joint.limits.acceleration)).collect(),
            effort: joints.iter().map(|joint| of(&joint.limits.effort)).collect(),
        }
    }
}

/// Friction of a joint, all terms.
#[derive(Clone, Copy, Debug)]
pub(super) struct JointFriction {
    /// In the order of [`Friction::ALL`].
    pub(super) terms: [f64; 6],
    /// Of Stribeck friction.
    pub(super) velocity: f64,
}

/// A frame whose origin has bounds.
#[derive(Clone, Debug)]
pub(super) struct Frame {
    pub(super) name: String,
    /// Where its 16 entries begin in the results of the function of frames.
    pub(super) start: usize,
}

/// The functions of an arm.
pub(super) struct Model {
    pub(super) joints: usize,
    /// Y_b.
    pub(super) regressor: Tape,
    /// The torque, with friction.
    pub(super) torque: Tape,
    /// The torque, without friction.
    pub(super) bare: Program<f64>,
    pub(super) friction: Vec<JointFriction>,
    /// Frames of links, then of the end effector: as a tape and as programs.
    pub(super) frames: Vec<(Tape, Program<f64>)>,
    /// Base parameters.
    pub(super) base: usize,
    /// Columns of friction: joint and term.
    pub(super) columns: Vec<(usize, Friction)>,
    /// Base parameters of the file.
    pub(super) pi: Vec<f64>,
    /// Rates below which signs are smooth.
    pub(super) smooth: Vec<f64>,
}

/// What signs of rates are smooth below, of the highest rate.
const SMOOTH: f64 = 0.01;

fn functions(manipulator: &Manipulator, names: &[&'static str]) -> Vec<Function<f64>> {
    let functions = Selection::named(names.iter().copied()).expect("functions of the catalogue");
    let module = schedule::module(&Equations::new(manipulator.clone()), &Options { functions, ..Options::default() });
    let found: Vec<Function<f64>> = module.functions.iter().map(|of| function(&module, of)).collect();
    // The order of a module is its own.
    names.iter().map(|name| found.iter().find(|of| of.name == *name).expect("it was asked for").clone()).collect()
}

fn program(of: &Function<f64>) -> Program<f64> {
    Program::new(of).expect("a step of codegen uses earlier steps and its arguments")
}

impl Model {
    /// The functions of an arm. `wants_frames`: origins of frames have bounds.
    pub(super) fn new(given: &Manipulator, arm: &Arm, limits: &Limits, wants_frames: bool) -> Model {
        let smooth: Vec<f64> = limits.velocity.iter().map(|v| SMOOTH * v.min(1e3)).collect();
        let mut whole = given.clone();
        whole.gravity_is_argument = false;
        let mut bare = whole.clone();
        let value = |p: &Polynomial| nominal(given, p).to_f64();
        let friction = given.joints.iter().map(|joint| {
            let of = |p: &Option<Polynomial>| p.as_ref().map_or(0.0, value);
            let rotor = joint.motor.as_ref().map_or(0.0, |motor| value(&motor.ratio).powi(2) * of(&motor.viscous));
            let stribeck = joint.stribeck.as_ref();
            JointFriction {
                terms: [
                    of(&joint.viscous) + rotor,
                    of(&joint.coulomb),
                    of(&joint.offset),
                    joint.load.as_ref().map_or(0.0, Number::to_f64),
                    of(&joint.cubic),
                    stribeck.map_or(0.0, |stribeck| value(&stribeck.torque)),
                ],
                velocity: stribeck.map_or(0.1, |stribeck| stribeck.velocity.to_f64()),
            }
        });
        let friction = friction.collect();
        for joint in &mut bare.joints {
            (joint.viscous, joint.coulomb, joint.offset) = (None, None, None);
            (joint.load, joint.cubic, joint.stribeck) = (None, None, None);
            if let Some(motor) = &mut joint.motor {
                motor.viscous = None;
            }
        }
        let torque = functions(&whole, &["inverse_dynamics"]).remove(0);
        let bare = program(&functions(&bare, &["inverse_dynamics"]).remove(0));
        let frames = if wants_frames { functions(&whole, &["link_frames", "direct_kinematics"]) } else { Vec::new() };
        let is_dependent = |joint: usize, term: Friction| {
            arm.dependent.iter().any(|dependent| dependent.joint == joint && dependent.term == term as usize)
        };
        let columns = (0..given.dof()).flat_map(|joint| Friction::ALL.map(|term| (joint, term)));
        let is_asked_for = |&(joint, term): &(usize, Friction)| {
            let is_usual = matches!(term, Friction::Viscous | Friction::Coulomb | Friction::Offset);
            (is_usual || arm.joints[joint].friction[term as usize].is_some()) && !is_dependent(joint, term)
        };
        Model {
            joints: given.dof(),
            regressor: Tape::new(&arm.steps, &smooth),
            torque: Tape::new(&torque, &smooth),
            bare,
            friction,
            frames: frames.iter().map(|of| (Tape::new(of, &smooth), program(of))).collect(),
            base: arm.base.len(),
            columns: columns.filter(is_asked_for).collect(),
            pi: (&arm.combination * arm.nominal()).as_slice().to_vec(),
            smooth,
        }
    }

    /// Columns of Y and of friction.
    pub(super) fn unknowns(&self) -> usize {
        self.base + self.columns.len()
    }

    /// The frame of a name: that of a joint's link, or `tool`. The function of frames, and where the frame is in its results.
    pub(super) fn frame(given: &Manipulator, name: &str) -> Option<(usize, Frame)> {
        if let Some(joint) = given.joints.iter().position(|joint| joint.name == name) {
            return Some((0, Frame { name: name.to_owned(), start: 16 * joint }));
        }
        (name == TOOL).then(|| (1, Frame { name: name.to_owned(), start: 0 }))
    }
}

/// The name of the end effector's frame among those of joints.
pub const TOOL: &str = "tool";

/// Whether a joint slides.
pub(super) fn slides(manipulator: &Manipulator, joint: usize) -> bool {
    manipulator.joints[joint].kind == JointKind::Prismatic
}
