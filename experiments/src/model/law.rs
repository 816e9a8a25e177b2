//! The laws of control of an experiment: each with its name, its gains, and what else it may be given.

use std::collections::BTreeMap;

use super::{Quantity, Robot};

/// Which controller.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ControlLawKind {
    /// u = g(q) + K_P e + K_D de.
    PdGravity,
    /// u = B (ddq_d + K_D de + K_P e) + n.
    InverseDynamics,
    /// The same with a term that beats a bounded uncertainty.
    Robust,
    /// u = Y(q, dq, dq_r, ddq_r) pi^ + K_D sigma, pi^ adapted.
    Adaptive,
    /// Inverse dynamics in the operational space, with integral.
    OperationalSpace,
}

/// What a gain has a number for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Per {
    /// Each joint.
    Joint,
    /// Each row of the task.
    Row,
    /// Each parameter of the regressor.
    Parameter,
    /// The law as a whole.
    Law,
}

/// A gain that a law needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gain {
    /// Its key in the file.
    pub key: &'static str,
    /// What it has numbers for.
    pub per: Per,
    /// Whether it may be zero; it is positive otherwise.
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
    pub const ALL: [ControlLawKind; 5] = [
        ControlLawKind::PdGravity,
        ControlLawKind::InverseDynamics,
        ControlLawKind::Robust,
        ControlLawKind::Adaptive,
        ControlLawKind::OperationalSpace,
    ];

    /// Its name in the file.
    pub const fn name(self) -> &'static str {
        match self {
            ControlLawKind::PdGravity => "pd_gravity",
            ControlLawKind::InverseDynamics => "inverse_dynamics",
            ControlLawKind::Robust => "robust",
            ControlLawKind::Adaptive => "adaptive",
            ControlLawKind::OperationalSpace => "operational_space",
        }
    }

    /// What it must be given.
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
        match self {
            ControlLawKind::PdGravity | ControlLawKind::InverseDynamics => JOINT_SPACE,
            ControlLawKind::Robust => ROBUST,
            ControlLawKind::Adaptive => ADAPTIVE,
            ControlLawKind::OperationalSpace => OPERATIONAL_SPACE,
        }
    }

    /// The keys that it may be given.
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

    /// The quantities that it logs at every sample, beside the torque.
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
    /// Which controller.
    pub kind: ControlLawKind,
    /// By the keys of [`ControlLawKind::gains`]; as many numbers as these say.
    pub gains: BTreeMap<&'static str, Vec<f64>>,
    /// One per joint, N m or N.
    pub torque_limits: Option<Vec<f64>>,
    /// Of a law that adapts.
    pub adaptation: Adaptation,
}

/// The interval that an estimate is projected on.
#[derive(Clone, Debug, PartialEq)]
pub struct EstimateBounds {
    /// The lowest estimates.
    pub lowest: Vec<f64>,
    /// The highest estimates.
    pub highest: Vec<f64>,
}

/// How a law adapts its estimate of the parameters.
#[derive(Clone, Debug, PartialEq)]
pub struct Adaptation {
    /// What it starts from.
    pub estimate: Vec<f64>,
    /// What it is kept in, where there are bounds.
    pub bounds: Option<EstimateBounds>,
    /// Whether it adapts at all.
    pub is_on: bool,
}

impl ControlLaw {
    /// The numbers of a gain; none for a key that the law does not have.
    pub fn gain(&self, key: &str) -> &[f64] {
        self.gains.get(key).map_or(&[], Vec::as_slice)
    }
}
