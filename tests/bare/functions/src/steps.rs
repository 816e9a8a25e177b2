//! Steps that a controlled arm takes beside its controller, on the Panda: the weight of its load, and contacts.

use crate::panda7_fast::{Nominal, DOF};
use armgen_runtime::{
    contact::{Contact, MomentumObserver, Threshold},
    nalgebra::{SVector, Vector3},
    payload::{payload_regressor, Payload, PayloadEstimator, PayloadRegressor, PayloadSettings, PARAMETERS},
    reference::State,
};

/// Knowledge of the load, and of contacts.
#[derive(Clone, Copy, Debug)]
pub struct Watch {
    estimator: PayloadEstimator<f32, DOF>,
    observer: MomentumObserver<f32, DOF>,
}

impl Watch {
    /// Nothing yet; `None` where a setting is impossible.
    pub fn new() -> Option<Watch> {
        let settings = PayloadSettings {
            gravity: Vector3::new(0.0, 0.0, -9.81),
            period: 1e-3,
            filter: 18.85,
            forgetting: 0.9,
            spread: SVector::repeat(0.5),
            least_rate: 0.02,
            body: [1.0, 0.0, 0.0, 0.05, 0.0075, 0.0, 0.0075, 0.0, 0.0, 0.005],
            deviation: [3.0, 0.3, 0.3, 0.3, 0.05, 0.02, 0.05, 0.02, 0.02, 0.05],
            is_slow: false,
        };
        let half = SVector::repeat(0.5);
        let threshold = Threshold { spread: half, resolution: SVector::zeros(), coulomb: half, load: SVector::zeros() };
        Some(Watch {
            estimator: PayloadEstimator::new(settings).ok()?,
            observer: MomentumObserver::new([25.0; DOF], 1e-3, threshold, 100).ok()?,
        })
    }
}

fn state(number: u32) -> State<f32, DOF> {
    State { q: SVector::from(crate::numbers(number, 0)), dq: SVector::from(crate::numbers(number, 1)) }
}

fn torque(number: u32) -> SVector<f32, DOF> {
    SVector::from(crate::numbers(number, 5))
}

/// The two regressors of a payload.
#[inline(never)]
pub fn payload_regressors(number: u32) -> PayloadRegressor<f32, DOF> {
    payload_regressor(&Nominal, &state(number), &Vector3::new(0.0, 0.0, -9.81))
}

/// A sample of the estimator, its regressors included; whether it was taken.
#[inline(never)]
pub fn payload_step(watch: &mut Watch, number: u32) -> bool {
    watch.estimator.step(&Nominal, &state(number), &torque(number)).is_ok()
}

/// The estimate with its intervals.
#[inline(never)]
pub fn payload_estimate(watch: &Watch) -> Payload<f32> {
    watch.estimator.estimate()
}

/// The nearest body that is possible.
#[inline(never)]
pub fn payload_body(watch: &mut Watch) -> [f32; PARAMETERS] {
    watch.estimator.physical()
}

/// A sample of the momentum observer.
#[inline(never)]
pub fn contact_step(watch: &mut Watch, number: u32) -> Option<Contact<f32, DOF>> {
    watch.observer.step(&Nominal, &state(number), &torque(number), &SVector::zeros()).ok()
}
