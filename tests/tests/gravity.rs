//! Arms with gravity as an argument: random ones against the oracle under another gravity than the nominal one, and one compiled, with its
//! robots of the runtime.

use armgen_codegen::program::Cost;
use armgen_codegen::schedule::{self, Options, Selection};
use armgen_codegen::source::Source;
use armgen_codegen::{validate, Model};
use armgen_runtime::control::PdGravity;
use armgen_runtime::nalgebra::Vector3;
use armgen_runtime::reference::{JointReference, State};
use armgen_runtime::robot::{Dynamics, InverseDynamicsDerivatives, Kinematics, Regressor};
use armgen_tests::functions::{Arguments, Functions};
use armgen_tests::interpreter::Interpreted;
use armgen_tests::judge::{judge, Tolerance};
use armgen_tests::precision::{FORWARD_RESIDUAL, ORACLE};
use armgen_tests::random;

#[allow(unreachable_pub, clippy::all, clippy::pedantic)]
mod mounted {
    include!(concat!(env!("OUT_DIR"), "/mounted.rs"));
    include!(concat!(env!("OUT_DIR"), "/mounted_runtime.rs"));
}
use mounted::{Mounted, Nominal, WithParameters, NOMINAL_GRAVITY, NOMINAL_PARAMETERS};

/// A robot under a gravity: its functions as those of an arm that has this one fixed.
struct Under {
    robot: Interpreted,
    g0: [f64; 3],
}

impl Functions for Under {
    fn dof(&self) -> usize {
        self.robot.dof()
    }

    fn parameter_names(&self) -> Vec<String> {
        self.robot.parameter_names()
    }

    fn nominal(&self) -> Vec<f64> {
        self.robot.nominal()
    }

    fn nominal_base(&self) -> Vec<f64> {
        self.robot.nominal_base()
    }

    fn has(&self, function: &str) -> bool {
        self.robot.has(function)
    }

    fn call(&self, function: &str, arguments: &Arguments) -> Vec<f64> {
        self.robot.call(function, &Arguments { g0: self.g0.to_vec(), ..arguments.clone() })
    }
}

fn check(seed: u64) {
    let text = random::arm(seed);
    let line = text.lines().find(|line| line.starts_with("gravity: ")).expect("every arm has it");
    let robot = Interpreted::new(&text.replace(line, "gravity: {argument: [0, 0, -9.81]}")).expect("a valid arm");
    // Along no axis of a joint, so that a motion tells as much of the parameters as under gravity in all directions.
    let under = Under { robot, g0: [1.5, -2.25, 9.5] };
    let fixed = text.replace(line, "gravity: [1.5, -2.25, 9.5]");
    judge(&format!("arm {seed}"), &under, &fixed, seed, Tolerance { values: ORACLE, residual: FORWARD_RESIDUAL });
}

#[test]
fn an_arm_under_any_gravity_agrees_with_the_oracle() {
    check(3);
}

#[test]
#[ignore = "wide"]
fn random_arms_under_any_gravity_agree_with_the_oracle() {
    (4..12).for_each(check);
}

/// From the leaves the factors of B of a chain cost less than from the base: 217 products and 181 sums with a fixed gravity, and gravity as an
/// argument adds eleven and seven.
#[test]
fn forward_dynamics_takes_gravity_by_the_cheaper_factors() {
    let file = concat!(env!("CARGO_MANIFEST_DIR"), "/../robots/ur5.yaml");
    let text = std::fs::read_to_string(file).expect("a robot of the project");
    let fixed = "gravity: [0, 0, -9.81]";
    assert!(text.contains(fixed));
    let (arm, _) =
        validate::read(&Source::new(file, text.replace(fixed, "gravity: {argument: [0, 0, -9.81]}"))).0.expect("valid");
    let functions = Selection::named(["forward_dynamics"]).expect("a function");
    let module = schedule::module(&Model::new(arm), &Options { functions, ..Options::default() });
    let cost = Cost::of(&module.functions[0]);
    assert!(cost.mul <= 191 && cost.add <= 162, "{cost:?}");
}

const Q: [f64; 3] = [0.7, -0.2, 1.1];
const DQ: [f64; 3] = [0.3, 0.5, -0.4];

#[test]
fn a_mounted_robot_has_its_own_gravity_and_the_nominal_one_that_of_the_description() {
    let (q, dq, ddq) = (Vector3::from(Q), Vector3::from(DQ), Vector3::new(0.1, 0.2, 0.3));
    assert_eq!(NOMINAL_GRAVITY, [1.0, -2.0, -9.81]);
    assert_eq!(Mounted::default().gravity, NOMINAL_GRAVITY);
    let of_nominal = WithParameters::default();
    assert_eq!((of_nominal.gravity, of_nominal.parameters), (NOMINAL_GRAVITY, NOMINAL_PARAMETERS));
    for g0 in [NOMINAL_GRAVITY, [0.0; 3], [9.5, 0.3, -1.0]] {
        let robot = Mounted { gravity: g0 };
        assert_eq!(robot.gravity(&q), Vector3::from(mounted::gravity(&g0, &Q)));
        assert_eq!(
            robot.inverse_dynamics(&q, &dq, &ddq),
            Vector3::from(mounted::inverse_dynamics(&g0, &Q, &DQ, &[0.1, 0.2, 0.3]))
        );
        let chosen = WithParameters { gravity: g0, ..WithParameters::default() };
        assert_eq!(chosen.gravity(&q), Vector3::from(mounted::gravity_with(&NOMINAL_PARAMETERS, &g0, &Q)));
        assert_eq!(chosen.potential_energy(&q), mounted::potential_energy_with(&NOMINAL_PARAMETERS, &g0, &Q));
        assert_eq!(robot.regressor(&q, &dq, &dq, &ddq), chosen.regressor(&q, &dq, &dq, &ddq));
        assert_eq!(robot.inertia_matrix(&q), Nominal.inertia_matrix(&q));
        assert_eq!(robot.direct_kinematics(&q), Nominal.direct_kinematics(&q));
        let is_nominal = g0 == NOMINAL_GRAVITY;
        assert_eq!(robot.gravity(&q) == Nominal.gravity(&q), is_nominal);
        assert_eq!(
            robot.inverse_dynamics_derivatives(&q, &dq, &ddq) == Nominal.inverse_dynamics_derivatives(&q, &dq, &ddq),
            is_nominal
        );
    }
}

/// A base that translates with the acceleration a is a gravity of g0 - a: a controller with that model asks for the torque of that gravity.
#[test]
fn controllers_take_a_mounted_robot() {
    let controller = PdGravity::new([100.0; 3], [10.0; 3]).expect("positive");
    let state = State { q: Vector3::from(Q), dq: Vector3::zeros() };
    let reference = JointReference { q: state.q, dq: Vector3::zeros(), ddq: Vector3::zeros() };
    let robot = Mounted { gravity: [0.0, 0.0, -9.81 - 2.5] };
    let torque = controller.torque(&robot, &reference, &state).expect("finite").tau;
    assert_eq!(torque, Vector3::from(mounted::gravity(&[0.0, 0.0, -12.31], &Q)));
}
