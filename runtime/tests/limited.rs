//! Joint rates and torques within limits: the box of braking, levels in order of priority, and arms whose model is off.

use crate::common;

use armgen_runtime::{
    clik::{Bounds, Clik, DampedLeastSquares, JointLimits, Limited, LimitedStep},
    control::{self, NullSpace, OperationalSpace, TorqueLimits},
    linalg::Damping,
    reference::{OperationalReference, Pose, State},
    robot::{Dynamics, Kinematics},
    simulation::{Integrator, Noise, Plant},
    task::{Row, Task},
};
use common::{
    arms::{hobby, panda, ur5, Chain},
    ghost,
    scara::Scara,
};
use nalgebra::{vector, SMatrix, SVector, Vector6};
use std::collections::VecDeque;

const PERIOD: f64 = 1e-3;

fn uniform(noise: &mut Noise, from: f64, to: f64) -> f64 {
    from + (to - from) * noise.uniform()
}

/// One joint, held at `choose` between the bounds of each sample: (q, dq) after the samples, and the largest excess of each limit.
fn by_rates(
    limits: &JointLimits<f64, 1>,
    mut state: State<f64, 1>,
    samples: usize,
    mut choose: impl FnMut(Bounds<f64, 1>) -> f64,
) -> f64 {
    let mut excess = 0.0f64;
    for _ in 0..samples {
        let bounds = limits.rate_bounds(&state, 0.01);
        assert!(bounds.low[0] <= bounds.high[0], "{bounds:?}");
        let next = choose(bounds);
        excess = excess.max((next - state.dq[0]).abs() / 0.01 / 3.0 - 1.0).max(next.abs() / 0.5 - 1.0);
        state = State { q: state.q.add_scalar(next * 0.01), dq: vector![next] };
        excess = excess.max(state.q[0].abs() - 1.0);
    }
    excess
}

#[test]
fn a_joint_within_its_box_can_always_brake() {
    let limits = JointLimits::rates([0.5]).unwrap().with_range([-1.0], [1.0]).unwrap().with_acceleration([3.0]).unwrap();
    let mut noise = Noise::new(1);
    for run in 0..200 {
        let start = State::at_rest(vector![uniform(&mut noise, -1.0, 1.0)]);
        let eager = noise.uniform();
        let mut to = 1.0;
        let excess = by_rates(&limits, start, 400, |Bounds { low, high }| {
            to = if noise.uniform() < 0.02 { -to } else { to };
            let at = if noise.uniform() < eager { 0.5 + 0.5 * to } else { noise.uniform() };
            low[0] + (high[0] - low[0]) * at
        });
        assert!(excess < 1e-12, "run {run}: {excess:e} beyond a limit");
    }
    // As fast as possible: it arrives exactly at the limit.
    let mut state = State::at_rest(vector![-0.3]);
    for _ in 0..300 {
        let high = limits.rate_bounds(&state, 0.01).high;
        state = State { q: state.q + high * 0.01, dq: high };
    }
    assert!((state.q[0] - 1.0).abs() < 1e-14 && state.dq[0].abs() < 1e-12, "{state:?}");
}

/// Accelerations held from sample to sample, by the whole of the limit and a horizon of one period: the same of the motion between samples.
#[test]
fn held_accelerations_brake_before_a_limit() {
    let limits = JointLimits::rates([0.5]).unwrap().with_range([-1.0], [1.0]).unwrap().with_acceleration([3.0]).unwrap();
    let mut noise = Noise::new(2);
    for run in 0..200 {
        let mut state = State::at_rest(vector![uniform(&mut noise, -1.0, 1.0)]);
        let eager = noise.uniform();
        let mut to = 1.0;
        for _ in 0..400 {
            let Bounds { low, high } = limits.acceleration_bounds(&state, 0.01, 1.0);
            to = if noise.uniform() < 0.02 { -to } else { to };
            let at = if noise.uniform() < eager { 0.5 + 0.5 * to } else { noise.uniform() };
            let u = low[0] + (high[0] - low[0]) * at;
            assert!(u.abs() < 3.0 + 1e-12);
            let (q, dq) = (state.q[0], state.dq[0]);
            // The turning point between the samples, if there is one.
            let turn = if u != 0.0 && (0.0..0.01).contains(&(-dq / u)) { q - dq * dq / (2.0 * u) } else { q };
            let next = vector![dq + u * 0.01];
            state = State { q: vector![q + (dq + 0.5 * u * 0.01) * 0.01], dq: next };
            let excess = turn.abs().max(state.q[0].abs()) - 1.0;
            assert!(excess < 1e-12 && next[0].abs() < 0.5 + 1e-12, "run {run}: {excess:e} {state:?}");
        }
    }
}

#[test]
fn a_joint_outside_may_move_inwards_and_a_fast_one_brakes() {
    let limits = JointLimits::rates([0.5]).unwrap().with_range([-1.0], [1.0]).unwrap();
    let at = |limits: &JointLimits<f64, 1>, q: f64, dq: f64| {
        let Bounds { low, high } = limits.rate_bounds(&State { q: vector![q], dq: vector![dq] }, 0.01);
        (low[0], high[0])
    };
    assert_eq!(at(&limits, 1.5, 0.0), (-0.5, 0.0));
    assert_eq!(at(&limits, -1.5, 0.0), (0.0, 0.5));
    let braking = limits.with_acceleration([3.0]).unwrap();
    assert_eq!(at(&braking, 1.5, 0.4), (0.37, 0.37));
    assert_eq!(at(&braking, 0.0, 0.9), (0.87, 0.87));
    let Bounds { low, high } = braking.acceleration_bounds(&State { q: vector![1.0], dq: vector![0.4] }, 0.01, 0.5);
    assert_eq!((low[0], high[0]), (-3.0, -3.0));
    let outside =
        limits.with_acceleration([30.0]).unwrap().acceleration_bounds(&State::at_rest(vector![1.001]), 0.1, 0.95).high[0];
    assert!((outside - -3.2).abs() < 1e-12, "{outside}: back by the end of the horizon, and 0.015 further for the reserve");
}

fn anywhere<const N: usize>(noise: &mut Noise, limit: &[(f64, f64); N]) -> SVector<f64, N> {
    SVector::from_fn(|i, _| uniform(noise, limit[i].0, limit[i].1))
}

const SCARA: [(f64, f64); 4] = [(-2.0, 2.0), (-2.4, 2.4), (0.0, 0.4), (-3.0, 3.0)];
const PANDA: [(f64, f64); 7] = [(-2.8, 2.8), (-1.7, 1.7), (-2.8, 2.8), (-3.0, -0.1), (-2.8, 2.8), (0.0, 3.7), (-2.8, 2.8)];

fn of<const N: usize>(limit: &[(f64, f64); N], rate: f64) -> JointLimits<f64, N> {
    JointLimits::rates([rate; N]).unwrap().with_range(limit.map(|l| l.0), limit.map(|l| l.1)).unwrap()
}

fn moving(pose: Pose<f64>, noise: &mut Noise, size: f64) -> OperationalReference<f64> {
    let velocity = Vector6::from_fn(|_, _| size * noise.normal());
    OperationalReference { pose, velocity, acceleration: Vector6::zeros() }
}

/// Rates towards random poses, from postures outside the limits, too, and through singular ones: each joint inside stays inside, each outside
/// comes no further out, accelerations are kept.
fn stays_inside<R: Kinematics<N, Real = f64>, const N: usize, const M: usize>(
    robot: &R,
    (limit, singular): ([(f64, f64); N], [f64; N]),
    (task, gain): (Task<M>, f64),
    with: impl Fn(Limited<f64, N, M>) -> Limited<f64, N, M>,
) {
    let (rate, acceleration) = (1.5, 10.0);
    let limits = of(&limit, rate).with_acceleration([acceleration; N]).unwrap();
    let law = with(Limited::new(task, [gain; M], 0.01, limits).unwrap());
    let mut noise = Noise::new(3);
    let mut limited = 0;
    for run in 0..12 {
        let mut state = State::at_rest(match run % 3 {
            0 => anywhere(&mut noise, &limit.map(|(a, b)| (a - 0.3, b + 0.3))),
            1 => singular.into(),
            _ => anywhere(&mut noise, &limit),
        });
        for k in 0..150 {
            let goal = Pose::of(robot, &anywhere(&mut noise, &limit.map(|(a, b)| (a - 0.5, b + 0.5))));
            let goal = if k < 75 {
                moving(goal, &mut noise, 0.3)
            } else {
                OperationalReference::at_rest(Pose::of(robot, &singular.into()))
            };
            let step = law.step(robot, &state, &goal).unwrap();
            limited += usize::from(step.limited);
            for i in 0..N {
                let (was, is) = (state.q[i], step.state.q[i]);
                let (low, high) = limit[i];
                assert!(is <= high.max(was) && is >= low.min(was), "run {run}, {k}, joint {i}: {was} to {is}");
                let by = (step.state.dq[i] - state.dq[i]).abs();
                assert!(by < acceleration * 0.01 + 1e-12 && step.state.dq[i].abs() < rate + 1e-12, "run {run}, {k}: {by}");
                // Where nothing stops the joint, the rate is that of its way.
                assert!(is == high || is == low || (is - was - step.state.dq[i] * 0.01).abs() < 1e-15);
            }
            state = step.state;
        }
    }
    assert!(limited > 100, "{limited} steps at a limit");
}

#[test]
fn joints_stay_within_their_limits() {
    let scara = ghost::nominal();
    stays_inside(&scara, (SCARA, [0.3, 0.0, 0.2, 0.4]), (ghost::task(), 20.0), |law| law);
    let damping = Damping::below(0.03).at_most(0.1).unwrap();
    stays_inside(&scara, (SCARA, [0.3, 0.0, 0.2, 0.4]), (ghost::task(), 20.0), |law| law.with_damping(damping).with_direction());
    let stretched = [0.0, 0.0, 0.0, -0.1, 0.0, 0.1, 0.0];
    stays_inside(&panda(), (PANDA, stretched), (Task::full(), 20.0), |law| law);
    stays_inside(&panda(), (PANDA, stretched), (Task::full(), 20.0), |law| {
        law.with_direction().with_weights([4.0, 4.0, 4.0, 1.0, 1.0, 1.0]).unwrap()
    });
}

/// What level 1 leaves of its velocity.
fn left<R: Kinematics<N, Real = f64>, const N: usize, const M: usize>(
    robot: &R,
    task: &Task<M>,
    (q, dq): (&SVector<f64, N>, &SVector<f64, N>),
    (goal, k): (&OperationalReference<f64>, f64),
) -> f64 {
    let v = task.select(&goal.velocity) + task.error(&goal.pose, &Pose::of(robot, q)) * k;
    (task.jacobian(&robot.geometric_jacobian(q)) * dq - v).norm()
}

#[test]
fn level_one_is_best_and_lower_levels_never_worsen_it() {
    let robot = panda();
    let task = Task::new([Row::X, Row::Y, Row::Z, Row::Rx]).unwrap();
    let limits = of(&PANDA, 1.0);
    let law = Limited::new(task, [5.0; 4], 0.01, limits).unwrap();
    let mut noise = Noise::new(4);
    let (mut worse, mut improved) = (0.0f64, 0);
    for number in 0..150 {
        // Every third posture has axes in line, so that J loses rank.
        let mut q = anywhere(&mut noise, &PANDA);
        if number % 3 == 0 {
            (q[1], q[2], q[4], q[5]) = (0.0, 0.0, 0.0, 0.0);
        }
        let state = State::at_rest(q);
        let goal = moving(Pose::of(&robot, &q), &mut noise, if number % 2 == 0 { 0.2 } else { 2.0 });
        let first = law.sample(&robot, &state, &goal).unwrap();
        let alone = first.step();
        let least = left(&robot, &task, (&q, &alone.state.dq), (&goal, 5.0));
        let Bounds { low, high } = limits.rate_bounds(&state, 0.01);
        for _ in 0..30 {
            let near = noise.uniform() < 0.5;
            let dq = SVector::<f64, 7>::from_fn(|i, _| {
                let dq = if near { alone.state.dq[i] + 0.01 * noise.normal() } else { uniform(&mut noise, low[i], high[i]) };
                dq.clamp(low[i], high[i])
            });
            let other = left(&robot, &task, (&q, &dq), (&goal, 5.0));
            assert!(other > least - 1e-8, "{number}: {other} below {least}");
        }
        // The elbow towards a height, then the middle of the ranges.
        let elbow = {
            let at = |q: &SVector<f64, 7>| robot.link_frames(q)[3][(2, 3)];
            SMatrix::<f64, 1, 7>::from_fn(|_, i| {
                let mut by = SVector::zeros();
                by[i] = 1e-6;
                (at(&(q + by)) - at(&(q - by))) / 2e-6
            })
        };
        let middle = SVector::<f64, 7>::from_fn(|i, _| 2.0 * (0.5 * (PANDA[i].0 + PANDA[i].1) - q[i]));
        let second = first.then(&elbow, &vector![0.05]).unwrap();
        let raised = second.step().state.dq;
        let third = second.then(&SMatrix::identity(), &middle).unwrap().step().state.dq;
        for dq in [&raised, &third] {
            worse = worse.max(left(&robot, &task, (&q, dq), (&goal, 5.0)) - least);
        }
        let height = |dq: &SVector<f64, 7>| ((elbow * dq)[0] - 0.05).abs();
        assert!(height(&raised) <= height(&alone.state.dq) + 1e-9, "{number}");
        assert!(height(&third) <= height(&raised) + 1e-9, "{number}");
        assert!((third - middle).norm() <= (raised - middle).norm() + 1e-9, "{number}");
        improved += usize::from((third - middle).norm() < (raised - middle).norm() - 1e-3);
    }
    println!("level 1 worsened by at most {worse:e}, {improved} postures nearer to the middle");
    assert!(worse < 1e-9 && improved > 40, "{worse:e} {improved}");
}

#[test]
fn a_kept_direction_is_scaled_by_what_the_slowest_joint_allows() {
    let robot = ghost::nominal();
    let limits = JointLimits::rates([1.0, 1.0, 0.3, 2.0]).unwrap();
    let law = Limited::new(ghost::task(), [1.0; 4], 0.01, limits).unwrap().with_direction();
    let mut noise = Noise::new(5);
    for _ in 0..50 {
        let q = anywhere(&mut noise, &[(-2.0, 2.0), (0.3, 2.4), (0.0, 0.4), (-3.0, 3.0)]);
        let goal = moving(Pose::of(&robot, &q), &mut noise, 1.0);
        let LimitedStep { state, scale, limited, .. } = law.step(&robot, &State::at_rest(q), &goal).unwrap();
        let j = ghost::task().jacobian(&robot.geometric_jacobian(&q));
        let v = ghost::task().select(&goal.velocity);
        let whole = j.try_inverse().unwrap() * v;
        let share = (0..4).map(|i| limits.rate()[i] / whole[i].abs()).fold(1.0, f64::min);
        assert!((scale - share).abs() < 1e-12 && limited == (share < 1.0), "{scale} {share}");
        assert!((j * state.dq - v * scale).amax() < 1e-12);
    }
}

#[test]
fn without_limits_in_the_way_it_is_damped_least_squares() {
    let (robot, damping) = (ghost::nominal(), Damping::below(0.03).at_most(0.1).unwrap());
    let limits = JointLimits::rates([1e3; 4]).unwrap();
    let law = Limited::new(ghost::task(), [20.0; 4], 1e-3, limits).unwrap().with_damping(damping);
    let other = DampedLeastSquares::new([20.0; 4], damping).unwrap();
    let other = Clik::new(ghost::task(), other, 1e-3, limits, [1e-9; 4]).unwrap();
    let mut noise = Noise::new(6);
    let mut damped = 0;
    for number in 0..60 {
        let mut q = anywhere(&mut noise, &SCARA);
        q[1] = if number % 2 == 0 { 1e-4 } else { q[1] };
        let goal = moving(Pose::of(&robot, &anywhere(&mut noise, &SCARA)), &mut noise, 0.2);
        let found = law.step(&robot, &State::at_rest(q), &goal).unwrap();
        let expected = other.step(&robot, &q, &goal).unwrap();
        assert!((found.state.dq - expected.dq).amax() < 1e-9 * (1.0 + expected.dq.amax()), "{number}");
        damped += usize::from(found.damped);
    }
    assert!(damped > 20);
}

#[test]
fn single_precision_keeps_limits_too() {
    let robot = Scara::<f32>::nominal();
    let limits = JointLimits::rates([1.5f32; 4]).unwrap();
    let limits = limits.with_range(SCARA.map(|l| l.0 as f32), SCARA.map(|l| l.1 as f32)).unwrap();
    let limits = limits.with_acceleration([10.0; 4]).unwrap();
    let law = Limited::new(ghost::task(), [20.0f32; 4], 0.01, limits).unwrap();
    let torques = TorqueLimits::new([150.0f32, 80.0, 250.0, 20.0]).unwrap();
    let operational = OperationalSpace::new(ghost::task(), [100.0f32; 4], [20.0; 4], [0.0; 4], 1e-3).unwrap();
    let mut control = control::Limited::new(operational, torques, limits, 8e-3, 0.7).unwrap();
    let mut noise = Noise::new(7);
    let mut state = State::at_rest(ghost::start().cast::<f32>());
    let middle = SVector::<f32, 4>::from_fn(|i, _| (0.5 * (SCARA[i].0 + SCARA[i].1)) as f32);
    for _ in 0..300 {
        let goal = Pose::of(&robot, &anywhere(&mut noise, &SCARA.map(|(a, b)| (a - 0.5, b + 0.5))).cast());
        let goal = OperationalReference::at_rest(goal);
        let torque = control.torque(&robot, &goal, &state).unwrap().torque.tau;
        assert!(torque[0].abs() <= 150.0 && torque[1].abs() <= 80.0 && torque[2].abs() <= 250.0 && torque[3].abs() <= 20.0);
        let sample = law.sample(&robot, &state, &goal).unwrap().then(&SMatrix::identity(), &(middle - state.q)).unwrap();
        let next = sample.step().state;
        for i in 0..4 {
            assert!(next.q[i] >= SCARA[i].0 as f32 && next.q[i] <= SCARA[i].1 as f32);
            assert!((next.dq[i] - state.dq[i]).abs() < 0.1 + 1e-6);
        }
        state = next;
    }
}

/// An arm under torques within limits: goals beyond the limits and inside in turn, a model with masses off by 4 % and one sample of delay.
struct Pulled<const N: usize, const M: usize> {
    task: Task<M>,
    limit: [(f64, f64); N],
    effort: [f64; N],
    rate: f64,
    acceleration: [f64; N],
    gains: (f64, f64),
}

impl<const N: usize, const M: usize> Pulled<N, M> {
    fn law(&self) -> control::Limited<f64, N, M> {
        let (k_p, k_d) = self.gains;
        let law = OperationalSpace::new(self.task, [k_p; M], [k_d; M], [0.0; M], PERIOD).unwrap();
        let middle = self.limit.map(|(a, b)| 0.5 * (a + b));
        let law = law.with_damping(Damping::below(0.02).at_most(0.1).unwrap());
        let law = law.with_null_space(NullSpace::new([10.0; N], [8.0; N], middle).unwrap());
        let joints = of(&self.limit, self.rate).with_acceleration(self.acceleration).unwrap();
        control::Limited::new(law, TorqueLimits::new(self.effort).unwrap(), joints, 8.0 * PERIOD, 0.6).unwrap()
    }

    fn run<P: Dynamics<N, Real = f64>, R: Dynamics<N, Real = f64>>(&self, what: &str, plant: &P, model: &R) {
        let mut law = self.law();
        let mut noise = Noise::new(8);
        let start = SVector::from(self.limit.map(|(a, b)| 0.55 * a + 0.45 * b));
        let mut arm = Plant::new(plant, State::at_rest(start), Integrator::RungeKutta4 { substeps: 1 });
        let mut late: VecDeque<_> = vec![*arm.state()].into();
        let (mut beyond, mut furthest) = (f64::NEG_INFINITY, 0);
        let (mut fast, mut nearest, mut limited, mut conflicts) = (0.0f64, f64::INFINITY, 0, 0);
        let mut goal = OperationalReference::at_rest(Pose::of(model, &start));
        for k in 0..5000 {
            if k % 500 == 0 {
                let wide = if k % 1000 == 0 { 0.5 } else { -0.2 };
                goal = OperationalReference::at_rest(Pose::of(
                    model,
                    &anywhere(&mut noise, &self.limit.map(|(a, b)| (a - wide, b + wide))),
                ));
            }
            late.push_back(*arm.state());
            let seen = late.pop_front().unwrap();
            let found = law.torque(model, &goal, &seen).unwrap();
            limited += usize::from(found.torque.limited);
            conflicts += usize::from(found.conflict.contains(&true));
            for i in 0..N {
                assert!(found.torque.tau[i].abs() <= self.effort[i], "{what}: torque {}", found.torque.tau);
            }
            arm.advance(&found.torque.tau, PERIOD).unwrap();
            for i in 0..N {
                let State { q, dq } = arm.state();
                let past = (q[i] - self.limit[i].1).max(self.limit[i].0 - q[i]);
                if past > beyond {
                    (beyond, furthest) = (past, i);
                }
                nearest = nearest.min(self.limit[i].1 - q[i]).min(q[i] - self.limit[i].0);
                fast = fast.max(dq[i].abs() / self.rate);
            }
        }
        println!("{what}: joint {furthest} is {beyond:e} beyond its range, {fast} of the rate, {limited} samples limited, {conflicts} conflicts");
        assert!(beyond < 0.0 && fast < 1.05, "{what}: {beyond} beyond a range, {fast} of the rate");
        assert!(nearest < 0.02 && limited > 500, "{what}: nothing comes near a limit");
    }
}

fn off(seed: u64) -> impl FnMut(usize) -> f64 {
    let mut noise = Noise::new(seed);
    move |_| if noise.uniform() < 0.5 { 0.04 } else { -0.04 }
}

#[test]
fn torques_stay_within_their_limits_and_joints_within_theirs() {
    let mut plant = ghost::nominal();
    for i in 0..6 {
        plant.parameters[i] *= if i % 2 == 0 { 1.04 } else { 0.96 };
    }
    Pulled {
        task: ghost::task(),
        limit: SCARA,
        effort: [330.0, 150.0, 250.0, 30.0],
        rate: 2.0,
        acceleration: [8.0, 8.0, 6.0, 10.0],
        gains: (100.0, 20.0),
    }
    .run("SCARA", &plant, &ghost::nominal());
    let limit = [(-1.0, 1.8), (-2.2, -0.3), (0.3, 2.3), (-1.6, 0.5), (0.3, 2.3), (-1.0, 2.0)];
    Pulled {
        task: Task::full(),
        limit,
        effort: [150.0, 150.0, 150.0, 28.0, 28.0, 28.0],
        rate: 2.0,
        acceleration: [10.0; 6],
        gains: (100.0, 20.0),
    }
    .run("UR5", &ur5().off(off(1)), &ur5());
    let limit = [(-1.0, 1.4), (-1.4, 0.6), (-1.0, 1.5), (-2.7, -0.9), (-1.1, 1.3), (0.6, 2.9), (-0.6, 2.0)];
    Pulled {
        task: Task::full(),
        limit,
        effort: [87.0, 87.0, 87.0, 87.0, 12.0, 12.0, 12.0],
        rate: 1.5,
        acceleration: [8.0, 8.0, 8.0, 8.0, 25.0, 25.0, 25.0],
        gains: (100.0, 20.0),
    }
    .run("Panda", &panda().off(off(2)), &panda());
    let limit = [(-1.0, 1.4), (0.2, 1.8), (-2.0, -0.3), (-0.5, 1.5), (-1.0, 1.0)];
    Pulled {
        task: Task::new([Row::X, Row::Y, Row::Z]).unwrap(),
        limit,
        effort: [2.5, 2.5, 1.5, 1.0, 1.0],
        rate: 3.0,
        acceleration: [20.0; 5],
        gains: (100.0, 20.0),
    }
    .run("hobby arm", &hobby().off(off(3)), &hobby());
}

#[test]
fn without_limits_in_the_way_it_is_operational_space_control() {
    let model = panda();
    let task = Task::new([Row::X, Row::Y, Row::Z, Row::Rz]).unwrap();
    let law = OperationalSpace::new(task, [100.0; 4], [20.0; 4], [5.0; 4], PERIOD).unwrap();
    let law = law.with_null_space(NullSpace::new([10.0; 7], [8.0; 7], [0.1; 7]).unwrap());
    let joints = JointLimits::rates([1e4; 7]).unwrap();
    let mut noise = Noise::new(9);
    for _ in 0..40 {
        let (mut law, mut limited) =
            (law, control::Limited::new(law, TorqueLimits::new([1e7; 7]).unwrap(), joints, 8e-3, 0.7).unwrap());
        let state = State { q: anywhere(&mut noise, &PANDA), dq: SVector::from_fn(|_, _| 0.5 * noise.normal()) };
        let goal = moving(Pose::of(&model, &anywhere(&mut noise, &PANDA)), &mut noise, 0.2);
        for _ in 0..2 {
            let expected = law.torque(&model, &goal, &state).unwrap().tau;
            let found = limited.torque(&model, &goal, &state).unwrap();
            let size = 1.0 + expected.amax();
            assert!(
                (found.torque.tau - expected).amax() < 1e-7 * size && !found.torque.limited,
                "{}",
                found.torque.tau - expected
            );
        }
        assert_eq!(law.integral(), limited.integral());
    }
}

/// A wrist that is too weak for its box: the torques are kept, the box yields least, and the joint is named.
#[test]
fn a_box_out_of_reach_yields_and_its_joint_is_named() {
    let model: Chain<7> = panda();
    let law = OperationalSpace::new(Task::full(), [100.0; 6], [20.0; 6], [0.0; 6], PERIOD).unwrap();
    let effort = [40.0, 60.0, 40.0, 40.0, 6.0, 6.0, 6.0];
    let torques = TorqueLimits::new(effort).unwrap();
    let mut noise = Noise::new(10);
    let (mut named, mut free) = (0, 0);
    for number in 0..60 {
        let q = anywhere(&mut noise, &PANDA);
        let acceleration = [if number % 2 == 0 { 600.0 } else { 10.0 }; 7];
        let joints = of(&PANDA, 2.0).with_acceleration(acceleration).unwrap();
        let mut limited = control::Limited::new(law, torques, joints, 8e-3, 1.0).unwrap();
        // Fast towards a limit, so that the box asks for all of the acceleration.
        let mut dq = SVector::<f64, 7>::zeros();
        let mut q = q;
        let fast = number % 7;
        (q[fast], dq[fast]) = (PANDA[fast].1 - 0.01, 2.0);
        let state = State { q, dq };
        let goal = OperationalReference::at_rest(Pose::of(&model, &q));
        let found = limited.torque(&model, &goal, &state).unwrap();
        let bounds = joints.acceleration_bounds(&state, 8e-3, 1.0);
        let (b, n) = (model.inertia_matrix(&q), model.inverse_dynamics(&q, &dq, &SVector::zeros()));
        for i in 0..7 {
            assert!(found.torque.tau[i].abs() <= effort[i]);
            assert!(((b * found.ddq + n)[i] - found.torque.tau[i]).abs() < 1e-9);
        }
        let outside =
            |x: &SVector<f64, 7>| SVector::<f64, 7>::from_fn(|i, _| x[i] - x[i].clamp(bounds.low[i], bounds.high[i])).norm();
        let least = outside(&found.ddq);
        if !found.conflict.contains(&true) {
            assert!(least < 1e-2, "{number}: {least}");
            free += 1;
            continue;
        }
        named += 1;
        assert!(least > 1e-3);
        // No other torque within the limits is nearer to the box, but for the share of the goal.
        let factors = b.cholesky().unwrap();
        for _ in 0..200 {
            let near = 10f64.powf(-3.0 * noise.uniform());
            let tau = SVector::<f64, 7>::from_fn(|i, _| {
                (found.torque.tau[i] + near * effort[i] * noise.normal()).clamp(-effort[i], effort[i])
            });
            let other = outside(&factors.solve(&(tau - n)));
            assert!(other > 0.98 * least - 1e-3, "{number}: {other} below {least}");
        }
    }
    println!("{named} conflicts, {free} without");
    assert!(named > 5 && free > 5, "{named} {free}");
}
