//! Optima in closed form, by integrals, and by full drive and full braking.

use crate::common::chain::{self, Chain};
use crate::common::paths::{line, one_joint, random, with_timing, FREE};
use armgen_runtime::timing::{Ends, JointFriction, JointPath, Limits, PathDynamics, Piece};

use super::worst;

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

/// A joint on the base with a point of 1 kg at its origin, of which tests change what they need.
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
