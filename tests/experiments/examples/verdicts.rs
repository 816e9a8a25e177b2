//! Compares verdicts of the sampled loop, at rest and in motion, with the simulated arm over three times the duration. Gains are
//! multiplied by 1/3, 1 and 3. Each period is joined by its half and its double, or by others where these decide nothing. Loads
//! of 0 and 10 kg are unknown to the model. The arms are a SCARA, a UR10 and a Puma 560.
//!
//! `cargo run --release -p armgen-experiment-tests --example verdicts`

use std::time::Duration;

use armgen_experiment_tests::{scara, ur10};
use armgen_runtime::control::{Adaptive, Controller, InverseDynamics};
use armgen_runtime::nalgebra::SVector;
use armgen_runtime::reference::{JointReference, State};
use armgen_runtime::robot::Dynamics;
use armgen_runtime::simulation::{run, Integrator, RunOptions};
use armgen_runtime::stability::{analyse, Delay, LineariseAtRest, LineariseInMotion, MotionAnalysis};

/// The Puma 560 with the standard parameters of all links.
#[allow(missing_docs, unreachable_pub)]
#[rustfmt::skip]
mod puma560 {
    include!(concat!(env!("OUT_DIR"), "/puma560.rs"));
    include!(concat!(env!("OUT_DIR"), "/puma560_runtime.rs"));
}

/// An error, rad or m, beyond which a run is lost.
const LOST: f64 = 1.0;
/// The time that is analysed, s; three times as much is simulated.
const SECONDS: f64 = 4.0;

/// Prediction and outcome.
struct Found {
    /// The spectral radius at rest.
    rest: f64,
    /// Whether the loop is predicted to be stable at rest.
    stable: bool,
    /// Whether the loop is predicted to diverge in motion.
    grows: bool,
    /// Whether the simulated run is lost.
    lost: bool,
    /// The largest error on the way, rad or m.
    largest: f64,
}

/// q_i = c_i + a_i (1 - cos w_i t).
struct Swing<const N: usize> {
    c: [f64; N],
    a: [f64; N],
}

impl<const N: usize> Swing<N> {
    fn at(&self, t: f64) -> JointReference<f64, N> {
        let w = |i: usize| 0.9 + 0.25 * i as f64;
        let of = |f: fn(f64, f64) -> f64| SVector::<f64, N>::from_fn(|i, _| self.a[i] * f(w(i), t));
        JointReference {
            q: SVector::from(self.c) + of(|w, t| 1.0 - (w * t).cos()),
            dq: of(|w, t| w * (w * t).sin()),
            ddq: of(|w, t| w * w * (w * t).cos()),
        }
    }
}

/// Whether the loop is stable, as predicted and as simulated.
fn judge<P, R, C, const N: usize>(plant: &P, model: &R, controller: C, swing: &Swing<N>, period: f64) -> Found
where
    P: Dynamics<N, Real = f64>,
    R: Dynamics<N, Real = f64>,
    C: LineariseAtRest<P, R, N> + LineariseInMotion<P, R, N> + Controller<R, N, Reference = JointReference<f64, N>>,
{
    let postures: Vec<SVector<f64, N>> = (0..16).map(|k| swing.at(0.25 * f64::from(k)).q).collect();
    let mut report = analyse(plant, model, &controller, &postures, period, Delay::NONE).expect("an answer");
    let joints: Vec<_> = (0..(SECONDS / period) as usize).map(|k| swing.at(k as f64 * period)).collect();
    let start = State::at_rest(joints[0].q);
    let analysis = MotionAnalysis { plant, joints: &joints, start, period, delay: Delay::NONE };
    report.motion = analysis.of(model, &controller, &joints).ok();

    let mut law = controller;
    let mut options = RunOptions::new(Duration::from_secs_f64(period), Duration::from_secs_f64(3.0 * SECONDS));
    options.integrator = Integrator::RungeKutta4 { substeps: 2 };
    let mut largest = 0.0f64;
    let end = run(
        plant,
        start,
        options,
        |t, measured| law.torque(model, &swing.at(t.as_secs_f64()), measured).map(|torque| torque.tau),
        |sample| largest = largest.max((swing.at(sample.time.as_secs_f64()).q - sample.state.q).amax()),
    );
    let grows = report.motion.is_some_and(|motion| motion.diverges());
    Found { rest: report.spectral_radius, stable: report.is_stable(), grows, lost: end.is_err() || largest > LOST, largest }
}

fn main() {
    let (mut all, mut agree) = (0, 0);
    let mut line = |what: String, found: Found| {
        let Found { rest, stable, grows, lost, largest } = found;
        let (said, is) = (stable && !grows, !lost);
        let word = |holds: bool| if holds { "holds" } else { "diverges" };
        all += 1;
        agree += usize::from(said == is);
        let differs = if said == is { "" } else { "  DIFFERENT" };
        println!("{what:66} {rest:9.6} {:>9} {:>9} {:>9} {largest:9.2e}{differs}", word(!grows), word(said), word(is));
    };
    println!("{:66} {:>9} {:>9} {:>9} {:>9} {:>9}", "", "at rest", "in motion", "said", "simulated", "error");
    let swing = Swing { c: [0.2, 1.2, 0.2, -0.3], a: [0.5, 0.3, 0.08, 0.4] };
    for load in [0.0, 10.0] {
        let mut parameters = scara::NOMINAL_PARAMETERS;
        parameters[2] += load;
        let plant = scara::WithParameters { parameters };
        for factor in [1.0 / 3.0, 1.0, 3.0] {
            let times = |gains: [f64; 4]| gains.map(|k| factor * k);
            for period in [1e-3, 2e-3, 4e-3] {
                let law = InverseDynamics::new(times([1000.0, 1000.0, 2000.0, 1000.0]), times([60.0, 60.0, 90.0, 60.0])).unwrap();
                let what = format!("SCARA, inverse dynamics, gains times {factor:.2}, {period} s, {load} kg");
                line(what, judge(&plant, &scara::Nominal, law, &swing, period));
            }
            for period in [2e-3, 4e-3, 8e-3] {
                let weights =
                    [1.0, 1.0, 0.001, 1.0, 1.0, 1.0, 1.0, 1.0, 6.25e6, 1.6e5, 1.0, 1.0, 6.25e6, 1.6e5].map(|k| 10.0 * k);
                let k_d = times([1000.0, 500.0, 2000.0, 100.0]);
                let law = Adaptive::new([100.0; 4], k_d, weights, scara::NOMINAL_PARAMETERS, period).unwrap();
                let what = format!("SCARA, adaptive, K_D times {factor:.2}, {period} s, {load} kg");
                line(what, judge(&plant, &scara::Nominal, law, &swing, period));
            }
        }
    }
    let swing = Swing { c: [0.3, -1.2, 1.4, -0.5, 1.0, 0.2], a: [0.3; 6] };
    let m6 = ur10::PARAMETER_NAMES.iter().position(|name| *name == "m6").expect("a standard parameter");
    for load in [0.0, 10.0] {
        let mut parameters = ur10::NOMINAL_PARAMETERS;
        parameters[m6] += load;
        let plant = ur10::WithParameters { parameters };
        for factor in [1.0 / 3.0, 1.0, 3.0] {
            for period in [2e-3, 10e-3, 20e-3] {
                let law = InverseDynamics::new([400.0 * factor; 6], [40.0 * factor; 6]).unwrap();
                let what = format!("UR10, inverse dynamics, gains times {factor:.2}, {period} s, {load} kg");
                line(what, judge(&plant, &ur10::Nominal, law, &swing, period));
            }
            for period in [1e-3, 0.5e-3, 0.2e-3] {
                let k_d = [20.0, 20.0, 10.0, 0.5, 0.5, 0.05].map(|k| factor * k);
                let law = Adaptive::new([20.0; 6], k_d, [10.0; 60], ur10::NOMINAL_PARAMETERS, period).unwrap();
                let what = format!("UR10, adaptive, K_D times {factor:.2}, {period} s, {load} kg");
                line(what, judge(&plant, &ur10::Nominal, law, &swing, period));
            }
        }
    }
    let swing = Swing { c: [0.3, -0.4, 0.6, -0.5, 0.8, 0.2], a: [0.3; 6] };
    let m6 = puma560::PARAMETER_NAMES.iter().position(|name| *name == "m6").expect("a standard parameter");
    for load in [0.0, 10.0] {
        let mut parameters = puma560::NOMINAL_PARAMETERS;
        parameters[m6] += load;
        let plant = puma560::WithParameters { parameters };
        for factor in [1.0 / 3.0, 1.0, 3.0] {
            for period in [5e-3, 10e-3, 20e-3] {
                let law = InverseDynamics::new([400.0 * factor; 6], [40.0 * factor; 6]).unwrap();
                let what = format!("Puma 560, inverse dynamics, gains times {factor:.2}, {period} s, {load} kg");
                line(what, judge(&plant, &puma560::Nominal, law, &swing, period));
            }
            for period in [1e-3, 0.5e-3, 0.25e-3] {
                let k_d = [20.0, 20.0, 10.0, 0.2, 0.2, 0.05].map(|k| factor * k);
                let law = Adaptive::new([20.0; 6], k_d, [1.0; 60], puma560::NOMINAL_PARAMETERS, period).unwrap();
                let what = format!("Puma 560, adaptive, K_D times {factor:.2}, {period} s, {load} kg");
                line(what, judge(&plant, &puma560::Nominal, law, &swing, period));
            }
        }
    }
    println!("{agree} of {all} agree");
}
