//! The control laws of an experiment: names, gains, and optional settings.

use std::collections::BTreeMap;

use super::{Quantity, Robot};

/// The kinds of controllers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControlLawKind {
    /// u = g(q) + K_P e + K_D de.
    PdGravity,
    /// u = B (ddq_d + K_D de + K_P e) + n.
    InverseDynamics,
    /// Inverse dynamics with a robust term against a bounded uncertainty.
    Robust,
    /// u = Y(q, dq, dq_r, ddq_r) pi^ + K_D sigma, with adaptation of pi^.
    Adaptive,
    /// Inverse dynamics in the operational space, with integral action.
    OperationalSpace,
    /// The same within limits of torque, position, rate and acceleration.
    Limited,
}

/// The dimension of a gain.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Per {
    /// A number per joint.
    Joint,
    /// A number per row of the task.
    Row,
    /// A number per parameter of the regressor.
    Parameter,
    /// A single number.
    Law,
}

/// A gain that a law needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gain {
    /// Its key in files.
    pub key: &'static str,
    /// Its dimension.
    pub per: Per,
    /// Whether zero is allowed; otherwise it must be positive.
    pub may_be_zero: bool,
}

const fn gain(key: &'static str, per: Per) -> Gain {
    Gain { key, per, may_be_zero: false }
}

const fn or_zero(key: &'static str, per: Per) -> Gain {
    Gain { key, per, may_be_zero: true }
}

impl ControlLawKind {
    /// All of them.
    pub const ALL: [ControlLawKind; 6] = [
        ControlLawKind::PdGravity,
        ControlLawKind::InverseDynamics,
        ControlLawKind::Robust,
        ControlLawKind::Adaptive,
        ControlLawKind::OperationalSpace,
        ControlLawKind::Limited,
    ];

    /// Its name in files.
    pub const fn name(self) -> &'static str {
        match self {
            ControlLawKind::PdGravity => "pd_gravity",
            ControlLawKind::InverseDynamics => "inverse_dynamics",
            ControlLawKind::Robust => "robust",
            ControlLawKind::Adaptive => "adaptive",
            ControlLawKind::OperationalSpace => "operational_space",
            ControlLawKind::Limited => "limited",
        }
    }

    /// The required gains.
    pub const fn gains(self) -> &'static [Gain] {
        const JOINT_SPACE: &[Gain] = &[gain("k_p", Per::Joint), gain("k_d", Per::Joint)];
        const ROBUST: &[Gain] = &[
            gain("k_p", Per::Joint),
            gain("k_d", Per::Joint),
            gain("p_position", Per::Joint),
            gain("p_velocity", Per::Joint),
            or_zero("rho", Per::Law),
            gain("epsilon", Per::Law),
        ];
        const ADAPTIVE: &[Gain] = &[gain("lambda", Per::Joint), gain("k_d", Per::Joint), gain("k_pi", Per::Parameter)];
        const OPERATIONAL_SPACE: &[Gain] = &[gain("k_p", Per::Row), gain("k_d", Per::Row), or_zero("k_i", Per::Row)];
        const LIMITED: &[Gain] = &[
            gain("k_p", Per::Row),
            gain("k_d", Per::Row),
            or_zero("k_i", Per::Row),
            gain("rate_limits", Per::Joint),
            gain("acceleration_limits", Per::Joint),
            gain("horizon", Per::Law),
            gain("braking", Per::Law),
        ];
        match self {
            ControlLawKind::PdGravity | ControlLawKind::InverseDynamics => JOINT_SPACE,
            ControlLawKind::Robust => ROBUST,
            ControlLawKind::Adaptive => ADAPTIVE,
            ControlLawKind::OperationalSpace => OPERATIONAL_SPACE,
            ControlLawKind::Limited => LIMITED,
        }
    }

    /// The optional keys.
    pub const fn optional(self) -> &'static [&'static str] {
        match self {
            ControlLawKind::Adaptive => &["torque_limits", "estimate", "lowest", "highest", "adaptation"],
            _ => &["torque_limits"],
        }
    }

    /// Whether it can run in continuous time.
    pub const fn is_continuous(self) -> bool {
        matches!(self, ControlLawKind::Adaptive)
    }

    /// The quantities that it logs at every sample besides the torque.
    pub fn watched(self, robot: &Robot) -> Vec<Quantity> {
        match self {
            ControlLawKind::Robust => vec![Quantity::ZNorm],
            ControlLawKind::Adaptive => (0..robot.parameters.len()).map(Quantity::Estimate).collect(),
            _ => Vec::new(),
        }
    }
}

/// A controller with its gains.
#[derive(Clone, Debug, PartialEq)]
pub struct ControlLaw {
    /// The kind of controller.
    pub kind: ControlLawKind,
    /// The gains by the keys of [`ControlLawKind::gains`], which also give the dimensions.
    pub gains: BTreeMap<&'static str, Vec<f64>>,
    /// A limit per joint, N m or N.
    pub torque_limits: Option<Vec<f64>>,
    /// Settings of an adaptive law.
    pub adaptation: Adaptation,
}

/// The interval onto which estimates are projected.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimateBounds {
    /// The lowest estimates.
    pub lowest: Vec<f64>,
    /// The highest estimates.
    pub highest: Vec<f64>,
}

/// Settings for the adaptation of the parameter estimate.
#[derive(Clone, Debug, PartialEq)]
pub struct Adaptation {
    /// The initial estimate.
    pub estimate: Vec<f64>,
    /// Bounds of the estimate, if any.
    pub bounds: Option<EstimateBounds>,
    /// Whether adaptation is active.
    pub is_on: bool,
}

impl ControlLaw {
    /// The numbers of a gain; empty for an unknown key.
    pub fn gain(&self, key: &str) -> &[f64] {
        self.gains.get(key).map_or(&[], Vec::as_slice)
    }
}
