//! Stops, overrides and resumes: every sample keeps the limits by dynamics written apart, and the end is always reached.

use crate::common::chain::{self, Chain, PANDA_LIMITS, SCARA_LIMITS, UR5_LIMITS};
use crate::common::paths::{line, one_joint, random, random_path, with_timing};
use armgen_runtime::timing::{Command, Ends, Governed, Governor, JointPath, Limits, Phase, Piece, Timing};
use std::time::Duration;

/// The limits of a test: speed, torque.
type Bounds<const N: usize> = ([f64; N], [f64; N]);

fn limits<const N: usize>((velocity, effort): Bounds<N>) -> Limits<f64, N> {
    Limits::velocity(velocity).unwrap().with_effort(effort.map(|x| -x), effort).unwrap()
}

/// The largest share of a limit at a sample.
fn share<const N: usize>(chain: &Chain<N>, (velocity, effort): Bounds<N>, at: &Governed<f64, N>) -> f64 {
    let reference = &at.reference;
    let tau = chain.torque_with_friction(&reference.q, &reference.dq, &reference.ddq);
    (0..N).fold(0.0, |most: f64, j| most.max(reference.dq[j].abs() / velocity[j]).max(tau[j].abs() / effort[j]))
}

/// What random commands came to.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    samples: usize,
    commands: usize,
    /// The largest share of a limit.
    worst: f64,
    /// Stops that came to rest, and the longest time until then, s.
    rests: usize,
    longest: f64,
}

impl Tally {
    fn add(&mut self, other: &Tally) {
        self.samples += other.samples;
        self.commands += other.commands;
        self.worst = self.worst.max(other.worst);
        self.rests += other.rests;
        self.longest = self.longest.max(other.longest);
    }
}

/// Random commands at random samples until the end; a sample has another command with the given chance.
fn governed<const N: usize>(
    chain: &Chain<N>,
    bounds: Bounds<N>,
    timing: &Timing<'_, f64, N>,
    next: &mut impl FnMut() -> f64,
    chance: f64,
) -> Tally {
    let mut storage = vec![[0.0; 2]; timing.segments()];
    let mut governor = Governor::new(timing, &mut storage).expect("an interval for each segment");
    let mut tally = Tally::default();
    let mut command = Command::Override(1.0);
    let (mut s, mut since, mut time) = (f64::NEG_INFINITY, 0.0, 0.0);
    loop {
        if next() < chance {
            let before = command;
            command = match (4.0 * next()) as u8 {
                0 => Command::Stop,
                1 => Command::Override(1.0),
                _ => Command::Override(0.05 + 0.95 * next()),
            };
            if before != command {
                (tally.commands, since) = (tally.commands + 1, 0.0);
            }
        }
        let period = 2e-3 * next() + 1e-4;
        let at = governor.advance(Duration::from_secs_f64(period), command);
        since += period;
        time += period;
        tally.samples += 1;
        assert!(at.progress.s >= s - 1e-12, "back from {s} to {}", at.progress.s);
        s = at.progress.s;
        let most = share(chain, bounds, &at);
        assert!(most <= 1.0 + 1e-9, "sample {} at {at:?} under {command:?}: {most}", tally.samples);
        tally.worst = tally.worst.max(most);
        match at.phase {
            Phase::Ended => {
                assert!(time >= timing.lower_bound(), "{time} s are less than {} s", timing.lower_bound());
                return tally;
            }
            Phase::Held => {
                assert!(command == Command::Stop && at.progress.ds == 0.0 && at.reference.ddq.amax() == 0.0, "{at:?}");
                if since > 0.0 {
                    tally.longest = tally.longest.max(since);
                    tally.rests += 1;
                    since = f64::NEG_INFINITY;
                }
            }
            Phase::Moving | Phase::GoingOn => {}
        }
        assert!(tally.samples < 1_000_000, "the end is not reached: {at:?} under {command:?}");
    }
}

fn table<const N: usize>(name: &str, chain: &Chain<N>, bounds: Bounds<N>, range: [f64; N], paths: u64, chance: f64) -> Tally {
    let mut all = Tally::default();
    for seed in 0..paths {
        let mut next = random(seed + 100);
        let path = random_path(&mut next, range);
        with_timing(chain, &path, &limits(bounds), Ends { hold: false, ..Ends::at_rest() }, 1e-3, 1000, |timing| {
            let timing = timing.unwrap_or_else(|error| panic!("{name}, path {seed}: {error}"));
            // A stop takes hundreds of samples: in one motion of four commands are rare.
            for chance in [chance, chance, chance, 0.01] {
                all.add(&governed(chain, bounds, &timing, &mut next, chance));
            }
        });
    }
    let Tally { samples, commands, rests, longest, .. } = all;
    let left = 1.0 - all.worst;
    println!(
        "{name}: {samples} samples, {commands} commands, {rests} at rest after at most {longest:.2} s, share 1 - {left:.1e}"
    );
    assert!(rests > 0 && all.worst > 0.5, "{name}: {all:?}");
    all
}

fn tables(paths: u64, chance: f64) -> Tally {
    let mut all = table("scara", &chain::scara(), SCARA_LIMITS, [2.0, 2.0, 0.3, 3.0], paths, chance);
    all.add(&table("ur5", &chain::ur5().without_friction(), UR5_LIMITS, [3.0; 6], paths, chance));
    all.add(&table("ur5, friction", &chain::ur5(), UR5_LIMITS, [3.0; 6], paths, chance));
    let range = [2.5, 1.7, 2.5, 1.5, 2.5, 1.8, 2.5];
    all.add(&table("panda, friction", &chain::panda(), PANDA_LIMITS, range, paths, chance));
    let curved = chain::scara().with_curved_friction(SCARA_LIMITS, 0.2, 0.1);
    all.add(&table("scara, curved friction", &curved, SCARA_LIMITS, [2.0, 2.0, 0.3, 3.0], paths, chance));
    all
}

#[test]
fn few_random_commands_keep_all_limits() {
    tables(1, 0.01);
}

#[test]
#[ignore = "wide"]
fn random_commands_keep_all_limits() {
    tables(20, 0.01);
}

/// A hundred thousand commands on ten arms, six of them of random numbers: some motions have a new command every few samples.
#[test]
#[ignore = "wide"]
fn a_hundred_thousand_commands_keep_all_limits() {
    let mut all = tables(6, 0.3);
    let (mut arms, mut seed) = (0, 0);
    while arms < 6 {
        seed += 1;
        let mut next = random(1000 + seed);
        let chain: Chain<4> = chain::random(&mut next);
        let velocity = std::array::from_fn(|_| 1.0 + 3.0 * next());
        let effort = std::array::from_fn(|i| (60.0 + 200.0 * next()) / (1.0 + i as f64) + 40.0);
        let mut of_arm = Tally::default();
        for _ in 0..6 {
            let path = random_path(&mut next, [2.0; 4]);
            let ends = Ends { hold: false, ..Ends::at_rest() };
            with_timing(&chain, &path, &limits((velocity, effort)), ends, 1e-3, 1500, |timing| {
                // A slide of a random arm may be too weak for its load.
                let Ok(timing) = timing else { return };
                for chance in [0.3, 0.3, 0.3, 0.01] {
                    of_arm.add(&governed(&chain, (velocity, effort), &timing, &mut next, chance));
                }
            });
        }
        arms += usize::from(of_arm.samples > 0);
        println!("arm {seed}: {of_arm:?}");
        all.add(&of_arm);
    }
    println!("{all:?}");
    assert!(all.commands >= 100_000 && all.rests > 100, "{all:?}");
}

/// A pendulum of 9.81 N m at 90 degrees with a motor of 8 N m passes there only with enough speed, and rests nowhere near.
#[test]
fn commands_leave_the_speed_that_an_arm_needs() {
    let pendulum = one_joint(false, [0.0; 2], [9.81, 0.0, 0.0], 1.0);
    let (bounds, path) = (([20.0], [8.0]), line(1.0, [0.0], [3.0]));
    with_timing(&pendulum, &path, &limits(bounds), Ends::at_rest(), 1e-3, 1000, |timing| {
        let timing = timing.expect("a timing");
        let mut storage = vec![[0.0; 2]; timing.segments()];
        for command in [Command::Stop, Command::Override(0.05), Command::Override(0.5)] {
            let mut gone_on = false;
            for begin in 1..40 {
                let mut governor = Governor::new(&timing, &mut storage).expect("an interval for each segment");
                governor.advance(timing.duration() * begin / 40, Command::Override(1.0));
                for sample in 0..20_000 {
                    let at = governor.advance(Duration::from_millis(1), command);
                    let most = share(&pendulum, bounds, &at);
                    assert!(most <= 1.0 + 1e-9, "sample {sample} at {at:?} under {command:?}: {most}");
                    gone_on |= at.phase == Phase::GoingOn;
                    if matches!(at.phase, Phase::Held | Phase::Ended) {
                        break;
                    }
                    assert!(sample < 19_999, "neither at rest nor at the end: {at:?}");
                }
            }
            assert_eq!(gone_on, command == Command::Stop, "{command:?}");
        }
        let mut next = random(9);
        for _ in 0..10 {
            governed(&pendulum, bounds, &timing, &mut next, 0.01);
        }
    });
}

#[test]
fn full_speed_is_the_timed_motion_and_half_speed_takes_twice_as_long() {
    let chain = chain::scara();
    let path = random_path(&mut random(7), [2.0, 2.0, 0.3, 3.0]);
    with_timing(&chain, &path, &limits(SCARA_LIMITS), Ends::at_rest(), 1e-3, 1000, |timing| {
        let timing = timing.expect("a timing");
        let mut storage = vec![[0.0; 2]; timing.segments()];
        assert!(Governor::new(&timing, &mut storage[1..]).is_none());
        let step = Duration::from_millis(1);
        for (share, factor) in [(1.0, 1.0), (0.5, 2.0)] {
            let mut governor = Governor::new(&timing, &mut storage).expect("an interval for each segment");
            assert_eq!(governor.sample().phase, Phase::Held);
            let mut time = Duration::ZERO;
            loop {
                time += step;
                let at = governor.advance(step, Command::Override(share));
                if share == 1.0 {
                    let apart = (at.reference.q - timing.sample(time).q).amax();
                    assert!(apart < 1e-6, "{apart} at {time:?}");
                }
                if at.phase == Phase::Ended {
                    break;
                }
            }
            let ratio = time.as_secs_f64() / timing.seconds();
            assert!((ratio - factor).abs() < 0.02, "{ratio} at {share}");
        }
    });
}

#[test]
fn a_stop_keeps_the_arm_and_a_resume_goes_on() {
    let chain = chain::scara();
    let path = random_path(&mut random(8), [2.0, 2.0, 0.3, 3.0]);
    with_timing(&chain, &path, &limits(SCARA_LIMITS), Ends::at_rest(), 1e-3, 1000, |timing| {
        let timing = timing.expect("a timing");
        let mut storage = vec![[0.0; 2]; timing.segments()];
        let mut governor = Governor::new(&timing, &mut storage).expect("an interval for each segment");
        let half = timing.duration() / 2;
        assert!(governor.advance(half, Command::Override(1.0)).progress.ds > 0.0);
        let stopped = governor.advance(Duration::from_secs(1), Command::Stop);
        assert_eq!(stopped.phase, Phase::Held);
        assert_eq!(governor.advance(Duration::from_secs(9), Command::Override(0.0)).progress, stopped.progress);
        let end = governor.advance(Duration::from_secs(60), Command::Override(1.0));
        assert_eq!(end.phase, Phase::Ended);
        assert!((end.reference.q - timing.sample(timing.duration()).q).amax() < 1e-12);
    });
}

/// After a contact: the arm stops, goes back along the path by a third of a unit, and stops. Coulomb friction turns with q', so the way back
/// has a timing of its own.
#[test]
fn an_arm_retreats_along_its_path() {
    let (chain, bounds) = (chain::ur5(), UR5_LIMITS);
    let path = random_path(&mut random(11), [3.0; 6]);
    let whole = path.pieces().last().map_or(0.0, Piece::end);
    let back = path.pieces().iter().rev().map(|piece| piece.reversed(whole - piece.end())).collect::<Vec<_>>();
    for s in [0.0, 0.3, 0.77, 1.0].map(|part| part * whole) {
        let there = path.pieces().iter().rev().find(|piece| piece.start <= s).expect("on the path").at(s);
        let s = whole - s;
        let here = back.iter().rev().find(|piece| piece.start <= s).expect("on the path").at(s);
        assert!((here.q - there.q).amax() < 1e-12 && (here.slope + there.slope).amax() < 1e-11);
        assert!((here.curvature - there.curvature).amax() < 1e-10);
    }
    let back = JointPath::new(back).expect("a path");
    let ends = Ends { hold: false, ..Ends::at_rest() };
    let step = Duration::from_millis(1);
    let stops: Vec<Governed<f64, 6>> = with_timing(&chain, &path, &limits(bounds), ends, 1e-3, 1000, |timing| {
        let timing = timing.expect("a timing");
        let mut storage = vec![[0.0; 2]; timing.segments()];
        (1..20)
            .map(|part| {
                let mut governor = Governor::new(&timing, &mut storage).expect("an interval for each segment");
                governor.advance(timing.duration() * part / 20, Command::Override(1.0));
                governor.advance(Duration::from_secs(5), Command::Stop)
            })
            .filter(|stopped| stopped.phase == Phase::Held)
            .collect()
    });
    assert!(stops.len() > 10, "{} stops", stops.len());
    with_timing(&chain, &back, &limits(bounds), ends, 1e-3, 1000, |timing| {
        let timing = timing.expect("a timing");
        let mut storage = vec![[0.0; 2]; timing.segments()];
        for stopped in stops {
            let begin = whole - stopped.progress.s;
            let mut governor = Governor::from_rest(&timing, &mut storage, begin).expect("on the path");
            let rest = governor.sample();
            assert!(rest.phase == Phase::Held && (rest.reference.q - stopped.reference.q).amax() < 1e-9, "{rest:?}");
            let mut moved = 0.0;
            for sample in 0.. {
                let at = governor.advance(step, if moved < 0.3 { Command::Override(0.5) } else { Command::Stop });
                let most = share(&chain, bounds, &at);
                assert!(most <= 1.0 + 1e-9, "from {begin}, sample {sample} at {at:?}: {most}");
                moved = at.progress.s - begin;
                if moved > 0.3 && matches!(at.phase, Phase::Held | Phase::Ended) || at.phase == Phase::Ended {
                    break;
                }
                assert!(sample < 20_000, "no way back from {begin}: {at:?}");
            }
        }
        for nowhere in [-0.1, whole + 0.1, f64::NAN] {
            assert!(Governor::from_rest(&timing, &mut storage, nowhere).is_none());
        }
    });
}

/// A piece from `s` on, as long as `length`.
fn part<const N: usize>(piece: &Piece<f64, N>, s: f64, length: f64) -> Piece<f64, N> {
    let mut part = Piece { start: s, length, ..*piece };
    for power in (0..6).rev() {
        for higher in power..5 {
            part.coefficients[higher] += part.coefficients[higher + 1] * (s - piece.start);
        }
    }
    part
}

/// Stops at many times beside the plan that rests first, found by bisection of its end: by how many ends of segments, where alone the
/// governor rests, it passes the first one after the end of that plan. How many stops pass 0, 1, 2 and more ends.
fn stops<const N: usize>(chain: &Chain<N>, bounds: Bounds<N>, range: [f64; N], paths: u64) -> [usize; 4] {
    let step = Duration::from_micros(100);
    let mut passed = [0; 4];
    for seed in 0..paths {
        let path = random_path(&mut random(seed + 300), range);
        let whole = path.pieces().last().map_or(0.0, Piece::end);
        with_timing(chain, &path, &limits(bounds), Ends { hold: false, ..Ends::at_rest() }, 1e-3, 1000, |timing| {
            let timing = timing.expect("a timing");
            let mut storage = vec![[0.0; 2]; timing.segments()];
            for share in 1..12 {
                let mut governor = Governor::new(&timing, &mut storage).expect("an interval for each segment");
                let begin = governor.advance(timing.duration() * share / 12, Command::Override(1.0)).progress;
                let mut rest = governor.sample();
                while !matches!(rest.phase, Phase::Held | Phase::Ended) {
                    rest = governor.advance(step, Command::Stop);
                }
                let is_possible = |to: f64| {
                    let cut = |piece: &Piece<f64, N>| {
                        let (s, end) = (piece.start.max(begin.s), piece.end().min(to));
                        (end - s > 1e-9).then(|| part(piece, s, end - s))
                    };
                    let cut = JointPath::new(path.pieces().iter().filter_map(cut).collect::<Vec<_>>()).expect("a path");
                    let ends = Ends { speed: [begin.ds, 0.0], hold: true };
                    with_timing(chain, &cut, &limits(bounds), ends, 1e-3, 300, |timing| timing.is_ok())
                };
                let (mut low, mut high) = (begin.s + 1e-6, whole);
                for _ in 0..24 {
                    let middle = 0.5 * (low + high);
                    *(if is_possible(middle) { &mut high } else { &mut low }) = middle;
                }
                let end = |i: usize| timing.profile(i).map(|p| p.start + p.length).expect("a segment");
                let between = (0..timing.segments()).filter(|i| end(*i) > high && end(*i) < rest.progress.s - 1e-9).count();
                passed[between.min(3)] += 1;
            }
        });
    }
    passed
}

/// Most stops rest at the first end that a plan reaches, nearly all others at the next.
#[test]
#[ignore = "wide"]
fn stops_are_as_short_as_those_of_a_search() {
    let all = [
        stops(&chain::scara(), SCARA_LIMITS, [2.0, 2.0, 0.3, 3.0], 5),
        stops(&chain::ur5(), UR5_LIMITS, [3.0; 6], 5),
        stops(&chain::ur5().without_friction(), UR5_LIMITS, [3.0; 6], 5),
    ];
    println!("{all:?}");
    assert!(all.iter().all(|[first, second, ..]| *first >= 35 && first + second >= 52), "{all:?}");
    assert!(all[1..].iter().all(|[_, _, more @ ..]| more == &[0; 2]), "{all:?}");
}
