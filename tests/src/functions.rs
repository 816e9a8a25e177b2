//! The functions of a robot, whoever computes them: emitted code, the traits of the runtime, or a program interpreted.

/// Arguments of all functions; each takes those that it needs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arguments {
    /// Parameters, for the `_with` forms.
    pub pi: Vec<f64>,
    /// Joint variables.
    pub q: Vec<f64>,
    /// Joint rates.
    pub dq: Vec<f64>,
    /// Joint accelerations.
    pub ddq: Vec<f64>,
    /// Reference rates.
    pub dqr: Vec<f64>,
    /// Reference accelerations.
    pub ddqr: Vec<f64>,
    /// Joint torques.
    pub tau: Vec<f64>,
}

/// What computes the functions of a robot.
pub trait Functions {
    /// Number of joints.
    fn dof(&self) -> usize;

    /// Names of the parameters.
    fn parameter_names(&self) -> Vec<String>;

    /// Values of the parameters in the description.
    fn nominal(&self) -> Vec<f64>;

    /// Values of the base parameters in the description; none where there is no `base_regressor`.
    fn nominal_base(&self) -> Vec<f64> {
        Vec::new()
    }

    /// Whether there is a function: the traits of the runtime do not have all of them, and not every arm has an operational inertia.
    fn has(&self, function: &str) -> bool;

    /// The value of a function by its name in the emitted module, row by row; of functions with several results one after the other.
    ///
    /// Panics where there is no such function.
    fn call(&self, function: &str, arguments: &Arguments) -> Vec<f64>;
}

/// The functions of every emitted module, in its order; `operational_inertia` only where the arm can do its task.
pub const FUNCTIONS: [&str; 30] = [
    "direct_kinematics",
    "link_frames",
    "geometric_jacobian",
    "geometric_jacobian_dot",
    "inertia_matrix",
    "inertia_matrix_with",
    "coriolis_matrix",
    "coriolis_matrix_with",
    "gravity",
    "gravity_with",
    "friction",
    "friction_with",
    "equations_of_motion",
    "equations_of_motion_with",
    "inverse_dynamics",
    "inverse_dynamics_with",
    "forward_dynamics",
    "forward_dynamics_with",
    "regressor",
    "known_torque",
    "kinetic_energy",
    "kinetic_energy_with",
    "potential_energy",
    "potential_energy_with",
    "momentum",
    "coriolis_transpose_times",
    "base_regressor",
    "operational_inertia",
    "inverse_dynamics_derivatives",
    "forward_dynamics_derivatives",
];

/// The function that not every arm has.
pub const OPTIONAL: &str = "operational_inertia";
