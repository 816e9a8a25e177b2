//! Time-optimal motion: the gap on random paths, limits between nodes, samples.

use crate::common::chain::{self, Chain, PANDA_LIMITS, SCARA_LIMITS, UR5_LIMITS};
use crate::common::paths::{random, random_path, with_timing, FREE};
use armgen_runtime::timing::{
    time_optimal, Ends, JointFriction, JointPath, Limits, Node, Piece, Segment, Timing, TimingError, Workspace,
};
use std::time::Duration;

mod exact;
mod faults;
mod random_arms;

/// The largest share of a limit that dynamics written apart find at `places` places of each segment.
fn worst<const N: usize>(
    chain: &Chain<N>,
    timing: &Timing<'_, f64, N>,
    velocity: [f64; N],
    acceleration: [f64; N],
    effort: [f64; N],
    places: usize,
) -> f64 {
    let mut worst = 0.0f64;
    for i in 0..timing.segments() {
        let p = timing.profile(i).expect("a segment");
        let ([low, high], slack) = (p.interval, 1e-9 * p.bound);
        assert!((low - slack..=high + slack).contains(&p.x[0]), "segment {i}: {} outside of {low} to {high}", p.x[0]);
        for place in 0..=places {
            let t = place as f64 / places as f64;
            // Inside: at the ends the sign of a rate may be that of the neighbour.
            let t = 1e-9 + (1.0 - 2e-9) * t;
            let progress = timing.at(i, t).expect("a segment");
            assert!(progress.ds > 0.0, "at rest at {t} of segment {i}");
            let at = timing.reference(&progress);
            let tau = chain.torque_with_friction(&at.q, &at.dq, &at.ddq);
            for j in 0..N {
                worst =
                    worst.max(at.dq[j].abs() / velocity[j]).max(at.ddq[j].abs() / acceleration[j]).max(tau[j].abs() / effort[j]);
            }
        }
    }
    worst
}

fn table<const N: usize>(
    name: &str,
    chain: &Chain<N>,
    (velocity, effort): ([f64; N], [f64; N]),
    acceleration: [f64; N],
    range: [f64; N],
    paths: u64,
) {
    let limits = Limits::velocity(velocity)
        .unwrap()
        .with_acceleration(acceleration)
        .unwrap()
        .with_effort(effort.map(|x| -x), effort)
        .unwrap();
    let (mut gaps, mut shares, mut counts) = (Vec::new(), 0.0f64, Vec::new());
    for seed in 0..paths {
        let path = random_path(&mut random(seed + 1), range);
        with_timing(chain, &path, &limits, Ends { hold: false, ..Ends::at_rest() }, 1e-3, 1000, |timing| {
            let timing = timing.unwrap_or_else(|error| panic!("{name}, path {seed}: {error}"));
            gaps.push(timing.gap());
            counts.push(timing.segments());
            let share = worst(chain, &timing, velocity, acceleration, effort, 28);
            assert!(share <= 1.0 + 1e-9, "{name}, path {seed}: {share}");
            shares = shares.max(share);
            assert!(timing.gap() >= 0.0, "{name}, path {seed}: {}", timing.gap());
        });
    }
    gaps.sort_by(f64::total_cmp);
    counts.sort_unstable();
    let (median, largest) = (gaps[gaps.len() / 2], gaps[gaps.len() - 1]);
    println!(
        "{name}: gap median {median:.2e}, largest {largest:.2e}; segments {}; share 1 - {:.1e}",
        counts[counts.len() / 2],
        1.0 - shares
    );
    assert!(largest <= 1e-3, "{name}: {largest}");
}

/// What storage holds from an earlier path is no part of the next.
#[test]
fn storage_of_an_earlier_path_changes_nothing() {
    let (chain, (velocity, effort)) = (chain::ur5(), UR5_LIMITS);
    let limits = Limits::velocity(velocity).and_then(|of| of.with_effort(effort.map(|x| -x), effort)).expect("limits");
    let mut next = random(11);
    let paths = [(); 2].map(|()| random_path(&mut next, [3.0; 6]));
    let (mut nodes, mut segments) = (vec![Node::empty(); 2064], vec![Segment::empty(); 1001]);
    for path in paths.iter().chain(&paths) {
        let timed = |timing: Result<Timing<'_, f64, 6>, TimingError>| {
            let timing = timing.expect("a timing");
            (timing.segments(), timing.duration(), timing.lower_bound())
        };
        let ends = Ends { hold: false, ..Ends::at_rest() };
        let work = Workspace { nodes: &mut nodes, segments: &mut segments };
        let again = timed(time_optimal(&chain, path, &limits, ends, 1e-3, work));
        assert_eq!(again, with_timing(&chain, path, &limits, ends, 1e-3, 1000, timed));
    }
}

#[test]
fn few_random_paths_are_timed_to_a_thousandth() {
    table("scara", &chain::scara(), SCARA_LIMITS, [FREE; 4], [2.5, 2.5, 0.3, 3.0], 2);
    table("ur5", &chain::ur5().without_friction(), UR5_LIMITS, [FREE; 6], [3.0; 6], 1);
    table("ur5, friction", &chain::ur5(), UR5_LIMITS, [FREE; 6], [3.0; 6], 1);
    let curved = chain::scara().with_curved_friction(SCARA_LIMITS, 0.2, 0.1);
    table("scara, curved friction", &curved, SCARA_LIMITS, [FREE; 4], [2.5, 2.5, 0.3, 3.0], 1);
}

/// Cubic friction of a fifth of the torque at the limit of speed, and Stribeck friction of a tenth of it that is gone at a tenth of that speed.
#[test]
#[ignore = "wide"]
fn random_paths_with_curved_friction_are_timed_to_a_thousandth() {
    let of_panda = [2.5, 1.7, 2.5, 1.5, 2.5, 1.8, 2.5];
    let scara = chain::scara().with_curved_friction(SCARA_LIMITS, 0.2, 0.1);
    table("scara", &scara, SCARA_LIMITS, [FREE; 4], [2.5, 2.5, 0.3, 3.0], 100);
    let ur5 = chain::ur5().with_curved_friction(UR5_LIMITS, 0.2, 0.1);
    table("ur5", &ur5, UR5_LIMITS, [FREE; 6], [3.0; 6], 100);
    let negative = chain::ur5().with_curved_friction(UR5_LIMITS, -0.05, 0.1);
    table("ur5, negative", &negative, UR5_LIMITS, [FREE; 6], [3.0; 6], 50);
    let panda = chain::panda().with_curved_friction(PANDA_LIMITS, 0.2, 0.1);
    table("panda", &panda, PANDA_LIMITS, [FREE; 7], of_panda, 100);
}

#[test]
#[ignore = "wide"]
fn random_paths_are_timed_to_a_thousandth() {
    let of_panda = [2.5, 1.7, 2.5, 1.5, 2.5, 1.8, 2.5];
    table("scara", &chain::scara(), SCARA_LIMITS, [FREE; 4], [2.5, 2.5, 0.3, 3.0], 100);
    table("scara, acceleration", &chain::scara(), SCARA_LIMITS, [8.0, 10.0, 4.0, 30.0], [2.5, 2.5, 0.3, 3.0], 100);
    table("ur5", &chain::ur5().without_friction(), UR5_LIMITS, [FREE; 6], [3.0; 6], 100);
    table("ur5, friction", &chain::ur5(), UR5_LIMITS, [FREE; 6], [3.0; 6], 100);
    table("ur5, friction, acceleration", &chain::ur5(), UR5_LIMITS, [10.0; 6], [3.0; 6], 100);
    table("panda", &chain::panda().without_friction(), PANDA_LIMITS, [FREE; 7], of_panda, 100);
    table("panda, friction", &chain::panda(), PANDA_LIMITS, [FREE; 7], of_panda, 100);
    table(
        "panda, acceleration",
        &chain::panda().without_friction(),
        PANDA_LIMITS,
        [15.0, 7.5, 10.0, 12.5, 15.0, 20.0, 20.0],
        of_panda,
        100,
    );
}

#[test]
fn samples_follow_the_law_and_end_at_the_end() {
    let chain = chain::scara();
    let path = random_path(&mut random(5), [2.0, 2.0, 0.3, 3.0]);
    let limits = Limits::velocity(SCARA_LIMITS.0).unwrap().with_effort(SCARA_LIMITS.1.map(|x| -x), SCARA_LIMITS.1).unwrap();
    with_timing(&chain, &path, &limits, Ends::at_rest(), 1e-3, 1000, |timing| {
        let timing = timing.expect("a timing");
        let end = timing.duration();
        assert!((end.as_secs_f64() - timing.seconds()).abs() < 3e-9 && end.as_secs_f64() >= timing.seconds());
        let (first, last) = (path.pieces()[0], path.pieces()[path.pieces().len() - 1]);
        assert_eq!(timing.sample(Duration::ZERO).q, first.at(first.start).q);
        assert!((timing.sample(end).q - last.at(last.end()).q).amax() < 1e-12 && timing.sample(end).dq.amax() == 0.0);
        assert_eq!(timing.sample(end + Duration::from_secs(3)).dq.amax(), 0.0);
        let step = Duration::from_micros(10);
        for i in 1..200u32 {
            let t = end * i / 200;
            let [before, at, after] = [t - step, t, t + step].map(|t| timing.sample(t));
            let h = step.as_secs_f64();
            assert!(((after.q - before.q) / (2.0 * h) - at.dq).amax() < 2e-3, "at {t:?}");
        }
    });
}

/// Where q'' jumps, u may jump, too: each side of the knot bounds x by itself. Two slides of 1 kg, across each other, with 1 N each; on the
/// motion x = 1 + 1/(2 q_2'^2) the second motor gives all of its force, in both directions in turn.
#[test]
fn a_jump_of_curvature_bounds_each_side_by_itself() {
    let slide = |alpha: f64, mass: f64| chain::Row {
        slides: true,
        a: 0.0,
        alpha,
        d: 0.0,
        theta: 0.0,
        mass,
        com: [0.0; 3],
        inertia: [0.0; 6],
        rotor: [0.0; 2],
        friction: JointFriction::default(),
    };
    let crane = Chain::new([slide(std::f64::consts::FRAC_PI_2, 0.0), slide(0.0, 1.0)], [0.0; 3]);
    let piece = |start: f64, [from, slope, curvature]: [f64; 3]| {
        let mut piece = Piece::line(start, 0.2, [start, 0.0], [start + 0.2, 0.0]);
        for (to, c) in piece.coefficients.iter_mut().zip([from, slope, 0.5 * curvature]) {
            to[1] = c;
        }
        piece
    };
    let path = JointPath::new(vec![piece(0.0, [0.0, 0.8, 1.0]), piece(0.2, [0.18, 1.0, -1.0])]).expect("a path");
    let limits = Limits::velocity([10.0; 2]).unwrap().with_effort([-1.0; 2], [1.0; 2]).unwrap();
    let x = |s: f64| 1.0 + 0.5 / if s < 0.2 { (0.8 + s) * (0.8 + s) } else { (1.2 - s) * (1.2 - s) };
    let ends = Ends { speed: [x(0.0).sqrt(), x(0.4).sqrt()], ..Ends::at_rest() };
    let possible: f64 = (0..4000).map(|i| 1e-4 / x((f64::from(i) + 0.5) * 1e-4).sqrt()).sum();
    with_timing(&crane, &path, &limits, ends, 1e-3, 1000, |timing| {
        let timing = timing.expect("a timing");
        println!("possible in {possible}, at least {}, found {}", timing.lower_bound(), timing.seconds());
        assert!(timing.lower_bound() <= possible * (1.0 + 1e-7) && timing.gap() < 2e-3);
    });
}
