//! Torques by the Newton-Euler method, body by body in the base frame: a second derivation besides Lagrange's. It is linear in the ten
//! inertial parameters of each body.
//!
//! Consider a body with mass m, first moment h = ∫ r dm and inertia I about the origin of its frame. The origin has the acceleration a (minus
//! gravity); the body rotates with ω, α:
//!
//! ```text
//! F = m a + α × h + ω × (ω × h)        N = I α + ω × (I ω) + h × a
//! τ_j = z_j · (N + (p - p_j) × F) (revolute),  z_j · F (prismatic),  for each joint j that moves the body
//! ```
//!
//! A rotor has the angular momentum I_m s z with s = z·ω + Σ k_j dq_j. Its rate of change acts on the link that carries it, and k_j I_m ds/dt on
//! joint j.
//!
//! The regressor has two rates: C(q, dq) dqr = ½ (V(dq + dqr) - V(dq) - V(dqr)). V(u) = C(q, u) u is the torque of a motion with rates u and no
//! accelerations, without gravity. This symmetric form belongs to the C of the Christoffel symbols.

use super::arm::{symmetric, Arm, Body};
use super::pose::Pose;
use super::vector::{add, apply, cross, dot, scale, sub, Vector};
use crate::values::element::Element;

/// The ten inertial parameters of a body in its frame: m, mcx, mcy, mcz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the frame's origin.
pub type Ten<E> = [E; 10];

/// The ten parameters of a body (Steiner): I = I_c + m (c'c 1 - c c').
pub fn ten<E: Element>(body: &Body<E>) -> Ten<E> {
    let (m, c) = (&body.mass, &body.com);
    let moment = scale(m, c);
    let square = dot(&moment, c);
    let entry = |i: usize, j: usize| {
        let shifted = body.inertia[i][j].minus(&moment[i].times(&c[j]));
        if i == j {
            shifted.plus(&square)
        } else {
            shifted
        }
    };
    let [hx, hy, hz] = moment.clone();
    [m.clone(), hx, hy, hz, entry(0, 0), entry(0, 1), entry(1, 1), entry(0, 2), entry(1, 2), entry(2, 2)]
}

/// The body with these ten parameters; `None` if its mass is 0.
pub fn body<E: Element>(ten: &[E]) -> Option<Body<E>> {
    let inverse = ten[0].inverse()?;
    let com = [1, 2, 3].map(|i| ten[i].times(&inverse));
    let about_origin = symmetric(&ten[4..10]);
    let square = dot(&scale(&ten[0], &com), &com);
    let inertia = [0, 1, 2].map(|i| {
        [0, 1, 2].map(|j| {
            let shifted = about_origin[i][j].plus(&ten[0].times(&com[i]).times(&com[j]));
            if i == j {
                shifted.minus(&square)
            } else {
                shifted
            }
        })
    });
    Some(Body { mass: ten[0].clone(), com, inertia })
}

/// Rates and accelerations of a motion, and the acceleration of gravity.
#[derive(Clone, Debug)]
pub struct Motion<E> {
    /// Rates of coordinates.
    pub rates: Vec<E>,
    /// Accelerations of coordinates.
    pub accelerations: Vec<E>,
    /// Acceleration of gravity, base frame.
    pub gravity: Vector<E>,
}

/// ω, α and the acceleration of the joint frame's origin (minus gravity), in the base frame.
#[derive(Clone, Debug)]
struct LinkMotion<E> {
    omega: Vector<E>,
    alpha: Vector<E>,
    a: Vector<E>,
}

impl<E: Element> LinkMotion<E> {
    /// The acceleration of a point at `lever` from the origin.
    fn at(&self, lever: &Vector<E>) -> Vector<E> {
        let centripetal = cross(&self.omega, &cross(&self.omega, lever));
        add(&self.a, &add(&cross(&self.alpha, lever), &centripetal))
    }
}

/// A motion of an arm at a state, for the torques of any body.
pub struct ArmMotion<'a, E> {
    arm: &'a Arm<E>,
    pose: &'a Pose<E>,
    motion: Motion<E>,
    links: Vec<LinkMotion<E>>,
}

/// The carrier of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Carrier {
    /// A link, in its link frame.
    Link(usize),
    /// The end effector.
    Tool(usize),
}

impl<'a, E: Element> ArmMotion<'a, E> {
    /// Velocities and accelerations of all links, base to tip.
    pub fn new(arm: &'a Arm<E>, pose: &'a Pose<E>, motion: Motion<E>) -> ArmMotion<'a, E> {
        let (rates, accelerations) = (arm.of_joints(&motion.rates), arm.of_joints(&motion.accelerations));
        let motion = Motion { rates, accelerations, ..motion };
        let mut links: Vec<LinkMotion<E>> = Vec::new();
        for (i, joint) in arm.joints.iter().enumerate() {
            let nothing = || arm.nothing();
            let rest = LinkMotion { omega: nothing(), alpha: nothing(), a: motion.gravity.clone().map(|g| g.negated()) };
            let (before, from) = match joint.parent {
                Some(parent) => (links[parent].clone(), pose.joints[parent].origin.clone()),
                None => (rest, nothing()),
            };
            let z = pose.axes[i].clone();
            let (turn, change) = (scale(&motion.rates[i], &z), scale(&motion.accelerations[i], &z));
            let mut a = before.at(&sub(&pose.joints[i].origin, &from));
            let (mut omega, mut alpha) = (before.omega.clone(), before.alpha.clone());
            if joint.revolute {
                alpha = add(&alpha, &add(&change, &cross(&omega, &turn)));
                omega = add(&omega, &turn);
            } else {
                // Translation along z in a rotating link: ddq z + 2 ω × z dq.
                let twice = add(&turn, &turn);
                a = add(&a, &add(&change, &cross(&omega, &twice)));
            }
            links.push(LinkMotion { omega, alpha, a });
        }
        ArmMotion { arm, pose, motion, links }
    }

    /// Adds the torques of a body.
    pub fn add_body(&self, carrier: Carrier, ten: &[E], torques: &mut [E]) {
        let (link, frame) = match carrier {
            Carrier::Link(link) => (link, &self.pose.links[link]),
            Carrier::Tool(tip) => (self.arm.tips[tip].link, &self.pose.tools[tip]),
        };
        if ten.iter().all(Element::is_zero) {
            return;
        }
        let turning = &self.links[link];
        let a = frame.into_frame(&turning.at(&sub(&frame.origin, &self.pose.joints[link].origin)));
        let (omega, alpha) = (frame.into_frame(&turning.omega), frame.into_frame(&turning.alpha));
        let h = [1, 2, 3].map(|i| ten[i].clone());
        let inertia = symmetric(&ten[4..10]);
        let force = add(&scale(&ten[0], &a), &add(&cross(&alpha, &h), &cross(&omega, &cross(&omega, &h))));
        let gyroscopic = cross(&omega, &apply(&inertia, &omega));
        let moment = add(&apply(&inertia, &alpha), &add(&gyroscopic, &cross(&h, &a)));
        self.add_wrench(Some(link), &frame.origin, &frame.direction(&force), &frame.direction(&moment), torques);
    }

    fn add_wrench(&self, link: Option<usize>, point: &Vector<E>, force: &Vector<E>, moment: &Vector<E>, torques: &mut [E]) {
        for &j in link.map_or(&[][..], |link| &self.pose.ancestors[link]) {
            let z = &self.pose.axes[j];
            let torque = if self.arm.joints[j].revolute {
                dot(z, &add(moment, &cross(&sub(point, &self.pose.joints[j].origin), force)))
            } else {
                dot(z, force)
            };
            torques[j] = torques[j].plus(&torque);
        }
    }

    /// Adds the torques of the rotor mass of joint `i`.
    pub fn add_rotor_mass(&self, i: usize, torques: &mut [E]) {
        let joint = &self.arm.joints[i];
        let Some((motor, carrier)) = joint.motor.as_ref().and_then(|motor| Some((motor, motor.carrier?))) else { return };
        let point = self.pose.links[carrier].point(&motor.position);
        let a = self.links[carrier].at(&sub(&point, &self.pose.joints[carrier].origin));
        let nothing = self.arm.nothing();
        self.add_wrench(Some(carrier), &point, &scale(&motor.mass, &a), &nothing, torques);
    }

    /// Adds the torques of the rotor inertia of joint `i`.
    pub fn add_rotor_inertia(&self, i: usize, inertia: &E, torques: &mut [E]) {
        let joint = &self.arm.joints[i];
        let Some(motor) = &joint.motor else { return };
        let mut change = motor.spin(&self.arm.zero, &self.motion.accelerations);
        if let Some(carrier) = motor.carrier {
            let turning = &self.links[carrier];
            let axis = self.pose.links[carrier].direction(&motor.axis);
            change = change.plus(&dot(&axis, &turning.alpha));
            let rotor_speed = dot(&axis, &turning.omega).plus(&motor.spin(&self.arm.zero, &self.motion.rates));
            // d/dt (I s z) = I (ds/dt z + s ω × z)
            let rate = add(&scale(&change, &axis), &scale(&rotor_speed, &cross(&turning.omega, &axis)));
            let nothing = self.arm.nothing();
            let point = self.pose.links[carrier].origin.clone();
            self.add_wrench(Some(carrier), &point, &nothing, &scale(inertia, &rate), torques);
        }
        motor.add_torque(&inertia.times(&change), torques);
    }

    /// Adds the torque of an armature at joint `i`.
    pub fn add_armature(&self, i: usize, armature: &E, torques: &mut [E]) {
        torques[i] = torques[i].plus(&armature.times(&self.motion.accelerations[i]));
    }

    /// The torques of the whole arm, without friction.
    pub fn torques(&self) -> Vec<E> {
        self.arm.of_coordinates(self.torques_of_joints())
    }

    /// The same, of joints as if each had a drive.
    fn torques_of_joints(&self) -> Vec<E> {
        let mut torques = vec![self.arm.zero.clone(); self.arm.joints.len()];
        for (i, joint) in self.arm.joints.iter().enumerate() {
            self.add_body(Carrier::Link(i), &ten(&joint.link), &mut torques);
            self.add_rotor_mass(i, &mut torques);
            self.add_armature(i, &joint.armature, &mut torques);
            if let Some(motor) = &joint.motor {
                self.add_rotor_inertia(i, &motor.inertia, &mut torques);
            }
        }
        for (tip, end) in self.arm.tips.iter().enumerate() {
            if let Some(load) = &end.payload {
                self.add_body(Carrier::Tool(tip), &ten(load), &mut torques);
            }
        }
        torques
    }
}

/// B ddqr + C(q, dq) dqr + g as a sum over motions, for any body.
pub struct ReferenceMotion<'a, E> {
    /// Motions with their weights: first accelerations and gravity alone; then V(dq + dqr), V(dq), V(dqr).
    parts: Vec<(E, ArmMotion<'a, E>)>,
}

impl<'a, E: Element> ReferenceMotion<'a, E> {
    /// The motions for a reference.
    pub fn new(arm: &'a Arm<E>, pose: &'a Pose<E>, dq: &[E], dqr: &[E], ddqr: &[E]) -> ReferenceMotion<'a, E> {
        let (zero, half) = (&arm.zero, arm.half());
        let still = vec![zero.clone(); arm.dof()];
        let nothing = arm.nothing();
        let sum: Vec<E> = dq.iter().zip(dqr).map(|(a, b)| a.plus(b)).collect();
        let velocity = |rates: &[E]| Motion { rates: rates.to_vec(), accelerations: still.clone(), gravity: nothing.clone() };
        let slow = Motion { rates: still.clone(), accelerations: ddqr.to_vec(), gravity: arm.gravity.clone() };
        let parts = [
            (arm.one.clone(), slow),
            (half.clone(), velocity(&sum)),
            (half.negated(), velocity(dq)),
            (half.negated(), velocity(dqr)),
        ];
        ReferenceMotion { parts: parts.into_iter().map(|(k, motion)| (k, ArmMotion::new(arm, pose, motion))).collect() }
    }

    /// The sum over all motions of the torques of joints from `add`, as torques of coordinates.
    pub fn torques(&self, add: &dyn Fn(&ArmMotion<'a, E>, &mut [E])) -> Vec<E> {
        let (_, first) = &self.parts[0];
        let mut total = vec![first.arm.zero.clone(); first.arm.joints.len()];
        for (weight, moving) in &self.parts {
            let mut torques = vec![first.arm.zero.clone(); first.arm.joints.len()];
            add(moving, &mut torques);
            for (total, torque) in total.iter_mut().zip(&torques) {
                *total = total.plus(&weight.times(torque));
            }
        }
        first.arm.of_coordinates(total)
    }

    /// The torques of the whole arm, without friction.
    pub fn whole(&self) -> Vec<E> {
        self.torques(&|moving, torques| torques.clone_from_slice(&moving.torques_of_joints()))
    }
}
