//! The program of docs/pick-and-place.md: a path timed, executed, stopped half-way and resumed.

// The page begins here.
use armgen_runtime::control::{InverseDynamics, TorqueLimits};
use armgen_runtime::nalgebra::SVector;
use armgen_runtime::reference::State;
use armgen_runtime::robot::Dynamics;
use armgen_runtime::simulation::{Integrator, Plant};
use armgen_runtime::timing::{
    time_optimal, Command, Ends, Governor, JointFriction, JointPath, Limits, LinkBound, Node, PathModel, Phase, Piece, Segment,
    Workspace,
};
use std::error::Error;
use std::time::Duration;

type Joints = SVector<f64, 4>;

const POINTS: [[f64; 4]; 4] = [[-0.8, 1.6, 0.35, 0.0], [-0.8, 1.6, 0.1, 0.0], [0.6, 1.2, 0.1, 1.2], [0.6, 1.2, 0.35, 1.2]];
const TORQUES: [f64; 4] = [60.0, 30.0, 200.0, 15.0];

/// Lines between the points. A corner is a quintic from `d` before the point to `d` after it.
fn path(d: f64) -> Vec<Piece<f64, 4>> {
    let points = POINTS.map(Joints::from);
    let along = |i: usize| (points[i + 1] - points[i]).normalize();
    let (mut pieces, mut s, mut from) = (Vec::new(), 0.0, points[0]);
    for i in 1..4 {
        let to = if i < 3 { points[i] - along(i - 1) * d } else { points[3] };
        let length = (to - from).norm();
        pieces.push(Piece::line(s, length, from.into(), to.into()));
        s += length;
        if i < 3 {
            let (a, b, p) = (along(i - 1), along(i), points[i]);
            let control = [p - a * d, p - a * (0.6 * d), p - a * (0.2 * d), p + b * (0.2 * d), p + b * (0.6 * d), p + b * d];
            // From control points to powers of s: differences, binomial coefficients, the length 2 d.
            let (mut row, mut scale) = (control, 1.0);
            let coefficients = std::array::from_fn(|k| {
                let c = row[0] * scale;
                row = std::array::from_fn(|j| if j < 5 { row[j + 1] - row[j] } else { row[j] });
                scale *= (5.0 - k as f64) / (k as f64 + 1.0) / (2.0 * d);
                c
            });
            pieces.push(Piece::new(s, 2.0 * d, coefficients));
            s += 2.0 * d;
            from = p + b * d;
        }
    }
    pieces
}

/// The robot, with friction and the lengths, masses and inertias that bound derivatives along a path.
fn model<R: Dynamics<4, Real = f64>>(robot: &R) -> PathModel<'_, R, f64, 4> {
    let viscous = |viscous| JointFriction { viscous, ..JointFriction::default() };
    let link = |joint: usize, distance, [mass, first_moment, inertia]: [f64; 3], [coupling, reflected]: [f64; 2]| LinkBound {
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
    PathModel { robot, friction: [viscous(5e-5), viscous(5e-5), viscous(25.0), viscous(2.0)], links, gravity: 9.81 }
}

/// What a run has to tell.
#[derive(Debug)]
pub struct Report {
    /// Duration of the motion without a stop, and the time that no motion on this path can beat, s.
    pub planned: [f64; 2],
    /// Share of the path at which the arm rested, and when it arrived at the end, s.
    pub stopped_at: f64,
    pub arrived: f64,
    /// The largest torque of each joint as a share of its limit, and the largest error of a joint, rad or m.
    pub torque: Joints,
    pub error: f64,
}

/// Times the path, and executes it with a stop of a second half-way.
pub fn pick_and_place<R: Dynamics<4, Real = f64>>(robot: &R) -> Result<Report, Box<dyn Error>> {
    let path = JointPath::new(path(0.125))?;
    let limits = Limits::velocity([3.0, 4.0, 1.0, 6.0])?.with_effort(TORQUES.map(|x| -x), TORQUES)?;
    let (mut nodes, mut segments) = (vec![Node::empty(); 2000], vec![Segment::empty(); 1000]);
    let work = Workspace { nodes: &mut nodes, segments: &mut segments };
    let timing = time_optimal(&model(robot), &path, &limits, Ends::at_rest(), 1e-3, work)?;

    let mut storage = vec![[0.0; 2]; timing.segments()];
    let mut governor = Governor::new(&timing, &mut storage).ok_or("an interval for each segment")?;
    // The motion leaves nothing for errors; the motors have a tenth more.
    let law = InverseDynamics::new([400.0; 4], [40.0; 4])?.with_torque_limits(TorqueLimits::new(TORQUES.map(|x| 1.1 * x))?);
    let mut arm = Plant::new(robot, State::at_rest(POINTS[0].into()), Integrator::RungeKutta4 { substeps: 1 });
    let whole = path.pieces().last().map_or(0.0, Piece::end);
    let mut report = Report {
        planned: [timing.seconds(), timing.lower_bound()],
        stopped_at: 0.0,
        arrived: 0.0,
        torque: Joints::zeros(),
        error: 0.0,
    };
    let period = Duration::from_millis(1);
    let (mut rested, mut now) = (0, governor.sample());
    for k in 1..10_000 {
        // The torque for this millisecond, held until the next.
        let torque = law.torque(robot, &now.reference, arm.state())?.tau;
        arm.advance(&torque, period.as_secs_f64())?;
        let stop = now.progress.s > 0.5 * whole && rested < 1000;
        now = governor.advance(period, if stop { Command::Stop } else { Command::Override(1.0) });
        if now.phase == Phase::Held {
            rested += 1;
            report.stopped_at = now.progress.s / whole;
        }
        report.torque = report.torque.sup(&torque.component_div(&Joints::from(TORQUES)).abs());
        report.error = report.error.max((now.reference.q - arm.state().q).amax());
        if now.phase == Phase::Ended {
            report.arrived = k as f64 * period.as_secs_f64();
            break;
        }
    }
    Ok(report)
}
// The page ends here.

use crate::common::{close, scara::Scara};

#[test]
fn the_page_of_pick_and_place_does_what_it_says() {
    let report = pick_and_place(&Scara::nominal()).unwrap();
    println!("{report:#?}");
    let [duration, bound] = report.planned;
    close("duration", duration, 1.8712, 2e-4);
    assert!(duration / bound < 1.001 && bound < duration);
    // The stop is past the middle, and takes its second and the time of braking and starting again.
    assert!(report.stopped_at > 0.5 && report.stopped_at < 0.9, "{}", report.stopped_at);
    assert!(report.arrived > duration + 1.0 && report.arrived < duration + 2.0, "{}", report.arrived);
    // The reference keeps its limits; feedback adds to that where the acceleration jumps within a sample.
    assert!(report.torque.amax() < 1.08 && report.torque.amax() > 0.98 && report.error < 2e-4);

    let page = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/pick-and-place.md")).unwrap();
    let text = include_str!("pick_and_place.rs");
    let program =
        text.split("// The page begins here.\n").nth(1).and_then(|text| text.split("// The page ends here.").next()).unwrap();
    assert!(page.contains(program), "docs/pick-and-place.md has another program");
}
