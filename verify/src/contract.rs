//! What an emitted module promises: its functions with their arguments and results.

use crate::program::Argument;

/// Shape of a result, in terms of the n joints, the p parameters, the b base parameters and the m rows of the task.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A number.
    Scalar,
    /// n entries.
    Vector,
    /// 4 x 4.
    Frame,
    /// n times 4 x 4.
    Frames,
    /// 6 x n.
    Jacobian,
    /// n x n.
    Square,
    /// n x p.
    Regressor,
    /// n x b, of the base parameters.
    BaseRegressor,
    /// n x n, n x n, n.
    EquationsOfMotion,
    /// m x m.
    Task,
    /// A pair of n x n.
    TwoSquares,
    /// Three of n x n.
    ThreeSquares,
}

/// A function that a module has or may have.
#[derive(Clone, Copy, Debug)]
pub struct Promise {
    /// Its name.
    pub name: &'static str,
    /// Its arguments.
    pub arguments: &'static [&'static str],
    /// Its result.
    pub shape: Shape,
    /// Whether every module has it.
    pub required: bool,
    /// Whether there is a form `_with` parameters at run time.
    pub parameters: bool,
}

const fn promise(name: &'static str, arguments: &'static [&'static str], shape: Shape, parameters: bool) -> Promise {
    Promise { name, arguments, shape, required: true, parameters }
}

const fn extra(name: &'static str, arguments: &'static [&'static str], shape: Shape) -> Promise {
    Promise { name, arguments, shape, required: false, parameters: false }
}

/// All functions that the checker knows.
pub const PROMISES: [Promise; 21] = [
    promise("direct_kinematics", &["q"], Shape::Frame, false),
    promise("link_frames", &["q"], Shape::Frames, false),
    promise("geometric_jacobian", &["q"], Shape::Jacobian, false),
    promise("geometric_jacobian_dot", &["q", "dq"], Shape::Jacobian, false),
    promise("inertia_matrix", &["q"], Shape::Square, true),
    promise("coriolis_matrix", &["q", "dq"], Shape::Square, true),
    promise("gravity", &["q"], Shape::Vector, true),
    promise("friction", &["dq"], Shape::Vector, true),
    promise("equations_of_motion", &["q", "dq"], Shape::EquationsOfMotion, true),
    promise("inverse_dynamics", &["q", "dq", "ddq"], Shape::Vector, true),
    promise("forward_dynamics", &["q", "dq", "tau"], Shape::Vector, true),
    promise("regressor", &["q", "dq", "dqr", "ddqr"], Shape::Regressor, false),
    promise("known_torque", &["q", "dq", "dqr", "ddqr"], Shape::Vector, false),
    promise("kinetic_energy", &["q", "dq"], Shape::Scalar, true),
    promise("potential_energy", &["q"], Shape::Scalar, true),
    extra("momentum", &["q", "dq"], Shape::Vector),
    extra("coriolis_transpose_times", &["q", "dq"], Shape::Vector),
    extra("base_regressor", &["q", "dq", "ddq"], Shape::BaseRegressor),
    extra("operational_inertia", &["q"], Shape::Task),
    extra("inverse_dynamics_derivatives", &["q", "dq", "ddq"], Shape::TwoSquares),
    extra("forward_dynamics_derivatives", &["q", "dq", "tau"], Shape::ThreeSquares),
];

impl Shape {
    /// The type in Rust, without blanks.
    pub fn rust(self) -> &'static str {
        match self {
            Shape::Scalar => "Real",
            Shape::Vector => "[Real;DOF]",
            Shape::Frame => "[[Real;4];4]",
            Shape::Frames => "[[[Real;4];4];DOF]",
            Shape::Jacobian => "[[Real;DOF];6]",
            Shape::Square => "[[Real;DOF];DOF]",
            Shape::Regressor => "[[Real;PARAMETERS];DOF]",
            Shape::BaseRegressor => "[[Real;BASE_PARAMETERS];DOF]",
            Shape::EquationsOfMotion => "EquationsOfMotion",
            Shape::Task => "[[Real;TASK_ROWS];TASK_ROWS]",
            Shape::TwoSquares => "([[Real;DOF];DOF],[[Real;DOF];DOF])",
            Shape::ThreeSquares => "([[Real;DOF];DOF],[[Real;DOF];DOF],[[Real;DOF];DOF])",
        }
    }

    /// Places of the entries, in order.
    pub fn places(self, n: usize, p: usize, b: usize, m: usize) -> Vec<String> {
        let matrix = |name: &str, rows: usize, columns: usize| -> Vec<String> {
            (0..rows).flat_map(|i| (0..columns).map(move |j| format!("{name}[{i}][{j}]"))).collect()
        };
        let vector = |name: &str| -> Vec<String> { (0..n).map(|i| format!("{name}[{i}]")).collect() };
        match self {
            Shape::Scalar => vec![String::new()],
            Shape::Vector => vector(""),
            Shape::Frame => matrix("", 4, 4),
            Shape::Frames => (0..n).flat_map(|i| matrix(&format!("[{i}]"), 4, 4)).collect(),
            Shape::Jacobian => matrix("", 6, n),
            Shape::Square => matrix("", n, n),
            Shape::Regressor => matrix("", n, p),
            Shape::BaseRegressor => matrix("", n, b),
            Shape::EquationsOfMotion => [matrix(".inertia", n, n), matrix(".coriolis", n, n), vector(".gravity")].concat(),
            Shape::Task => matrix("", m, m),
            Shape::TwoSquares => [matrix(".0", n, n), matrix(".1", n, n)].concat(),
            Shape::ThreeSquares => [matrix(".0", n, n), matrix(".1", n, n), matrix(".2", n, n)].concat(),
        }
    }
}

impl Promise {
    /// The promise of a function's name, and whether it is the form with parameters.
    pub fn of(name: &str) -> Option<(&'static Promise, bool)> {
        let plain = PROMISES.iter().find(|p| p.name == name).map(|p| (p, false));
        let base = name.strip_suffix("_with");
        plain.or_else(|| PROMISES.iter().find(|p| p.parameters && Some(p.name) == base).map(|p| (p, true)))
    }

    /// Names of all functions that a module must have.
    pub fn required() -> Vec<String> {
        let mut names = Vec::new();
        for promise in PROMISES.iter().filter(|p| p.required) {
            names.push(promise.name.to_string());
            if promise.parameters {
                names.push(format!("{}_with", promise.name));
            }
        }
        names
    }

    /// The signature in Rust, without blanks.
    pub fn signature(&self, with_parameters: bool) -> String {
        let mut arguments: Vec<String> = self.arguments.iter().map(|name| format!("{name}:&[Real;DOF]")).collect();
        if with_parameters {
            arguments.insert(0, "pi:&[Real;PARAMETERS]".into());
        }
        format!("({})->{}", arguments.join(","), self.shape.rust())
    }

    /// Length of an argument.
    pub fn length(argument: Argument, n: usize, p: usize) -> usize {
        if argument == Argument::Pi {
            p
        } else {
            n
        }
    }
}
