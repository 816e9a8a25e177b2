//! How a path is passed: stops, shares of the limits of speed, limits of the end effector.

use crate::common::chain::{self, Chain, PANDA_LIMITS, SCARA_LIMITS, TIP, UR5_LIMITS};
use crate::common::paths::{random, random_path, with_timing};
use armgen_runtime::timing::{
    Command, Ends, Governor, JointFriction, JointPath, Limit, Limits, PathDynamics, PathError, PathFault, Phase, Piece, Timing,
    ToolLimit,
};
use nalgebra::SVector;
use std::time::Duration;

type Bounds<const N: usize> = ([f64; N], [f64; N]);

fn limits<const N: usize>((velocity, effort): Bounds<N>) -> Limits<f64, N> {
    Limits::velocity(velocity).and_then(|of| of.with_effort(effort.map(|x| -x), effort)).expect("limits")
}

const FALLS: Ends<f64> = Ends { speed: [0.0; 2], hold: false };

/// Values at 28 places inside each segment, by dynamics written apart: the largest share of torques, of speeds and their limit on the
/// piece, and of both limits of the end effector.
fn shares<const N: usize>(
    chain: &Chain<N>,
    timing: &Timing<'_, f64, N>,
    pieces: &[Piece<f64, N>],
    (velocity, effort): Bounds<N>,
    tool: [f64; 2],
) -> [f64; 4] {
    let mut most = [0.0f64; 4];
    for i in 0..timing.segments() {
        for place in 0..=28 {
            let progress = timing.at(i, 1e-9 + (1.0 - 2e-9) * f64::from(place) / 28.0).expect("a segment");
            let piece = pieces.iter().rfind(|piece| piece.start <= progress.s).expect("a piece");
            let at = timing.reference(&progress);
            let tau = chain.torque_with_friction(&at.q, &at.dq, &at.ddq);
            let rate = chain.tool_rate(&at.q, &at.dq);
            let turn = rate.fixed_rows::<3>(3).norm() / (tool[1] * piece.speed);
            for j in 0..N {
                most[0] = most[0].max(tau[j].abs() / effort[j]);
                most[1] = most[1].max(at.dq[j].abs() / (velocity[j] * piece.speed));
            }
            most[2] = most[2].max(rate.fixed_rows::<3>(0).norm() / (tool[0] * piece.speed));
            most[3] = most[3].max(turn);
        }
    }
    most
}

/// Two lines with a corner at the second of three random points, where the motion rests if asked to.
fn corner<const N: usize>(next: &mut impl FnMut() -> f64, range: [f64; N], stop: bool) -> [Piece<f64, N>; 2] {
    let [a, b, c] = [(); 3].map(|()| SVector::<f64, N>::from_fn(|j, _| range[j] * (2.0 * next() - 1.0)));
    let first = Piece::line(0.0, (b - a).norm(), a.into(), b.into());
    [first, Piece { stop, ..Piece::line(first.end(), (c - b).norm(), b.into(), c.into()) }]
}

fn stops<const N: usize>(name: &str, chain: &Chain<N>, bounds: Bounds<N>, range: [f64; N]) {
    let mut next = random(3);
    let open = JointPath::new(corner(&mut random(3), range, false).to_vec());
    assert!(matches!(open, Err(PathError { piece: 1, fault: PathFault::Corner { .. }, .. })), "{name}: {open:?}");
    let pieces = corner(&mut next, range, true);
    let path = JointPath::new(pieces.to_vec()).expect("a path");
    let alone = pieces.map(|piece| {
        let path = JointPath::new(vec![piece]).expect("a path");
        with_timing(chain, &path, &limits(bounds), FALLS, 1e-3, 600, |timing| {
            let timing = timing.expect("a timing");
            [timing.seconds(), timing.lower_bound()]
        })
    });
    let [duration, lower] = [0, 1].map(|k| alone[0][k] + alone[1][k]);
    with_timing(chain, &path, &limits(bounds), FALLS, 1e-3, 1200, |timing| {
        let timing = timing.unwrap_or_else(|error| panic!("{name}: {error}"));
        assert!(timing.seconds() >= lower && timing.lower_bound() <= duration, "{name}: {alone:?} {}", timing.seconds());
        assert!(timing.gap() <= 1e-3, "{name}: {}", timing.gap());
        let rests: Vec<f64> =
            (1..timing.segments()).filter_map(|i| timing.profile(i)).filter(|of| of.x[0] == 0.0).map(|of| of.start).collect();
        assert_eq!(rests, [pieces[1].start], "{name}");
        let most = shares(chain, &timing, &pieces, bounds, [1.0; 2]);
        assert!(most[0].max(most[1]) <= 1.0 + 1e-9 && most[0].max(most[1]) > 0.99, "{name}: {most:?}");
        // Led at changing speeds, the arm still rests at the corner.
        let mut storage = vec![[0.0; 2]; timing.segments()];
        let mut governor = Governor::new(&timing, &mut storage).expect("storage");
        let (mut least, mut command, mut samples) = (f64::INFINITY, Command::Override(1.0), 0);
        loop {
            samples += 1;
            if next() < 0.01 {
                command = Command::Override(0.2 + 0.8 * next());
            }
            let at = governor.advance(Duration::from_micros(500), command);
            if (at.progress.s - pieces[1].start).abs() < 1e-3 {
                least = least.min(at.progress.ds);
            }
            for j in 0..N {
                assert!(at.reference.dq[j].abs() <= bounds.0[j] * (1.0 + 1e-9), "{name}: {at:?}");
            }
            if at.phase == Phase::Ended {
                break;
            }
            assert!(samples < 1_000_000, "{name}: {at:?}");
        }
        assert!(least < 0.02, "{name}: at the corner ds is {least}");
    });
}

#[test]
fn a_path_that_stops_is_two_paths() {
    stops("scara", &chain::scara(), SCARA_LIMITS, [2.5, 2.5, 0.3, 3.0]);
    stops("ur5", &chain::ur5(), UR5_LIMITS, [2.0; 6]);
}

#[test]
fn speeds_are_shares_of_their_limits_on_a_piece() {
    let (chain, bounds) = (chain::ur5().without_friction(), UR5_LIMITS);
    let path = random_path(&mut random(5), [2.0; 6]);
    let mut pieces = path.pieces().to_vec();
    let middle = pieces.len() / 2;
    pieces[middle].speed = 0.2;
    let free = with_timing(&chain, &path, &limits(bounds), FALLS, 1e-3, 1000, |timing| timing.expect("a timing").seconds());
    let path = JointPath::new(pieces.clone()).expect("a path");
    with_timing(&chain, &path, &limits(bounds), FALLS, 1e-3, 1000, |timing| {
        let timing = timing.expect("a timing");
        let most = shares(&chain, &timing, &pieces, bounds, [1.0; 2]);
        assert!(most[0].max(most[1]) <= 1.0 + 1e-9 && most[1] > 0.999, "{most:?}");
        assert!(timing.gap() <= 1e-3 && timing.lower_bound() > 1.1 * free, "{} {free}", timing.lower_bound());
    });
    for speed in [0.0, -1.0, 1.1, f64::NAN, 1e-20] {
        pieces[0].speed = speed;
        let error = JointPath::new(pieces.clone()).expect_err("no share");
        assert_eq!(error.fault, PathFault::Speed);
    }
}

fn led<const N: usize>(name: &str, chain: &Chain<N>, bounds: Bounds<N>, range: [f64; N], seed: u64) {
    let path = random_path(&mut random(seed), range);
    let free = with_timing(chain, &path, &limits(bounds), FALLS, 1e-3, 1000, |timing| {
        shares(chain, &timing.expect("a timing"), path.pieces(), bounds, [1.0; 2])
    });
    // TIP is given in the frame of the last joint.
    let tool = ToolLimit { speed: 0.5 * free[2], turn_rate: 0.6 * free[3], joint: N - 1, distance: TIP.norm() };
    let limited = limits(bounds).with_tool(tool).expect("limits");
    with_timing(chain, &path, &limited, FALLS, 1e-3, 1000, |timing| {
        let timing = timing.unwrap_or_else(|error| panic!("{name}: {error}"));
        let most = shares(chain, &timing, path.pieces(), bounds, [tool.speed, tool.turn_rate]);
        assert!(most.iter().all(|share| *share <= 1.0 + 1e-9) && most[2].max(most[3]) > 0.999, "{name}: {most:?}");
        assert!(timing.gap() <= 1e-3, "{name}: {}", timing.gap());
        let margins = timing.margins();
        assert!(
            (margins.tool[0] - most[2]).abs() < 1e-2 && (margins.tool[1] - most[3]).abs() < 1e-2,
            "{name}: {margins:?} {most:?}"
        );
        let binds = (0..timing.segments()).filter_map(|i| timing.binding(i)).any(|of| of.0 == Limit::ToolSpeed && of.2 > 0.99);
        assert!(binds, "{name}");
        let mut storage = vec![[0.0; 2]; timing.segments()];
        let mut governor = Governor::new(&timing, &mut storage).expect("storage");
        let (mut next, mut command) = (random(seed), Command::Override(1.0));
        loop {
            if next() < 0.01 {
                command = Command::Override(0.2 + 0.8 * next());
            }
            let at = governor.advance(Duration::from_millis(1), command);
            let rate = chain.tool_rate(&at.reference.q, &at.reference.dq);
            assert!(rate.fixed_rows::<3>(0).norm() <= tool.speed * (1.0 + 1e-9), "{name}: {at:?}");
            assert!(rate.fixed_rows::<3>(3).norm() <= tool.turn_rate * (1.0 + 1e-9), "{name}: {at:?}");
            if at.phase == Phase::Ended {
                break;
            }
        }
    });
}

#[test]
fn the_end_effector_keeps_its_limits() {
    led("scara", &chain::scara(), SCARA_LIMITS, [2.5, 2.5, 0.3, 3.0], 1);
    led("ur5", &chain::ur5(), UR5_LIMITS, [3.0; 6], 2);
    led("panda", &chain::panda().without_friction(), PANDA_LIMITS, [1.5; 7], 4);
}

/// A joint that turns moves the end effector at its distance from the axis: the limit of one is a limit of the other.
#[test]
fn the_end_effector_of_one_joint_takes_the_time_of_its_closed_form() {
    let joint = chain::Row {
        slides: false,
        a: 0.5,
        alpha: 0.3,
        d: 1.0,
        theta: 0.0,
        mass: 20.0,
        com: [0.0; 3],
        inertia: [0.0, 0.0, 0.0, 0.0, 0.0, 4.0],
        rotor: [0.0; 2],
        friction: JointFriction::default(),
    };
    let chain = Chain::new([joint], [0.0, 0.0, -9.81]);
    let (radius, way, v, a) = (TIP.xy().norm(), 2.0, 1.5, 4.0);
    let path = JointPath::new(vec![Piece::line(0.0, way, [0.0], [way])]).expect("a path");
    let exact = way / v + v / a;
    for (speed, turn_rate) in [(v * radius, f64::INFINITY), (f64::INFINITY, v)] {
        let tool = ToolLimit { speed, turn_rate, joint: 7, distance: TIP.norm() };
        let limits = Limits::velocity([100.0]).and_then(|of| of.with_acceleration([a])).and_then(|of| of.with_tool(tool));
        with_timing(&chain, &path, &limits.expect("limits"), FALLS, 1e-4, 600, |timing| {
            let timing = timing.expect("a timing");
            assert!(
                timing.lower_bound() <= exact * (1.0 + 1e-12) && exact <= timing.seconds() * (1.0 + 1e-12),
                "{} {exact}",
                timing.seconds()
            );
            assert!(timing.gap() <= 1e-4, "{}", timing.gap());
        });
    }
    for (speed, turn_rate, distance) in
        [(0.0, 1.0, 0.0), (1.0, -1.0, 0.0), (f64::NAN, 1.0, 0.0), (1.0, 1.0, -1.0), (1.0, 1.0, f64::NAN)]
    {
        let tool = ToolLimit { speed, turn_rate, joint: 0, distance };
        assert!(Limits::velocity([1.0]).and_then(|of| of.with_tool(tool)).is_err(), "{tool:?}");
    }
}
