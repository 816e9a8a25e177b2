//! What is executed is read by the checker: it is the equations, and whatever is planted in it is found.

use armgen_certify::verify_executed;
use armgen_codegen::schedule::{Options, Selection};
use armgen_codegen::source::Source;
use armgen_codegen::{validate, Model, Trig};
use armgen_evaluate::{function, Program};
use armgen_numbers::{Angle, Function, Operand, Operator};

use crate::arms::robots;

/// Functions of a robot of the repository as they are executed; all of them if none is named.
fn functions(robot: &str, names: &[&str]) -> (Source, Vec<Function<f64>>) {
    let found = robots().into_iter().find_map(|(name, text)| (name == robot).then_some(text));
    let text = found.unwrap_or_else(|| include_str!("../../tests/data/trees/helix.yaml").into());
    let source = Source::new(robot, text);
    let (manipulator, places) = validate::read(&source).0.expect("a valid robot");
    let functions = if names.is_empty() { Selection::default() } else { Selection::named(names).expect("functions") };
    let options = Options { trig: Trig::Fast, functions, ..Options::default() };
    let module = armgen_codegen::programs(&Model::new(manipulator), &places, &options).expect("a module");
    let functions = module.functions.iter().map(|of| function(&module, of)).collect();
    (source, functions)
}

/// The first fault that the checker finds.
fn fault(source: &Source, functions: &[Function<f64>]) -> Option<String> {
    let programs: Vec<Program<f64>> = functions.iter().map(|of| Program::new(of).expect("a program")).collect();
    let report = verify_executed(source, &programs.iter().collect::<Vec<_>>());
    assert!(report.functions.len() >= functions.len() || report.first_fault().is_some());
    report.first_fault()
}

fn all_are_the_equations(robot: &str) {
    let (source, functions) = functions(robot, &[]);
    assert!(functions.len() > 10, "{robot}");
    assert_eq!(fault(&source, &functions), None, "{robot}");
}

#[test]
fn executed_functions_are_the_equations() {
    all_are_the_equations("scara4");
    let (source, functions) = functions("panda7", &["inertia_matrix", "inverse_dynamics", "direct_kinematics"]);
    assert_eq!(fault(&source, &functions), None);
}

/// Functions that compute angles, and another factor, another term and another constant of an angle.
#[test]
fn executed_angles_are_those_of_the_description() {
    let (source, sound) = functions("helix", &["inertia_matrix", "gravity"]);
    assert_eq!(fault(&source, &sound), None);
    let found = |plant: &dyn Fn(&mut Angle<f64>)| {
        let mut planted = sound.clone();
        let angle = planted[1].angles.iter_mut().find(|angle| !angle.factors.is_empty()).expect("it computes an angle");
        plant(angle);
        assert!(fault(&source, &planted).expect("not found").starts_with("gravity"));
    };
    found(&|angle| angle.factors[1] = Some(0.7850000000000001));
    found(&|angle| angle.factors[0] = None);
    found(&|angle| angle.terms[1].1 ^= true);
    found(&|angle| angle.turn = angle.turn.map(|turn| -turn));
}

#[test]
#[ignore = "wide"]
fn executed_functions_of_other_robots_are_the_equations() {
    for robot in ["puma560", "ur5", "panda7", "scara"] {
        all_are_the_equations(robot);
    }
}

/// Each operation in turn becomes another one, each constant the next float, each output its opposite, each operand another value.
#[test]
fn planted_faults_are_found_in_what_is_executed() {
    let (source, sound) = functions("scara4", &["inverse_dynamics"]);
    let found = |plant: &dyn Fn(&mut Function<f64>)| {
        let mut planted = sound.clone();
        plant(&mut planted[0]);
        assert_ne!(planted, sound);
        let fault = fault(&source, &planted).unwrap_or_else(|| panic!("not found: {:?}", planted[0]));
        assert!(fault.starts_with("inverse_dynamics"), "{fault}");
    };
    for i in (0..sound[0].operations.len()).step_by(3) {
        let operation = sound[0].operations[i];
        found(&|of| {
            of.operations[i].operator = match operation.operator {
                Operator::Add => Operator::Subtract,
                Operator::Subtract => Operator::Multiply,
                _ => Operator::Add,
            };
        });
        if let Operand::Constant(k) = operation.left {
            found(&|of| of.operations[i].left = Operand::Constant(k.next_up()));
        }
        let other = |operand| if operand == Operand::Value(0) { Operand::Value(1) } else { Operand::Value(0) };
        found(&|of| of.operations[i].right = other(operation.right));
    }
    for i in 0..sound[0].outputs.len() {
        found(&|of| of.outputs[i].negated = !of.outputs[i].negated);
    }
    found(&|of| of.angles[0].terms[0].0 ^= 1);
}
