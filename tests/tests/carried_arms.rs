//! Arms on a rail and on a mobile base: every function takes only variables that its equation depends on, and every module equals its equations.
//!
//! Whether an equation depends on a variable follows from its derivative, which is exact in the prime field.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use armgen_codegen::derive::parameters::View;
use armgen_codegen::diagnostic::Colour;
use armgen_codegen::program::Function;
use armgen_codegen::ring::{ExprId, Symbol};
use armgen_codegen::schedule::{module, Options, Selection};
use armgen_codegen::source::Source;
use armgen_codegen::{validate, Model};
use armgen_tests::exported_arms;
use armgen_tests::random::Random;
use armgen_verify::judge::checker::Effort;
use armgen_verify::read::claims::Claims;
use armgen_verify::verify_with;

/// Points in prime fields, each of its own prime.
const EFFORT: Effort = Effort { points: 2, exact_points: 0, seed: 1 };

/// No entry of these depends on the position of a slide before all other joints.
const WITHOUT_SLIDES: [&str; 8] = [
    "geometric_jacobian",
    "geometric_jacobian_dot",
    "link_jacobians",
    "inertia_matrix",
    "coriolis_matrix",
    "gravity",
    "inverse_dynamics",
    "operational_inertia",
];

/// Joints before an arm: how many there are, and how many of them slide.
#[derive(Clone, Copy, Debug)]
enum Before {
    /// A rail.
    Rail = 1,
    /// Two slides and a turn, each at right angles to the others.
    MobileBase = 3,
}

impl Before {
    fn slides(self) -> usize {
        (self as usize).min(2)
    }

    /// The arm behind these joints, in rows of the convention of its file.
    fn carry(self, text: &str) -> String {
        let standard = text.contains("convention: standard");
        assert!(standard || text.contains("convention: modified"), "a table of Denavit and Hartenberg:\n{text}");
        // The twist is in the row before or in that of the joint itself.
        let twists = match (self, standard) {
            (Before::Rail, _) => ["0"; 3],
            (Before::MobileBase, true) => ["-pi/2", "pi/2", "0"],
            (Before::MobileBase, false) => ["0", "-pi/2", "pi/2"],
        };
        let kinds = ["prismatic", "prismatic", "revolute"];
        let rows = (0..self as usize).map(|i| {
            format!(
                "  - {{name: carrier_{i}, type: {}, a: 0, alpha: {}, d: 0, theta: 0, link: {{mass: 30, inertia: {{xx: 1, yy: 1, zz: 1}}}}}}\n",
                kinds[i], twists[i]
            )
        });
        let carried = text.replacen("\njoints:\n", &format!("\njoints:\n{}", rows.collect::<String>()), 1);
        assert_ne!(carried, text);
        carried
    }
}

/// The same description with right angles in the decimals of exporters.
fn with_decimals(text: &str) -> String {
    text.replace("pi/2", "1.5707963").replace("pi", "3.14159")
}

/// The variables of the symbols that a function takes: joint angles as one of their symbols.
fn variables(function: &Function) -> BTreeSet<Symbol> {
    let of = |symbol: Symbol| match symbol.angle() {
        Some(angle) => angle.terms().map(|(joint, _)| Symbol::Sine(joint)).collect(),
        None => vec![symbol],
    };
    function.symbols().into_iter().flat_map(of).collect()
}

/// Each of these functions takes only what its equation depends on.
fn take_only_what_matters(name: &str, text: &str, functions: &[&str]) -> Vec<(String, BTreeSet<Symbol>)> {
    let source = Source::new("robot.yaml", text);
    let (valid, said) = validate::read(&source);
    let (manipulator, _) = valid.unwrap_or_else(|| panic!("{name}:\n{}", said.render(&source, Colour::Never)));
    let model = Model::new(manipulator);
    let functions = Selection::named(functions.iter().copied()).expect("they are emitted functions");
    let module = module(&model, &Options { functions, ..Options::default() });
    let taken = module.functions.iter().map(|function| {
        let view = if function.with_parameters { View::Vector(&model.parameters) } else { View::Nominal };
        let mut equation = function.quantity.by_recursion(&model, view);
        let (entries, _) = equation.pool.with_gravity(&equation.entries);
        let taken = variables(function);
        for &variable in &taken {
            let slopes = match variable {
                Symbol::Sine(joint) | Symbol::Position(joint) => equation.pool.partial_derivative(&entries, joint),
                _ => equation.pool.differentiate(&entries, &mut |_, symbol| {
                    if symbol == variable {
                        ExprId::ONE
                    } else {
                        ExprId::ZERO
                    }
                }),
            };
            let depends = slopes.iter().any(|&slope| slope != ExprId::ZERO);
            assert!(depends, "{name}: {} takes {variable:?}, and does not depend on it", function.name());
        }
        (function.name(), taken)
    });
    taken.collect()
}

/// The same of a robot of the project behind slides, whose positions these functions do not take.
fn do_not_take_slides(path: &Path, before: Before) {
    let plain = std::fs::read_to_string(path).expect("a description");
    for text in [plain.clone(), with_decimals(&plain)] {
        let name = format!("{}, {before:?}", path.display());
        for (function, taken) in take_only_what_matters(&name, &before.carry(&text), &WITHOUT_SLIDES) {
            let slides: Vec<&Symbol> =
                taken.iter().filter(|s| matches!(s, Symbol::Position(i) if usize::from(*i) < before.slides())).collect();
            assert!(slides.is_empty(), "{name}: {function} takes {slides:?}");
        }
    }
}

fn equals_its_equations(name: &str, text: &str) {
    println!("{name}");
    let source = Source::new("robot.yaml", text);
    let (generated, said) = armgen_codegen::generate(&source, &Options::default());
    let generated = generated.unwrap_or_else(|| panic!("{name}:\n{}", said.render(&source, Colour::Never)));
    let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
    let report = verify_with(&source, &generated.module, claims, EFFORT);
    assert!(report.passed(), "{name}: {}", report.first_fault().unwrap_or_default());
}

/// All descriptions of the project, sorted.
fn robots() -> Vec<PathBuf> {
    let folders = ["../robots", "robots"].map(|folder| Path::new(env!("CARGO_MANIFEST_DIR")).join(folder));
    let files = folders.iter().flat_map(|folder| std::fs::read_dir(folder).expect("a folder of robots"));
    let mut paths: Vec<PathBuf> = files
        .map(|file| file.expect("a file").path())
        .filter(|path| path.extension().is_some_and(|ending| ending == "yaml"))
        .collect();
    paths.sort();
    assert!(paths.len() > 10, "{paths:?}");
    paths
}

fn first_arm() -> u64 {
    std::env::var("ARMGEN_FIRST_ARM").map_or(0, |text| text.parse().expect("a number"))
}

#[test]
fn two_robots_behind_slides_take_only_what_matters() {
    let robot = |name: &str| Path::new(env!("CARGO_MANIFEST_DIR")).join("robots").join(name);
    do_not_take_slides(&robot("single_joint.yaml"), Before::MobileBase);
    do_not_take_slides(&robot("modified_prismatic.yaml"), Before::Rail);
}

/// `ARMGEN_FIRST_ARM` is the first seed, 0 unless given.
#[test]
#[ignore = "wide"]
fn arms_with_numbers_of_real_files_take_only_what_matters() {
    for seed in first_arm()..first_arm() + 6 {
        for before in [exported_arms::Before::Nothing, exported_arms::Before::Rail, exported_arms::Before::Mobile] {
            take_only_what_matters(
                &format!("seed {seed}, {before:?}"),
                &exported_arms::arm(seed, (2, 4), before),
                &WITHOUT_SLIDES,
            );
        }
    }
}

/// A robot, the joints before it and its decimals follow from `ARMGEN_FIRST_ARM`, 0 unless given.
#[test]
#[ignore = "wide"]
fn a_robot_behind_slides_takes_only_what_matters_and_equals_its_equations() {
    let (mut random, robots) = (Random::new(first_arm()), robots());
    let robot = &robots[random.whole(0, robots.len() as i64 - 1) as usize];
    let before = if random.chance(50) { Before::Rail } else { Before::MobileBase };
    println!("{}, {before:?}", robot.display());
    do_not_take_slides(robot, before);
    let text = before.carry(&std::fs::read_to_string(robot).expect("a description"));
    let text = if random.chance(50) { with_decimals(&text) } else { text };
    equals_its_equations(&format!("{}, {before:?}", robot.display()), &text);
}

/// Axes apart by pi to sixteen and to eight digits: what one turns of the other is dust, which only roundings at the length of the axes allow.
#[test]
#[ignore = "wide"]
fn axes_apart_by_nearly_pi_equal_their_equations() {
    for twist in ["3.141592653589793", "3.14159265"] {
        let text = format!(
            "name: apart
convention: standard
gravity: [0, 0, -9.81]
joints:
  - {{name: a, type: prismatic, a: -0.03, alpha: pi/2, d: -0.45, theta: 3.1415927, link: {{mass: 2.5, com: [0.5, 0, 0.1], inertia: {{xx: 0.1, yy: 0.1, zz: 0.1}}}}}}
  - {{name: b, type: prismatic, a: -6.26e-06, alpha: -pi/2, d: 2.14e-05, theta: -0.2, link: {{mass: 2.5, inertia: {{xx: 0.1, yy: 0.1, zz: 0.1}}}}}}
  - {{name: c, type: revolute, a: 0, alpha: {twist}, d: -6.38e-06, theta: 2.89, link: {{mass: 2.5, inertia: {{xx: 0.1, yy: 0.1, zz: 0.1}}}}}}
  - {{name: d, type: revolute, a: 0.2484, alpha: 0.76, d: 0.48, theta: 1.5707963267948966, link: {{mass: 1.2, inertia: {{xx: 0.1, yy: 0.1, zz: 0.1}}}}}}
"
        );
        equals_its_equations(twist, &text);
    }
}

#[test]
#[ignore = "full: many minutes; a robot that is drawn is wide"]
fn every_robot_behind_slides_takes_only_what_matters_and_equals_its_equations() {
    for robot in robots() {
        let plain = std::fs::read_to_string(&robot).expect("a description");
        for before in [Before::Rail, Before::MobileBase] {
            do_not_take_slides(&robot, before);
            for text in [plain.clone(), with_decimals(&plain)] {
                equals_its_equations(&format!("{}, {before:?}", robot.display()), &before.carry(&text));
            }
        }
    }
}
