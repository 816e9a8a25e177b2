//! Spectral radii of the sampled loops at 81 postures along the ghost path, with the load in the plant and not in the model.
//!
//! Stored radii and periods come from the technical project, docs/technical-project.md.

use crate::common;

use armgen_runtime::{
    control::{Adaptive, BoundaryLayer, Interval, InverseDynamics, NullSpace, OperationalSpace, PdGravity, Robust},
    linalg::{left_singular, Damping},
    reference::{JointReference, OperationalReference, Pose, State},
    robot::Kinematics,
    simulation::{Integrator, Plant},
    stability::{
        analyse, analyse_start, Delay, Linearise, LineariseAtRest, LineariseInMotion, MotionAnalysis, Report, Rest, SampledLoop,
        StabilityError, StablePeriod,
    },
    task::{Row, Task},
};
use common::{
    close, close_percent, ghost,
    gimbal::Gimbal,
    mass::{Mass, FREE},
    scara::{Scara, NOMINAL},
};
use nalgebra::{vector, Vector3, Vector4};

fn report<C: LineariseAtRest<Scara<f64>, Scara<f64>, 4>>(controller: &C, delay: Delay) -> Report<f64> {
    let report = analyse(&ghost::loaded(), &ghost::nominal(), controller, &ghost::postures(), 1e-3, delay).unwrap();
    println!("{report:?}");
    report
}

#[track_caller]
fn check<C: LineariseAtRest<Scara<f64>, Scara<f64>, 4>>(controller: &C, radius: f64, period: f64, percent: f64) {
    let report = report(controller, Delay::NONE);
    close("spectral radius", report.spectral_radius, radius, 1e-4);
    assert!(report.is_stable());
    let StablePeriod::UpTo(found) = report.period else { panic!("{report:?}") };
    close_percent("largest stable period", found, period, percent);
}

#[track_caller]
fn check_delayed<C: LineariseAtRest<Scara<f64>, Scara<f64>, 4>>(controller: &C, radius: f64) {
    let report = report(controller, Delay::samples(1));
    close("spectral radius with one sample of delay", report.spectral_radius, radius, 1e-4);
    assert!(!report.is_stable());
}

const K_P: [f64; 4] = [1000.0, 1000.0, 2000.0, 1000.0];
const K_D: [f64; 4] = [10.0, 10.0, 50.0, 1.0];

fn robust(rho: f64) -> Robust<f64, 4> {
    Robust::new(K_P, K_D, [1.0; 4], [1.0; 4], BoundaryLayer { rho, epsilon: 0.2 }).unwrap()
}

#[test]
fn robust_as_reported() {
    check(&robust(10.0), 0.994830, 25e-3, 2.0);
}

#[test]
fn the_pd_part_alone() {
    check(&InverseDynamics::new(K_P, K_D).unwrap(), 0.999750, 2.0e-3, 2.0);
    check_delayed(&InverseDynamics::new(K_P, K_D).unwrap(), 1.000248);
    // Without its added term the robust law is the same.
    assert_eq!(report(&robust(0.0), Delay::NONE), report(&InverseDynamics::new(K_P, K_D).unwrap(), Delay::NONE));
}

fn robust_tuned() -> Robust<f64, 4> {
    Robust::new([1e4; 4], [200.0; 4], [5.4e7; 4], [1e3; 4], BoundaryLayer { rho: 10.0, epsilon: 0.2 }).unwrap()
}

#[test]
fn robust_with_tuned_gains() {
    let report = report(&robust_tuned(), Delay::NONE);
    close("spectral radius", report.spectral_radius, 0.84131, 1e-4);
    check_delayed(&robust_tuned(), 1.0459);
}

fn operational_space(k_p: [f64; 4], k_i: [f64; 4], k_d: [f64; 4]) -> OperationalSpace<f64, 4, 4> {
    OperationalSpace::new(ghost::task(), k_p, k_d, k_i, 1e-3).unwrap()
}

fn operational_space_as_reported() -> OperationalSpace<f64, 4, 4> {
    operational_space([5000.0, 5000.0, 10_000.0, 5000.0], [20.0, 20.0, 2000.0, 20.0], [50.0, 50.0, 100.0, 50.0])
}

#[test]
fn operational_space_reported_and_tuned() {
    let controller = operational_space_as_reported();
    check(&controller, 0.9999960, 20e-3, 2.0);
    close("radius", report(&controller, Delay::NONE).spectral_radius, 0.9999960, 1e-7);
    let tuned = report(&operational_space([1e4; 4], [1e5; 4], [200.0; 4]), Delay::NONE);
    assert!(tuned.is_stable());
}

fn adaptive(lambda: [f64; 4], k_d: [f64; 4], third: f64, fourth: f64, mass: f64) -> Adaptive<f64, 4, 14> {
    let k_pi = [1.0, 1.0, 0.001, 1.0, 1.0, 1.0, 1.0, 1.0, third, fourth, 1.0, 1.0, third, fourth].map(|k| 10.0 * k);
    let mut estimate = NOMINAL;
    estimate[2] = mass;
    Adaptive::new(lambda, k_d, k_pi, estimate, 1e-3).unwrap()
}

fn adaptive_scaled(lambda: f64, k_d: [f64; 4]) -> Adaptive<f64, 4, 14> {
    adaptive([lambda; 4], k_d, 50f64.powi(4), 20f64.powi(4), 10.0)
}

#[test]
fn adaptive_a() {
    check(&adaptive_scaled(500.0, K_D), 0.999636, 3.99e-3, 0.5);
}

#[test]
fn adaptive_b() {
    // With the estimate that it begins with, and with the load that it has: a little less.
    let controller = adaptive_scaled(100.0, [1000.0, 500.0, 2000.0, 100.0]);
    let found = analyse_start(&ghost::loaded(), &ghost::nominal(), &controller, &ghost::postures(), 1e-3, Delay::NONE).unwrap();
    close("spectral radius at the start", found.spectral_radius, 0.99497, 1e-4);
    let StablePeriod::UpTo(limit) = found.period else { panic!("{found:?}") };
    close_percent("largest stable period at the start", limit, 8.60e-3, 0.5);
    check(&controller, 0.99489, 8.26e-3, 0.5);
}

#[test]
fn adaptive_as_reported_is_unstable() {
    for (mass, radius, period) in [(10.0, 7.19, 0.2444e-3), (15.0, 9.01, 0.2000e-3)] {
        let controller = adaptive([500.0, 500.0, 10_000.0, 500.0], K_D, 1.0, 1.0, mass);
        let at_start = |controller: &Adaptive<f64, 4, 14>| {
            analyse_start(&ghost::loaded(), &ghost::nominal(), controller, &ghost::postures(), 1e-3, Delay::NONE).unwrap()
        };
        let found = at_start(&controller);
        close_percent("spectral radius", found.spectral_radius, radius, 1.0);
        let StablePeriod::UpTo(limit) = found.period else { panic!("{found:?}") };
        close("largest stable period", limit, period, 0.5e-7);
        assert!(!found.is_stable());
        // Adaptation does not matter for it.
        let frozen = at_start(&controller.with_frozen([true; 14]));
        close_percent("radius without adaptation", frozen.spectral_radius, radius, 1.0);
        // The arm rests with the true load alone, wherever the estimate begins.
        close_percent("radius at rest", report(&controller, Delay::NONE).spectral_radius, 9.01, 1.0);
    }
}

/// Derivatives of the torque itself, by central differences, against the linearisation.
#[track_caller]
fn linearised<C: Linearise<Scara<f64>, 4>>(controller: &C, torque: impl Fn(&State<f64, 4>) -> Vector4<f64>) {
    linearised_at(ghost::start(), controller, torque);
}

#[track_caller]
fn linearised_at<C: Linearise<Scara<f64>, 4>>(q: Vector4<f64>, controller: &C, torque: impl Fn(&State<f64, 4>) -> Vector4<f64>) {
    let feedback = controller.linearise(&ghost::nominal(), &q).unwrap();
    let h = 1e-7;
    for i in 0..4 {
        let mut d = Vector4::zeros();
        d[i] = h;
        let dq = (torque(&State::at_rest(q + d)) - torque(&State::at_rest(q - d))) / (2.0 * h);
        let dv = (torque(&State { q, dq: d }) - torque(&State { q, dq: -d })) / (2.0 * h);
        let scale = 1.0 + feedback.position.amax();
        assert!((feedback.position.column(i) - dq).amax() < 1e-6 * scale, "{i}: {} {dq}", feedback.position);
        assert!((feedback.velocity.column(i) - dv).amax() < 1e-6 * scale, "{i}: {} {dv}", feedback.velocity);
    }
}

#[test]
fn linearisations_are_derivatives_of_the_torque() {
    let model = ghost::nominal();
    let rest = JointReference::at_rest(ghost::start());
    let pd = PdGravity::new([2000.0, 2000.0, 5000.0, 100.0], [200.0, 200.0, 300.0, 10.0]).unwrap();
    linearised(&pd, |x| pd.torque(&model, &rest, x).unwrap().tau);
    let inverse = InverseDynamics::new(K_P, K_D).unwrap();
    linearised(&inverse, |x| inverse.torque(&model, &rest, x).unwrap().tau);
    linearised(&robust(10.0), |x| robust(10.0).torque(&model, &rest, x).unwrap().tau);
    let adaptive = adaptive_scaled(500.0, K_D);
    linearised(&adaptive, |x| adaptive.law(&model, &rest, x, adaptive.estimate()).unwrap().0.tau);
    let operational = operational_space_as_reported();
    let pose = OperationalReference::at_rest(Pose::of(&model, &ghost::start()));
    linearised(&operational, |x| operational.clone().torque(&model, &pose, x).unwrap().tau);
    let relaxed = relaxed([30.0; 4]);
    linearised(&relaxed, |x| relaxed.clone().torque(&model, &pose, x).unwrap().tau);
    let (q, damped) = near_singular(2.0, 6000.0);
    let pose = OperationalReference::at_rest(Pose::of(&model, &q));
    linearised_at(q, &damped, |x| damped.clone().torque(&model, &pose, x).unwrap().tau);
}

/// A posture with the elbow nearly stretched, and a law that damps there: lambda is `times` the smallest singular value.
fn near_singular(times: f64, k_i: f64) -> (Vector4<f64>, OperationalSpace<f64, 4, 4>) {
    let q = vector![0.3, 0.1, 0.2, 0.4];
    let j = ghost::task().jacobian(&ghost::nominal().geometric_jacobian(&q));
    // w = sin(theta2) / 4, and lambda = lambda_0 (1 - w / w_0).
    let (w, w_0) = (0.1f64.sin() / 4.0, 0.1);
    let damping = Damping::below(w_0).at_most(times * left_singular(&j).sigma[3] / (1.0 - w / w_0)).unwrap();
    (q, operational_space([400.0; 4], [k_i; 4], [40.0; 4]).with_damping(damping))
}

/// The error along u of the smallest sigma obeys dde + g (K_D de + K_P e + K_I int e) = 0, g = sigma^2 / (sigma^2 + lambda^2). So
/// lambda = 2 sigma leaves a fifth of the gains, and K_I = 16000 / 5 is the limit.
#[test]
fn damping_lowers_the_gain_of_the_integral() {
    let model = ghost::nominal();
    let at = |times: f64, k_i: f64| {
        let (q, law) = near_singular(times, k_i);
        analyse(&model, &model, &law, &[q], 1e-4, Delay::NONE).unwrap()
    };
    for (times, k_i, stable) in [(2.0, 3000.0, true), (2.0, 3400.0, false), (1e-6, 15_000.0, true), (1e-6, 17_000.0, false)] {
        assert_eq!(at(times, k_i).is_stable(), stable, "lambda {times} sigma, K_I {k_i}: {:?}", at(times, k_i));
    }
    // The law that is damped runs at a singular posture, and so does its analysis; a load it cannot hold there.
    let (_, law) = near_singular(2.0, 1000.0);
    let stretched = [vector![0.3, 0.0, 0.2, 0.4]];
    let report = analyse(&model, &model, &law, &stretched, 1e-3, Delay::NONE).unwrap();
    assert_eq!(report.without_rest, None);
    let loaded = analyse(&ghost::loaded(), &model, &law, &stretched, 1e-3, Delay::NONE).unwrap();
    assert_eq!(loaded.without_rest, Some(0));
}

/// Compares the rest of the simulated arm, and the decay of its error there, with the analysis.
#[test]
fn an_operational_law_rests_where_it_is_said_to() {
    fn rest<const M: usize>(what: &str, reference: Vector4<f64>, mut law: OperationalSpace<f64, 4, M>) -> f64 {
        let (plant, model) = (ghost::loaded(), ghost::nominal());
        let said: armgen_runtime::stability::Rest<f64, 4> = LineariseAtRest::settle(&law, &plant, &model, &reference).unwrap();
        assert!(said.is_held, "{what}");
        let pose = OperationalReference::at_rest(Pose::of(&model, &reference));
        let mut arm = Plant::new(&plant, State::at_rest(reference), Integrator::RungeKutta4 { substeps: 1 });
        for _ in 0..20_000 {
            arm.advance(&law.torque(&model, &pose, arm.state()).unwrap().tau, 1e-3).unwrap();
        }
        let off = (arm.state().q - said.q).amax();
        let moved = (said.q - reference).amax();
        println!("{what}: {} moved by {moved}, off by {off}", said.q);
        assert!(off < 1e-9, "{what}: off by {off}");
        let report = analyse(&plant, &model, &law, &[reference], 1e-3, Delay::NONE).unwrap();
        close(what, report.offset, moved, 1e-15);
        assert!(report.is_stable(), "{report:?}");
        // About that posture the torque follows the feedback.
        let torque = |x: &State<f64, 4>| law.clone().torque(&model, &pose, x).unwrap().tau;
        let h = 1e-6;
        for i in 0..4 {
            let mut d = Vector4::zeros();
            d[i] = h;
            let by_position = (torque(&State::at_rest(said.q + d)) - torque(&State::at_rest(said.q - d))) / (2.0 * h);
            let scale = 1.0 + said.feedback.position.amax();
            assert!((said.feedback.position.column(i) - by_position).amax() < 1e-4 * scale, "{what}, {i}");
        }
        moved
    }
    let (k_p, k_d, q) = ([400.0; 4], [40.0; 4], ghost::start());
    let none = rest("no integral", q, operational_space(k_p, [0.0; 4], k_d));
    assert!(none > 1e-3, "{none}");
    let some = rest("z with an integral", q, operational_space(k_p, [0.0, 0.0, 2000.0, 0.0], k_d));
    assert!(some > 1e-4 && some < none, "{some} {none}");
    let all = rest("all with an integral", q, operational_space(k_p, [2000.0; 4], k_d));
    assert!(all < 1e-12, "{all}");
    // The null space gives way by its spring.
    assert!(rest("null space", q, relaxed([30.0; 4])) > 1e-3);
    let (near, damped) = near_singular(2.0, 0.0);
    assert!(rest("damped", near, damped) > 1e-3);
    // Without a spring nothing holds it.
    let loose = LineariseAtRest::settle(&relaxed([0.0; 4]), &ghost::loaded(), &ghost::nominal(), &q);
    assert!(loose.is_some_and(|rest: armgen_runtime::stability::Rest<f64, 4>| !rest.is_held));
}

/// Far from its reference an orientation error does not change by -J. Rows of three angles rest 0.2 rad off, and the feedback
/// there still equals the derivative of the torque. The same holds for the integral of a row next to rows that rest off.
#[test]
fn a_rest_off_the_reference_is_linearised_there() {
    let (plant, model) = (Gimbal { load: vector![60.0, -80.0, 50.0] }, Gimbal { load: Vector3::zeros() });
    let task = Task::new([Row::Rx, Row::Ry, Row::Rz]).unwrap();
    let reference = vector![0.3, 0.4, -0.5];
    let goal = Pose::of(&model, &reference);
    for k_i in [[0.0; 3], [2000.0, 0.0, 0.0]] {
        let law = OperationalSpace::new(task, [400.0; 3], [40.0; 3], k_i, 1e-3).unwrap();
        let said: Rest<f64, 3> = law.settle(&plant, &model, &reference).unwrap();
        let e = task.error(&goal, &Pose::of(&model, &said.q));
        assert!(said.is_held && e.norm() > 0.15 && e.norm() < 0.4, "{e}");
        let (pose, h) = (OperationalReference::at_rest(goal), 1e-5);
        let mut held = law;
        // The torque that the integral holds.
        let mut arm = Plant::new(&plant, State::at_rest(said.q), Integrator::RungeKutta4 { substeps: 1 });
        for _ in 0..20_000 {
            arm.advance(&held.torque(&model, &pose, arm.state()).unwrap().tau, 1e-3).unwrap();
        }
        assert!((arm.state().q - said.q).amax() < 1e-9, "{} {}", arm.state().q, said.q);
        for i in 0..3 {
            let mut d = Vector3::zeros();
            d[i] = h;
            let torque = |q: Vector3<f64>| held.clone().torque(&model, &pose, &State::at_rest(q)).unwrap().tau;
            let by_position = (torque(said.q + d) - torque(said.q - d)) / (2.0 * h);
            let off = (said.feedback.position.column(i) - by_position).amax();
            assert!(off < 1e-6 * said.feedback.position.amax(), "{i}: {off}");
            let error = |q: Vector3<f64>| task.error(&goal, &Pose::of(&model, &q));
            let turned = (error(said.q + d) - error(said.q - d)) / (2.0 * h);
            for k in 0..said.feedback.state_by_position.nrows() {
                assert!((said.feedback.state_by_position[(k, i)] - turned[k]).abs() < 1e-8);
            }
        }
    }
}

/// If the estimate is frozen, or at its bound, F(Lambda e) + K_D Lambda e carries the load: the quill rests low by 5 g / ((50 + 25) 500) m.
#[test]
fn an_estimate_that_cannot_come_to_the_truth_rests_off_the_reference() {
    let (plant, model, reference) = (ghost::loaded(), ghost::nominal(), ghost::start());
    let (low, high) = (NOMINAL.map(|p| p - 1.0), NOMINAL.map(|p| p + 2.0));
    let law = adaptive_scaled(500.0, K_D);
    let third = std::array::from_fn(|i| i == 2);
    let bounded = law.with_projection(Interval::new(low, high).unwrap());
    for (law, missing) in [(law.with_frozen([true; 14]), 5.0), (law.with_frozen(third), 5.0), (bounded, 3.0)] {
        let said: Rest<f64, 4> = law.settle(&plant, &model, &reference).unwrap();
        let off = missing * 9.81 / ((50.0 + 25.0) * 500.0);
        assert!(said.is_held);
        close("the quill", (reference[2] - said.q[2]).abs(), off, 1e-9);
        assert_eq!(said.feedback.torque_by_state.ncols(), 0);
        // The torque of the law itself at that estimate.
        let mut estimate = NOMINAL;
        estimate[2] += 5.0 - missing;
        let rest = JointReference::at_rest(reference);
        let torque = |x: &State<f64, 4>| law.law(&model, &rest, x, &estimate.into()).unwrap().0.tau;
        let h = 1e-6;
        for i in 0..4 {
            let mut d = Vector4::zeros();
            d[i] = h;
            let by_position = (torque(&State::at_rest(said.q + d)) - torque(&State::at_rest(said.q - d))) / (2.0 * h);
            let by_rates = (torque(&State { q: said.q, dq: d }) - torque(&State { q: said.q, dq: -d })) / (2.0 * h);
            let scale = 1.0 + said.feedback.position.amax();
            assert!((said.feedback.position.column(i) - by_position).amax() < 1e-6 * scale, "{i}");
            assert!((said.feedback.velocity.column(i) - by_rates).amax() < 1e-6 * scale, "{i}");
        }
        let report = analyse(&plant, &model, &law, &[reference], 1e-3, Delay::NONE).unwrap();
        close("offset", report.offset, (reference - said.q).amax(), 1e-15);
    }
    // The frozen value of a parameter that gravity does not excite does not matter.
    let mut elsewhere = NOMINAL;
    elsewhere[0] += 3.0;
    let first = std::array::from_fn(|i| i == 0);
    let law = Adaptive::new([500.0; 4], K_D, [10.0; 14], elsewhere, 1e-3).unwrap().with_frozen(first);
    let said: Rest<f64, 4> = law.settle(&plant, &model, &reference).unwrap();
    assert!(said.is_held && (said.q - reference).amax() < 1e-12 && said.feedback.torque_by_state.ncols() == 1);
    // One half of a force makes up for the other one, which is frozen.
    let (plant, q) = (Mass { force: 8.0, ..FREE }, vector![0.3]);
    let halves = Adaptive::new([10.0], [5.0], [1.0; 2], [1.0, 0.0], 1e-3).unwrap();
    let rest = |law: Adaptive<f64, 1, 2>| -> Rest<f64, 1> { law.settle(&plant, &FREE, &q).unwrap() };
    let one = rest(halves.with_frozen([true, false]));
    assert!(one.is_held && (one.q - q).amax() < 1e-12 && one.feedback.torque_by_state.ncols() == 1);
    let none = rest(halves.with_frozen([true; 2]));
    // (8 - 1) N by 5 * 10 N/m.
    close("both frozen", (none.q - q).amax(), 7.0 / 50.0, 1e-9);
}

/// x relaxed: one joint motion is free, under a spring of this stiffness and a damper.
fn relaxed(stiffness: [f64; 4]) -> OperationalSpace<f64, 4, 3> {
    let task = Task::new([Row::Y, Row::Z, Row::Rz]).unwrap();
    let null_space = NullSpace::new(stiffness, [12.0; 4], ghost::start().into()).unwrap();
    OperationalSpace::new(task, [400.0; 3], [40.0; 3], [2000.0; 3], 1e-3).unwrap().with_null_space(null_space)
}

#[test]
fn a_null_space_without_a_spring_may_drift() {
    let radius = |controller: OperationalSpace<f64, 4, 3>| {
        let sampled = SampledLoop::new(&ghost::nominal(), &ghost::nominal(), &controller, &ghost::start()).unwrap();
        sampled.spectral_radius(1e-3, Delay::NONE).unwrap()
    };
    assert!(radius(relaxed([30.0; 4])) < 0.9999);
    close("without a spring", radius(relaxed([0.0; 4])), 1.0, 1e-9);
}

#[test]
fn memories_are_excited_ones_only() {
    let q = ghost::start();
    let feedback = adaptive_scaled(500.0, K_D).linearise(&ghost::nominal(), &q).unwrap();
    assert_eq!(feedback.torque_by_state.ncols(), 1, "m_l3 alone is excited at rest");
    let operational = operational_space([1e4; 4], [0.0, 0.0, 1e5, 0.0], [200.0; 4]).linearise(&ghost::nominal(), &q).unwrap();
    assert_eq!(operational.torque_by_state.ncols(), 1);
}

/// The analysis against the thing itself: the error of the simulated loop shrinks by the spectral radius, sample by sample.
#[test]
fn a_simulated_loop_decays_by_its_radius() {
    let (plant, model) = (ghost::loaded(), ghost::loaded());
    let controller = InverseDynamics::new([400.0; 4], [10.0, 12.0, 14.0, 16.0]).unwrap();
    let q = ghost::start();
    let radius = SampledLoop::new(&plant, &model, &controller, &q).unwrap().spectral_radius(20e-3, Delay::NONE).unwrap();
    let reference = JointReference::at_rest(q);
    let mut state = State::at_rest(q + Vector4::repeat(1e-4));
    let mut sizes = Vec::new();
    let mut arm = Plant::new(&plant, state, Integrator::RungeKutta4 { substeps: 4 });
    for _ in 0..400 {
        arm.advance(&controller.torque(&model, &reference, &state).unwrap().tau, 20e-3).unwrap();
        state = *arm.state();
        sizes.push((state.q - q).norm().hypot(state.dq.norm() * 0.05));
    }
    let decay = (sizes[199] / sizes[49]).powf(1.0 / 150.0);
    close("decay per sample", decay, radius, 2e-3);
}

/// Small deviations of the mass: the closed form's eigenvalues are their growth, sample by sample.
#[test]
fn deviations_in_motion_grow_by_the_eigenvalues() {
    let h = 1e-3;
    let joints: Vec<_> = (0..4000)
        .map(|k| {
            let t = k as f64 * h;
            JointReference { q: vector![t.sin()], dq: vector![t.cos()], ddq: vector![-t.sin()] }
        })
        .collect();
    let start = State { q: joints[0].q, dq: joints[0].dq };
    let analysis = MotionAnalysis { plant: &FREE, joints: &joints, start, period: h, delay: Delay::NONE };
    // |z|^2 = 1 + k_P h^2/2 - k_D h where the eigenvalues are complex.
    for (k_p, k_d) in [(1e4f64, 6.0f64), (1e4, 4.0), (400.0, 0.6)] {
        let controller = InverseDynamics::new([k_p], [k_d]).unwrap();
        let motion = analysis.of(&FREE, &controller, &joints).unwrap();
        let rate = (1.0 + k_p * h * h / 2.0 - k_d * h).ln() / 2.0 / h;
        println!("{motion:?} {rate}");
        close("rate", motion.growth.rate, rate, 0.05 * rate.abs());
        assert_eq!(motion.diverges(), rate * 4.0 > 10f64.ln(), "{motion:?}");
        assert_eq!(motion.lost, None, "it starts on the reference, and nothing disturbs it");
    }
    let late = MotionAnalysis { delay: Delay::samples(3), ..analysis.clone() };
    let controller = InverseDynamics::new([2000.0], [20.0]).unwrap();
    assert!(!analysis.of(&FREE, &controller, &joints).unwrap().diverges());
    assert!(late.of(&FREE, &InverseDynamics::new([1e5], [400.0]).unwrap(), &joints).unwrap().diverges());
    let nothing = MotionAnalysis { joints: &[], ..analysis.clone() };
    assert_eq!(nothing.of(&FREE, &controller, &[]), Err(StabilityError::NoSample));
    let few = analysis.of(&FREE, &controller, &joints[..3999]);
    assert_eq!(few, Err(StabilityError::NoReference { sample: 3999 }));
    let never = MotionAnalysis { period: 0.0, ..analysis };
    assert_eq!(never.of(&FREE, &controller, &joints), Err(StabilityError::Period));
}

#[test]
fn a_controller_state_that_is_too_short_changes_what_it_has() {
    let adaptive = adaptive_scaled(500.0, K_D);
    let with = |state: &[f64]| LineariseInMotion::<Scara<f64>, Scara<f64>, 4>::with_controller_state(&adaptive, state);
    assert_eq!(with(&[]).estimate(), adaptive.estimate());
    assert_eq!((with(&[7.0]).estimate()[0], with(&[7.0]).estimate()[1]), (7.0, NOMINAL[1]));
    let operational = operational_space_as_reported();
    let with = |state: &[f64]| LineariseInMotion::<Scara<f64>, Scara<f64>, 4>::with_controller_state(&operational, state);
    assert_eq!((with(&[]).integral()[3], with(&[1.0, 2.0, 3.0, 4.0, 5.0]).integral()[3]), (0.0, 4.0));
}

#[test]
fn a_sampled_mass_has_the_eigenvalues_of_the_closed_form() {
    // z^2 - (2 - k_P h^2/2 - k_D h) z + (1 + k_P h^2/2 - k_D h) = 0, stable while k_P h < 2 k_D and k_D h < 2.
    let loop_of =
        |k_p: f64, k_d: f64| SampledLoop::new(&FREE, &FREE, &InverseDynamics::new([k_p], [k_d]).unwrap(), &vector![0.0]).unwrap();
    for (k_p, k_d, h) in [(100.0f64, 5.0f64, 1e-2f64), (1e4, 200.0, 1e-3), (1e3, 1.0, 1e-3)] {
        let (b, c) = (2.0 - k_p * h * h / 2.0 - k_d * h, 1.0 + k_p * h * h / 2.0 - k_d * h);
        let disc = b * b - 4.0 * c;
        let radius = if disc < 0.0 { c.sqrt() } else { ((b.abs() + disc.sqrt()) / 2.0).abs() };
        close("radius", loop_of(k_p, k_d).spectral_radius(h, Delay::NONE).unwrap(), radius, 1e-7);
    }
    let StablePeriod::UpTo(limit) = loop_of(1000.0, 10.0).largest_stable_period(1e-3, Delay::NONE).unwrap() else { panic!() };
    close("limit by the position gain", limit, 2.0 * 10.0 / 1000.0, 1e-7);
    let StablePeriod::UpTo(limit) = loop_of(100.0, 50.0).largest_stable_period(1.0, Delay::NONE).unwrap() else { panic!() };
    close("limit by the velocity gain", limit, 2.0 / 50.0, 1e-7);
}

/// 2 K_P (q_d - q) = f + k q, where the gains hold the spring; nowhere where it pushes more than they do.
#[test]
fn a_law_without_an_integral_rests_off_its_reference() {
    let [k_p, k_d] = [[100.0], [20.0]];
    let of = |plant: &Mass| {
        analyse(plant, &FREE, &InverseDynamics::new(k_p, k_d).unwrap(), &[vector![0.3]], 1e-3, Delay::NONE).unwrap()
    };
    for (force, stiffness) in [(40.0, 6.0), (-400.0, 60.0), (10.0, -150.0)] {
        let report = of(&Mass { force, stiffness, ..FREE });
        let q = (200.0 * 0.3 - force) / (200.0 + stiffness);
        close("offset", report.offset, f64::abs(0.3 - q), 1e-8);
        assert!(report.without_rest.is_none() && report.is_stable(), "{report:?}");
    }
    let report = of(&Mass { force: 1.0, stiffness: -300.0, ..FREE });
    assert_eq!((report.without_rest, report.is_stable()), (Some(0), false));
    // Only the second posture is not held: this force alone holds the mass at the first.
    let pushed = Mass { force: 90.0, stiffness: -300.0, ..FREE };
    let law = PdGravity::new([250.0], k_d).unwrap();
    let report = analyse(&pushed, &FREE, &law, &[vector![0.3], vector![0.4]], 1e-3, Delay::NONE).unwrap();
    assert_eq!(report.without_rest, Some(1));
    close("offset", report.offset, 0.0, 1e-12);

    // Beyond its boundary layer the robust law adds rho, whatever the error: 2 (K_P e + rho) = f, and K_P alone is its stiffness.
    let (rho, force) = (5.0, 40.0);
    let robust = Robust::new(k_p, k_d, [1.0], [1.0], BoundaryLayer { rho, epsilon: 1e-6 }).unwrap();
    let loaded = Mass { force, ..FREE };
    let report = analyse(&loaded, &FREE, &robust, &[vector![0.3]], 1e-3, Delay::NONE).unwrap();
    close("offset beyond the layer", report.offset, (force / 2.0 - rho) / k_p[0], 1e-8);
    close("spectral radius beyond the layer", report.spectral_radius, of(&loaded).spectral_radius, 1e-7);
}

/// An offset F_0 of friction acts at rest: K_P e = F_0 of PD, whose law has no friction, 2 K_P e = F_0 less that of the model of the others.
#[test]
fn the_offset_of_friction_moves_the_rest() {
    let plant = Mass { friction: 10.0, ..FREE };
    let ([k_p, k_d], q) = ([[1000.0], [100.0]], [vector![0.3]]);
    let pd = PdGravity::new(k_p, k_d).unwrap();
    let inverse = InverseDynamics::new(k_p, k_d).unwrap();
    let robust = Robust::new(k_p, k_d, [1.0], [1.0], BoundaryLayer { rho: 0.0, epsilon: 1.0 }).unwrap();
    let task = Task::new([Row::X]).unwrap();
    let operational = OperationalSpace::<f64, 1, 1>::new(task, k_p, k_d, [0.0], 1e-3).unwrap();
    let integral = OperationalSpace::<f64, 1, 1>::new(task, k_p, k_d, [1000.0], 1e-3).unwrap();
    let known = Mass { friction: 4.0, ..FREE };
    let offset = |law: &dyn LineariseAtRest<Mass, Mass, 1>, model: &Mass| {
        analyse(&plant, model, law, &q, 1e-3, Delay::NONE).unwrap().offset
    };
    close("PD", offset(&pd, &FREE), 10.0 / 1000.0, 1e-10);
    close("PD, whatever the model's friction", offset(&pd, &known), 10.0 / 1000.0, 1e-10);
    for (law, of) in [
        (&inverse as &dyn LineariseAtRest<Mass, Mass, 1>, "inverse dynamics"),
        (&robust, "robust"),
        (&operational, "operational space"),
    ] {
        close(of, offset(law, &FREE), 10.0 / 2000.0, 1e-10);
        close(of, offset(law, &known), 6.0 / 2000.0, 1e-10);
        close(of, offset(law, &plant), 0.0, 1e-15);
    }
    close("with an integral", offset(&integral, &FREE), 0.0, 1e-12);
}

#[test]
fn every_sample_of_delay_counts() {
    // Nearly without stiffness v_{n+1} = v_n - k_D h v_{n-d}, stable while k_D h < 2 cos(d pi / (2 d + 1)) (Levin, May, 1976).
    let sampled = SampledLoop::new(&FREE, &FREE, &InverseDynamics::new([1e-4], [50.0]).unwrap(), &vector![0.0]).unwrap();
    for d in 0..=10usize {
        let expected = 2.0 * (d as f64 * std::f64::consts::PI / (2 * d + 1) as f64).cos() / 50.0;
        let StablePeriod::UpTo(limit) = sampled.largest_stable_period(1e-3, Delay::samples(d)).unwrap() else { panic!("{d}") };
        close_percent(&format!("limit with {d} samples of delay"), limit, expected, 0.01);
    }
    assert_eq!((Delay::NONE, Delay::default()), (Delay::samples(0), Delay::samples(0)));
}

/// A controller with an integral, measured late: the simulated error shrinks, or grows, by the radius.
#[test]
fn a_delayed_loop_moves_by_its_radius() {
    use armgen_runtime::simulation::{run, RunOptions, Sensor};
    use core::time::Duration;
    let (plant, model) = (ghost::loaded(), ghost::loaded());
    let q = ghost::start();
    for (delay, gain) in [(1, 1.0), (2, 0.5), (2, 0.68), (3, 0.3), (5, 0.15)] {
        let [k_p, k_d] = [[400.0 * gain; 4], [40.0 * gain; 4]];
        let mut controller = OperationalSpace::new(ghost::task(), k_p, k_d, [400.0 * gain; 4], 20e-3).unwrap();
        let sampled = SampledLoop::new(&plant, &model, &controller, &q).unwrap();
        let radius = sampled.spectral_radius(20e-3, Delay::samples(delay)).unwrap();
        let reference = OperationalReference::at_rest(Pose::of(&model, &q));
        let mut options = RunOptions::new(Duration::from_millis(20), Duration::from_secs(6));
        options.sensor = Sensor::new(delay, 0.0, 0.0, 0);
        options.integrator = Integrator::RungeKutta4 { substeps: 4 };
        let mut sizes = Vec::new();
        let start = State::at_rest(q + Vector4::repeat(1e-7));
        run(
            &plant,
            start,
            options,
            |_, measured| controller.torque(&model, &reference, measured).map(|torque| torque.tau),
            |sample| sizes.push((sample.state.q - q).norm().hypot(sample.state.dq.norm() * 0.05)),
        )
        .unwrap();
        // The mean over many samples, past the modes that fade faster.
        let (from, to) = (sizes.len() / 2, sizes.len() - 1);
        let found = (sizes[to] / sizes[from]).powf(1.0 / (to - from) as f64);
        println!("{delay} {gain}: {found} {radius}");
        close(&format!("delay {delay}, gain {gain}"), found, radius, 3e-3);
    }
}

#[test]
fn what_has_no_answer_says_so() {
    let (plant, model) = (ghost::loaded(), ghost::nominal());
    let controller = operational_space_as_reported();
    let singular = vector![0.0, 0.0, 0.0, 0.0];
    let postures = [ghost::start(), singular];
    let error = analyse(&plant, &model, &controller, &postures, 1e-3, Delay::NONE).unwrap_err();
    assert_eq!(error, StabilityError::Singular { posture: 1 });
    let error = analyse(&plant, &model, &controller, &[], 1e-3, Delay::NONE).unwrap_err();
    assert_eq!(error, StabilityError::NoPosture);
    let error = analyse(&plant, &model, &controller, &postures[..1], f64::NAN, Delay::NONE).unwrap_err();
    assert_eq!(error, StabilityError::Period);
}
