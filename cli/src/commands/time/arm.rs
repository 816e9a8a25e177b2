//! An arm as the timing of a path sees it, executed from its description.

use std::cell::RefCell;

use armgen_codegen::exact::Polynomial;
use armgen_codegen::kinds::{JointKind, ParameterId};
use armgen_codegen::manipulator::{Manipulator, Placement};
use armgen_codegen::schedule::{self, Options, Selection};
use armgen_codegen::{Model, Trig};
use armgen_evaluate::{program, Program, Workspace};
use armgen_runtime::timing::{JointFriction, LinkBound, PathDynamics, PathTorques};
use nalgebra::{Matrix3, SVector, Vector3, Vector6};

/// Lengths and inertias are sums of few terms, rounded to nearest: this much more bounds them.
const UPWARDS: f64 = 1.0 + 1e-12;

/// The inverse dynamics without friction, and what a timing needs besides. Joints beyond those of the description weigh nothing.
pub(super) struct Arm<const N: usize> {
    dof: usize,
    inverse_dynamics: Program<f64>,
    workspace: RefCell<Workspace<f64>>,
    /// J of the one end effector, where its speed is asked for.
    jacobian: Option<(Program<f64>, RefCell<Workspace<f64>>)>,
    /// The joint whose link carries the end effector, and how far from its origin at most, m.
    tip: (usize, f64),
    friction: [JointFriction<f64>; N],
    links: [LinkBound<f64>; N],
    gravity: f64,
}

impl<const N: usize> Arm<N> {
    /// The arm of a description of at most N joints without smooth friction; `None` where it has no equations of motion.
    /// `is_led`: it has one end effector, whose speed is asked for.
    pub(super) fn new(manipulator: &Manipulator, is_led: bool) -> Option<Arm<N>> {
        if manipulator.is_massless() {
            return None;
        }
        let value = |p: &Polynomial| p.evaluate(&|ParameterId(i)| manipulator.parameters[i as usize].nominal.clone()).to_f64();
        let given = |p: &Option<Polynomial>| p.as_ref().map_or(0.0, value);
        let friction = std::array::from_fn(|i| {
            let Some(joint) = manipulator.joints.get(i) else { return JointFriction::default() };
            let motor = joint.motor.as_ref().map_or(0.0, |motor| value(&motor.ratio).powi(2) * given(&motor.viscous));
            JointFriction {
                viscous: given(&joint.viscous) + motor,
                coulomb: given(&joint.coulomb),
                offset: given(&joint.offset),
                load: joint.load.as_ref().map_or(0.0, |load| load.to_f64()),
                cubic: given(&joint.cubic),
                stribeck: joint.stribeck.as_ref().map_or(0.0, |stribeck| value(&stribeck.torque)),
                stribeck_velocity: joint.stribeck.as_ref().map_or(0.0, |stribeck| stribeck.velocity.to_f64()),
            }
        });
        // Friction depends on the sign of the rates, which is known on every part of a path: it is added there.
        let mut bare = manipulator.clone();
        bare.gravity_is_argument = false;
        for joint in &mut bare.joints {
            (joint.viscous, joint.coulomb, joint.offset, joint.load) = (None, None, None, None);
            (joint.cubic, joint.stribeck) = (None, None);
            if let Some(motor) = &mut joint.motor {
                motor.viscous = None;
            }
        }
        let model = Model::new(bare);
        let function = |name: &str| {
            let functions = Selection::named([name]).expect("a function of the catalogue");
            let module = schedule::module(&model, &Options { trig: Trig::Fast, functions, ..Options::default() });
            let function: Program<f64> = program(&module, &module.functions[0]);
            let workspace = RefCell::new(function.workspace());
            (function, workspace)
        };
        let (inverse_dynamics, workspace) = function("inverse_dynamics");
        let jacobian = is_led.then(|| function("geometric_jacobian"));
        let tip = manipulator.tip.index();
        let (rotation, origin) = frame(&manipulator.joints[tip].link_frame, &value);
        let tip = (tip, (rotation * frame(&manipulator.tool.frame, &value).1 + origin).norm() * UPWARDS);
        let gravity = Vector3::from(std::array::from_fn(|i| value(&manipulator.gravity[i]))).norm() * UPWARDS;
        let links = links(manipulator, &value);
        Some(Arm { dof: manipulator.dof(), inverse_dynamics, workspace, jacobian, tip, friction, links, gravity })
    }

    /// Whether the speed of its end effector is known.
    pub(super) fn is_led(&self) -> bool {
        self.jacobian.is_some()
    }

    /// The joint whose link carries the end effector, and how far from its origin at most, m.
    pub(super) fn tip(&self) -> (usize, f64) {
        self.tip
    }

    /// The speed and the turn rate of the end effector, m/s and rad/s; 0 where they are not asked for.
    pub(super) fn tool_speeds(&self, q: &SVector<f64, N>, dq: &SVector<f64, N>) -> [f64; 2] {
        let rate = self.tool_rate(q, dq);
        [rate.fixed_rows::<3>(0).norm(), rate.fixed_rows::<3>(3).norm()]
    }

    /// tau with friction of joints that move, or begin to move, in the directions of `forwards`.
    pub(super) fn torque(
        &self,
        q: &SVector<f64, N>,
        dq: &SVector<f64, N>,
        ddq: &SVector<f64, N>,
        forwards: &SVector<f64, N>,
    ) -> SVector<f64, N> {
        let (gravity, mut tau) = (self.gravity_torque(q), self.bare(q, dq, ddq));
        for (i, of) in self.friction.iter().enumerate() {
            let sign = if forwards[i] == 0.0 { 0.0 } else { forwards[i].signum() };
            tau[i] += of.viscous * dq[i] + sign * (of.coulomb + of.load * gravity[i].abs()) + of.offset;
            tau[i] += of.cubic * dq[i] * dq[i] * dq[i];
            if of.stribeck != 0.0 {
                tau[i] += sign * of.stribeck * (-dq[i].abs() / of.stribeck_velocity).exp();
            }
        }
        tau
    }

    /// The torque of a joint that holds the arm at rest, without friction, and by how much friction at rest may lower it.
    pub(super) fn holding(&self, q: &SVector<f64, N>, joint: usize) -> (f64, f64) {
        let gravity = self.gravity_torque(q)[joint];
        let of = &self.friction[joint];
        (gravity + of.offset, of.coulomb + of.stribeck + of.load * gravity.abs())
    }

    fn gravity_torque(&self, q: &SVector<f64, N>) -> SVector<f64, N> {
        self.bare(q, &SVector::zeros(), &SVector::zeros())
    }

    fn bare(&self, q: &SVector<f64, N>, dq: &SVector<f64, N>, ddq: &SVector<f64, N>) -> SVector<f64, N> {
        let mut tau = SVector::<f64, N>::zeros();
        let n = self.dof;
        let arguments = [&q.as_slice()[..n], &dq.as_slice()[..n], &ddq.as_slice()[..n]];
        let result = &mut tau.as_mut_slice()[..n];
        self.inverse_dynamics.run(&arguments, result, &mut self.workspace.borrow_mut()).expect("the lengths of this arm");
        tau
    }
}

/// A frame in numbers.
fn frame(placement: &Placement, value: &dyn Fn(&Polynomial) -> f64) -> (Matrix3<f64>, Vector3<f64>) {
    let rotation = Matrix3::from_fn(|i, j| placement.rotation[i][j].to_f64());
    (rotation, Vector3::from_fn(|i, _| value(&placement.translation[i])))
}

/// Mass, first moment and moment of inertia about the origin of a joint.
#[derive(Clone, Copy, Default)]
struct Sum {
    mass: f64,
    first: Vector3<f64>,
    inertia: Matrix3<f64>,
}

impl Sum {
    fn add(&mut self, mass: f64, com: Vector3<f64>, inertia: Matrix3<f64>) {
        self.mass += mass;
        self.first += com * mass;
        self.inertia += inertia + (Matrix3::identity() * com.norm_squared() - com * com.transpose()) * mass;
    }
}

fn links<const N: usize>(manipulator: &Manipulator, value: &dyn Fn(&Polynomial) -> f64) -> [LinkBound<f64>; N] {
    let (joints, loads) = (&manipulator.joints, manipulator.loads());
    let mut sums = [Sum::default(); N];
    for (i, joint) in joints.iter().enumerate() {
        let (rotation, origin) = frame(&joint.link_frame, value);
        let loads = loads.iter().filter(|load| load.link == i).map(|load| (load.body, Some(&load.tool.frame)));
        let bodies = joint.link.iter().map(|body| (body, None)).chain(loads);
        for (placed, tool) in bodies {
            let body = &placed.body;
            let [xx, xy, yy, xz, yz, zz] = std::array::from_fn(|k| value(&body.inertia[k]));
            let mut com = Vector3::from_fn(|k, _| value(&body.com[k]));
            let mut inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
            if let Some(tool) = tool {
                let (turn, place) = frame(tool, value);
                com = turn * com + place;
                inertia = turn * inertia * turn.transpose();
            }
            sums[i].add(value(&body.mass), rotation * com + origin, rotation * inertia * rotation.transpose());
        }
        if let (Some(motor), Some(parent)) = (&joint.motor, joint.parent) {
            let p = parent.index();
            let (rotation, origin) = frame(&joints[p].link_frame, value);
            let place = Vector3::from_fn(|k, _| value(&motor.position[k]));
            let axis = rotation * Vector3::from_fn(|k, _| motor.axis[k].to_f64());
            let spin = motor.inertia.as_ref().map_or(0.0, value);
            sums[p].add(value(&motor.mass), rotation * place + origin, axis * axis.transpose() * spin);
        }
    }
    std::array::from_fn(|i| {
        let Some(joint) = joints.get(i) else {
            return LinkBound {
                parent: None,
                slides: false,
                distance: 0.0,
                mass: 0.0,
                first_moment: 0.0,
                inertia: 0.0,
                coupling: 0.0,
                reflected: 0.0,
            };
        };
        let (ratio, spin) =
            joint.motor.as_ref().map_or((0.0, 0.0), |motor| (value(&motor.ratio), motor.inertia.as_ref().map_or(0.0, value)));
        LinkBound {
            parent: joint.parent.map(|parent| parent.index()),
            slides: joint.kind == JointKind::Prismatic,
            distance: frame(&joint.placement, value).1.norm() * UPWARDS,
            mass: sums[i].mass * UPWARDS,
            first_moment: sums[i].first.norm() * UPWARDS,
            // Frobenius' norm is at least the largest eigenvalue.
            inertia: sums[i].inertia.norm() * UPWARDS,
            coupling: (ratio * spin).abs() * UPWARDS,
            reflected: (ratio * ratio * spin + joint.armature.as_ref().map_or(0.0, value)) * UPWARDS,
        }
    })
}

impl<const N: usize> PathDynamics<N> for Arm<N> {
    type Real = f64;

    fn path_dynamics(&self, q: &SVector<f64, N>, slope: &SVector<f64, N>, curvature: &SVector<f64, N>) -> PathTorques<f64, N> {
        let gravity = self.gravity_torque(q);
        PathTorques {
            inertial: self.bare(q, &SVector::zeros(), slope) - gravity,
            velocity: self.bare(q, slope, curvature) - gravity,
            gravity,
        }
    }

    fn tool_rate(&self, q: &SVector<f64, N>, slope: &SVector<f64, N>) -> Vector6<f64> {
        let Some((jacobian, workspace)) = &self.jacobian else { return Vector6::zeros() };
        let mut j = vec![0.0; jacobian.outputs()];
        jacobian.run(&[&q.as_slice()[..self.dof]], &mut j, &mut workspace.borrow_mut()).expect("the lengths of this arm");
        Vector6::from_fn(|row, _| (0..self.dof).map(|joint| j[row * self.dof + joint] * slope[joint]).sum())
    }

    fn joint_friction(&self) -> &[JointFriction<f64>; N] {
        &self.friction
    }

    fn link_bounds(&self) -> &[LinkBound<f64>; N] {
        &self.links
    }

    fn gravity_length(&self) -> f64 {
        self.gravity
    }
}
