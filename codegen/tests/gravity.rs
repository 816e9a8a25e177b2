//! Gravity as an argument, as exact identities in the prime field.

use armgen_codegen::catalogue::quantities::base_regressor::BASE_REGRESSOR;
use armgen_codegen::catalogue::quantities::equations_of_motion::EQUATIONS_OF_MOTION;
use armgen_codegen::catalogue::quantities::first_moment::POTENTIAL_ENERGY;
use armgen_codegen::catalogue::quantities::forward_dynamics::FORWARD_DYNAMICS;
use armgen_codegen::catalogue::quantities::gravity::GRAVITY;
use armgen_codegen::catalogue::quantities::inverse_dynamics::INVERSE_DYNAMICS;
use armgen_codegen::catalogue::{self, Argument, Quantity};
use armgen_codegen::derive::base::{base_parameters, rank, regressor_of};
use armgen_codegen::derive::derivation::Derivation;
use armgen_codegen::derive::parameters::{ParameterVector, View};
use armgen_codegen::program::{Cost, Module};
use armgen_codegen::ring::{ExprId, Pool, Symbol};
use armgen_codegen::schedule::{module, Options, Selection};
use armgen_codegen::source::Source;
use armgen_codegen::{validate, Model};

/// An arm with all that gravity enters.
const ARM: &str = include_str!("../../tests/data/mounted.yaml");
const ARGUMENT: &str = "{argument: [1, -2, -9.81]}";

/// The same under a fixed gravity.
fn under(vector: &str) -> Model {
    assert!(ARM.contains(ARGUMENT));
    read(&ARM.replace(ARGUMENT, vector))
}

fn read(text: &str) -> Model {
    let source = Source::new("arm.yaml", text.to_owned());
    let (read, diagnostics) = validate::read(&source);
    Model::new(read.unwrap_or_else(|| panic!("{diagnostics:?}")).0)
}

fn view(model: &Model, with_parameters: bool) -> View<'_> {
    if with_parameters {
        View::Vector(&model.parameters)
    } else {
        View::Nominal
    }
}

/// All forms that an arm has.
fn forms(model: &Model) -> impl Iterator<Item = (&'static Quantity, bool)> + use<'_> {
    catalogue::functions().filter(|(quantity, with)| (quantity.missing)(model, *with).is_none())
}

/// The derivative by each coordinate of g0.
fn by_gravity(pool: &mut Pool, exprs: &[ExprId]) -> [Vec<ExprId>; 3] {
    [0, 1, 2].map(|axis| {
        pool.differentiate(exprs, &mut |_, symbol| if symbol == Symbol::Gravity(axis) { ExprId::ONE } else { ExprId::ZERO })
    })
}

/// The entries in another pool, with other expressions for the coordinates of g0.
fn substituted(from: &Derivation, pool: &mut Pool, gravity: [ExprId; 3]) -> Vec<ExprId> {
    from.pool.substitute_into(pool, &from.entries, &|pool, symbol| match symbol {
        Symbol::Gravity(axis) => gravity[usize::from(axis)],
        other => pool.symbol(other),
    })
}

#[test]
fn a_quantity_declares_whether_gravity_enters_it() {
    let model = read(ARM);
    for (quantity, with) in forms(&model) {
        let Derivation { mut pool, mut entries, .. } = quantity.by_recursion(&model, view(&model, with));
        // The size and the sign of a gravity torque are inputs; gravity enters by the torque.
        entries.extend((0..3).filter_map(|joint| pool.gravity(joint)));
        let enters = by_gravity(&mut pool, &entries).concat().iter().any(|&entry| entry != ExprId::ZERO);
        assert_eq!(enters, quantity.arguments.contains(&Argument::Gravity), "{}", quantity.function_name(with));
        assert!(enters || !quantity.documentation.names_gravity, "{}", quantity.name);
    }
    let forms: Vec<String> = forms(&model).map(|(quantity, with)| quantity.function_name(with)).collect();
    // Without coupled joints there is no need of their variables.
    let all = catalogue::functions().filter(|(quantity, _)| quantity.name != "joint_variables");
    let all: Vec<String> = all.map(|(quantity, with)| quantity.function_name(with)).collect();
    assert_eq!(forms, all, "the arm has every function");
}

#[test]
fn a_number_for_the_argument_gives_the_arm_with_that_gravity() {
    let model = read(ARM);
    // Of an arm without gravity no joint has a load, and no expression its size.
    let loaded = |quantity: &Quantity| {
        quantity.name.contains("load") || quantity.name.contains("verse_dynamics") || quantity.name.contains("ward_dynamics")
    };
    for vector in ["[1, -2, -9.81]", "[3, 0.5, -1]", "[0, 0, 0]"] {
        let fixed = under(vector);
        let numbers = fixed.manipulator.gravity.each_ref().map(|g| g.evaluate(&|_| unreachable!("no names")));
        // The base parameters of the two are not the same.
        let same = |quantity: &Quantity| *quantity != BASE_REGRESSOR && !(vector == "[0, 0, 0]" && loaded(quantity));
        for (quantity, with) in forms(&model).filter(|(quantity, _)| same(quantity)) {
            let expected = quantity.by_recursion(&fixed, view(&fixed, with));
            let found = quantity.by_recursion(&model, view(&model, with));
            let mut pool = expected.pool;
            let gravity = numbers.each_ref().map(|number| pool.constant(number));
            let at = substituted(&found, &mut pool, gravity);
            assert_eq!(at.len(), expected.entries.len());
            let equal = at.iter().zip(&expected.entries).all(|(&a, &b)| pool.equal(a, b));
            assert!(equal, "{} under {vector}", quantity.function_name(with));
        }
    }
}

#[test]
fn gravity_and_potential_energy_are_affine_in_the_argument() {
    let model = read(ARM);
    for quantity in [&GRAVITY, &POTENTIAL_ENERGY, &EQUATIONS_OF_MOTION, &BASE_REGRESSOR] {
        let Derivation { mut pool, entries, .. } = quantity.by_recursion(&model, View::Nominal);
        let first = by_gravity(&mut pool, &entries);
        assert!(first.iter().all(|column| column.iter().any(|&entry| entry != ExprId::ZERO)), "{}", quantity.name);
        for column in first {
            assert!(by_gravity(&mut pool, &column).concat().iter().all(|&entry| entry == ExprId::ZERO), "{}", quantity.name);
        }
    }
}

/// R = u u' + [u]×, the turn by a right angle about u = (1, 2, 2)/3.
const TURN: [[i64; 3]; 3] = [[1, -4, 8], [8, 4, 1], [-4, 7, 4]];

#[test]
fn an_arm_on_a_tilted_base_is_the_arm_under_a_gravity_turned_back() {
    let upright = read(ARM);
    let tilted = read(&ARM.replace("task:", "base: {axis: [1, 2, 2], angle: pi/2}\ntask:"));
    for quantity in [&GRAVITY, &POTENTIAL_ENERGY, &INVERSE_DYNAMICS, &FORWARD_DYNAMICS] {
        let expected = quantity.by_recursion(&tilted, View::Nominal);
        let found = quantity.by_recursion(&upright, View::Nominal);
        let mut pool = expected.pool;
        let g0 = [0, 1, 2].map(|axis| pool.symbol(Symbol::Gravity(axis)));
        let turned = [0, 1, 2].map(|column| {
            let terms = [0, 1, 2].map(|row| {
                let factor = pool.fraction(TURN[row][column], 9);
                pool.mul(factor, g0[row])
            });
            let sum = pool.add(terms[0], terms[1]);
            pool.add(sum, terms[2])
        });
        let under = substituted(&found, &mut pool, turned);
        assert!(under.iter().zip(&expected.entries).all(|(&a, &b)| pool.equal(a, b)), "{}", quantity.name);
    }
}

#[test]
fn base_parameters_are_those_under_gravity_in_all_directions() {
    // The first axis is vertical: the first moments of its link are felt once the mount tilts.
    let link = "link: {mass: 2, com: [0.1, 0.2, 0.3], inertia: {xx: 0.2, yy: 0.3, zz: 0.25}}";
    let joint = |name: &str, row: &str| format!("  - {{name: {name}, type: revolute, {row}, theta: 0, {link}}}\n");
    let joints =
        joint("a", "a: 0, alpha: pi/2, d: 1") + &joint("b", "a: 1, alpha: 0, d: 0") + &joint("c", "a: 1, alpha: pi/2, d: 0");
    let text = format!("name: arm\nconvention: standard\ngravity: [0, 0, -9.81]\njoints:\n{joints}");
    let count = |model: &Model| {
        let base = base_parameters(&model.manipulator, &model.field).expect("short combinations");
        for vector in [&base, &ParameterVector::standard(&model.manipulator)] {
            let (pool, y) = regressor_of(&model.manipulator, &model.field, vector);
            assert_eq!(rank(&pool, &y), base.len());
        }
        base.entries.iter().map(|entry| entry.name.clone()).collect::<Vec<String>>()
    };
    let argument = text.replace("[0, 0, -9.81]", "{argument: [0, 0, -9.81]}");
    let (fixed, any) = (count(&read(&text)), count(&read(&argument)));
    let more: Vec<&str> = any.iter().filter(|name| !fixed.contains(name)).map(|name| name.trim_end_matches('R')).collect();
    assert_eq!(more, ["mcx1", "mcy1"]);
    assert_eq!(any.len(), fixed.len() + 2);
}

fn generated(model: &Model, functions: &[&str]) -> Module {
    let functions = Selection::named(functions.iter().copied()).expect("they exist");
    module(model, &Options { functions, ..Options::default() })
}

#[test]
fn what_gravity_does_not_enter_has_the_steps_that_it_has_under_a_fixed_one() {
    let names = ["inertia_matrix", "coriolis_matrix", "friction", "kinetic_energy", "momentum", "center_of_mass"];
    let [fixed, argument] = [under("[1, -2, -9.81]"), read(ARM)].map(|model| generated(&model, &names));
    for (a, b) in fixed.functions.iter().zip(&argument.functions) {
        assert_eq!((&a.steps, &a.outputs, &a.arguments), (&b.steps, &b.outputs, &b.arguments), "{}", a.name());
    }
    assert_eq!(fixed.functions.len(), names.len());
}

#[test]
fn the_argument_costs_few_operations() {
    let text = include_str!("../../robots/panda7.yaml").replace("gravity: [0, 0, -9.81]", "gravity: {argument: [0, 0, -9.81]}");
    assert!(text.contains("argument"));
    let module = generated(&read(&text), &["gravity", "inverse_dynamics"]);
    let costs: Vec<(usize, usize)> = module.functions.iter().map(Cost::of).map(|cost| (cost.mul, cost.add)).collect();
    // With the numbers in place of the argument: 40, 28 and 266, 261.
    assert!(costs[0].0 <= 56 && costs[0].1 <= 39, "{costs:?}");
    assert!(costs[1].0 <= 281 && costs[1].1 <= 271, "{costs:?}");
}
