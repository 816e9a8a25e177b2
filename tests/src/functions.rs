//! The functions of a robot, whoever computes them: emitted code, the traits of the runtime, or a program interpreted.

use armgen_codegen::catalogue;

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
    /// Acceleration of free fall, of arms where that is an argument.
    pub g0: Vec<f64>,
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

    /// Whether there is a function: not every arm has all.
    fn has(&self, function: &str) -> bool;

    /// The value of a function by its name in the emitted module, row by row; of functions with several results one after the other.
    ///
    /// Panics where there is no such function.
    fn call(&self, function: &str, arguments: &Arguments) -> Vec<f64>;
}

/// Names of all functions that can be emitted, in the order of the module. Excluded are the `absent` functions, and
/// `load_friction` where the description has no such friction, `joint_variables` where it couples no joints.
pub fn expected(absent: &[String], description: &str) -> Vec<String> {
    let loaded = [", load: ", "{load: "].iter().any(|key| description.contains(key));
    let coupled = [" follows: ", " adds: "].iter().any(|key| description.contains(key));
    let asked = catalogue::functions().filter(|(quantity, _)| match quantity.name {
        "load_friction" => loaded,
        "joint_variables" => coupled,
        _ => true,
    });
    asked.map(|(quantity, with)| quantity.function_name(with)).filter(|name| !absent.contains(name)).collect()
}

/// The functions that the head of a module lists as missing.
pub fn absent(text: &str) -> Vec<String> {
    let name = |line: &str| Some(line.strip_prefix("// There is no `")?.split_once('`')?.0.to_owned());
    text.lines().filter_map(name).collect()
}
