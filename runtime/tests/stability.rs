//! Spectral radii of the sampled loops at 81 postures along the ghost path, with the load in the plant and not in the model.

mod common;

use armgen_runtime::{
    control::{Adaptive, BoundaryLayer, InverseDynamics, NullSpace, OperationalSpace, PdGravity, Robust},
    reference::{JointReference, OperationalReference, Pose, State},
    robot::Dynamics,
    stability::{
        analyse, analyse_start, Delay, Linearise, LineariseAtRest, MotionAnalysis, Report, SampledLoop, StabilityError,
        StablePeriod,
    },
    task::{Row, Task},
};
use common::{
    close, close_percent, ghost,
    scara::{Scara, NOMINAL},
};
use nalgebra::{vector, SMatrix, SVector, Vector4};

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
    let q = ghost::start();
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
}

/// x relaxed: one joint motion is free, under a spring of this stiffness and a damper.
fn relaxed(stiffness: [f64; 4]) -> OperationalSpace<f64, 4, 3> {
    let task = Task::new([Row::Y, Row::Z, Row::Rz]).unwrap();
    let null_space = NullSpace::new(stiffness, [12.0; 4], ghost::start().into()).unwrap();
    OperationalSpace::new(task, [400.0; 3], [40.0; 3], [100.0; 3], 1e-3).unwrap().with_null_space(null_space)
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
    use armgen_runtime::simulation::{Integrator, Plant};
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
    let never = MotionAnalysis { period: 0.0, ..analysis };
    assert_eq!(never.of(&FREE, &controller, &joints), Err(StabilityError::Period));
}

/// A point mass of 2 kg on a line, without friction, held back by a force and a spring.
#[derive(Clone, Debug)]
struct Mass {
    force: f64,
    stiffness: f64,
}

const FREE: Mass = Mass { force: 0.0, stiffness: 0.0 };

impl armgen_runtime::robot::Kinematics<1> for Mass {
    type Real = f64;
    fn direct_kinematics(&self, q: &SVector<f64, 1>) -> nalgebra::Matrix4<f64> {
        let mut t = nalgebra::Matrix4::identity();
        t[(0, 3)] = q[0];
        t
    }
    fn link_frames(&self, q: &SVector<f64, 1>) -> [nalgebra::Matrix4<f64>; 1] {
        [self.direct_kinematics(q)]
    }
    fn geometric_jacobian(&self, _: &SVector<f64, 1>) -> SMatrix<f64, 6, 1> {
        SVector::<f64, 6>::x()
    }
    fn geometric_jacobian_dot(&self, _: &SVector<f64, 1>, _: &SVector<f64, 1>) -> SMatrix<f64, 6, 1> {
        SMatrix::zeros()
    }
}

impl Dynamics<1> for Mass {
    fn inertia_matrix(&self, _: &SVector<f64, 1>) -> SMatrix<f64, 1, 1> {
        SMatrix::from_element(2.0)
    }
    fn coriolis_matrix(&self, _: &SVector<f64, 1>, _: &SVector<f64, 1>) -> SMatrix<f64, 1, 1> {
        SMatrix::zeros()
    }
    fn gravity(&self, q: &SVector<f64, 1>) -> SVector<f64, 1> {
        vector![self.force] + q * self.stiffness
    }
    fn friction(&self, _: &SVector<f64, 1>) -> SVector<f64, 1> {
        SVector::zeros()
    }
    fn equations_of_motion(&self, q: &SVector<f64, 1>, dq: &SVector<f64, 1>) -> armgen_runtime::robot::EquationsOfMotion<f64, 1> {
        armgen_runtime::robot::EquationsOfMotion {
            inertia: self.inertia_matrix(q),
            coriolis: self.coriolis_matrix(q, dq),
            gravity: self.gravity(q),
        }
    }
    fn inverse_dynamics(&self, q: &SVector<f64, 1>, _: &SVector<f64, 1>, ddq: &SVector<f64, 1>) -> SVector<f64, 1> {
        ddq * 2.0 + self.gravity(q)
    }
    fn forward_dynamics(&self, q: &SVector<f64, 1>, _: &SVector<f64, 1>, tau: &SVector<f64, 1>) -> SVector<f64, 1> {
        (tau - self.gravity(q)) / 2.0
    }
    fn kinetic_energy(&self, _: &SVector<f64, 1>, dq: &SVector<f64, 1>) -> f64 {
        dq[0] * dq[0]
    }
    fn potential_energy(&self, q: &SVector<f64, 1>) -> f64 {
        self.force * q[0] + 0.5 * self.stiffness * q[0] * q[0]
    }
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
        let report = of(&Mass { force, stiffness });
        let q = (200.0 * 0.3 - force) / (200.0 + stiffness);
        close("offset", report.offset, f64::abs(0.3 - q), 1e-8);
        assert!(report.without_rest.is_none() && report.is_stable(), "{report:?}");
    }
    let report = of(&Mass { force: 1.0, stiffness: -300.0 });
    assert_eq!((report.without_rest, report.is_stable()), (Some(0), false));
    // Of two postures it is the second that is not held: this force alone holds the mass at the first.
    let pushed = Mass { force: 90.0, stiffness: -300.0 };
    let law = PdGravity::new([250.0], k_d).unwrap();
    let report = analyse(&pushed, &FREE, &law, &[vector![0.3], vector![0.4]], 1e-3, Delay::NONE).unwrap();
    assert_eq!(report.without_rest, Some(1));
    close("offset", report.offset, 0.0, 1e-12);

    // Beyond its boundary layer the robust law adds rho, whatever the error: 2 (K_P e + rho) = f, and K_P alone is its stiffness.
    let (rho, force) = (5.0, 40.0);
    let robust = Robust::new(k_p, k_d, [1.0], [1.0], BoundaryLayer { rho, epsilon: 1e-6 }).unwrap();
    let report = analyse(&Mass { force, stiffness: 0.0 }, &FREE, &robust, &[vector![0.3]], 1e-3, Delay::NONE).unwrap();
    close("offset beyond the layer", report.offset, (force / 2.0 - rho) / k_p[0], 1e-8);
    close("spectral radius beyond the layer", report.spectral_radius, of(&Mass { force, stiffness: 0.0 }).spectral_radius, 1e-7);
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
    use armgen_runtime::simulation::{run, Integrator, RunOptions, Sensor};
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
