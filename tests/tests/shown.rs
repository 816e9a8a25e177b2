//! What `show` prints is the arm: every formula, closed or in steps, read back as text and compared with the program that is emitted.

use std::ops::Range;

use armgen_codegen::catalogue::{self, ResultPart, Sizes};
use armgen_codegen::show::{Form, Item, Reading, Sheet, Style};
use armgen_codegen::{source::Source, validate, Model};
use armgen_tests::formula;
use armgen_tests::functions::{Arguments, Functions};
use armgen_tests::interpreter::Interpreted;
use armgen_tests::precision::{agree, ORACLE};
use armgen_tests::random;
use armgen_tests::shown::{state_names, Shown};

/// Constants of several terms in every place: lengths, offsets of both kinds of joint, inertias, friction, gravity; roots from
/// sqrt and from pi/12, sine and cosine of 0.7. Many of them lead with a negative term.
const ROOTS: &str = "
name: roots
convention: standard
gravity: [1 - sqrt(3), 0.5, sqrt(2) - 9]
parameters: {m: sqrt(5) - 1, I: 1 - sqrt(2)/2}
joints:
  - {name: a, type: prismatic, a: 0.3, alpha: pi/6, d: sqrt(2) - 1, theta: 0.7, link: {mass: 3 - sqrt(2), com: [0.1 - sqrt(2)/20, 0, 0.2]}}
  - name: b
    type: revolute
    a: sqrt(2) - 1
    alpha: pi/4
    d: 1 - sqrt(3)
    theta: pi/12
    link: {mass: m, com: [2 - sqrt(3), 0, 0.1], inertia: {xx: I, yy: I, zz: I}}
    motor: {ratio: 1 - 3*sqrt(2), inertia: 0.01, axis: [1, 1, 0]}
    friction: {viscous: sqrt(3) - 1, coulomb: sqrt(2) - 1}
task: [x, y]
regressor: [m]
";

/// A wrist whose tool is turned by three general angles.
const TOOL: &str = "
name: tool
convention: modified
gravity: [0, -9.81, 0]
joints:
  - {name: a, type: revolute, a: 0.3, alpha: 0.7, d: 0, theta: pi/5, link: {mass: 2, com: [0, 0.1, 0], inertia: {xx: 0.1, yy: 0.1, zz: 0.1}}}
tool: {xyz: [sqrt(2) - 1, 0.1, 0], rpy: [0.7, pi/6, -1.2]}
task: [rz]
regressor: standard
";

/// A small arm whose constants appear on their own.
const SLIDE: &str = "
name: slide
convention: standard
gravity: [0, 0, -9.81]
joints:
  - {name: a, type: prismatic, a: sqrt(2) - 2, alpha: 0.7, d: sqrt(2) - 1, theta: pi/12, link: {mass: 2 - sqrt(2)}}
task: [z]
regressor: standard
";

/// The function whose result the shown matrix comes from, and the places of its entries in it.
fn place(shown: &str, sizes: &Sizes) -> Option<(String, Range<usize>)> {
    for (quantity, with) in catalogue::functions() {
        let (function, mut start) = (quantity.function_name(with), 0);
        for part in quantity.result {
            let all = start..start + part.len(sizes);
            start = all.end;
            match part.element {
                Some(element) => {
                    let number = shown.strip_prefix(element.name).and_then(|rest| rest.strip_prefix('_')?.parse::<usize>().ok());
                    if let Some(number) = number {
                        let size = part.rows().of(sizes) * part.columns().of(sizes);
                        let first = all.start + (number - 1) * size;
                        return Some((function, first..first + size));
                    }
                }
                None if part.name == ResultPart::RESULT && shown == function => return Some((function, all)),
                None if shown == format!("{function}_{}", part.name) => return Some((function, all)),
                None => {}
            }
        }
    }
    None
}

fn check(what: &str, text: &str) {
    let model = Model::new(validate::read(&Source::new("robot.yaml", text)).0.unwrap_or_else(|| panic!("{what}\n{text}")).0);
    let program = Interpreted::new(text).expect("it has been read");
    let (dof, sizes) = (program.dof(), model.sizes());
    let described: Vec<(String, f64)> =
        model.manipulator.parameters.iter().map(|p| (p.name.clone(), p.nominal.to_f64())).collect();
    let arguments: Vec<(String, f64)> = program.parameter_names().into_iter().zip(program.nominal()).collect();
    let state = random::state(dof, 7);
    let tau: Vec<f64> = state.ddq.iter().map(|x| 3.0 * x).collect();
    let a = Arguments {
        pi: program.nominal(),
        q: state.q,
        dq: state.dq,
        ddq: state.ddq,
        dqr: state.dqr,
        ddqr: state.ddqr,
        tau: tau.clone(),
        ..Arguments::default()
    };
    let g = if program.has("gravity") { program.call("gravity", &a) } else { Vec::new() };
    let vectors: [(&str, &[f64]); 7] =
        [("q", &a.q), ("dq", &a.dq), ("ddq", &a.ddq), ("dqr", &a.dqr), ("ddqr", &a.ddqr), ("tau", &tau), ("g", &g)];
    let variables = state_names(&vectors);
    let items: Vec<Item> = Item::names(&[]).iter().flat_map(|name| Item::named(name, dof, &[])).collect();
    let forms = [Form::Shortest, Form::Closed, Form::Steps];
    for (reading, form) in [Reading::Nominal, Reading::Symbolic].into_iter().flat_map(|reading| forms.map(|form| (reading, form)))
    {
        let json = Sheet::in_style(&model, &items, reading, Style { form, digits: None }).json();
        let shown = Shown::read(&serde_json::from_str(&json).expect("JSON")).unwrap_or_else(|error| panic!("{what}: {error}"));
        for quantity in &shown.quantities {
            let what = format!("{what}: {} ({reading:?}, {form:?})", quantity.name);
            let of = if quantity.name.ends_with("_with") { &arguments } else { &described };
            let mut names = variables.clone();
            names.extend(of.iter().cloned());
            let value = |text: &str| formula::evaluate(&formula::parse(text)?, &names);
            let found = quantity.value(&names).unwrap_or_else(|error| panic!("{what}: {error}")).concat();
            // The unit tests of the minors compare them with the Jacobian.
            if quantity.name == "determinant" && quantity.columns < quantity.rows {
                continue;
            }
            let expected = if quantity.name == "determinant" {
                let factors = quantity.factors.iter().flatten().map(|text| value(text).unwrap_or_else(|e| panic!("{what}: {e}")));
                vec![factors.product()]
            } else {
                let (function, entries) = place(&quantity.name, &sizes).unwrap_or_else(|| panic!("{what}: of no function"));
                program.call(&function, &a)[entries].to_vec()
            };
            agree(&what, &found, &expected, ORACLE);
        }
    }
}

#[test]
#[ignore = "wide"]
fn every_formula_has_the_value_of_the_program() {
    check("roots", ROOTS);
    check("tool", TOOL);
    check("slide", SLIDE);
    // The symbolic forms of three general angles take half a minute; TOOL has as many.
    for (name, text) in random::tricky().into_iter().filter(|(name, _)| *name != "general_angles") {
        check(name, text);
    }
}

#[test]
#[ignore = "wide"]
fn formulas_of_random_arms_have_the_values_of_their_programs() {
    // Few joints: the check is about constants, and a determinant with names is slow.
    for seed in 0..12 {
        let mut random = random::Random::new(seed);
        let dof = 1 + seed as usize % 3;
        check(&format!("arm {seed}"), &random::arm_with("arm", dof, &mut random));
    }
}
