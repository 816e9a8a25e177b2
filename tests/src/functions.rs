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

    /// The value of a function by its name in the emitted module, row by row; `equations_of_motion` gives B, C and g one after the other.
    ///
    /// Panics where there is no such function.
    fn call(&self, function: &str, arguments: &Arguments) -> Vec<f64>;
}

/// The functions of every emitted module, in its order.
pub const FUNCTIONS: [&str; 24] = [
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
];
