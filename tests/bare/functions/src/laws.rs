//! Motion at the limit: a path of the SCARA timed within 48 segments and led by a governor, and laws with limits on the Panda. The same bits
//! on every machine.

use crate::panda7_fast::{Nominal, DOF};
use armgen_runtime::{
    clik::{self, JointLimits},
    control::{self, HandGuiding, Impedance, NullSpace, OperationalSpace, TorqueLimits, Walls},
    linalg::{quadratic_program, Damping},
    nalgebra::{SMatrix, SVector},
    reference::{OperationalReference, Pose, State},
    task::{Row, Task},
    timing::{
        time_optimal, Command, Ends, Governed, Governor, JointFriction, JointPath, Limits, LinkBound, Node, PathModel, Piece,
        Segment, Timing, Workspace,
    },
};
use core::{fmt, time::Duration};

/// Segments of the timing: all of the storage.
pub const SEGMENTS: usize = 48;
/// States at which the laws are called.
pub const STATES: u32 = 11;
/// Samples of the governor.
pub const SAMPLES: u32 = 400;

type Scara = crate::scara_fast::Nominal;
type Line = JointPath<f32, 4, [Piece<f32, 4>; 1]>;
type Model = PathModel<'static, Scara, f32, 4>;

/// Storage of a timing, 30 kB: an array of each, that is never moved.
pub type Nodes = [Node<f32, 4>; 2 * 16 + 1];
/// The other part of it.
pub type Segments = [Segment<f32, 4>; SEGMENTS + 1];

/// Arm, path and limits of a timing.
#[derive(Debug)]
pub struct Motion {
    model: Model,
    path: Line,
    limits: Limits<f32, 4>,
}

impl Motion {
    /// `None` where a number is impossible.
    pub fn new() -> Option<Motion> {
        let link = |joint: usize, distance, [mass, first_moment, inertia]: [f32; 3], [coupling, reflected]: [f32; 2]| LinkBound {
            parent: joint.checked_sub(1),
            slides: joint == 2,
            distance,
            mass,
            first_moment,
            inertia,
            coupling,
            reflected,
        };
        let links = [
            link(0, 0.0, [20.0, 5.0, 5.26], [0.01, 0.01]),
            link(1, 0.5, [20.0, 5.0, 5.26], [0.01, 0.01]),
            link(2, 0.5, [10.0, 0.0, 0.001], [0.25, 12.5]),
            link(3, 0.0, [0.0, 0.0, 1.0], [0.02, 0.4]),
        ];
        let friction = [5e-5, 5e-5, 25.0, 2.0].map(|viscous| JointFriction { viscous, ..JointFriction::default() });
        let piece = Piece::line(0.0, 1.0, [0.0, 0.5, 0.1, 0.0], [1.0, 1.1, 0.2, 0.7]);
        let effort = [250.0, 120.0, 400.0, 30.0];
        let limits = Limits::velocity([4.0, 5.0, 1.2, 12.0]).ok()?.with_effort(effort.map(|x: f32| -x), effort).ok()?;
        let model = PathModel { robot: &crate::scara_fast::Nominal, friction, links, gravity: 9.81 };
        Some(Motion { model, path: JointPath::new([piece]).ok()?, limits })
    }
}

/// The fastest motion, refined until the storage is full.
#[inline(never)]
pub fn timing<'w>(motion: &'w Motion, nodes: &'w mut Nodes, segments: &'w mut Segments) -> Option<Timing<'w, f32, 4>> {
    let Motion { model, path, limits } = motion;
    let work = Workspace { nodes, segments };
    time_optimal(model, path, limits, Ends::at_rest(), 1e-6, work).ok()
}

/// Another command every 40 samples.
fn command(sample: u32) -> Command<f32> {
    match sample / 40 % 4 {
        0 => Command::Override(1.0),
        1 => Command::Override(0.4),
        2 => Command::Stop,
        _ => Command::Override(0.8),
    }
}

/// A sample of the governor, at 250 Hz.
#[inline(never)]
pub fn governor_step(governor: &mut Governor<'_, f32, 4>, sample: u32) -> Governed<f32, 4> {
    governor.advance(Duration::from_millis(4), command(sample))
}

fn numbers<const N: usize>(state: u32, quantity: u32) -> SVector<f32, N> {
    SVector::from(crate::numbers::<N>(state, quantity))
}

/// Seven unknowns and fourteen bounds, a square of random numbers and the unit matrix: a program of joint rates.
#[inline(never)]
pub fn rate_program(state: u32) -> Option<SVector<f32, DOF>> {
    let a = SMatrix::<f32, DOF, DOF>::from_fn(|i, k| crate::numbers::<DOF>(state + 3 * i as u32, 2)[k]);
    let h = a.tr_mul(&a) + SMatrix::identity() * 0.1;
    let above = SMatrix::<f32, DOF, DOF>::identity();
    let found = quadratic_program(&h, &(numbers::<DOF>(state, 3) * 4.0), &[above, -above], &[SVector::repeat(-0.3); 2]);
    found.ok().map(|found| found.x)
}

/// The laws.
#[derive(Clone, Debug)]
pub struct Laws {
    impedance: Impedance<f32, DOF, 6>,
    guiding: HandGuiding<f32, DOF>,
    torques: control::Limited<f32, DOF, 6>,
    rates: clik::Limited<f32, DOF, 6>,
}

impl Laws {
    /// `None` where a setting is impossible.
    pub fn new() -> Option<Laws> {
        let task = Task::new([Row::X, Row::Y, Row::Z, Row::Rx, Row::Ry, Row::Rz]).ok()?;
        let (one, range) = ([1.0; DOF], [3.2; DOF]);
        let joints = JointLimits::rates([2.0; DOF]).ok()?.with_range(range.map(|x| -x), range).ok()?;
        let joints = joints.with_acceleration([10.0; DOF]).ok()?;
        let null_space = NullSpace::new([10.0; DOF], [8.0; DOF], [0.5; DOF]).ok()?;
        let damping = Damping::below(0.02).at_most(0.1).ok()?;
        let law = OperationalSpace::new(task, [100.0; 6], [20.0; 6], [0.0; 6], 1e-3).ok()?;
        let law = law.with_damping(damping).with_null_space(null_space);
        let walls = Walls::new(range.map(|x| -x), range, [0.2; DOF], [50.0; DOF], one).ok()?;
        Some(Laws {
            impedance: Impedance::new(task, [300.0, 300.0, 300.0, 20.0, 20.0, 20.0], 0.7).ok()?.with_null_space(null_space),
            guiding: HandGuiding::new(one).ok()?.with_walls(walls),
            torques: control::Limited::new(law, TorqueLimits::new([87.0; DOF]).ok()?, joints, 8e-3, 0.7).ok()?,
            rates: clik::Limited::new(task, [5.0; 6], 1e-2, joints).ok()?.with_damping(damping),
        })
    }
}

fn state(number: u32) -> State<f32, DOF> {
    State { q: numbers(number, 0), dq: numbers::<DOF>(number, 1) * 0.3 }
}

fn reference(number: u32) -> OperationalReference<f32> {
    OperationalReference::at_rest(Pose::of(&Nominal, &(numbers::<DOF>(number, 0) * 0.98)))
}

/// The torque of the impedance.
#[inline(never)]
pub fn impedance_step(laws: &Laws, number: u32) -> Option<SVector<f32, DOF>> {
    laws.impedance.torque(&Nominal, &reference(number), &state(number)).ok().map(|torque| torque.tau)
}

/// The torque of an arm that is led by hand.
#[inline(never)]
pub fn guiding_step(laws: &mut Laws, number: u32) -> Option<SVector<f32, DOF>> {
    laws.guiding.torque(&Nominal, &state(number)).ok().map(|torque| torque.tau)
}

/// The torque within limits of torque, rate and position.
#[inline(never)]
pub fn limited_torque_step(laws: &mut Laws, number: u32) -> Option<SVector<f32, DOF>> {
    laws.torques.torque(&Nominal, &reference(number), &state(number)).ok().map(|limited| limited.torque.tau)
}

/// The joint rates within limits.
#[inline(never)]
pub fn limited_rate_step(laws: &Laws, number: u32) -> Option<SVector<f32, DOF>> {
    laws.rates.step(&Nominal, &state(number), &reference(number)).ok().map(|step| step.state.dq)
}

/// Numbers as they are printed on both machines: the bits.
#[derive(Clone, Copy, Debug)]
pub struct BitsLine<'a> {
    /// Their name.
    pub name: &'static str,
    /// Which of this name.
    pub number: u32,
    /// The numbers.
    pub values: &'a [f32],
}

impl fmt::Display for BitsLine<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "bits {} {}", self.name, self.number)?;
        self.values.iter().try_for_each(|value| write!(f, " {:08x}", value.to_bits()))
    }
}

/// Hands the lines of all results to `visit`, as long as it succeeds.
///
/// # Errors
/// That of `visit`, or where a result is missing.
#[inline(never)]
pub fn each_line(visit: &mut dyn FnMut(&BitsLine<'_>) -> fmt::Result) -> fmt::Result {
    timed_lines(visit)?;
    let mut laws = Laws::new().ok_or(fmt::Error)?;
    for number in 0..STATES {
        for (name, values) in [
            ("rate_program", rate_program(number)),
            ("impedance", impedance_step(&laws, number)),
            ("guiding", guiding_step(&mut laws, number)),
            ("limited_torque", limited_torque_step(&mut laws, number)),
            ("limited_rate", limited_rate_step(&laws, number)),
        ] {
            visit(&BitsLine { name, number, values: values.ok_or(fmt::Error)?.as_slice() })?;
        }
    }
    Ok(())
}

fn timed_lines(visit: &mut dyn FnMut(&BitsLine<'_>) -> fmt::Result) -> fmt::Result {
    let motion = Motion::new().ok_or(fmt::Error)?;
    let mut nodes: Nodes = [Node::empty(); 33];
    let mut segments: Segments = [Segment::empty(); SEGMENTS + 1];
    let timing = timing(&motion, &mut nodes, &mut segments).ok_or(fmt::Error)?;
    visit(&BitsLine { name: "timing", number: timing.segments() as u32, values: &[timing.seconds(), timing.lower_bound()] })?;
    for number in 0..timing.segments() {
        let profile = timing.profile(number).ok_or(fmt::Error)?;
        visit(&BitsLine { name: "law", number: number as u32, values: &[profile.x[0], profile.x[1], profile.k] })?;
    }
    let mut storage = [[0.0; 2]; SEGMENTS];
    let mut governor = Governor::new(&timing, &mut storage).ok_or(fmt::Error)?;
    for sample in 0..SAMPLES {
        let at = governor_step(&mut governor, sample);
        if sample % 10 == 9 {
            visit(&BitsLine { name: "governor", number: sample, values: at.reference.q.as_slice() })?;
        }
    }
    Ok(())
}
