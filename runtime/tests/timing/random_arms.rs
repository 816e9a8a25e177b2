//! Arms of random numbers: enclosures of torques, limits between nodes, and the larger of two laws.

use crate::common::chain::{self, Chain, SCARA_LIMITS, UR5_LIMITS};
use crate::common::paths::{random, random_path, with_timing, FREE};
use armgen_runtime::timing::{Ends, JointPath, Limits, PathDynamics, Piece, Profile, TimingFault};
use armgen_runtime::trajectory::Progress;

use super::worst;

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
