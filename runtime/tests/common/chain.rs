//! Arms of numbers in standard Denavit-Hartenberg rows, by Newton and Euler link by link: written apart from the generator.

use armgen_runtime::timing::{JointFriction, LinkBound, PathDynamics, PathTorques};
use nalgebra::{Matrix3, Rotation3, SVector, Vector3, Vector6};

/// The end effector in the frame of the last joint, m.
pub const TIP: Vector3<f64> = Vector3::new(0.1, -0.05, 0.2);

/// A row and its link; com and inertia (about the centre of mass) in the link frame.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub slides: bool,
    pub a: f64,
    pub alpha: f64,
    pub d: f64,
    pub theta: f64,
    pub mass: f64,
    pub com: [f64; 3],
    /// xx, xy, yy, xz, yz, zz.
    pub inertia: [f64; 6],
    /// Ratio and inertia of the rotor about the joint axis.
    pub rotor: [f64; 2],
    pub friction: JointFriction<f64>,
}

/// A joint frame: z is the axis.
#[derive(Clone, Copy, Debug)]
struct Joint {
    slides: bool,
    rotation: Matrix3<f64>,
    translation: Vector3<f64>,
    mass: f64,
    com: Vector3<f64>,
    inertia: Matrix3<f64>,
    rotor: [f64; 2],
}

#[derive(Clone, Debug)]
pub struct Chain<const N: usize> {
    joints: [Joint; N],
    gravity: Vector3<f64>,
    pub friction: [JointFriction<f64>; N],
    links: [LinkBound<f64>; N],
}

impl<const N: usize> Chain<N> {
    pub fn new(rows: [Row; N], gravity: [f64; 3]) -> Self {
        let gravity = Vector3::from(gravity);
        let (mut outer_rotation, mut outer_translation) = (Matrix3::identity(), Vector3::zeros());
        let joints = rows.map(|row| {
            let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), row.theta).into_inner();
            let (rotation, translation) = (outer_rotation * turn, outer_translation + outer_rotation * Vector3::z() * row.d);
            outer_rotation = Rotation3::from_axis_angle(&Vector3::x_axis(), row.alpha).into_inner();
            outer_translation = Vector3::x() * row.a;
            let [xx, xy, yy, xz, yz, zz] = row.inertia;
            let tensor = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
            Joint {
                slides: row.slides,
                rotation,
                translation,
                mass: row.mass,
                com: outer_rotation * Vector3::from(row.com) + outer_translation,
                inertia: outer_rotation * tensor * outer_rotation.transpose(),
                rotor: row.rotor,
            }
        });
        // The inertia of a rotor about its axis turns with the link that carries it.
        let mut joints = joints;
        for i in 1..N {
            let axis = joints[i].rotation * Vector3::z();
            joints[i - 1].inertia += axis * axis.transpose() * joints[i].rotor[1];
        }
        let mut links = joints.map(|joint| {
            let at_origin =
                joint.inertia + (Matrix3::identity() * joint.com.norm_squared() - joint.com * joint.com.transpose()) * joint.mass;
            LinkBound {
                parent: None,
                slides: joint.slides,
                distance: joint.translation.norm() * (1.0 + 1e-14),
                mass: joint.mass,
                first_moment: joint.mass * joint.com.norm() * (1.0 + 1e-14),
                inertia: at_origin.norm() * (1.0 + 1e-14),
                coupling: joint.rotor[0].abs() * joint.rotor[1],
                reflected: joint.rotor[0] * joint.rotor[0] * joint.rotor[1],
            }
        });
        for (i, link) in links.iter_mut().enumerate() {
            link.parent = i.checked_sub(1);
        }
        Self { joints, gravity, friction: rows.map(|row| row.friction), links }
    }

    pub fn without_friction(mut self) -> Self {
        self.friction = [JointFriction::default(); N];
        self
    }

    /// The same arm with cubic and Stribeck friction: a share of the joint's limit of torque each, at its limit of speed and at rest.
    pub fn with_curved_friction(mut self, (velocity, effort): ([f64; N], [f64; N]), cubic: f64, stribeck: f64) -> Self {
        for (joint, of) in self.friction.iter_mut().enumerate() {
            of.cubic = cubic * effort[joint] / velocity[joint].powi(3);
            (of.stribeck, of.stribeck_velocity) = (stribeck * effort[joint], 0.04 * velocity[joint]);
        }
        self
    }

    pub fn reach(&self) -> f64 {
        self.links.iter().map(|link| link.distance).sum()
    }

    /// tau without friction.
    pub fn torque(&self, q: &SVector<f64, N>, dq: &SVector<f64, N>, ddq: &SVector<f64, N>, gravity: bool) -> SVector<f64, N> {
        let zero = Vector3::zeros();
        let mut forces = [(zero, zero); N];
        let mut rotations = [Matrix3::identity(); N];
        let mut arms = [zero; N];
        let (mut w, mut dw) = (zero, zero);
        let mut a = if gravity { -self.gravity } else { zero };
        let mut of_rotors = [0.0; N];
        let mut on_parents = [zero; N];
        for (i, joint) in self.joints.iter().enumerate() {
            let axis = joint.rotation * Vector3::z();
            let [ratio, inertia] = joint.rotor;
            let coupling = ratio * inertia;
            of_rotors[i] = coupling * (ratio * ddq[i] + axis.dot(&dw));
            on_parents[i] = (axis * ddq[i] + w.cross(&axis) * dq[i]) * coupling;
            let turn = if joint.slides { 0.0 } else { q[i] };
            let rotation = joint.rotation * Rotation3::from_axis_angle(&Vector3::z_axis(), turn).into_inner();
            let arm = joint.translation + axis * if joint.slides { q[i] } else { 0.0 };
            let mut next = a + dw.cross(&arm) + w.cross(&w.cross(&arm));
            if joint.slides {
                next += axis * ddq[i] + w.cross(&axis) * (2.0 * dq[i]);
            } else {
                dw += axis * ddq[i] + w.cross(&axis) * dq[i];
                w += axis * dq[i];
            }
            let back = rotation.transpose();
            (w, dw, a) = (back * w, back * dw, back * next);
            let force = (a + dw.cross(&joint.com) + w.cross(&w.cross(&joint.com))) * joint.mass;
            let moment = joint.inertia * dw + w.cross(&(joint.inertia * w)) + joint.com.cross(&force);
            forces[i] = (force, moment);
            rotations[i] = rotation;
            arms[i] = arm;
        }
        let mut tau = SVector::zeros();
        for i in (0..N).rev() {
            let (force, moment) = forces[i];
            tau[i] = of_rotors[i] + if self.joints[i].slides { force.z } else { moment.z };
            if i > 0 {
                let force = rotations[i] * force;
                let moment = rotations[i] * moment + arms[i].cross(&force) + on_parents[i];
                forces[i - 1].0 += force;
                forces[i - 1].1 += moment;
            }
        }
        tau
    }

    /// tau with friction, for joints that move.
    pub fn torque_with_friction(&self, q: &SVector<f64, N>, dq: &SVector<f64, N>, ddq: &SVector<f64, N>) -> SVector<f64, N> {
        let zero = SVector::zeros();
        let gravity = self.torque(q, &zero, &zero, true);
        let mut tau = self.torque(q, dq, ddq, true);
        for (i, f) in self.friction.iter().enumerate() {
            let sign = if dq[i] > 0.0 {
                1.0
            } else if dq[i] < 0.0 {
                -1.0
            } else {
                0.0
            };
            let stribeck = if f.stribeck > 0.0 { f.stribeck * (-dq[i].abs() / f.stribeck_velocity).exp() } else { 0.0 };
            tau[i] += f.viscous * dq[i] + f.cubic * dq[i].powi(3);
            tau[i] += sign * (f.coulomb + f.load * gravity[i].abs() + stribeck) + f.offset;
        }
        tau
    }
}

impl<const N: usize> PathDynamics<N> for Chain<N> {
    type Real = f64;

    fn path_dynamics(&self, q: &SVector<f64, N>, slope: &SVector<f64, N>, curvature: &SVector<f64, N>) -> PathTorques<f64, N> {
        let zero = SVector::zeros();
        PathTorques {
            inertial: self.torque(q, &zero, slope, false),
            velocity: self.torque(q, slope, curvature, false),
            gravity: self.torque(q, &zero, &zero, true),
        }
    }

    /// Of the point [`TIP`], link by link, in the frame of the last joint.
    fn tool_rate(&self, q: &SVector<f64, N>, slope: &SVector<f64, N>) -> Vector6<f64> {
        let (mut v, mut w) = (Vector3::zeros(), Vector3::zeros());
        for (i, joint) in self.joints.iter().enumerate() {
            let axis = joint.rotation * Vector3::z();
            let (turn, way) = if joint.slides { (0.0, q[i]) } else { (q[i], 0.0) };
            let back = (joint.rotation * Rotation3::from_axis_angle(&Vector3::z_axis(), turn).into_inner()).transpose();
            v += w.cross(&(joint.translation + axis * way));
            *if joint.slides { &mut v } else { &mut w } += axis * slope[i];
            (v, w) = (back * v, back * w);
        }
        v += w.cross(&TIP);
        Vector6::new(v.x, v.y, v.z, w.x, w.y, w.z)
    }

    fn joint_friction(&self) -> &[JointFriction<f64>; N] {
        &self.friction
    }

    fn link_bounds(&self) -> &[LinkBound<f64>; N] {
        &self.links
    }

    fn gravity_length(&self) -> f64 {
        self.gravity.norm()
    }
}

#[allow(clippy::too_many_arguments)] // a row of a table
const fn row(
    a: f64,
    alpha: f64,
    d: f64,
    theta: f64,
    mass: f64,
    com: [f64; 3],
    inertia: [f64; 6],
    viscous: f64,
    coulomb: f64,
) -> Row {
    let friction = JointFriction { viscous, coulomb, offset: 0.0, load: 0.0, cubic: 0.0, stribeck: 0.0, stribeck_velocity: 0.0 };
    Row { slides: false, a, alpha, d, theta, mass, com, inertia, rotor: [0.0, 0.0], friction }
}

use std::f64::consts::{FRAC_PI_2, PI};

/// A UR5 of the manufacturer's table; friction of a plausible size, not measured.
pub fn ur5() -> Chain<6> {
    let rows = [
        row(0.0, -FRAC_PI_2, 0.089159, 0.0, 3.7, [0.0; 3], [0.010267, 0.0, 0.00666, 0.0, 0.0, 0.010267], 12.0, 8.0),
        row(0.425, 0.0, 0.0, 0.0, 8.393, [-0.145, 0.0, 0.13585], [0.015107, 0.0, 0.22689, 0.0, 0.0, 0.22689], 14.0, 9.0),
        row(0.39225, 0.0, 0.0, 0.0, 2.275, [-0.14225, 0.0, 0.01615], [0.004095, 0.0, 0.049443, 0.0, 0.0, 0.049443], 9.0, 6.0),
        row(0.0, -FRAC_PI_2, 0.10915, 0.0, 1.219, [0.0, 0.093, 0.0], [0.111173, 0.0, 0.111173, 0.0, 0.0, 0.21942], 1.5, 1.2),
        row(0.0, FRAC_PI_2, 0.09465, 0.0, 1.219, [0.0, -0.09465, 0.0], [0.111173, 0.0, 0.21942, 0.0, 0.0, 0.111173], 1.4, 1.0),
        row(0.0, 0.0, 0.0823, 0.0, 0.1879, [0.0, 0.0, -0.0823], [0.017136, 0.0, 0.033822, 0.0, 0.0, 0.017136], 1.2, 1.0),
    ];
    Chain::new(rows, [0.0, 0.0, -9.81])
}

pub const UR5_LIMITS: ([f64; 6], [f64; 6]) = ([3.15, 3.15, 3.15, 3.2, 3.2, 3.2], [150.0, 150.0, 150.0, 28.0, 28.0, 28.0]);

/// A Panda: kinematics of the manufacturer, bodies of published identifications, rounded; friction of a plausible size, not measured.
pub fn panda() -> Chain<7> {
    let rows = [
        row(
            0.0,
            -FRAC_PI_2,
            0.333,
            0.0,
            4.97,
            [0.004, 0.048, 0.002],
            [0.70337, -0.00677, 0.00912, -0.00014, -0.01917, 0.70661],
            4.5,
            2.0,
        ),
        row(
            0.0,
            FRAC_PI_2,
            0.0,
            0.0,
            0.647,
            [-0.003, 0.003, 0.029],
            [0.00796, 0.01025, 0.026, 0.00393, -0.0007, 0.02811],
            4.5,
            3.0,
        ),
        row(
            0.0825,
            FRAC_PI_2,
            0.316,
            0.0,
            3.229,
            [-0.055, -0.067, -0.039],
            [0.03724, -0.0114, 0.01083, 0.00476, 0.01281, 0.03616],
            3.5,
            2.0,
        ),
        row(
            0.0825,
            FRAC_PI_2,
            0.0,
            PI,
            3.588,
            [-0.029, 0.027, 0.104],
            [0.02585, 0.00133, 0.02832, -0.0078, 0.00864, 0.01955],
            3.5,
            2.0,
        ),
        row(
            0.0,
            -FRAC_PI_2,
            0.384,
            0.0,
            1.226,
            [0.012, 0.038, -0.041],
            [0.03555, -0.00404, 0.00863, -0.00212, 0.00023, 0.02947],
            1.2,
            0.8,
        ),
        row(
            0.088,
            FRAC_PI_2,
            0.0,
            PI,
            1.667,
            [-0.028, -0.011, 0.014],
            [0.00196, -0.00116, 0.00543, -0.00011, -0.00034, 0.00435],
            1.0,
            0.6,
        ),
        row(
            0.0,
            0.0,
            0.107,
            0.0,
            1.496,
            [0.0017, 0.0014, -0.0065],
            [0.01653, 0.00039, 0.01411, -0.00071, -0.00105, 0.00668],
            0.8,
            0.5,
        ),
    ];
    Chain::new(rows, [0.0, 0.0, -9.81])
}

pub const PANDA_LIMITS: ([f64; 7], [f64; 7]) =
    ([2.175, 2.175, 2.175, 2.175, 2.61, 2.61, 2.61], [87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0]);

/// A SCARA with links of 0.5 m, a slide and rotors; friction at the rotors.
pub fn scara() -> Chain<4> {
    let viscous = |viscous: f64| JointFriction { viscous, ..JointFriction::default() };
    let body = |mass: f64, x: f64, zz: f64| (mass, [x, 0.0, 0.0], [0.0, 0.0, 0.0, 0.0, 0.0, zz]);
    let of = |slides, a, alpha, d, theta, (mass, com, inertia), rotor, friction| Row {
        slides,
        a,
        alpha,
        d,
        theta,
        mass,
        com,
        inertia,
        rotor,
        friction,
    };
    let rows = [
        of(false, 0.5, 0.0, 1.0, 0.0, body(20.0, -0.25, 4.0), [1.0, 0.01], viscous(5e-5)),
        of(false, 0.5, PI, 0.0, 0.0, body(20.0, -0.25, 4.0), [1.0, 0.01], viscous(5e-5)),
        of(true, 0.0, 0.0, 0.5, 0.0, body(10.0, 0.0, 0.0), [50.0, 0.005], viscous(25.0)),
        of(false, 0.0, 0.0, 0.0, -FRAC_PI_2, body(0.0, 0.0, 1.0), [20.0, 0.001], viscous(2.0)),
    ];
    Chain::new(rows, [0.0, 0.0, -9.81])
}

pub const SCARA_LIMITS: ([f64; 4], [f64; 4]) = ([4.0, 5.0, 1.2, 12.0], [250.0, 120.0, 400.0, 30.0]);

/// An arm of random numbers: both kinds of joints, oblique axes, rotors, all friction.
pub fn random<const N: usize>(random: &mut impl FnMut() -> f64) -> Chain<N> {
    let mut between = |low: f64, high: f64| low + (high - low) * random();
    let rows = std::array::from_fn(|i| {
        let slides = between(0.0, 1.0) < 0.25;
        // A body of three points masses is always possible.
        let size = between(0.02, 0.2);
        let moments = [between(0.2, 1.0), between(0.2, 1.0), between(0.2, 1.0)].map(|x| x * size * size);
        let mass = between(0.3, 8.0) / (i + 1) as f64;
        let [x, y, z] = moments.map(|m| m * mass);
        Row {
            slides,
            a: between(-0.4, 0.4),
            alpha: between(-2.0, 2.0),
            d: between(-0.3, 0.3),
            theta: between(-3.0, 3.0),
            mass,
            com: [between(-0.2, 0.2), between(-0.2, 0.2), between(-0.2, 0.2)],
            inertia: [y + z, 0.0, x + z, 0.0, 0.0, x + y],
            rotor: if between(0.0, 1.0) < 0.5 { [between(20.0, 100.0), between(1e-6, 1e-4)] } else { [0.0, 0.0] },
            friction: JointFriction {
                viscous: between(0.0, 3.0),
                coulomb: between(0.0, 3.0),
                offset: between(-0.5, 0.5),
                load: between(0.0, 0.1),
                ..JointFriction::default()
            },
        }
    });
    Chain::new(rows, [between(-3.0, 3.0), between(-3.0, 3.0), -9.0])
}
