//! Programs executed have the bits of the emitted modules compiled: every function, random and special states, several numbers of states.

use armgen_codegen::schedule::Options;
use armgen_codegen::source::Source;
use armgen_codegen::{validate, Model};
use armgen_evaluate::{programs, Scalar};
use armgen_tests::emitted::{emitted, Emitted, ALL};
use armgen_tests::functions::{Arguments, Functions};
use armgen_tests::random::Random;

/// Numbers of states in a call: one, few, a small block, more than a large block and a small one.
const STATES: [usize; 4] = [1, 5, 16, 83];

/// A number of an argument: mostly of a usual size, sometimes a zero, one beyond the range of fast sines, an infinite one, not a number.
fn number(random: &mut Random) -> f64 {
    const SPECIAL: [f64; 8] = [0.0, -0.0, 1e6, -1e20, 1e-310, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
    if random.chance(3) {
        SPECIAL[random.whole(0, 7) as usize]
    } else {
        random.real(-4.0, 4.0)
    }
}

/// Bits; one pattern for all that is not a number.
fn bits(values: impl Iterator<Item = f64>) -> Vec<u64> {
    values.map(|value| if value.is_nan() { u64::MAX } else { value.to_bits() }).collect()
}

/// Compares all functions of a module, and returns the number of compared entries.
fn compare<T: Scalar + Into<f64>>(robot: &Emitted, scalar: armgen_codegen::Scalar, nearest: fn(f64) -> T, seed: u64) -> usize {
    let source = Source::new(robot.path, robot.description());
    let (manipulator, places) = validate::read_for(&source, scalar).0.expect("it was generated");
    let options = Options { scalar, ..Options::default() };
    let module = armgen_codegen::programs(&Model::new(manipulator), &places, &options).expect("it was generated");
    let mut random = Random::new(seed);
    let mut compared = 0;
    for program in programs::<T>(&module) {
        let mut workspace = program.workspace();
        for states in STATES {
            let given: Vec<Vec<f64>> = program
                .arguments()
                .iter()
                .map(|argument| (0..states * argument.length).map(|_| number(&mut random)).collect())
                .collect();
            let own: Vec<Vec<T>> = given.iter().map(|vector| vector.iter().map(|&x| nearest(x)).collect()).collect();
            let slices: Vec<&[T]> = own.iter().map(Vec::as_slice).collect();
            let mut result = vec![nearest(7.0); states * program.outputs()];
            program.run(&slices, &mut result, &mut workspace).expect("lengths that fit");
            for state in 0..states {
                let mut arguments = Arguments::default();
                for (argument, vector) in program.arguments().iter().zip(&given) {
                    let vector = vector[state * argument.length..(state + 1) * argument.length].to_vec();
                    let place = match argument.name.as_str() {
                        "pi" => &mut arguments.pi,
                        "q" => &mut arguments.q,
                        "dq" => &mut arguments.dq,
                        "ddq" => &mut arguments.ddq,
                        "dqr" => &mut arguments.dqr,
                        "ddqr" => &mut arguments.ddqr,
                        "tau" => &mut arguments.tau,
                        "g0" => &mut arguments.g0,
                        other => panic!("a new argument, {other}"),
                    };
                    *place = vector;
                }
                let found = &result[state * program.outputs()..(state + 1) * program.outputs()];
                let found = bits(found.iter().map(|&x| x.into()));
                let compiled = bits(robot.call(program.name(), &arguments).into_iter());
                compared += found.len();
                assert_eq!(found, compiled, "{} {}, seed {seed}, state {state} of {states}", robot.module, program.name());
            }
        }
    }
    compared
}

fn check(robot: &Emitted, seed: u64) {
    let compared = if robot.narrow {
        compare::<f32>(robot, armgen_codegen::Scalar::F32, |x| x as f32, seed)
    } else {
        compare::<f64>(robot, armgen_codegen::Scalar::F64, |x| x, seed)
    };
    println!("{}: {compared} numbers, seed {seed}", robot.module);
    assert!(compared > 0);
}

#[test]
fn a_scara_and_an_arm_with_everything_have_the_bits_of_their_modules() {
    for module in ["scara4", "scara4_f32", "everything"] {
        check(emitted(module), 1);
    }
}

#[test]
#[ignore = "wide"]
fn every_robot_has_the_bits_of_its_module() {
    for robot in ALL {
        check(robot, 2);
    }
}

/// An arm with gravity as an argument, given the nominal vector, is the arm that has it fixed.
#[test]
fn programs_take_gravity_as_an_argument() {
    let text = include_str!("../../tests/data/mounted.yaml");
    let fixed = text.replace("{argument: [1, -2, -9.81]}", "[1, -2, -9.81]");
    let torques = |text: &str, before: &[&[f64]]| {
        let source = Source::new("mounted.yaml", text);
        let (manipulator, places) = validate::read(&source).0.expect("a valid arm");
        let module = armgen_codegen::programs(&Model::new(manipulator), &places, &Options::default()).expect("of usual size");
        let program =
            programs::<f64>(&module).into_iter().find(|program| program.name() == "inverse_dynamics").expect("it has mass");
        let (q, dq, ddq) = ([0.3, -0.2, 1.1], [0.5, 0.4, -0.6], [1.0, -2.0, 0.7]);
        let given: Vec<&[f64]> = before.iter().copied().chain([&q[..], &dq[..], &ddq[..]]).collect();
        let names: Vec<String> = program.arguments().iter().map(|argument| argument.name.clone()).collect();
        let mut result = vec![0.0; program.outputs()];
        program.run(&given, &mut result, &mut program.workspace()).expect("lengths that fit");
        (names, result)
    };
    let (names, found) = torques(text, &[&[1.0, -2.0, -9.81]]);
    let (_, expected) = torques(&fixed, &[]);
    assert_eq!(names, ["g0", "q", "dq", "ddq"]);
    for (a, b) in found.iter().zip(&expected) {
        assert!((a - b).abs() <= 1e-12 * b.abs().max(1.0), "{found:?} {expected:?}");
    }
    let (_, weightless) = torques(text, &[&[0.0; 3]]);
    assert!(weightless.iter().zip(&expected).any(|(a, b)| (a - b).abs() > 1.0));
}
