//! The author may choose the base parameters of a `base_regressor`, but the function must be a regressor of them.

use crate::common;

use armgen_certify::{certify, verify};
use armgen_codegen::kinds::Scalar;
use armgen_codegen::manipulator;
use armgen_codegen::validate;
use armgen_verify::certificate::report::Verdict;
use armgen_verify::certificate::Certificate;
use armgen_verify::judge::checker::{Checker, Effort};
use armgen_verify::judge::constants;
use armgen_verify::read::claims::Claims;
use armgen_verify::read::reader::{Function, Module};
use armgen_verify::textbook::base::OwnParameters;
use armgen_verify::textbook::equations::parameters::{Standard, Vector};
use armgen_verify::values::element::Element;
use armgen_verify::values::formula::{Formula, Rational};
use armgen_verify::values::program::{Angle, Output, Program, Step};

/// A `base_regressor` under modification, with its parameters.
#[derive(Clone)]
struct Subject {
    module: Module,
    manipulator: manipulator::Manipulator,
    claims: Claims,
    own: OwnParameters,
    /// The steps of the entries, row by row.
    rows: Vec<Vec<usize>>,
    program: Program,
}

fn subject(name: &str) -> Subject {
    let source = common::source(name);
    let generated = common::generate(&source, Scalar::F64);
    let module = Module::read(&generated.module).expect("a module");
    let (manipulator, _) = validate::read(&source).0.expect("a valid description");
    let claims = Claims::from_numbers(&generated.constants).expect("short formulas");
    let own = constants::base_parameters(&manipulator, &claims, &module).expect("base parameters");
    let program = module.program("base_regressor").expect("the function").clone();
    let steps: Vec<usize> = program.outputs.iter().map(|output| output.step).collect();
    let rows = steps.chunks(own.named.len()).map(<[usize]>::to_vec).collect();
    Subject { module, manipulator, claims, own, rows, program }
}

impl Subject {
    fn step(&mut self, step: Step) -> usize {
        self.program.steps.push(step);
        self.program.steps.len() - 1
    }

    /// Replaces a column in some rows; `of` computes the new step from the steps of a row.
    fn replace(&mut self, column: usize, rows: impl IntoIterator<Item = usize>, of: impl Fn(&[usize]) -> Step) {
        for i in rows {
            self.rows[i][column] = self.step(of(&self.rows[i].clone()));
        }
    }

    /// The column with this name.
    fn column(&self, name: &str) -> usize {
        let place = self.own.named.iter().position(|(parameter, _)| parameter.name() == name);
        place.unwrap_or_else(|| panic!("no {name} in {:?}", self.own.named))
    }

    /// The joints whose torque in a column is not identically 0.
    fn felt(&self, column: usize) -> Vec<usize> {
        let zero = |step: usize| match &self.program.steps[step] {
            Step::Literal(k) => self.program.literals[*k].value == 0.0,
            _ => false,
        };
        (0..self.rows.len()).filter(|&i| !zero(self.rows[i][column])).collect()
    }

    /// The points of the check.
    fn checker(&self) -> Checker {
        let vector = Vector::of(&self.manipulator, &constants::parameter_names(&self.module)).expect("a parameter vector");
        let effort = Effort { points: 2, exact_points: 1, seed: 5 };
        Checker::new(self.manipulator.clone(), vector, self.claims.clone(), effort, &self.module, Some(self.own.clone()))
            .expect("points")
    }

    fn verdict(mut self, checker: &Checker) -> Verdict {
        let entry = |(i, row): (usize, &Vec<usize>)| {
            let entries = row.iter().enumerate().map(move |(c, &step)| Output { place: format!("[{i}][{c}]"), step });
            entries.collect::<Vec<Output>>()
        };
        self.program.outputs = self.rows.iter().enumerate().flat_map(entry).collect();
        let function = Function { documentation: Vec::new(), program: self.program };
        checker.function("base_regressor", &Ok(function), self.module.real).verdict
    }

    #[track_caller]
    fn check(self, wanted: &str) {
        let checker = self.checker();
        self.check_by(&checker, wanted);
    }

    #[track_caller]
    fn check_by(self, checker: &Checker, wanted: &str) {
        match self.verdict(checker) {
            Verdict::Different { entry, why } => {
                let found = format!("{entry} {why}");
                assert!(found.starts_with(wanted), "{found}");
            }
            other => panic!("{other:?}"),
        }
    }
}

#[test]
#[ignore = "wide"]
fn every_entry_with_another_sign_is_named() {
    for name in ["scara", "single_joint", "modified_prismatic"] {
        let right = subject(name);
        let checker = right.checker();
        for column in 0..right.own.named.len() {
            for i in right.felt(column) {
                let mut wrong = right.clone();
                wrong.replace(column, [i], |row| Step::Negate(row[column]));
                wrong.check_by(&checker, &format!("[{i}][{column}] "));
            }
        }
    }
}

#[test]
fn a_column_as_a_whole_is_held_to_the_torque() {
    for name in ["panda7", "base_set"] {
        let right = subject(name);
        let checker = right.checker();
        for column in 0..right.own.named.len() {
            let (mut wrong, felt) = (right.clone(), right.felt(column));
            let alone = !matches!(right.own.named[column].0, Standard::Link(..));
            wrong.replace(column, felt.clone(), |row| Step::Add(row[column], row[column]));
            let why = if alone { "differs: column" } else { "differs: with NOMINAL_BASE_PARAMETERS" };
            wrong.check_by(&checker, &format!("[{}][{column}] {why}", felt[0]));
        }
    }
}

#[test]
fn coefficients_are_constant() {
    let mut subject = subject("panda7");
    let column = subject.column("mcx7");
    let felt = subject.felt(column);
    let cosine = subject.step(Step::Cosine(Angle { terms: vec![(0, 1)], turn: None, factors: Vec::new(), computed: None }));
    subject.replace(column, felt.clone(), |row| Step::Multiply(row[column], cosine));
    subject.check(&format!("[{}][{column}] differs: column `mcx7", felt[0]));
}

#[test]
fn other_base_parameters_will_do() {
    // mcx (a) + mcy (b) = (2 mcx + mcy) (a/2) + mcy (b - a/2): a rotated frame, another unit.
    let mut subject = subject("panda7");
    let (x, y) = (subject.column("mcx5"), subject.column("mcy5"));
    let half = Formula::Rational(Rational::from_parts(1.into(), 2u8.into()));
    let a = subject.own.nominal[x].times(&half);
    subject.own.nominal[y] = subject.own.nominal[y].minus(&a);
    subject.own.nominal[x] = a;
    let joints = subject.felt(x);
    assert_eq!(joints, subject.felt(y));
    subject.replace(x, joints.clone(), |row| Step::Add(row[x], row[x]));
    subject.replace(x, joints, |row| Step::Add(row[x], row[y]));
    let checker = subject.checker();
    assert_eq!(subject.verdict(&checker), Verdict::Equal);
}

#[test]
fn columns_are_independent() {
    // The same column twice, each with half of the value.
    let mut subject = subject("scara4");
    let column = subject.own.named.iter().position(|(parameter, _)| matches!(parameter, Standard::Link(..))).expect("a link's");
    let half = Formula::Rational(Rational::from_parts(1.into(), 2u8.into()));
    subject.own.nominal[column] = subject.own.nominal[column].times(&half);
    let (parameter, value) = (subject.own.named[column], subject.own.nominal[column].clone());
    subject.own.named.push(parameter);
    subject.own.nominal.push(value);
    for row in &mut subject.rows {
        row.push(row[column]);
    }
    let last = subject.own.named.len() - 1;
    subject.check(&format!("[0][{last}] its column depends on those before it"));
}

/// Checks the fault of a module edited at one place, with the claims of the correct module.
#[track_caller]
fn check_edited(name: &str, edit: impl Fn(&str) -> String, wanted: &str) {
    let source = common::source(name);
    let right = common::generate(&source, Scalar::F64).module;
    let edited = edit(&right);
    assert!(edited != right, "nothing was edited");
    let report = verify(&source, &edited, None);
    let said = report.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(!report.passed() && said.contains(wanted), "{said}");
}

/// The text with a replacement at the first occurrence after `from`.
fn after(text: &str, from: &str, old: &str, new: &str) -> String {
    let at = text.find(from).expect("it stands there");
    text[..at].to_string() + &text[at..].replacen(old, new, 1)
}

#[test]
fn names_and_values_are_judged() {
    let names = |old: &'static str, new: &'static str| move |text: &str| after(text, "const BASE_PARAMETER_NAMES", old, new);
    check_edited("scara", names("\"Fm2\"", "\"Fw2\""), "the module does not say of which parameters");
    check_edited(
        "scara",
        names("\"Fm2\"", "\"Fw2\""),
        "BASE_PARAMETER_NAMES DIFFERENT in entry [8]: `Fw2` is no base parameter's name",
    );
    check_edited("scara", names("\"Fm2\"", "\"Fm1\""), "BASE_PARAMETER_NAMES DIFFERENT in entry [8]: `Fm1` stands there twice");
    check_edited("scara", names("\"Fm2\"", "\"Fm1\""), "base_regressor DIFFERENT in entry [0][8]: ");
    check_edited("scara", names("\"mcx2R\"", "\"Ixz2R\""), "`Ixz2R` is no combination of the torques of Ixz2, Iyz2");
    check_edited("scara", names("\"mcx2R\",", ""), "BASE_PARAMETERS DIFFERENT: is 11, not 10");
    let count = |text: &str| text.replacen("BASE_PARAMETERS: usize = ", "BASE_PARAMETERS: usize = 1", 1);
    check_edited("scara", count, "BASE_PARAMETERS DIFFERENT: is 111, not 11");
    let value = |text: &str| after(text, "const NOMINAL_BASE_PARAMETERS", "5.26", "5.27");
    check_edited("scara", value, "NOMINAL_BASE_PARAMETERS DIFFERENT in entry [2]: is 5.27");
}

#[test]
fn claimed_values_must_give_the_torque() {
    let source = common::source("scara");
    let generated = common::generate(&source, Scalar::F64);
    let report = certify(&source, &generated);
    let mut certificate = Certificate::of(&report);
    let values = certificate.constants.iter_mut().find(|c| c.name == "NOMINAL_BASE_PARAMETERS").expect("values");
    // Closer to the literal than any float, but not the value.
    values.literals[1].1 += " + 1/100000000000000000000";
    let fault = verify(&source, &generated.module, Some(&certificate)).first_fault().unwrap_or_default();
    assert!(fault.starts_with("base_regressor[") && fault.contains("does not give the torque"), "{fault}");
}
