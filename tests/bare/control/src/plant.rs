//! The arm that is controlled: the emitted forward dynamics with 5 kg more at the end effector, integrated over one period.

use crate::robot::{forward_dynamics_with, DOF, NOMINAL_PARAMETERS, PARAMETERS};
use armgen_runtime::{nalgebra::SVector, reference::State, robot::array};

/// The nominal parameters with m_l3 = 15 kg.
const LOADED: [f32; PARAMETERS] = {
    let mut parameters = NOMINAL_PARAMETERS;
    parameters[2] = 15.0;
    parameters
};

/// One step of Runge and Kutta's fourth-order method of length `h`, s, under held torques.
pub(crate) fn advance(state: &State<f32, DOF>, tau: &SVector<f32, DOF>, h: f32) -> State<f32, DOF> {
    let slope = |state: &State<f32, DOF>| State {
        q: state.dq,
        dq: SVector::from(forward_dynamics_with(&LOADED, array(&state.q), array(&state.dq), array(tau))),
    };
    let along = |slope: &State<f32, DOF>, h: f32| State { q: state.q + slope.q * h, dq: state.dq + slope.dq * h };
    let k1 = slope(state);
    let k2 = slope(&along(&k1, h / 2.0));
    let k3 = slope(&along(&k2, h / 2.0));
    let k4 = slope(&along(&k3, h));
    let mean = State { q: (k1.q + (k2.q + k3.q) * 2.0 + k4.q) / 6.0, dq: (k1.dq + (k2.dq + k3.dq) * 2.0 + k4.dq) / 6.0 };
    along(&mean, h)
}
