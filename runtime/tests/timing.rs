//! Time-optimal motion: exact optima, the gap on random paths, limits between nodes, places of faults.

use crate::common::chain::{self, Chain, PANDA_LIMITS, SCARA_LIMITS, UR5_LIMITS};
use armgen_runtime::timing::{
    time_optimal, Ends, JointFriction, JointPath, Limits, Node, PathDynamics, PathError, PathFault, Piece, Profile, Segment,
    Timing, TimingError, TimingFault, Workspace,
};
use armgen_runtime::trajectory::Progress;
use nalgebra::{DMatrix, DVector, SVector};
use std::time::Duration;

/// Random numbers in [0, 1) (Knuth's linear congruences).
pub(crate) fn random(seed: u64) -> impl FnMut() -> f64 {
    let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

/// The natural cubic spline through points, knots by chord length.
fn spline<const N: usize>(points: &[SVector<f64, N>]) -> Vec<Piece<f64, N>> {
    let n = points.len() - 1;
    let h: Vec<f64> = points.windows(2).map(|p| (p[1] - p[0]).norm()).collect();
    let mut system = DMatrix::zeros(n + 1, n + 1);
    system[(0, 0)] = 1.0;
    system[(n, n)] = 1.0;
    for i in 1..n {
        (system[(i, i - 1)], system[(i, i)], system[(i, i + 1)]) = (h[i - 1], 2.0 * (h[i - 1] + h[i]), h[i]);
    }
    let lu = system.lu();
    let mut second = vec![SVector::<f64, N>::zeros(); n + 1];
    for joint in 0..N {
        let right = DVector::from_fn(n + 1, |i, _| match i {
            0 => 0.0,
            i if i == n => 0.0,
            i => 6.0 * ((points[i + 1] - points[i])[joint] / h[i] - (points[i] - points[i - 1])[joint] / h[i - 1]),
        });
        let solution = lu.solve(&right).expect("a spline");
        (0..=n).for_each(|i| second[i][joint] = solution[i]);
    }
    let mut start = 0.0;
    (0..n)
        .map(|i| {
            let mut coefficients = [SVector::zeros(); 6];
            coefficients[0] = points[i];
            coefficients[1] = (points[i + 1] - points[i]) / h[i] - (second[i] * 2.0 + second[i + 1]) * (h[i] / 6.0);
            coefficients[2] = second[i] / 2.0;
            coefficients[3] = (second[i + 1] - second[i]) / (6.0 * h[i]);
            let piece = Piece::new(start, h[i], coefficients);
            start += h[i];
            piece
        })
        .collect()
}

/// Three to seven points, anywhere within `range` of zero.
pub(crate) fn random_path<const N: usize>(
    next: &mut impl FnMut() -> f64,
    range: [f64; N],
) -> JointPath<f64, N, Vec<Piece<f64, N>>> {
    let count = 3 + (next() * 5.0) as usize;
    let points: Vec<SVector<f64, N>> = (0..count).map(|_| SVector::from_fn(|j, _| range[j] * (2.0 * next() - 1.0))).collect();
    JointPath::new(spline(&points)).expect("a path")
}

pub(crate) fn with_timing<R: PathDynamics<N, Real = f64>, const N: usize, A>(
    robot: &R,
    path: &JointPath<f64, N, Vec<Piece<f64, N>>>,
    limits: &Limits<f64, N>,
    ends: Ends<f64>,
    goal: f64,
    segments: usize,
    judge: impl FnOnce(Result<Timing<'_, f64, N>, TimingError>) -> A,
) -> A {
    let (mut nodes, mut segments) = (vec![Node::empty(); 2 * segments + 64], vec![Segment::empty(); segments + 1]);
    let work = Workspace { nodes: &mut nodes, segments: &mut segments };
    judge(time_optimal(robot, path, limits, ends, goal, work))
}

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

const FREE: f64 = f64::INFINITY;

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

/// An arm of one joint, and the path from 0 to `length` in one piece.
pub(crate) fn one_joint(slides: bool, friction: [f64; 2], gravity: [f64; 3], mass: f64) -> Chain<1> {
    let friction = JointFriction { viscous: friction[0], coulomb: friction[1], ..JointFriction::default() };
    let a = if slides { 0.0 } else { 1.0 };
    let row = chain::Row {
        slides,
        a,
        alpha: 0.0,
        d: 0.0,
        theta: 0.0,
        mass,
        com: [0.0; 3],
        inertia: [0.0; 6],
        rotor: [0.0; 2],
        friction,
    };
    Chain::new([row], gravity)
}

pub(crate) fn line<const N: usize>(length: f64, from: [f64; N], to: [f64; N]) -> JointPath<f64, N, Vec<Piece<f64, N>>> {
    JointPath::new(vec![Piece::line(0.0, length, from, to)]).expect("a line")
}

fn inside<const N: usize>(
    name: &str,
    robot: &Chain<N>,
    path: &JointPath<f64, N, Vec<Piece<f64, N>>>,
    limits: [[f64; N]; 2],
    exact: f64,
) {
    let [velocity, effort] = limits;
    let limits = Limits::velocity(velocity).unwrap().with_effort(effort.map(|x| -x), effort).unwrap();
    with_timing(robot, path, &limits, Ends { hold: false, ..Ends::at_rest() }, 1e-4, 700, |timing| {
        let timing = timing.unwrap_or_else(|error| panic!("{name}: {error}"));
        println!("{name}: {:.9} <= {exact:.9} <= {:.9}, {} segments", timing.lower_bound(), timing.seconds(), timing.segments());
        assert!(timing.lower_bound() <= exact * (1.0 + 1e-12) && exact <= timing.seconds() * (1.0 + 1e-12), "{name}");
        assert!(timing.gap() < 1e-3, "{name}: {}", timing.gap());
        let share = worst(robot, &timing, velocity, [FREE; N], effort, 50);
        assert!(share <= 1.0 + 1e-9, "{name}: {share}");
    });
}

#[test]
fn a_slide_with_friction_has_the_time_of_its_closed_form() {
    let (mass, viscous, coulomb, force, way) = (2.0, 1.5, 2.0, 10.0, 0.5);
    // m dv = F - F_c - F_v v, then m dv = -F - F_c - F_v v: exponentials, and the time of the switch by bisection.
    let (rate, top, low) = (viscous / mass, (force - coulomb) / viscous, (force + coulomb) / viscous);
    let after = |t: f64| {
        let v = top * -f64::exp_m1(-rate * t);
        let s = top * t - v / rate;
        let stop = f64::ln_1p(v / low) / rate;
        (s + (v + low) * -f64::exp_m1(-rate * stop) / rate - low * stop, t + stop)
    };
    let (mut left, mut right) = (0.0, 10.0);
    for _ in 0..200 {
        let middle = 0.5 * (left + right);
        if after(middle).0 < way {
            left = middle
        } else {
            right = middle
        }
    }
    let slide = one_joint(true, [viscous, coulomb], [0.0; 3], mass);
    inside("slide", &slide, &line(1.0, [0.0], [way]), [[3.0], [force]], after(left).1);
    // The same path backwards, and with s in other units.
    for unit in [1e-6, 1e6] {
        inside("slide in other units", &slide, &line(unit, [way], [0.0]), [[3.0], [force]], after(left).1);
    }
}

/// m v' = F - f(v), then m v' = -F - f(v): times and ways by Simpson's rule over v, and the speed of the switch by bisection.
#[test]
fn a_slide_with_curved_friction_has_the_time_of_its_integrals() {
    let (mass, force, way) = (2.0, 10.0, 0.5);
    for (cubic, stribeck, velocity) in [(1.5, 0.0, 0.0), (-0.4, 0.0, 0.0), (0.0, 4.0, 0.2), (1.0, 3.0, 0.05)] {
        let mut slide = one_joint(true, [0.7, 1.0], [0.0; 3], mass);
        (slide.friction[0].cubic, slide.friction[0].stribeck, slide.friction[0].stribeck_velocity) = (cubic, stribeck, velocity);
        let decay = |v: f64| if stribeck > 0.0 { stribeck * (-v / velocity).exp() } else { 0.0 };
        let friction = |v: f64| 0.7 * v + 1.0 + cubic * v.powi(3) + decay(v);
        let simpson = |f: &dyn Fn(f64) -> f64, to: f64| {
            let h = to / 4000.0;
            let weight = |i: i32| [2.0, 4.0][i as usize % 2];
            let inner: f64 = (1..4000).map(|i| weight(i) * f(h * f64::from(i))).sum();
            (f(0.0) + inner + f(to)) * h / 3.0
        };
        let after = |top: f64| {
            let of = |power: i32| {
                simpson(&|v| mass * v.powi(power) * (1.0 / (force - friction(v)) + 1.0 / (force + friction(v))), top)
            };
            (of(1), of(0))
        };
        let (mut left, mut right) = (0.0, 1.6);
        for _ in 0..60 {
            let middle = 0.5 * (left + right);
            *(if after(middle).0 < way { &mut left } else { &mut right }) = middle;
        }
        inside("slide", &slide, &line(1.0, [0.0], [way]), [[3.0], [force]], after(left).1);
        inside("slide, backwards", &slide, &line(1e3, [way], [0.0]), [[3.0], [force]], after(left).1);
    }
}

#[test]
fn a_pendulum_has_the_time_of_its_energy() {
    let (gravity, way) = (9.81, 2.0f64);
    let pendulum = one_joint(false, [0.0; 2], [gravity, 0.0, 0.0], 1.0);
    for torque in [15.0, 8.0] {
        // w²/2 is the work of torque and gravity from either end; with t = v² at each end the integrands are smooth (Simpson).
        let half = 0.5 * way + gravity * (1.0 - way.cos()) / (2.0 * torque);
        let simpson = |f: &dyn Fn(f64) -> f64, to: f64| {
            let n = 20_000;
            let h = to / n as f64;
            (0..=n)
                .map(|i| {
                    f((i as f64 * h).max(1e-9))
                        * if i == 0 || i == n {
                            1.0
                        } else if i % 2 == 1 {
                            4.0
                        } else {
                            2.0
                        }
                })
                .sum::<f64>()
                * h
                / 3.0
        };
        let rise = |v: f64| 2.0 * v / (2.0 * (torque * v * v - gravity * (1.0 - (v * v).cos()))).sqrt();
        let fall = |v: f64| 2.0 * v / (2.0 * (torque * v * v + gravity * ((way - v * v).cos() - way.cos()))).sqrt();
        let exact = simpson(&rise, half.sqrt()) + simpson(&fall, (way - half).sqrt());
        inside("pendulum", &pendulum, &line(1.0, [0.0], [way]), [[20.0], [torque]], exact);
    }
}

#[test]
fn inertia_alone_has_the_time_of_a_trapezoid() {
    let link = chain::Row { slides: false, a: 1.0, mass: 1.0, ..one_row() };
    let arm = Chain::new([link, link], [0.0, 0.0, -9.81]);
    let path = |way: f64| line(1.0, [0.0, 0.5 * std::f64::consts::PI], [way, 0.5 * std::f64::consts::PI]);
    // B_11 = 3 kg m² with the elbow at a right angle; a = 20/3.
    inside("triangle", &arm, &path(1.0), [[100.0; 2], [20.0, 100.0]], 2.0 * (3.0f64 / 20.0).sqrt());
    inside("trapezoid", &arm, &path(2.0), [[1.0, 100.0], [20.0, 100.0]], 2.15);
}

/// The least and the greatest u at s and x = ds² within torques; `None` where there is none.
fn slopes<const N: usize>(chain: &Chain<N>, piece: &Piece<f64, N>, effort: f64, s: f64, x: f64) -> Option<[f64; 2]> {
    let at = piece.at(s);
    // Dry friction has its sign at rest, too.
    let x = x.max(1e-14);
    let rest = chain.torque_with_friction(&at.q, &(at.slope * x.sqrt()), &(at.curvature * x));
    let inertial = chain.path_dynamics(&at.q, &at.slope, &at.curvature).inertial;
    let mut found = [f64::NEG_INFINITY, f64::INFINITY];
    for (m, rest) in inertial.iter().zip(&rest) {
        let ends = [(-effort - rest) / m, (effort - rest) / m];
        found = [found[0].max(ends[0].min(ends[1])), found[1].min(ends[0].max(ends[1]))];
    }
    (found[0] < found[1]).then_some(found)
}

/// The time of full drive until full braking (Bobrow, Dubowsky, Gibson 1985), by the method of Runge and Kutta from both ends; `None` where
/// these two profiles do not meet.
fn drive_and_brake<const N: usize>(chain: &Chain<N>, piece: &Piece<f64, N>, effort: f64) -> Option<f64> {
    let steps = 2000u16;
    let h = piece.length / f64::from(steps);
    let profile = |from: f64, h: f64, end: usize| {
        let slope = |s: f64, x: f64| slopes(chain, piece, effort, s, x).map(|u| 2.0 * u[end]);
        let (mut all, mut x) = (vec![0.0], 0.0f64);
        for i in 0..steps {
            let s = from + h * f64::from(i);
            let next = || {
                let a = slope(s, x)?;
                let b = slope(s + 0.5 * h, x + 0.5 * h * a)?;
                let c = slope(s + 0.5 * h, x + 0.5 * h * b)?;
                let d = slope(s + h, x + h * c)?;
                Some(x + h / 6.0 * (a + 2.0 * b + 2.0 * c + d))
            };
            let Some(reached) = next().filter(|x| *x > 0.0) else { break };
            x = reached;
            all.push(x);
        }
        all
    };
    let (drive, brake) = (profile(piece.start, h, 1), profile(piece.end(), -h, 0));
    let last = usize::from(steps);
    let brake = |i: usize| brake.get(last - i).copied();
    let switch = (1..last).find(|i| drive.get(*i).zip(brake(*i)).is_some_and(|(drive, brake)| *drive >= brake))?;
    brake(switch - 1)?;
    let x = |i: usize| if i < switch { drive.get(i).copied() } else { brake(i) };
    (0..last).map(|i| Some(2.0 * h / (x(i)?.sqrt() + x(i + 1)?.sqrt()))).sum()
}

fn driven<const N: usize>(seeds: std::ops::Range<u64>) -> usize {
    let mut found = 0;
    for seed in seeds {
        let mut next = random(seed);
        let chain: Chain<N> = chain::random(&mut next);
        let mut point = || std::array::from_fn(|_| 1.5 * next() - 0.75);
        let (path, effort) = (line(1.0, point(), point()), 60.0);
        let Some(exact) = drive_and_brake(&chain, &path.pieces()[0], effort) else { continue };
        let limits = Limits::velocity([FREE; N]).unwrap().with_effort([-effort; N], [effort; N]).unwrap();
        with_timing(&chain, &path, &limits, Ends { hold: false, ..Ends::at_rest() }, 2e-4, 1500, |timing| {
            let timing = timing.unwrap_or_else(|error| panic!("arm {seed}: {error}"));
            let [low, high] = [timing.lower_bound() / exact - 1.0, timing.seconds() / exact - 1.0];
            assert!(low < 1e-5 && high > -1e-5 && high - low < 1e-3, "arm {seed}: {exact}, {low:e} {high:e}");
        });
        found += 1;
    }
    found
}

/// Made-up arms of two and three joints on lines between two postures, with viscous friction, dry friction, and such that grows with the load.
#[test]
fn the_time_is_that_of_full_drive_and_full_braking() {
    let found = [driven::<2>(1..16), driven::<3>(16..31)];
    assert!(found[0] >= 5 && found[1] >= 5, "{found:?}");
}

fn one_row() -> chain::Row {
    let friction = JointFriction::default();
    chain::Row {
        slides: false,
        a: 0.0,
        alpha: 0.0,
        d: 0.0,
        theta: 0.0,
        mass: 1.0,
        com: [0.0; 3],
        inertia: [0.0; 6],
        rotor: [0.0; 2],
        friction,
    }
}

#[test]
fn every_fault_has_its_place() {
    let pieces = |all: &[[f64; 3]]| {
        let mut start = 0.0;
        let pieces = all.iter().map(|[from, to, other]| {
            let piece = Piece::line(start, 1.0, [*from, 0.0], [*to, *other]);
            start += 1.0;
            piece
        });
        JointPath::new(pieces.collect::<Vec<_>>()).map(|_| ())
    };
    let fault = |s: f64, piece: usize, fault: PathFault| Err(PathError { s, piece, fault });
    assert_eq!(JointPath::<f64, 2, Vec<Piece<f64, 2>>>::new(vec![]).unwrap_err().fault, PathFault::Empty);
    assert_eq!(pieces(&[[0.0, f64::NAN, 0.0]]).unwrap_err().fault, PathFault::NotFinite);
    assert_eq!(pieces(&[[0.0, 1.0, 0.0], [1.0, 1.0, 0.0]]), fault(1.0, 1, PathFault::ZeroLength));
    assert!(
        matches!(pieces(&[[0.0, 1.0, 0.0], [1.1, 2.0, 0.0]]).unwrap_err().fault, PathFault::Jump { joint: 0, by } if (by - 0.1).abs() < 1e-12)
    );
    assert!(
        matches!(pieces(&[[0.0, 1.0, 0.0], [1.0, 1.0, 1.0]]).unwrap_err().fault, PathFault::Corner { angle } if (angle - std::f64::consts::FRAC_PI_2).abs() < 1e-5)
    );
    assert_eq!(pieces(&[[0.0, 1.0, 0.0], [1.0, 3.0, 0.0]]), fault(1.0, 1, PathFault::Scale));
    // q = (s - 1/2)²: the joint stops half-way and turns back.
    let mut cusp = Piece::line(0.0, 1.0, [0.25, 0.0], [0.25, 0.0]);
    (cusp.coefficients[1][0], cusp.coefficients[2][0]) = (-1.0, 1.0);
    let error = JointPath::new(vec![cusp]).map(|_| ()).unwrap_err();
    assert!(error.fault == PathFault::TurningBack && (error.s - 0.5).abs() < 1e-9, "{error}");

    let pendulum = one_joint(false, [0.0; 2], [9.81, 0.0, 0.0], 1.0);
    let timed = |from: f64, to: f64, torque: f64, ends: Ends<f64>| {
        let limits = Limits::velocity([20.0]).unwrap().with_effort([-torque], [torque]).unwrap();
        with_timing(&pendulum, &line(1.0, [from], [to]), &limits, ends, 1e-3, 400, |timing| timing.map(|t| t.seconds()))
    };
    let error = timed(0.0, 2.0, 8.0, Ends::at_rest()).unwrap_err();
    assert!(
        matches!(error.fault, TimingFault::EndNotHeld { joint: 0, torque, limit } if (torque - 9.81 * 2f64.sin()).abs() < 1e-12 && limit == 8.0)
    );
    assert_eq!(error.s, 1.0);
    // The work of 6 N m is that of gravity at 6 q = 9.81 (1 - cos q), q = 1.438 of 3: there the arm is at rest again.
    for (from, to, torque, [low, high]) in [(0.0, 3.0, 6.0, [0.46, 0.50]), (1.2, 2.9, 8.0, [0.0, 0.02])] {
        let error = timed(from, to, torque, Ends { hold: false, ..Ends::at_rest() }).unwrap_err();
        assert!(matches!(error.fault, TimingFault::InfeasibleSpeed { joint: 0, .. }), "{error}");
        assert!(low <= error.s && error.s <= high, "{error}");
    }
    // From there the arm falls back at once, with friction and without.
    for friction in [[0.0; 2], [0.5, 0.1]] {
        let (arm, limits) = (one_joint(false, friction, [9.81, 0.0, 0.0], 1.0), Limits::velocity([20.0]).unwrap());
        let limits = limits.with_effort([-8.0], [8.0]).unwrap();
        let ends = Ends { hold: false, ..Ends::at_rest() };
        let error =
            with_timing(&arm, &line(1.0, [1.2], [2.9]), &limits, ends, 1e-3, 400, |timing| timing.map(|_| ())).unwrap_err();
        assert!(matches!(error.fault, TimingFault::InfeasibleSpeed { proved: true, .. }) && error.s == 0.0, "{error}");
    }
    let fast = timed(0.0, 1.0, 15.0, Ends { speed: [21.0, 0.0], hold: false }).unwrap_err();
    assert!(matches!(fast.fault, TimingFault::InfeasibleSpeed { proved: true, .. }), "{fast}");
    let limits = Limits::velocity([FREE]).unwrap();
    let error =
        with_timing(&pendulum, &line(1.0, [0.0], [1.0]), &limits, Ends::at_rest(), 1e-3, 400, |timing| timing.map(|_| ()))
            .unwrap_err();
    assert_eq!(error.fault, TimingFault::MissingLimit { joint: 0 });
    let limits = Limits::velocity([1.0]).unwrap();
    let error = with_timing(&pendulum, &line(1.0, [0.0], [9.0]), &limits, Ends::at_rest(), 1e-3, 8, |timing| timing.map(|_| ()))
        .unwrap_err();
    assert!(matches!(error.fault, TimingFault::TooCoarse { segments } if segments > 8), "{error}");
    assert!(Limits::velocity([0.0]).is_err() && Limits::velocity([1.0]).unwrap().with_effort([0.0], [1.0]).is_err());
}

/// Torques along paths lie in their enclosures; the largest |f - quadratic|/error.
fn enclosures<const N: usize>(
    chain: &Chain<N>,
    limits: &Limits<f64, N>,
    path: &JointPath<f64, N, Vec<Piece<f64, N>>>,
    places: usize,
    next: &mut impl FnMut() -> f64,
) -> f64 {
    with_timing(chain, path, limits, Ends { hold: false, ..Ends::at_rest() }, 1e-2, 3000, |timing| {
        let Ok(timing) = timing else { return 0.0 };
        let mut worst = 0.0f64;
        for _ in 0..places {
            let (i, t) = ((next() * timing.segments() as f64) as usize, next());
            let p = timing.profile(i).expect("a segment");
            let of = timing.reference(&Progress { s: p.start + t * p.length, ds: 1.0, dds: 0.0 });
            let exact = chain.path_dynamics(&of.q, &of.dq, &of.ddq);
            let [value, error] = timing.enclosure(i, t).expect("a segment");
            for (exact, value, error) in [
                (exact.inertial, value.inertial, error.inertial),
                (exact.velocity, value.velocity, error.velocity),
                (exact.gravity, value.gravity, error.gravity),
            ] {
                for j in 0..N {
                    let away = (exact[j] - value[j]).abs();
                    assert!(away <= error[j], "joint {j}: {away:e} of {:e}", error[j]);
                    if error[j] > 0.0 {
                        worst = worst.max(away / error[j]);
                    }
                }
            }
        }
        worst
    })
}

/// What random arms came to: the largest |f - quadratic|/error and share of a limit, paths that are timed, with a gap above 0.5 %, and
/// neither timed nor proved impossible.
#[derive(Default)]
struct Tally {
    error: f64,
    share: f64,
    timed: usize,
    loose: usize,
    undecided: usize,
}

fn random_arm<const N: usize>(seed: u64, paths: u64, places: usize, dense: usize, tally: &mut Tally) {
    let mut next = random(1000 + seed);
    let chain: Chain<N> = chain::random(&mut next);
    let velocity = std::array::from_fn(|_| 1.0 + 3.0 * next());
    let effort = std::array::from_fn(|i| (30.0 + 200.0 * next()) / (1.0 + i as f64) + 20.0);
    let limits = Limits::velocity(velocity).unwrap().with_effort(effort.map(|x: f64| -x), effort).unwrap();
    for number in 0..paths {
        let path = random_path(&mut next, [2.0; N]);
        tally.error = tally.error.max(enclosures(&chain, &limits, &path, places, &mut next));
        with_timing(&chain, &path, &limits, Ends { hold: false, ..Ends::at_rest() }, 1e-3, 1500, |timing| match timing {
            Ok(timing) => {
                tally.timed += 1;
                let share = worst(&chain, &timing, velocity, [FREE; N], effort, dense);
                assert!(share <= 1.0 + 1e-9, "arm {seed}, path {number}: {share}");
                assert!(timing.gap() >= 0.0, "arm {seed}, path {number}: gap {}", timing.gap());
                // Where only momentum carries a slide that is nearly too heavy for its motor, a millionth of a torque is a percent of x.
                tally.loose += usize::from(timing.gap() > 5e-3);
                tally.share = tally.share.max(share);
            }
            // Neither timed nor proved impossible.
            Err(error) if matches!(error.fault, TimingFault::TooCoarse { .. }) => tally.undecided += 1,
            // A slide of a random arm may be too weak for its load.
            Err(error) => assert!(
                matches!(error.fault, TimingFault::InfeasiblePoint { .. } | TimingFault::InfeasibleSpeed { .. }),
                "arm {seed}, path {number}: {error}"
            ),
        });
    }
}

/// Arms of four and of six joints in turn.
fn random_arms(arms: u64, paths: u64, places: usize, dense: usize) {
    let mut tally = Tally::default();
    for seed in 0..arms {
        match seed % 2 {
            0 => random_arm::<4>(seed, paths, places, dense, &mut tally),
            _ => random_arm::<6>(seed, paths, places, dense, &mut tally),
        }
    }
    let (Tally { error, share, timed, loose, undecided }, all) = (tally, (arms * paths) as usize);
    let left = 1.0 - share;
    println!(
        "{timed} of {all} timed, {loose} loosely, {undecided} undecided; |f - quadratic|/error at most {error:.2}, limits at most 1 - {left:.1e}"
    );
    assert!(
        timed * 2 > all && loose * 50 <= all && undecided * 10 <= all,
        "{timed} timed, {loose} loosely, {undecided} undecided"
    );
    assert!(error > 0.3, "the bound is far too large: {error}");
}

#[test]
fn random_arms_keep_their_enclosures_and_limits() {
    random_arms(4, 1, 2000, 20);
}

/// On five paths each; `ARMGEN_RANDOM_ARMS` is another number of arms.
#[test]
#[ignore = "wide"]
fn many_random_arms_keep_their_enclosures_and_limits() {
    let arms = std::env::var("ARMGEN_RANDOM_ARMS").map_or(20, |text| text.parse().expect("ARMGEN_RANDOM_ARMS is a number"));
    random_arms(arms, 5, 10_000, 100);
}

/// Laws of less torque, of one joint each, keep the limits, and so does the larger of two of them at each place; none is above the bound,
/// and none takes less time than the lower bound.
fn larger_of_two<const N: usize>(
    name: &str,
    chain: &Chain<N>,
    (velocity, effort): ([f64; N], [f64; N]),
    range: [f64; N],
    paths: u64,
) {
    let of = |velocity, effort: [f64; N]| {
        Limits::velocity(velocity).and_then(|of| of.with_effort(effort.map(|x| -x), effort)).expect("limits")
    };
    let ends = Ends { hold: false, ..Ends::at_rest() };
    let (mut worst, mut crossings, mut pairs) = (0.0f64, 0, 0);
    for seed in 0..paths {
        let mut next = random(500 + seed);
        let path = random_path(&mut next, range);
        let mut of_less = || {
            let mut less = (velocity, effort);
            let (slow, weak) = ((next() * N as f64) as usize, (next() * N as f64) as usize);
            less.0[slow] *= 0.6 + 0.4 * next();
            less.1[weak] *= 0.6 + 0.4 * next();
            with_timing(chain, &path, &of(less.0, less.1), ends, 1e-2, 1000, |timing| {
                // Too little torque for its load.
                let timing = timing.ok()?;
                Some((0..timing.segments()).map(|i| timing.profile(i).expect("a segment")).collect::<Vec<_>>())
            })
        };
        let (Some(one), Some(other)) = (of_less(), of_less()) else { continue };
        pairs += 1;
        let at = |law: &[Profile<f64>], s: f64| {
            let p = law[law.partition_point(|p| p.start <= s).max(1) - 1];
            let (t, middle) = ((s - p.start) / p.length, 0.5 * (p.x[0] + p.x[1]) + p.k);
            let r = 1.0 - t;
            (p.x[0] * r * r + 2.0 * middle * r * t + p.x[1] * t * t, ((middle - p.x[0]) * r + (p.x[1] - middle) * t) / p.length)
        };
        with_timing(chain, &path, &of(velocity, effort), ends, 1e-3, 1000, |timing| {
            let timing = timing.expect("a timing");
            let end = path.pieces().last().map_or(0.0, Piece::end);
            let (mut time, mut first) = (0.0, None);
            let places = 20_000;
            for i in 0..places {
                let s = end * (f64::from(i) + 0.5) / f64::from(places);
                let (a, b) = (at(&one, s), at(&other, s));
                let (x, u) = if a.0 >= b.0 { a } else { b };
                crossings += usize::from(first.is_some_and(|first| first != (a.0 >= b.0)));
                first = Some(a.0 >= b.0);
                time += end / f64::from(places) / x.sqrt();
                let at = timing.reference(&Progress { s, ds: x.sqrt(), dds: u });
                let tau = chain.torque_with_friction(&at.q, &at.dq, &at.ddq);
                for j in 0..N {
                    worst = worst.max(at.dq[j].abs() / velocity[j]).max(tau[j].abs() / effort[j]);
                }
            }
            for i in 0..timing.segments() {
                let p = timing.profile(i).expect("a segment");
                let x = at(&one, p.start).0.max(at(&other, p.start).0);
                assert!(x <= p.bound * (1.0 + 1e-9), "{name}, path {seed}, segment {i}: {x} above {}", p.bound);
            }
            // The sum over the places misses a little of the time at rest.
            assert!(
                time * (1.0 + 1e-2) >= timing.lower_bound(),
                "{name}, path {seed}: {time} s are less than {}",
                timing.lower_bound()
            );
        });
    }
    println!("{name}: {pairs} pairs of laws, {crossings} crossings, share 1 - {:.1e}", 1.0 - worst);
    assert!(worst <= 1.0 + 1e-9 && pairs * 2 > paths as usize && crossings > 0, "{name}: {worst}");
}

#[test]
fn the_larger_of_two_laws_is_a_law() {
    larger_of_two("scara", &chain::scara(), SCARA_LIMITS, [2.5, 2.5, 0.3, 3.0], 3);
    larger_of_two("ur5, friction", &chain::ur5(), UR5_LIMITS, [3.0; 6], 2);
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

/// Coefficients, lengths and limits of any size, signs at random: an error or a motion within its limits.
fn strange<const N: usize>(chain: &Chain<N>, count: u64) -> usize {
    let sizes = [0.0, 5e-324, 1e-310, 1e-160, 1e-30, 1e-9, 1e-3, 0.5, 1.0, 1.0, 1.0, 2.0, 30.0, 1e6, 1e12, 1e40, 1e160, f64::MAX];
    let mut timed = 0;
    for seed in 0..count {
        let mut next = random(7000 + seed);
        // Most numbers are of a usual size.
        let mut any = |strange: f64| {
            let usual = next() > strange;
            let size = if usual { 0.1 + next() } else { sizes[(next() * sizes.len() as f64) as usize] };
            size * if next() < 0.5 { -1.0 } else { 1.0 }
        };
        let share = [0.01, 0.05, 0.3][seed as usize % 3];
        let (mut start, mut pieces) = (any(share), Vec::new());
        for _ in 0..1 + seed % 3 {
            let length = any(share).abs();
            let mut coefficients = [SVector::zeros(); 6].map(|of: SVector<f64, N>| of.map(|_| any(share)));
            if let Some(last) = pieces.last().map(|last: &Piece<f64, N>| last.at(last.end())).filter(|_| any(0.0) > 0.0) {
                (coefficients[0], coefficients[1]) = (last.q, last.slope);
            }
            pieces.push(Piece::new(start, length, coefficients));
            start += length;
        }
        let (velocity, effort) = ([(); N].map(|()| any(share).abs() * 3.0), [(); N].map(|()| any(share).abs() * 100.0));
        let Ok(path) = JointPath::new(pieces) else { continue };
        let Ok(limits) = Limits::velocity(velocity).and_then(|of| of.with_effort(effort.map(|x| -x), effort)) else { continue };
        let speed = if seed % 5 == 0 { [any(0.5).abs(), any(0.5).abs()] } else { [0.0; 2] };
        with_timing(chain, &path, &limits, Ends { speed, hold: false }, 1e-2, 300, |timing| {
            let Ok(timing) = timing else { return };
            timed += 1;
            assert!(timing.seconds() > 0.0 && timing.lower_bound() <= timing.seconds(), "{seed}: {}", timing.seconds());
            for i in 0..timing.segments() {
                for t in [0.01, 0.3, 0.7, 0.99] {
                    let at = timing.reference(&timing.at(i, t).expect("a segment"));
                    let tau = chain.torque_with_friction(&at.q, &at.dq, &at.ddq);
                    for j in 0..N {
                        let share = (at.dq[j].abs() / velocity[j]).max(tau[j].abs() / effort[j]);
                        assert!(share <= 1.0 + 1e-9, "{seed}, joint {j}, segment {i} at {t}: {share}");
                    }
                }
            }
        });
    }
    timed
}

#[test]
fn strange_numbers_are_an_error_or_a_motion() {
    let slide = one_joint(true, [1.0, 0.5], [0.0; 3], 2.0);
    let timed = [strange(&slide, 3000), strange(&chain::scara(), 1000)];
    println!("{timed:?} are timed");
    assert!(timed.iter().all(|timed| *timed > 20), "{timed:?}");
}
