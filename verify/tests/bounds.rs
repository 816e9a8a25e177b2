//! Error bounds are never exceeded, close to actual errors, distinguish errors from faults, and agree with the emitted companion.

#[path = "bounds/page.rs"]
mod page;

use crate::{arms, common};

use std::path::Path;
use std::process::Command;

use armgen_codegen::emit::Notes;
use armgen_codegen::kinds::Scalar;
use armgen_codegen::manipulator::Manipulator;
use armgen_codegen::schedule::{Options, Selection};
use armgen_codegen::source::Source;
use armgen_codegen::validate;
use armgen_verify::floats::bounds::{domain_of, draw, notes, of, of_function, two_digits};
use armgen_verify::floats::companion::{companion, Extent, LaneArguments, Table};
use armgen_verify::floats::errors::{Run, Seen, Subject};
use armgen_verify::read::claims::Claims;
use armgen_verify::read::reader::Module;
use armgen_verify::values::arithmetic::wide::Wide;
use armgen_verify::values::element::Element;
use armgen_verify::values::float::LANES;
use armgen_verify::values::program::Step;
use armgen_verify::values::ranges::literal_errors;
use armgen_verify::values::stream::Stream;

/// A robot of the project: its text, module, claims and description.
fn robot(name: &str, scalar: Scalar) -> (String, Module, Claims, Manipulator) {
    robot_with(name, &Options { scalar, ..Options::default() })
}

fn robot_with(name: &str, options: &Options) -> (String, Module, Claims, Manipulator) {
    let (source, scalar) = (common::source(name), options.scalar);
    let generated = common::generate_with(&source, options);
    let module = Module::read(&generated.module).expect("a module");
    let (manipulator, _) = validate::read_for(&source, scalar).0.expect("a valid description");
    (generated.module, module, Claims::from_numbers(&generated.constants).expect("short formulas"), manipulator)
}

fn measure(manipulator: &Manipulator, module: &Module, subjects: Vec<Subject>, batches: u64, seed: u64) -> Vec<Seen> {
    let mut run = Run::new(manipulator, module, subjects, seed);
    run.go_on(batches).expect("states in reach");
    run.seen
}

#[track_caller]
fn check(name: &str, options: &Options, states: u64) {
    let scalar = options.scalar;
    let (_, module, claims, manipulator) = robot_with(name, options);
    let subjects = Subject::all(&manipulator, &module, &claims).expect("functions");
    for seen in measure(&manipulator, &module, subjects, states.div_ceil(LANES as u64), 11) {
        assert_eq!((seen.beyond_running, seen.beyond_a_priori), (0, 0), "{name} {scalar:?}: {seen:?}");
        if let Some(torques) = &seen.residual {
            assert!(torques.beyond == 0 && torques.part <= 1.0 && torques.largest > 0.0, "{name} {scalar:?}: {seen:?}");
        }
        assert!(seen.running.is_finite() && seen.running <= 1e-3 * seen.value.max(1e-30), "{name} {scalar:?}: {seen:?}");
        // So few states miss the worst error; with a million states the ratio is below 100.
        assert!(seen.ratio().is_none_or(|ratio| ratio < 400.0), "{name} {scalar:?}: {seen:?}");
    }
}

#[test]
#[ignore = "wide"]
fn bounds_hold_and_are_near() {
    for name in ["scara", "everything", "modified_prismatic", "base_set", "panda7"] {
        check(name, &Options::default(), 40);
    }
    for name in ["scara4", "single_joint", "general_angles"] {
        check(name, &Options { scalar: Scalar::F32, ..Options::default() }, 40);
    }
}

#[test]
#[ignore = "wide"]
fn bounds_hold_and_are_near_with_fused_operations() {
    for name in ["scara", "everything", "modified_prismatic", "base_set", "panda7"] {
        check(name, &Options { fuse: true, ..Options::default() }, 40);
    }
    for name in ["scara4", "single_joint", "general_angles"] {
        check(name, &Options { scalar: Scalar::F32, fuse: true, ..Options::default() }, 40);
    }
}

/// Over the box and at a state, fused operations have smaller bounds than the same steps with separate rounding.
#[test]
fn a_fused_operation_rounds_once() {
    let bounds = |fuse: bool| {
        let (_, module, claims, manipulator) = robot_with("panda7", &Options { fuse, ..Options::default() });
        let domain = domain_of(&manipulator, &module);
        let program = module.program("inverse_dynamics").expect("a function");
        let values = claims.resolve("inverse_dynamics", &program.literals, module.real).values.clone();
        let table = Table::of(program, &literal_errors(program, &values, module.real), module.real).expect("a table");
        let at_a_state = table.run(&draw(&domain, &mut Stream::new(5), module.real)).into_iter().map(|(_, bound)| bound);
        [of_function(program, &values, &domain, &module, &claims).largest(), at_a_state.fold(0.0, f64::max)]
    };
    let ([fused, fused_at_a_state], [plain, plain_at_a_state]) = (bounds(true), bounds(false));
    assert!(
        fused < 0.9 * plain && fused_at_a_state < 0.9 * plain_at_a_state,
        "{fused} {plain} {fused_at_a_state} {plain_at_a_state}"
    );
}

/// A function whose numbers are wrong by some units in the last place exceeds the bounds of the correct one.
#[test]
#[ignore = "wide"]
fn a_planted_fault_is_seen() {
    let (_, module, claims, manipulator) = robot("scara", Scalar::F64);
    let subjects = Subject::all(&manipulator, &module, &claims).expect("functions");
    let names = ["inertia_matrix", "gravity", "inverse_dynamics", "forward_dynamics", "regressor"];
    let off = Wide::from_f64(1.0 + 400.0 * f64::EPSILON);
    let planted: Vec<Subject> = subjects
        .into_iter()
        .filter(|subject| names.contains(&subject.program.name.as_str()))
        .map(|subject| subject.with_literals(|exact| exact.times(&off)))
        .collect();
    assert_eq!(planted.len(), names.len());
    for seen in measure(&manipulator, &module, planted, 7, 3) {
        assert!(seen.beyond_running > 0, "{seen:?}");
    }
}

#[test]
fn bounds_are_rounded_up_and_stand_in_the_documentation() {
    for (bound, text) in [
        (1.04e-13, "1.1e-13"),
        (1.05e-13, "1.1e-13"),
        (9.91e-20, "1.0e-19"),
        (5.04, "5.1e0"),
        (3.0, "3.0e0"),
        (8.5e-300, "8.5e-300"),
    ] {
        assert_eq!(two_digits(bound), text);
    }
    let mut generated = common::generate(&common::source("scara"), Scalar::F64);
    let (_, module, claims, manipulator) = robot("scara", Scalar::F64);
    let bounds = notes(&of(&manipulator, &module, &claims), false);
    generated.annotate(&Notes { head: bounds.head, functions: bounds.functions });
    let documented = generated.module;
    let stated = documented.lines().filter(|line| line.starts_with("/// Rounding error: ")).count();
    assert_eq!(stated, module.functions.len());
    let head: Vec<&str> = documented.lines().take_while(|line| line.starts_with("//")).collect();
    assert!(head.iter().any(|line| line.starts_with("// Box of the rounding errors: ")), "{head:#?}");
    // Only comments have changed.
    let again = Module::read(&documented).expect("a module");
    assert_eq!((again.real, again.trig, &again.constants), (module.real, module.trig, &module.constants));
    let programs = |module: &Module| -> Vec<_> {
        module.functions.iter().map(|(_, function)| function.as_ref().expect("it was read").program.clone()).collect()
    };
    assert_eq!(programs(&again), programs(&module));
}

/// The companion, compiled with its module, returns the values of the checker.
#[test]
#[ignore = "wide"]
fn the_companion_returns_the_same_bounds() {
    let cases = [
        ("everything", Scalar::F64, false),
        ("scara", Scalar::F32, false),
        ("panda7", Scalar::F32, false),
        ("load_friction", Scalar::F64, true),
        ("scara4", Scalar::F32, true),
    ];
    for (name, scalar, fuse) in cases {
        let (text, module, claims, manipulator) = robot_with(name, &Options { scalar, fuse, ..Options::default() });
        let companion = companion(&module, &claims, "use super::robot::*;").expect("a companion");
        let arguments = draw(&domain_of(&manipulator, &module), &mut Stream::new(5), module.real);
        let mut calls = String::new();
        let mut expected = Vec::new();
        for (function, read) in &module.functions {
            let program = &read.as_ref().expect("a function").program;
            let list: Vec<String> =
                program.arguments.iter().map(|&a| format!("&{:?}", arguments.of(a)).replace("&[]", "&[0.0; 0]")).collect();
            calls += &format!("    show(&format!(\"{{:?}}\", robot_bounds::{function}_error_bound({})));\n", list.join(", "));
            let values = claims.resolve(function, &program.literals, module.real).values.clone();
            let table = Table::of(program, &literal_errors(program, &values, module.real), module.real).expect("a table");
            expected.extend(table.run(&arguments).into_iter().map(|(_, bound)| bound));
        }
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("companion").join(name);
        std::fs::create_dir_all(folder.join("src")).expect("a folder");
        let write = |file: &str, text: &str| std::fs::write(folder.join(file), text).expect("written");
        let manifest = |edition: &str| {
            let text = "[package]\nname = \"companion\"\nversion = \"0.1.0\"\nedition = \"2021\"\n\n[dependencies]\nlibm = \"0.2\"\n\n[workspace]\n";
            write("Cargo.toml", &text.replace("2021", edition));
        };
        write("src/robot.rs", &text);
        write("src/robot_bounds.rs", &companion);
        write(
            "src/main.rs",
            &format!(
                "mod robot;\nmod robot_bounds;\nfn show(text: &str) {{\n    let words = text.split(|c: char| !(c.is_ascii_digit() || \"+-.einf\".contains(c)));\n    \
                 for word in words.filter(|w| w.parse::<robot::Real>().is_ok()) {{\n        println!(\"{{word}}\");\n    }}\n}}\nfn main() {{\n{calls}}}\n"
            ),
        );
        let cargo = |command: &str| {
            Command::new(env!("CARGO"))
                .args([command, "--offline", "--quiet"])
                .current_dir(&folder)
                .env("CARGO_TARGET_DIR", folder.join("target"))
                .env("RUSTFLAGS", "-D warnings")
                .output()
                .expect("cargo runs")
        };
        for edition in ["2015", "2018", "2024"].iter().filter(|_| name == "scara") {
            manifest(edition);
            let output = cargo("check");
            assert!(output.status.success(), "edition {edition}: {}", String::from_utf8_lossy(&output.stderr));
        }
        manifest("2021");
        let output = cargo("run");
        let printed = String::from_utf8_lossy(&output.stdout).into_owned();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let found: Vec<f64> = printed.lines().map(|word| word.parse().expect("a number")).collect();
        let single = |x: &f64| if scalar == Scalar::F32 { f64::from(*x as f32) } else { *x };
        let (found, expected): (Vec<f64>, Vec<f64>) = (found.iter().map(single).collect(), expected.iter().map(single).collect());
        assert_eq!(found, expected, "{name}");
        assert!(expected.iter().any(|bound| *bound > 0.0));
    }
}

/// The companion's bound for inverse kinematics, compiled. Posture q has the pose T(q) up to rounding. So the bound at a point near q is at least
/// its distance from q, and not much larger; at singular postures and far from q it is infinite.
#[test]
#[ignore = "wide"]
fn the_bound_of_inverse_kinematics_holds() {
    for (name, scalar) in [("puma560", Scalar::F64), ("scara", Scalar::F64), ("scara", Scalar::F32)] {
        let (text, module, claims, _) = robot(name, scalar);
        let companion = companion(&module, &claims, "use super::robot::*;").expect("a companion");
        let companion = companion + &armgen_verify::floats::companion::of_inverse_kinematics(&module, Extent::default());
        let main = include_str!("common/solution_bounds.rs.txt");
        let printed =
            run_of(&format!("solutions/{name}"), &[("main.rs", main), ("robot.rs", &text), ("robot_bounds.rs", &companion)]);
        println!("{name}: {printed}");
    }
}

/// The same of coupled joints, at postures that are found: those of single precision are off by no more than the bound, and so are points
/// beside those of double precision. The couplings are random ones: whole factors between joints that turn, any beside slides.
#[test]
#[ignore = "wide"]
fn the_bound_of_coupled_postures_holds() {
    let mut random = Random(5);
    let wanted = ["planar3r", "elbow3r", "position3r", "position_prr", "position_rrp", "gantry", "stanford", "general", "table"];
    let free = arms::made_up().into_iter().filter(|(name, ..)| wanted.contains(name));
    let mut all: Vec<_> = free.map(|(name, _, _, text)| (name.to_owned(), coupled_at_random(&text, &mut random))).collect();
    all.extend(arms::coupled().into_iter().map(|(name, _, _, text)| (name.to_owned(), text)));
    // The first axis is far from every frame where the second link is at the base frame.
    let rows = [(arms::R, "5", "0", "0", "0"), (arms::R, "0.4", "0", "0.1", "0.3")];
    all.push(("beside".to_owned(), arms::description("beside", "task: [x, y]\nbase: {xyz: [-5, 0, 0]}", &rows)));
    let (mut files, mut modules, mut calls) = (Vec::new(), String::new(), String::new());
    for (name, text) in &all {
        for (module, scalar) in [(format!("{name}_f32"), Scalar::F32), (format!("{name}_f64"), Scalar::F64)] {
            let names = ["direct_kinematics", "link_frames", "geometric_jacobian", "joint_variables"];
            let functions = Selection::named(names).expect("functions");
            let options = Options { scalar, functions, ..Options::default() };
            let generated = common::generate_with(&Source::new(format!("{name}.yaml"), text.clone()), &options);
            let import = format!("use super::{module}::*;");
            let bounds = armgen_certify::companion(&generated, &import).expect("a companion");
            let of_postures = armgen_certify::companion_of_inverse_kinematics(&generated).expect("a companion");
            for (ending, text) in
                [("", generated.module.clone()), ("_ik", generated.inverse_kinematics()), ("_bounds", bounds + &of_postures)]
            {
                modules += &format!("#[allow(warnings)]\nmod {module}{ending};\n");
                files.push((format!("{module}{ending}.rs"), text));
            }
        }
        let of =
            |ending: &str| files.iter().find(|(file, _)| *file == format!("{name}_f64{ending}.rs")).map_or("", |(_, text)| text);
        // A given value leaves more joints than rows.
        if of("_bounds").contains("pub fn inverse_kinematics_error_bound") && !of("_ik").contains("redundancy: Real") {
            let range = if name == "beside" { "0.3" } else { "3.1" };
            calls += &format!(
                "    judge!({range}, {name}_f32, {name}_f32_ik, {name}_f32_bounds, {name}_f64, {name}_f64_ik, {name}_f64_bounds);\n"
            );
        }
    }
    assert!(calls.lines().count() >= 10, "{calls}");
    let main = include_str!("common/coupled_bounds.rs.txt");
    files.push(("main.rs".to_owned(), format!("{modules}\n{RANDOM}\n{main}\nfn main() {{\n{calls}}}\n")));
    let files: Vec<_> = files.iter().map(|(file, text)| (file.as_str(), text.as_str())).collect();
    println!("{}", run_of("coupled_solutions", &files));
}

include!("../../codegen/tests/inverse_kinematics/random.rs");

const RANDOM: &str = include_str!("../../codegen/tests/inverse_kinematics/random.rs");

/// The rows of a description with random couplings, whole turns of whose coordinates are whole turns of the joints.
fn coupled_at_random(free: &str, random: &mut Random) -> String {
    let kinds: Vec<bool> = free.lines().filter(|line| line.contains("{name: j")).map(|line| line.contains("prismatic")).collect();
    // Each joint adds some of those before it, in a random order.
    let mut order: Vec<usize> = (0..kinds.len()).collect();
    (1..order.len()).for_each(|i| order.swap(i, random.below(i as u64 + 1) as usize));
    let mut text = free.to_owned();
    for (place, &joint) in order.iter().enumerate().skip(1) {
        let mut leaders = Vec::new();
        for &leader in &order[..place] {
            let factors: &[&str] = match (kinds[joint], kinds[leader]) {
                _ if random.below(2) == 0 => continue,
                (true, false) => continue,
                (false, false) => &["1", "-1", "2", "-3"],
                (_, true) => &["0.7", "-3/2", "sqrt(2)", "pi/2"],
            };
            leaders.push(format!("j{}: {}", leader + 1, factors[random.below(4) as usize]));
        }
        if !leaders.is_empty() {
            let offset = ["", ", offset: 0.3", ", offset: -pi/3", ", offset: sqrt(2)"][random.below(4) as usize];
            let name = format!("{{name: j{}, ", joint + 1);
            text = text.replacen(&name, &format!("{name}adds: {{{}}}{offset}, ", leaders.join(", ")), 1);
        }
    }
    if text.contains("adds: ") {
        text
    } else {
        coupled_at_random(free, random)
    }
}

/// The output of a program of these files, which has to succeed.
fn run_of(folder: &str, files: &[(&str, &str)]) -> String {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(folder);
    std::fs::create_dir_all(folder.join("src")).expect("a folder");
    let manifest =
        "[package]\nname = \"solutions\"\nversion = \"0.1.0\"\nedition = \"2021\"\n\n[dependencies]\nlibm = \"0.2\"\n\n\
                    [workspace]\n\n[profile.dev]\nopt-level = 1\ndebug = false\nincremental = false\n";
    std::fs::write(folder.join("Cargo.toml"), manifest).expect("written");
    for (file, text) in files {
        std::fs::write(folder.join("src").join(file), text).expect("written");
    }
    let output = Command::new(env!("CARGO"))
        .args(["run", "--offline", "--quiet"])
        .current_dir(&folder)
        .env("CARGO_TARGET_DIR", folder.join("target"))
        .env("RUSTFLAGS", "-D warnings")
        .output()
        .expect("cargo runs");
    let printed = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(output.status.success(), "{}: {printed}{}", folder.display(), String::from_utf8_lossy(&output.stderr));
    printed
}

/// Merging takes the larger sizes and adds the counts.
#[test]
fn what_is_seen_in_parts_is_seen_of_the_whole() {
    let (_, module, claims, manipulator) = robot("scara4", Scalar::F64);
    let subjects = Subject::all(&manipulator, &module, &claims).expect("functions");
    let (mut first, second) =
        (measure(&manipulator, &module, subjects.clone(), 1, 1), measure(&manipulator, &module, subjects, 2, 2));
    first.iter_mut().zip(&second).for_each(|(a, b)| a.join(b));
    assert!(first.iter().all(|seen: &Seen| seen.states == 24));
    assert!(first.iter().zip(&second).all(|(a, b)| a.error >= b.error && a.running >= b.running));
}

/// Lanes give the same bits as single runs.
#[test]
#[ignore = "wide"]
fn lanes_return_the_bounds_of_the_companion() {
    for (name, scalar) in
        [("scara", Scalar::F64), ("everything", Scalar::F64), ("everything", Scalar::F32), ("panda7", Scalar::F32)]
    {
        let (_, module, claims, manipulator) = robot(name, scalar);
        let (domain, mut stream) = (domain_of(&manipulator, &module), Stream::new(8));
        let mut states: [_; LANES] = std::array::from_fn(|_| draw(&domain, &mut stream, module.real));
        // States where sensitivities or divisors are 0.
        states[3].q.fill(0.0);
        states[5].dq.fill(0.0);
        let side = LaneArguments::new(&states, module.real);
        for (function, read) in &module.functions {
            let program = &read.as_ref().expect("a function").program;
            let values = claims.resolve(function, &program.literals, module.real).values.clone();
            let table = Table::of(program, &literal_errors(program, &values, module.real), module.real).expect("a table");
            let mut lanes = table.lanes();
            lanes.run(&side);
            for (lane, state) in states.iter().enumerate() {
                let single = program.run_float(state, module.real);
                for ((output, (value, bound)), single) in program.outputs.iter().zip(table.run(state)).zip(single) {
                    let found = (lanes.step(output.step).0[lane].to_bits(), lanes.bound(output.step)[lane].to_bits());
                    let same = value.is_nan() || found.0 == value.to_bits() && found.0 == single.to_bits();
                    assert!(same && found.1 == bound.to_bits(), "{name} {function}{output} lane {lane}");
                }
            }
        }
    }
}

/// Accelerations have a bound over the box, on themselves or on their torques, and wrong equations exceed it.
#[test]
#[ignore = "wide"]
fn accelerations_solve_the_equations_within_a_bound() {
    for path in common::paths() {
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        let (_, module, claims, manipulator) = robot(&name, Scalar::F64);
        let bounds = of(&manipulator, &module, &claims);
        for function in ["forward_dynamics", "forward_dynamics_with"] {
            let bound = &bounds[function];
            assert!(bound.residual.is_some() || bound.largest().is_finite(), "{name} {function}");
        }
        if bounds["forward_dynamics"].residual.is_some() {
            let note = &notes(&bounds, module.sizes().gravity).functions["forward_dynamics"];
            assert!(note.starts_with("Rounding error: ddq is that of torques off by at most "), "{name}");
        }
    }
    let (_, module, claims, manipulator) = robot("everything", Scalar::F64);
    let mut subjects = Subject::all(&manipulator, &module, &claims).expect("functions");
    subjects.retain(|subject| subject.program.name == "forward_dynamics");
    let right = measure(&manipulator, &module, subjects.clone(), 20, 9);
    assert_eq!(right[0].residual.as_ref().map(|torques| torques.beyond), Some(0), "{right:?}");
    let off = Wide::from_f64(1.0 + 1e5 * f64::EPSILON);
    let wrong = subjects.into_iter().map(|subject| subject.with_literals(|exact| exact.times(&off))).collect();
    let wrong = measure(&manipulator, &module, wrong, 20, 9);
    assert!(wrong[0].residual.as_ref().is_some_and(|torques| torques.beyond > 0), "{wrong:?}");
}

/// A solution of another form, here with another quotient, has no such bound.
#[test]
#[ignore = "wide"]
fn another_form_of_the_solution_has_no_bound_of_torques() {
    let (_, module, claims, manipulator) = robot("panda7", Scalar::F64);
    let domain = domain_of(&manipulator, &module);
    let program = module.program("forward_dynamics").expect("the function");
    let values = claims.resolve("forward_dynamics", &program.literals, module.real).values.clone();
    assert!(of_function(program, &values, &domain, &module, &claims).residual.is_some());
    let mut other = program.clone();
    let divide = |step: &Step| matches!(step, Step::Divide(..));
    let last = other.steps.iter().rposition(divide).expect("a divisor");
    if let Step::Divide(_, divisor) = other.steps[last] {
        other.steps[last] = Step::Divide(divisor, divisor);
    }
    assert_eq!(of_function(&other, &values, &domain, &module, &claims).residual, None);
}
