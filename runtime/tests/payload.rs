//! The estimator of a payload: its regressors against a chain that carries the load, the batch solution, simulation, consistency.

use crate::common::arms::{panda, ur5, Chain};
use crate::common::single::Single;
use armgen_runtime::{
    control::InverseDynamics,
    payload::{payload_regressor, PayloadEstimator, PayloadSettings, PARAMETERS},
    reference::{JointReference, State},
    robot::{CoriolisTransposeTimes, Dynamics, Momentum},
    settings::{Setting, SettingError},
    simulation::{Integrator, Noise, Plant},
};
use nalgebra::{vector, DMatrix, DVector, Matrix3, SMatrix, SVector, Vector3};

const PERIOD: f64 = 0.01;
const LAMBDA: f64 = std::f64::consts::TAU * 3.0;

/// m, m c, I about the origin of the end effector's frame.
fn ten(mass: f64, c: Vector3<f64>, inertia: Matrix3<f64>) -> [f64; PARAMETERS] {
    let i = inertia + (Matrix3::identity() * c.norm_squared() - c * c.transpose()) * mass;
    let h = c * mass;
    [mass, h[0], h[1], h[2], i[(0, 0)], i[(0, 1)], i[(1, 1)], i[(0, 2)], i[(1, 2)], i[(2, 2)]]
}

/// A load of three kilograms.
fn load() -> ([f64; PARAMETERS], f64, Vector3<f64>, Matrix3<f64>) {
    let (mass, c) = (3.0, vector![0.02, -0.03, 0.08]);
    let inertia = Matrix3::new(0.012, 0.001, -0.002, 0.001, 0.015, 0.0015, -0.002, 0.0015, 0.009);
    (ten(mass, c, inertia), mass, c, inertia)
}

/// The chain with the load on its last link, whose frame is that of the end effector.
fn loaded<const N: usize>(mut arm: Chain<N>) -> Chain<N> {
    let (_, mass, c, inertia) = load();
    let link = &mut arm.links[N - 1];
    let own = Vector3::from(link.centre);
    let sum = link.mass + mass;
    let centre = (own * link.mass + c * mass) / sum;
    let [xx, yy, zz, xy, yz, xz] = link.inertia;
    let steiner = |m: f64, from: Vector3<f64>| {
        let r = from - centre;
        (Matrix3::identity() * r.norm_squared() - r * r.transpose()) * m
    };
    let i = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz) + steiner(link.mass, own) + inertia + steiner(mass, c);
    (link.mass, link.centre) = (sum, centre.into());
    link.inertia = [i[(0, 0)], i[(1, 1)], i[(2, 2)], i[(0, 1)], i[(1, 2)], i[(0, 2)]];
    arm
}

fn settings<const N: usize>(spread: [f64; N]) -> PayloadSettings<f64, N> {
    PayloadSettings {
        gravity: vector![0.0, 0.0, -9.81],
        period: PERIOD,
        filter: LAMBDA,
        forgetting: 1.0,
        spread: spread.into(),
        least_rate: 0.02,
        body: ten(1.0, vector![0.0, 0.0, 0.05], Matrix3::identity() * 0.005),
        deviation: [3.0, 0.3, 0.3, 0.3, 0.05, 0.02, 0.05, 0.02, 0.02, 0.05],
        is_slow: false,
    }
}

/// P pi is the momentum that the load adds, G pi the rest of its torque.
#[test]
fn regressors_are_those_of_a_chain_with_the_load() {
    let (arm, with) = (panda(), loaded(panda()));
    let pi = SVector::from(load().0);
    let (q, dq) = (vector![0.2, -0.4, 0.3, -2.0, 0.1, 1.7, 0.7], vector![0.3, -0.2, 0.5, 0.1, -0.4, 0.2, 0.6]);
    let of = payload_regressor(&arm, &State { q, dq }, &vector![0.0, 0.0, -9.81]);
    let momentum = with.momentum(&q, &dq) - arm.momentum(&q, &dq);
    assert!((of.momentum * pi - momentum).amax() < 1e-11, "{} {momentum}", of.momentum * pi);
    let rest = |arm: &Chain<7>| arm.gravity(&q) - arm.coriolis_transpose_times(&q, &dq);
    let force = rest(&with) - rest(&arm);
    assert!((of.force * pi - force).amax() < 1e-6, "{} {force}", of.force * pi);
}

fn reference<const N: usize>(start: &SVector<f64, N>, t: f64) -> JointReference<f64, N> {
    let wave = |i: usize, d: i32| -> f64 {
        let w = 0.9 + 0.35 * i as f64;
        let of = |w: f64, by: f64| {
            by * match d {
                0 => 1.0 - (w * t).cos(),
                1 => w * (w * t).sin(),
                _ => w * w * (w * t).cos(),
            }
        };
        of(w, 0.35) + of(2.3 * w, 0.12)
    };
    JointReference {
        q: start + SVector::from_fn(|i, _| wave(i, 0)),
        dq: SVector::from_fn(|i, _| wave(i, 1)),
        ddq: SVector::from_fn(|i, _| wave(i, 2)),
    }
}

/// Measurements of a loaded arm that follows waves: states, and torques of the past period with noise of a part of their size.
fn simulated<const N: usize>(arm: Chain<N>, start: [f64; N], seconds: f64, noise: f64) -> Vec<(State<f64, N>, SVector<f64, N>)> {
    let with = loaded(arm);
    let law = InverseDynamics::new([60.0; N], [15.0; N]).unwrap();
    let start = SVector::from(start);
    let mut plant = Plant::new(&with, State::at_rest(start), Integrator::RungeKutta4 { substeps: 4 });
    let (mut tau, mut found) = (SVector::zeros(), Vec::new());
    let mut random = Noise::new(7);
    for k in 0..(seconds / PERIOD) as usize {
        let measured = *plant.state();
        found.push((measured, tau));
        tau = law.torque(&with, &reference(&start, k as f64 * PERIOD), &measured).unwrap().tau;
        plant.advance(&tau, PERIOD).unwrap();
    }
    let count = found.len() as f64;
    let size = SVector::<f64, N>::from_fn(|i, _| (found.iter().map(|(_, tau)| tau[i] * tau[i]).sum::<f64>() / count).sqrt());
    for (_, tau) in &mut found {
        *tau += SVector::from_fn(|i, _| noise * size[i] * random.normal());
    }
    found
}

const UR5: [f64; 6] = [0.4, -1.2, 1.5, -0.6, 1.3, 0.5];

#[test]
fn the_recursion_is_the_batch_solution() {
    batch_and_recursion(1.0);
    batch_and_recursion(0.4);
}

fn batch_and_recursion(forgetting: f64) {
    let arm = ur5();
    let of = PayloadSettings { forgetting, ..settings([2.0, 3.0, 1.5, 0.5, 0.4, 0.3]) };
    let mut estimator = PayloadEstimator::new(of).unwrap();
    let samples = simulated(arm, UR5, 3.0, 0.02);
    let prior =
        |k: usize| (std::array::from_fn(|i| if i == k { 1.0 / of.deviation[k] } else { 0.0 }), of.body[k] / of.deviation[k]);
    let mut rows: Vec<([f64; PARAMETERS], f64)> = (0..PARAMETERS).map(prior).collect();
    let (mut y, mut torque) = (SMatrix::<f64, 6, PARAMETERS>::zeros(), SVector::<f64, 6>::zeros());
    let mut before = None;
    for (state, tau) in &samples {
        estimator.step(&arm, state, tau).unwrap();
        let regressor = payload_regressor(&arm, state, &of.gravity);
        let (p, x) = (
            arm.momentum(&state.q, &state.dq),
            arm.coriolis_transpose_times(&state.q, &state.dq) - arm.friction(&state.dq) - arm.gravity(&state.q),
        );
        if let Some((earlier, p_before, x_before)) = before.replace((regressor, p, x)) {
            let a = LAMBDA * PERIOD;
            y = (y + (regressor.momentum - earlier.momentum) * LAMBDA + (regressor.force + earlier.force) * (a / 2.0))
                / (1.0 + a);
            torque = (torque + (tau + (x + x_before) / 2.0) * a - (p - p_before) * LAMBDA) / (1.0 + a);
            // All that is known fades by the same share a sample.
            let kept = forgetting.powf(PERIOD / 2.0);
            rows.iter_mut().for_each(|(row, right)| row.iter_mut().chain([right]).for_each(|x| *x *= kept));
            for i in (0..6).filter(|&i| state.dq[i].abs() >= of.least_rate) {
                let weight = (a / (2.0 + a)).sqrt() / of.spread[i];
                rows.push((std::array::from_fn(|k| y[(i, k)] * weight), torque[i] * weight));
            }
        }
    }
    let a = DMatrix::from_fn(rows.len(), PARAMETERS, |i, k| rows[i].0[k]);
    let b = DVector::from_fn(rows.len(), |i, _| rows[i].1);
    let batch = a.clone().svd(true, true).solve(&b, 1e-14).unwrap();
    let found = estimator.estimate();
    let covariance = (a.transpose() * &a).try_inverse().unwrap();
    for k in 0..PARAMETERS {
        assert!((found.body[k] - batch[k]).abs() < 1e-9 * batch.amax(), "{k}: {} {}", found.body[k], batch[k]);
        assert!((found.three_sigma[k] / (3.0 * covariance[(k, k)].sqrt()) - 1.0).abs() < 1e-6, "{k}");
    }
}

/// 2 % noise: the mass within 5 % after 1 to 3 s and within 1 % after 5 s, and inside its interval.
#[test]
fn the_mass_of_a_load_is_found_within_seconds() {
    let arm = ur5();
    let (truth, ..) = load();
    // The noise behind the filter.
    let samples = simulated(arm, UR5, 6.0, 0.02);
    let mut estimator = PayloadEstimator::new(settings([0.5, 0.6, 0.3, 0.06, 0.05, 0.03])).unwrap();
    for (k, (state, tau)) in samples.iter().enumerate() {
        estimator.step(&arm, state, tau).unwrap();
        let (t, found) = (k as f64 * PERIOD, estimator.estimate());
        let error = (found.body[0] / truth[0] - 1.0).abs();
        assert!(t < 3.0 || error < 0.05, "{t} s: {error}");
        assert!(t < 5.0 || error < 0.01, "{t} s: {error}");
        if (k + 1) % 100 == 0 {
            println!("{t:.2} s: mass {:.3} +- {:.3} kg, off by {:.2} %", found.body[0], found.three_sigma[0], 100.0 * error);
            assert!((found.body[0] - truth[0]).abs() < found.three_sigma[0], "{t} s: {found:?}");
        }
    }
    let physical = estimator.physical();
    let found = estimator.estimate();
    for k in 0..PARAMETERS {
        assert!((physical[k] - truth[k]).abs() < 1.2 * found.three_sigma[k], "{k}: {} {}", physical[k], truth[k]);
    }
}

/// With signals, model and recursion in f32 the estimate is that of f64 within a hundredth of a three-sigma interval.
#[test]
fn single_precision_finds_the_same_load() {
    let arm = ur5();
    let of = settings([0.5, 0.6, 0.3, 0.06, 0.05, 0.03]);
    let mut estimator = PayloadEstimator::new(of).unwrap();
    let single = |x: f64| x as f32;
    let mut in_f32 = PayloadEstimator::new(PayloadSettings {
        gravity: of.gravity.map(single),
        period: single(of.period),
        filter: single(of.filter),
        forgetting: single(of.forgetting),
        spread: of.spread.map(single),
        least_rate: single(of.least_rate),
        body: of.body.map(single),
        deviation: of.deviation.map(single),
        is_slow: of.is_slow,
    })
    .unwrap();
    for (state, tau) in &simulated(arm, UR5, 6.0, 0.02) {
        estimator.step(&arm, state, tau).unwrap();
        let state = State { q: state.q.map(single), dq: state.dq.map(single) };
        in_f32.step(&Single(arm), &state, &tau.map(single)).unwrap();
    }
    let (wide, narrow) = (estimator.estimate(), in_f32.estimate());
    let (wide_body, narrow_body) = (estimator.physical(), in_f32.physical());
    for k in 0..PARAMETERS {
        let scale = wide.three_sigma[k];
        let lost = [
            (f64::from(narrow.body[k]) - wide.body[k]) / scale,
            f64::from(narrow.three_sigma[k]) / scale - 1.0,
            (f64::from(narrow_body[k]) - wide_body[k]) / scale,
        ];
        println!("{k}: {lost:?}");
        assert!(lost.iter().all(|lost| lost.abs() < 0.01), "{k}: {lost:?}");
    }
    let mass = f64::from(narrow.body[0]);
    assert!((mass / load().0[0] - 1.0).abs() < 0.01, "{mass}");
}

fn is_consistent(body: &[f64; PARAMETERS]) -> bool {
    let [m, x, y, z, xx, xy, yy, xz, yz, zz] = *body;
    let half = (xx + yy + zz) / 2.0;
    let j = nalgebra::Matrix4::new(half - xx, -xy, -xz, x, -xy, half - yy, -yz, y, -xz, -yz, half - zz, z, x, y, z, m);
    j.symmetric_eigenvalues().min() > 0.0
}

/// Without a load estimates are of either sign; the nearest body is positive definite, at every sample and nearly weightless.
#[test]
fn the_nearest_body_is_consistent_at_every_sample() {
    let arm = ur5();
    let mut estimator = PayloadEstimator::new(settings([0.5, 0.6, 0.3, 0.06, 0.05, 0.03])).unwrap();
    let mut impossible = 0;
    // The model of the arm with the load: nothing is left for the estimator.
    let with = loaded(arm);
    for (state, tau) in &simulated(arm, UR5, 4.0, 0.02) {
        estimator.step(&with, state, tau).unwrap();
        impossible += usize::from(!is_consistent(&estimator.estimate().body));
        assert!(is_consistent(&estimator.physical()));
    }
    assert!(impossible > 100, "{impossible}");
    let mass = estimator.physical()[0];
    assert!(mass < 0.05, "{mass}");
}

/// What was known is forgotten: after a load is put down the estimate follows.
#[test]
fn a_forgetting_estimator_follows_a_change() {
    let arm = ur5();
    let with = loaded(arm);
    let samples = simulated(arm, UR5, 8.0, 0.0);
    let masses = [1.0, 0.05].map(|forgetting| {
        let of = PayloadSettings { forgetting, ..settings([0.5, 0.6, 0.3, 0.06, 0.05, 0.03]) };
        let mut estimator = PayloadEstimator::new(of).unwrap();
        for (k, (state, tau)) in samples.iter().enumerate() {
            // From half of the time on the load is a part of the model.
            estimator.step(if k < 400 { &arm } else { &with }, state, tau).unwrap();
        }
        estimator.estimate().body[0]
    });
    assert!(masses[0] > 0.5 && masses[1].abs() < 0.1, "{masses:?}");
}

/// In slow motion gravity alone gives mass and centre of mass.
#[test]
fn slow_motion_gives_mass_and_centre_of_mass() {
    let arm = ur5();
    let (truth, ..) = load();
    let of = PayloadSettings { is_slow: true, least_rate: 0.0, ..settings([0.5, 0.6, 0.3, 0.06, 0.05, 0.03]) };
    let mut estimator = PayloadEstimator::new(of).unwrap();
    let with = loaded(arm);
    for k in 0..3000 {
        let t = k as f64 * PERIOD;
        let q = SVector::from(UR5) + SVector::from_fn(|i, _| 0.4 * (0.2 * t + i as f64).sin());
        let dq = SVector::from_fn(|i, _| 0.08 * (0.2 * t + i as f64).cos());
        let tau = with.gravity(&q);
        estimator.step(&arm, &State { q, dq }, &tau).unwrap();
    }
    let found = estimator.estimate();
    for k in 0..4 {
        assert!((found.body[k] - truth[k]).abs() < 0.01 * truth[0], "{k}: {} {}", found.body[k], truth[k]);
    }
    for k in 4..PARAMETERS {
        assert!((found.body[k] - of.body[k]).abs() < 1e-9, "{k}");
    }
}

#[test]
fn settings_without_a_meaning_are_refused() {
    let good = settings([1.0; 6]);
    let refused = |change: &dyn Fn(&mut PayloadSettings<f64, 6>)| {
        let mut of = good;
        change(&mut of);
        match PayloadEstimator::new(of) {
            Err(SettingError::NotPositive { setting, .. } | SettingError::NotFinite { setting, .. }) => Some(setting),
            _ => None,
        }
    };
    assert_eq!(refused(&|_| {}), None);
    assert_eq!(refused(&|of| of.period = 0.0), Some(Setting::Period));
    assert_eq!(refused(&|of| of.filter = f64::NAN), Some(Setting::Filter));
    assert_eq!(refused(&|of| of.forgetting = 1.1), Some(Setting::Forgetting));
    assert_eq!(refused(&|of| of.spread[2] = 0.0), Some(Setting::TorqueSpread));
    assert_eq!(refused(&|of| of.least_rate = -1.0), Some(Setting::LeastRate));
    assert_eq!(refused(&|of| of.body[0] = -1.0), Some(Setting::Estimate));
    assert_eq!(refused(&|of| of.deviation[9] = f64::INFINITY), Some(Setting::Estimate));
    let mut estimator = PayloadEstimator::new(good).unwrap();
    let before = estimator;
    let lost = State { q: SVector::from(UR5), dq: SVector::repeat(f64::NAN) };
    assert!(estimator.step(&ur5(), &lost, &SVector::zeros()).is_err() && estimator == before);
}
