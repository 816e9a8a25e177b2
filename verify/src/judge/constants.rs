//! Compares the constants of a module with the description.

use std::collections::BTreeSet;

use armgen_description::exact::Number;
use armgen_description::kinds::{JointKind, ParameterId};
use armgen_description::manipulator::{JointVariable, Limits, Manipulator};

use crate::certificate::report::{ConstantReport, Exact, Verdict};
use crate::judge::checker::Checker;
use crate::read::claims::Claims;
use crate::read::reader::{Constant, Module};
use crate::textbook::base::OwnParameters;
use crate::textbook::equations::angles::Angles;
use crate::textbook::equations::arm::{formula, Arm};
use crate::textbook::equations::parameters::{self, Standard, Vector};
use crate::values::arithmetic::prime::Residue;
use crate::values::check::Check;
use crate::values::element::Element;
use crate::values::enclosure::Float;
use crate::values::formula::Formula;
use crate::values::program::{Literal, JOINTS, MOTORS, NOMINAL_GRAVITY, TIPS};

/// Tells which angles of the description the functions of a module compute. A function that takes the sine of another sum is refused.
pub fn name_angles(module: &mut Module, manipulator: &Manipulator, claims: &Claims) {
    let (angles, real) = (Angles::of(manipulator), module.real);
    for (name, function) in &mut module.functions {
        let Ok(found) = function else { continue };
        let values = claims.resolve(name, &found.program.literals, real).values.clone();
        if let Err(why) = angles.name(&mut found.program, &values) {
            *function = Err(why);
        }
    }
}

/// The expected value of a constant.
enum Expected {
    Text(String),
    Integer(u64),
    Truth(bool),
    Number(Formula),
    Infinite(bool),
    Array(Vec<Expected>),
}

/// The first entry that differs from the expected one.
fn compare(found: &Constant, expected: &Expected, real: Float, entry: &str) -> Option<(String, String)> {
    let differs = |text: String| Some((entry.to_string(), text));
    match (found, expected) {
        (Constant::Text(a), Expected::Text(b)) if a == b => None,
        (Constant::Text(a), Expected::Text(b)) => differs(format!("is \"{a}\", not \"{b}\"")),
        (Constant::Integer(a), Expected::Integer(b)) if a == b => None,
        (Constant::Integer(a), Expected::Integer(b)) => differs(format!("is {a}, not {b}")),
        (Constant::Truth(a), Expected::Truth(b)) if a == b => None,
        (Constant::Infinite(a), Expected::Infinite(b)) if a == b => None,
        (Constant::Number(negative, literal), Expected::Number(exact)) => {
            let value = if *negative { -literal.value } else { literal.value };
            // Here 0 and -0 are equal.
            if real.is_nearest(value + 0.0, exact) {
                None
            } else {
                let sign = if *negative { "-" } else { "" };
                differs(format!("is {sign}{}, not the float nearest to {exact}", literal.text))
            }
        }
        (Constant::Array(found), Expected::Array(expected)) if found.len() == expected.len() => found
            .iter()
            .zip(expected)
            .enumerate()
            .find_map(|(i, (found, expected))| compare(found, expected, real, &format!("{entry}[{i}]"))),
        (Constant::Array(found), Expected::Array(expected)) => {
            differs(format!("has {} entries, not {}", found.len(), expected.len()))
        }
        _ => differs("is not what the description says".into()),
    }
}

fn numbers(constant: &Constant, expected: &Expected, into: &mut Vec<Exact>) {
    match (constant, expected) {
        (Constant::Number(negative, literal), Expected::Number(exact)) => {
            let sign = if *negative { "-" } else { "" };
            into.push(Exact { literal: format!("{sign}{}", literal.text), value: exact.clone() });
        }
        (Constant::Array(a), Expected::Array(b)) => a.iter().zip(b).for_each(|(a, b)| numbers(a, b, into)),
        _ => {}
    }
}

/// The names in a constant of the module; `None` if the constant is missing.
pub fn names(module: &Module, constant: &str) -> Option<Vec<String>> {
    let Constant::Array(names) = module.constants.get(constant)? else { return Some(Vec::new()) };
    let text = |name: &Constant| match name {
        Constant::Text(name) => name.clone(),
        _ => String::new(),
    };
    Some(names.iter().map(text).collect())
}

/// Names of the base parameters, if the module has a `base_regressor`.
fn base_names(module: &Module) -> Option<Vec<String>> {
    let present = module.functions.iter().any(|(name, _)| name == "base_regressor");
    names(module, "BASE_PARAMETER_NAMES").filter(|_| present)
}

/// The module's names of parameters.
pub fn parameter_names(module: &Module) -> Vec<String> {
    names(module, "PARAMETER_NAMES").unwrap_or_default()
}

/// The constants with claimed exact values: parameters derived from bodies. For several bodies combined at general angles, an expanded
/// formula would be too long; the claim defines it in steps.
pub fn claimed_constants(vector: &Vector, module: &Module) -> Vec<&'static str> {
    let run_time = (!matches!(vector, Vector::Names(_))).then_some("NOMINAL_PARAMETERS");
    run_time.into_iter().chain(base_names(module).map(|_| "NOMINAL_BASE_PARAMETERS")).collect()
}

/// The claimed exact values of this many parameters; without claims the decimal values in the text.
fn claimed(constant: &str, length: usize, claims: &Claims, module: &Module) -> Option<Vec<Formula>> {
    let claimed = claims.of(constant);
    if claimed.len() == length {
        return Some(claimed.to_vec());
    }
    let Constant::Array(entries) = module.constants.get(constant)? else { return None };
    let literal = |entry: &Constant| match entry {
        Constant::Number(negative, Literal { text, .. }) => {
            let size = crate::values::formula::parse::decimal(text).ok()?;
            Some(if *negative { size.negated() } else { size })
        }
        _ => None,
    };
    entries.iter().map(literal).collect()
}

/// The base parameters of a module with a `base_regressor`: its names, with the claimed values.
pub fn base_parameters(manipulator: &Manipulator, claims: &Claims, module: &Module) -> Option<OwnParameters> {
    let names = base_names(module)?;
    let named = parameters::base_parameters(manipulator, &names).ok()?;
    let nominal = claimed("NOMINAL_BASE_PARAMETERS", names.len(), claims, module)?;
    (named.len() == nominal.len()).then_some(OwnParameters { named, nominal })
}

/// The first name that is no base parameter, or occurs twice.
fn wrong_name(manipulator: &Manipulator, names: &[String]) -> Option<(usize, String)> {
    names.iter().enumerate().find_map(|(k, name)| {
        let one = std::slice::from_ref(name);
        let none = parameters::base_parameters(manipulator, one).err().map(|why| (k, why));
        none.or_else(|| names[..k].contains(name).then(|| (k, format!("`{name}` stands there twice"))))
    })
}

/// The first base parameter that is 0, and so has no column, or that has a name without R but differs from that standard parameter.
fn wrong_value(checker: &Checker, own: &OwnParameters) -> Option<(usize, String)> {
    checker.points().iter().find_map(|point| {
        let values = point.literals(&own.nominal)?;
        let names = Arm::nominal(&point.arithmetic, checker.manipulator());
        let arm = names.and_then(|names| Arm::new(&point.arithmetic, checker.manipulator(), &names));
        let wrong = |(k, ((parameter, carries), value)): (usize, (&(Standard, bool), &Residue))| {
            let why = if value.is_zero() {
                "is 0: what is 0 has no column".to_string()
            } else if !carries && arm.as_ref().map(|arm| parameter.value(arm)).as_ref() != Some(value) {
                format!("is not the standard parameter `{}`: {}", parameter.name(), own.nominal[k])
            } else {
                return None;
            };
            Some((k, why))
        };
        own.named.iter().zip(&values).enumerate().find_map(wrong)
    })
}

/// The exact nominal parameters. Named quantities have the values of the description; other values are claimed, and the checker compares
/// them with the description at its points.
pub fn nominal_parameters(manipulator: &Manipulator, vector: &Vector, claims: &Claims, module: &Module) -> Option<Vec<Formula>> {
    let claimed = |parameters: usize| claimed("NOMINAL_PARAMETERS", parameters, claims, module);
    match vector {
        Vector::Names(ids) => Some(ids.iter().map(|&id| formula(&manipulator.parameters[id].nominal)).collect()),
        Vector::Standard(all) => claimed(all.len()),
        Vector::Base(base, _) => claimed(base.len()),
    }
}

fn expected(checker: &Checker, module: &Module, nominal: &[Formula], names: &[String]) -> Vec<(String, Expected)> {
    let manipulator = checker.manipulator();
    let coordinates = manipulator.coordinates();
    let array = |entries: Vec<Expected>| Expected::Array(entries);
    let texts = |texts: Vec<String>| array(texts.into_iter().map(Expected::Text).collect());
    let bound = |bound: Option<&Number>, negative: bool| match bound {
        Some(value) => Expected::Number(formula(value)),
        None => Expected::Infinite(negative),
    };
    let position = coordinates.iter().map(|of| {
        let pair = of.limits.position.as_ref();
        array(vec![bound(pair.map(|p| &p[0]), true), bound(pair.map(|p| &p[1]), false)])
    });
    let sizes =
        |of: fn(&Limits) -> &Option<Number>| array(coordinates.iter().map(|own| bound(of(own.limits).as_ref(), false)).collect());
    let parameter_names = checker.vector().names(manipulator).unwrap_or_else(|| names.to_vec());
    let mut all = vec![
        ("NAME", Expected::Text(manipulator.name.clone())),
        ("DOF", Expected::Integer(coordinates.len() as u64)),
        ("JOINT_NAMES", texts(coordinates.iter().map(|of| of.joint.name.clone()).collect())),
        (
            "JOINT_IS_REVOLUTE",
            array(coordinates.iter().map(|of| Expected::Truth(of.joint.kind == JointKind::Revolute)).collect()),
        ),
        ("POSITION_LIMITS", array(position.collect())),
        ("VELOCITY_LIMITS", sizes(|limits| &limits.velocity)),
        ("EFFORT_LIMITS", sizes(|limits| &limits.effort)),
        ("ACCELERATION_LIMITS", sizes(|limits| &limits.acceleration)),
        ("JERK_LIMITS", sizes(|limits| &limits.jerk)),
        ("PARAMETERS", Expected::Integer(parameter_names.len() as u64)),
        ("PARAMETER_NAMES", texts(parameter_names)),
        ("NOMINAL_PARAMETERS", array(nominal.iter().cloned().map(Expected::Number).collect())),
    ];
    let integers = |all: &[usize]| array(all.iter().map(|&one| Expected::Integer(one as u64)).collect());
    let mut of_tips = Vec::new();
    if manipulator.tips.is_empty() {
        all.push(("TASK_ROWS", Expected::Integer(manipulator.task.len() as u64)));
        all.push(("TASK", integers(&manipulator.task_rows())));
    } else {
        all.push((TIPS, texts(manipulator.tips.iter().map(|tip| tip.name.clone()).collect())));
    }
    for tip in &manipulator.tips {
        let rows: Vec<usize> = tip.task.iter().map(|row| row.index()).collect();
        let joints = &manipulator.joints;
        let path: Vec<usize> =
            std::iter::successors(Some(tip.joint.index()), |&joint| Some(joints[joint].parent?.index())).collect();
        let moving: BTreeSet<usize> = match &manipulator.coupling {
            Some(coupling) => path.iter().flat_map(|&i| &coupling.variables[i].factors).map(|(a, _)| *a).collect(),
            None => path.into_iter().collect(),
        };
        let moving: Vec<usize> = moving.into_iter().collect();
        of_tips.push((tip.constant("TASK_ROWS"), Expected::Integer(rows.len() as u64)));
        of_tips.push((tip.constant("TASK"), integers(&rows)));
        of_tips.push((tip.constant("COORDINATES"), integers(&moving)));
    }
    if let Some(coupling) = &manipulator.coupling {
        let row = |variable: &JointVariable| {
            let factor = |a: usize| variable.factors.iter().find(|(of, _)| *of == a).map(|(_, factor)| factor.clone());
            let entries = (0..coordinates.len()).map(|a| Expected::Number(formula(&factor(a).unwrap_or_default())));
            array(entries.collect())
        };
        let offsets = coupling.variables.iter().map(|variable| Expected::Number(formula(&variable.offset)));
        all.push((JOINTS, Expected::Integer(manipulator.joints.len() as u64)));
        all.push(("ALL_JOINT_NAMES", texts(manipulator.joints.iter().map(|joint| joint.name.clone()).collect())));
        all.push(("COUPLING", array(coupling.variables.iter().map(row).collect())));
        all.push(("COUPLING_OFFSET", array(offsets.collect())));
    }
    let motors = motor_rates(manipulator, coordinates.len());
    if !motors.is_empty() {
        all.push((MOTORS, Expected::Integer(motors.len() as u64)));
        let row = |row: &Vec<Number>| array(row.iter().map(|rate| Expected::Number(formula(rate))).collect());
        all.push(("MOTOR_RATES", array(motors.iter().map(row).collect())));
    }
    if manipulator.gravity_is_argument {
        let nominal = |id: ParameterId| manipulator.parameters[id.0 as usize].nominal.clone();
        let gravity = manipulator.gravity.iter().map(|g| Expected::Number(formula(&g.evaluate(&nominal))));
        all.push((NOMINAL_GRAVITY, array(gravity.collect())));
    }
    if let Some(names) = base_names(module) {
        let nominal = claimed("NOMINAL_BASE_PARAMETERS", names.len(), checker.claims(), module).unwrap_or_default();
        let nominal = nominal.into_iter().map(Expected::Number).collect();
        all.push(("BASE_PARAMETERS", Expected::Integer(names.len() as u64)));
        all.push(("BASE_PARAMETER_NAMES", texts(names)));
        all.push(("NOMINAL_BASE_PARAMETERS", array(nominal)));
    }
    all.into_iter().map(|(name, expected)| (name.to_owned(), expected)).chain(of_tips).collect()
}

/// Whether the module of an arm has the speeds of motors: where a joint is coupled, or a motor with several joints.
pub(crate) fn has_motor_rates(manipulator: &Manipulator) -> bool {
    let mut motors = manipulator.joints.iter().filter_map(|joint| joint.motor.as_ref()).peekable();
    motors.peek().is_some() && (manipulator.coupling.is_some() || motors.any(|motor| !motor.coupling.is_empty()))
}

/// N: of each motor k_r S_i + Σ k_j S_j, the rotor's rate beside the link that carries it by the rates of coordinates.
fn motor_rates(manipulator: &Manipulator, coordinates: usize) -> Vec<Vec<Number>> {
    if !has_motor_rates(manipulator) {
        return Vec::new();
    }
    let factor = |joint: usize, a: usize| match &manipulator.coupling {
        Some(coupling) => coupling.variables[joint].factors.iter().find(|(of, _)| *of == a).map(|(_, factor)| factor.clone()),
        None => (joint == a).then(Number::one),
    };
    let nominal = |id: ParameterId| manipulator.parameters[id.0 as usize].nominal.clone();
    let motors = manipulator.joints.iter().enumerate().filter_map(|(i, joint)| Some((i, joint.motor.as_ref()?)));
    let rates = motors.map(|(i, motor)| {
        let own = (i, motor.ratio.evaluate(&nominal));
        let entry = |a: usize| {
            let all = motor.coupling.iter().chain([&own]);
            all.fold(Number::zero(), |sum, (joint, k)| sum.plus(&factor(*joint, a).unwrap_or_default().times(k)))
        };
        (0..coordinates).map(entry).collect()
    });
    rates.collect()
}

/// Checks all constants of a module.
pub fn check(checker: &Checker, module: &Module, nominal: &[Formula]) -> Vec<ConstantReport> {
    let names = parameter_names(module);
    let expected = expected(checker, module, nominal, &names);
    let mut reports = Vec::new();
    for (name, expected) in &expected {
        let mut literals = Vec::new();
        let verdict = match module.constants.get(name) {
            None if !Check::ConstantsThere.is_made() => Verdict::Equal,
            None => Verdict::Refused("the module does not have it".into()),
            Some(value) => {
                numbers(value, expected, &mut literals);
                match compare(value, expected, module.real, "") {
                    Some((entry, why)) if Check::Constants.is_made() => Verdict::Different { entry, why },
                    _ => Verdict::Equal,
                }
            }
        };
        reports.push(ConstantReport { name: name.clone(), verdict, literals });
    }
    let mut differs = |name: &str, check: Check, wrong: &dyn Fn() -> Option<(usize, String)>| {
        let Some(report) = reports.iter_mut().find(|r| r.name == name && r.verdict == Verdict::Equal) else { return };
        if let Some((entry, why)) = wrong().filter(|_| check.is_made()) {
            report.verdict = Verdict::Different { entry: format!("[{entry}]"), why };
        }
    };
    differs("NOMINAL_PARAMETERS", Check::NominalParameters, &|| {
        let entry = wrong_parameter(checker, nominal)?;
        let stands_for = match checker.vector() {
            Vector::Base(..) => "combination of standard parameters that its name stands for",
            _ => "value that the bodies of the description give",
        };
        let claimed = nominal.get(entry).map(|value| format!(": {value}")).unwrap_or_default();
        Some((entry, format!("is not the {stands_for}{claimed}")))
    });
    differs("BASE_PARAMETER_NAMES", Check::BaseNames, &|| wrong_name(checker.manipulator(), &base_names(module)?));
    differs("NOMINAL_BASE_PARAMETERS", Check::BaseValues, &|| wrong_value(checker, checker.base()?));
    reports
}

/// The first standard or base parameter whose claimed value disagrees with the bodies of the description.
fn wrong_parameter(checker: &Checker, nominal: &[Formula]) -> Option<usize> {
    checker.points().iter().find_map(|point| {
        let right = point.reference.nominal.as_ref()?;
        let Some(claimed) = point.literals(nominal) else { return Some(0) };
        claimed.iter().zip(right).position(|(a, b)| a != b)
    })
}
