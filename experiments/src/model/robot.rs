//! The data of a robot besides its functions: names, joint types, limits, parameters, task.

use armgen_runtime::task::Row;

use super::Unit;

/// A robot as data.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    /// Its name.
    pub name: String,
    /// The joints from base to tip.
    pub joints: Vec<Joint>,
    /// The parameter vector of its regressor.
    pub parameters: Vec<Parameter>,
    /// The rows of its task.
    pub task: Vec<Row>,
}

/// A joint.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Its name.
    pub name: String,
    /// Whether it is revolute; otherwise prismatic.
    pub revolute: bool,
    /// Lowest and highest position, rad or m; infinite without a limit.
    pub position: [f64; 2],
    /// Highest rate, rad/s or m/s; infinite without a limit.
    pub velocity: f64,
    /// Highest torque or force, N m or N; infinite without a limit.
    pub effort: f64,
}

/// A parameter of the dynamics.
#[derive(Clone, Debug, PartialEq)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its value in the description.
    pub nominal: f64,
}

impl Robot {
    /// Number of joints.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// The nominal parameter values.
    pub fn nominal(&self) -> Vec<f64> {
        self.parameters.iter().map(|parameter| parameter.nominal).collect()
    }

    /// The names of the parameters.
    pub fn parameter_names(&self) -> Vec<&str> {
        self.parameters.iter().map(|parameter| parameter.name.as_str()).collect()
    }
}

impl Joint {
    /// Unit of the joint variable: rad or m.
    pub fn unit(&self) -> Unit {
        if self.revolute {
            Unit::Radian
        } else {
            Unit::Metre
        }
    }

    /// Unit of the rate: rad/s or m/s.
    pub fn rate_unit(&self) -> Unit {
        if self.revolute {
            Unit::RadianPerSecond
        } else {
            Unit::MetrePerSecond
        }
    }

    /// Unit of torque or force: N m or N.
    pub fn effort_unit(&self) -> Unit {
        if self.revolute {
            Unit::NewtonMetre
        } else {
            Unit::Newton
        }
    }
}
