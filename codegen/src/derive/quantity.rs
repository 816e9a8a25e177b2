//! A quantity: the language-independent declaration of an emitted function, and its derivation by recursion over the links.
//!
//! Each is declared once, in the file of its derivation (`quantities/`); [`Quantity::of_tip`] makes those of a named end effector. Code that prints, counts, documents or tests functions
//! reads the declaration of every [`Quantity`], and knows no function by name.
//!
//! Texts of documentation hold links in braces: `{gravity}` is a function, `{q}` an argument, `{PARAMETER_NAMES}` a constant of the module,
//! each in the notation of a language. Text between back quotes is code, the same in all languages.

use std::collections::BTreeMap;
use std::sync::{Mutex, PoisonError};

use super::arm::Arm;
use super::derivation::{Derivation, OVER_GROUPED_BODIES, OVER_THE_LINKS};
use super::model::{Model, Sizes};
use super::parameters::View;
use super::passes::{self, RewriteScope};
use super::plan::{Plan, Start};
pub use crate::kinds::Feature;
use crate::manipulator::Tip;
use crate::pass::{Pass, Passes};
use crate::ring::count::{DIVISION_COST, SINE_COSINE_COST};
use crate::ring::{ExprId, Pool};

/// A function of the emitted module.
pub struct Quantity {
    /// Its name in the emitted module.
    pub name: &'static str,
    /// Its symbol.
    pub symbol: Typeset,
    /// Arguments of the plain function, in order; [`Argument::Gravity`] of arms alone that have the acceleration of free fall as an argument.
    pub arguments: &'static [Argument],
    /// The parts of its result.
    pub result: &'static [ResultPart],
    /// The type of the result, if it is a struct of the parts instead of a list.
    pub structure: Option<Structure>,
    /// Whether there is a form `_with` the parameters at run time.
    pub has_parameters: bool,
    /// Its documentation.
    pub documentation: Documentation,
    /// Its derivation.
    pub recursion: Recursion,
    /// Why an arm does not have the function, or its form with parameters at run time, if it does not: by [`Quantity::absence`].
    pub missing: fn(&Model, bool) -> Option<String>,
    /// Quantities whose values this one returns together; empty for all others.
    pub gathers: &'static [&'static Quantity],
    /// The trait of the runtime that it is a method of; any name but Kinematics, Dynamics, Regressor is a trait of its own, written by a test.
    pub interface: Option<&'static str>,
}

/// A symbol in plain text and in LaTeX.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Typeset {
    /// In plain text.
    pub text: &'static str,
    /// In LaTeX.
    pub latex: &'static str,
}

impl Typeset {
    /// A symbol that LaTeX writes as plain text does.
    pub const fn plain(text: &'static str) -> Typeset {
        Typeset { text, latex: text }
    }

    /// A symbol.
    pub const fn new(text: &'static str, latex: &'static str) -> Typeset {
        Typeset { text, latex }
    }
}

/// A number, a vector, a matrix or a list of matrices that a function returns.
#[derive(Clone, Copy, Debug)]
pub struct ResultPart {
    /// Its name, [`ResultPart::RESULT`] where it is all that is returned.
    pub name: &'static str,
    /// Its symbol.
    pub symbol: Typeset,
    /// The letter of an entry.
    pub letter: Typeset,
    /// Its dimensions, outermost first; empty for a number. The last two are the dimensions of a matrix.
    pub lengths: &'static [Length],
    /// Unit of the entries.
    pub unit: &'static str,
    /// One matrix, if this is a list of matrices.
    pub element: Option<Element>,
    /// Its description where a result has several parts: a title, and what follows it in full documentation.
    pub meaning: [&'static str; 2],
}

/// One matrix of a list: what its name and its symbol begin with, before its number.
#[derive(Clone, Copy, Debug)]
pub struct Element {
    /// Its name: `link_frame` of `link_frame_1`.
    pub name: &'static str,
    /// Its letter: `T` of `T_1(q)`.
    pub letter: &'static str,
}

/// The name and the title of a type that has the parts of a result as fields.
#[derive(Clone, Copy, Debug)]
pub struct Structure {
    /// Its name.
    pub name: &'static str,
    /// Its title.
    pub title: &'static str,
}

/// A dimension of a result or of an argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Length {
    /// Number of coordinates: of joints, where none is coupled.
    Dof,
    /// Number of joints: of a robot without coupled joints the number of coordinates, whose constant it has.
    Joints,
    /// Number of joints of a robot with coupled joints, in a constant of its own.
    AllJoints,
    /// Number of parameters.
    Parameters,
    /// Number of base parameters.
    BaseParameters,
    /// Number of rows of the task.
    Task,
    /// That number.
    Fixed(usize),
    /// That number, in the constant of this name: the rows of the task of a named end effector.
    Named(&'static str, usize),
}

/// An argument of an emitted function.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Argument {
    /// The parameter vector.
    Pi,
    /// Acceleration of free fall in the base frame.
    Gravity,
    /// Joint variables.
    Q,
    /// Joint rates.
    Dq,
    /// Joint accelerations.
    Ddq,
    /// Reference rates.
    Dqr,
    /// Reference accelerations.
    Ddqr,
    /// Joint torques.
    Tau,
}

/// A function that an arm does not have.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Absent {
    /// Its name.
    pub function: String,
    /// Why.
    pub reason: String,
}

/// The documentation of a function.
#[derive(Clone, Copy, Debug)]
pub struct Documentation {
    /// Its title.
    pub title: &'static str,
    /// The formula and its source.
    pub formula: &'static str,
    /// The result with its frame, unit and sign, after "Returns".
    pub result: &'static str,
    /// The same of the form with parameters at run time, where that differs.
    pub result_with: Option<&'static str>,
    /// Possible failures, without and with parameters at run time.
    pub failure: [&'static str; 2],
    /// Whether it depends on the acceleration of free fall directly, and so documents it.
    pub names_gravity: bool,
    /// What features of joints add, by their number, for arms that have them.
    pub features: [Option<&'static str>; Feature::ALL.len()],
    /// The part that base parameters omit, for the form with base parameters at run time.
    pub base: Option<&'static str>,
    /// Whether the head of a module names the function if the arm lacks it. False for functions that most arms do not need; their
    /// traits have a default.
    pub said_missing: bool,
}

/// The derivation of a quantity by recursion over the links.
#[derive(Clone, Copy)]
pub struct Recursion {
    /// The entries of all parts, row by row, for an arm in a pool.
    pub entries: fn(&mut Pool, &Arm, &mut Plan, &DerivationInput<'_>) -> Vec<ExprId>,
    /// The passes that may rewrite the arm, if its parameters are numbers.
    pub rewriting: RewriteScope,
    /// How the parameters enter, where the quantity decides that.
    pub view: for<'a> fn(&'a Model, View<'a>) -> View<'a>,
    /// Prepares the arm before all passes.
    pub prepare: fn(&mut Pool, &mut Arm),
    /// Passes that it cannot use.
    pub without: &'static [Pass],
    /// Where searches for its plan start.
    pub starts: &'static [Start],
    /// What it is of.
    pub of: Of,
    /// Whether the entries are of coordinates already, where joints are coupled.
    pub in_coordinates: bool,
}

/// What a quantity is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Of {
    /// The robot.
    Robot,
    /// The end effector; a robot whose end effectors have names has it once for each.
    EndEffector,
    /// The named end effector of this number.
    Tip(usize),
}

/// The arm that a derivation is for, and how its parameters enter.
#[derive(Clone, Copy)]
pub struct DerivationInput<'a> {
    /// The arm and its parameters.
    pub model: &'a Model,
    /// How the parameters enter.
    pub view: View<'a>,
}

impl Documentation {
    const CANNOT_FAIL: &'static str = "cannot fail";

    /// For a function that cannot fail, and that does not depend on the acceleration of free fall directly.
    pub const fn new(title: &'static str, formula: &'static str, result: &'static str) -> Documentation {
        Documentation {
            title,
            formula,
            result,
            result_with: None,
            failure: [Documentation::CANNOT_FAIL; 2],
            names_gravity: false,
            features: [None; Feature::ALL.len()],
            base: None,
            said_missing: true,
        }
    }

    /// The same with what a feature of joints adds.
    pub const fn with(self, feature: Feature, text: &'static str) -> Documentation {
        let mut documentation = self;
        documentation.features[feature as usize] = Some(text);
        documentation
    }

    /// The same with what base parameters leave out.
    pub const fn with_base(self, base: &'static str) -> Documentation {
        Documentation { base: Some(base), ..self }
    }
}

impl Recursion {
    /// A derivation without anything out of the ordinary.
    pub const fn new(
        rewriting: RewriteScope,
        entries: fn(&mut Pool, &Arm, &mut Plan, &DerivationInput<'_>) -> Vec<ExprId>,
    ) -> Recursion {
        fn as_asked<'a>(_: &'a Model, view: View<'a>) -> View<'a> {
            view
        }
        Recursion {
            entries,
            rewriting,
            view: as_asked,
            prepare: |_, _| (),
            without: &[],
            starts: &[Start::PLAIN],
            of: Of::Robot,
            in_coordinates: false,
        }
    }
}

impl ResultPart {
    /// The name of a part that is the whole result.
    pub const RESULT: &'static str = "result";

    /// A part that is the whole result.
    pub const fn whole(symbol: Typeset, letter: Typeset, lengths: &'static [Length], unit: &'static str) -> ResultPart {
        ResultPart { name: ResultPart::RESULT, symbol, letter, lengths, unit, element: None, meaning: [""; 2] }
    }

    /// Number of entries.
    pub fn len(&self, sizes: &Sizes) -> usize {
        self.lengths.iter().map(|length| length.of(sizes)).product()
    }

    /// Number of columns, 1 of a number or a vector.
    pub fn columns(&self) -> Length {
        match self.lengths {
            [.., _, columns] => *columns,
            _ => Length::Fixed(1),
        }
    }

    /// Number of rows of one matrix, 1 of a number.
    pub fn rows(&self) -> Length {
        match self.lengths {
            [.., rows, _] | [rows] => *rows,
            [] => Length::Fixed(1),
        }
    }
}

impl Length {
    /// Its value for an arm.
    pub fn of(self, sizes: &Sizes) -> usize {
        match self {
            Length::Dof => sizes.dof,
            Length::Joints | Length::AllJoints => sizes.joints,
            Length::Parameters => sizes.parameters,
            Length::BaseParameters => sizes.base_parameters,
            Length::Task => sizes.task,
            Length::Fixed(value) | Length::Named(_, value) => value,
        }
    }

    /// The constant of the emitted module that holds it, or the number.
    pub fn constant(self) -> String {
        match self {
            Length::Dof | Length::Joints => "DOF".into(),
            Length::AllJoints => "JOINTS".into(),
            Length::Parameters => "PARAMETERS".into(),
            Length::BaseParameters => "BASE_PARAMETERS".into(),
            Length::Task => "TASK_ROWS".into(),
            Length::Fixed(value) => value.to_string(),
            Length::Named(constant, _) => constant.into(),
        }
    }
}

impl Argument {
    /// All of them.
    pub const ALL: [Argument; 8] =
        [Argument::Pi, Argument::Gravity, Argument::Q, Argument::Dq, Argument::Ddq, Argument::Dqr, Argument::Ddqr, Argument::Tau];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Argument::Pi => "pi",
            Argument::Gravity => "g0",
            Argument::Q => "q",
            Argument::Dq => "dq",
            Argument::Ddq => "ddq",
            Argument::Dqr => "dqr",
            Argument::Ddqr => "ddqr",
            Argument::Tau => "tau",
        }
    }

    /// Its length.
    pub fn length(self) -> Length {
        match self {
            Argument::Pi => Length::Parameters,
            Argument::Gravity => Length::Fixed(3),
            _ => Length::Dof,
        }
    }

    /// Its meaning, with its unit.
    pub fn meaning(self) -> &'static str {
        match self {
            Argument::Pi => "the parameters in the order of {PARAMETER_NAMES}, SI units.",
            Argument::Gravity => {
                "acceleration of free fall in the base frame, m/s²; {NOMINAL_GRAVITY} is that of the description. For a base that translates with the acceleration a it is g0 - a, exactly; \
                 terms of a base that turns are missing."
            }
            Argument::Q => "joint variables, rad (revolute) or m (prismatic).",
            Argument::Dq => "joint rates, rad/s or m/s.",
            Argument::Ddq => "joint accelerations, rad/s² or m/s².",
            Argument::Dqr => "reference rates, rad/s or m/s.",
            Argument::Ddqr => "reference accelerations, rad/s² or m/s².",
            Argument::Tau => "joint torques (forces) on the joint side of the gears, N m or N.",
        }
    }
}

impl PartialEq for Quantity {
    fn eq(&self, other: &Quantity) -> bool {
        self.name == other.name
    }
}

impl Eq for Quantity {}

impl std::fmt::Debug for Quantity {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

impl Quantity {
    /// Every arm has it.
    pub const NEVER_MISSING: fn(&Model, bool) -> Option<String> = |_, _| None;

    /// For quantities of the dynamics.
    pub const MISSING_WITHOUT_MASS: fn(&Model, bool) -> Option<String> =
        |model, _| model.manipulator.is_massless().then(|| "nothing in the arm has mass or inertia".into());

    /// Why an arm does not have the function, or its form with parameters at run time, if it does not.
    pub fn absence(&self, model: &Model, with_parameters: bool) -> Option<String> {
        match self.recursion.of {
            Of::Tip(tip) => (self.missing)(&model.at(tip), with_parameters),
            Of::Robot | Of::EndEffector => (self.missing)(model, with_parameters),
        }
    }

    /// The same quantity of the named end effector of that number, with its name before its own.
    ///
    /// Each is made once and kept as long as the program runs, as those of the catalogue are: a few hundred bytes for a name that a
    /// description gives.
    pub fn of_tip(&'static self, number: usize, tip: &Tip) -> &'static Quantity {
        type Key = (&'static str, String, usize, usize);
        static ALL: Mutex<BTreeMap<Key, &'static Quantity>> = Mutex::new(BTreeMap::new());
        let mut all = ALL.lock().unwrap_or_else(PoisonError::into_inner);
        all.entry((self.name, tip.name.clone(), number, tip.task.len())).or_insert_with(|| {
            let kept = |text: String| -> &'static str { Box::leak(text.into_boxed_str()) };
            let task = tip.constant("TASK");
            let said = |text: &str| kept(text.replace("{TASK}", &format!("{{{task}}}")));
            let length = |length: &Length| match length {
                Length::Task => Length::Named(kept(tip.constant("TASK_ROWS")), tip.task.len()),
                other => *other,
            };
            let result = self.result.iter().map(|part| {
                let lengths: Vec<Length> = part.lengths.iter().map(length).collect();
                ResultPart { lengths: Box::leak(lengths.into_boxed_slice()), ..*part }
            });
            let documentation = Documentation {
                title: kept(format!("{} End effector: `{}`.", self.documentation.title, tip.name)),
                formula: said(self.documentation.formula),
                result: said(self.documentation.result),
                ..self.documentation
            };
            Box::leak(Box::new(Quantity {
                name: kept(tip.prefix() + self.name),
                result: Box::leak(result.collect::<Vec<_>>().into_boxed_slice()),
                documentation,
                recursion: Recursion { of: Of::Tip(number), ..self.recursion },
                ..*self
            }))
        })
    }

    /// The same quantity of a robot with coupled joints, which has more joints than coordinates. Each is made once, as [`Quantity::of_tip`] does.
    pub fn of_coupled_joints(&'static self) -> &'static Quantity {
        static ALL: Mutex<BTreeMap<&'static str, &'static Quantity>> = Mutex::new(BTreeMap::new());
        if !self.has_length(Length::Joints) {
            return self;
        }
        let mut all = ALL.lock().unwrap_or_else(PoisonError::into_inner);
        all.entry(self.name).or_insert_with(|| {
            let length = |&length: &Length| if length == Length::Joints { Length::AllJoints } else { length };
            let result = self.result.iter().map(|part| {
                let lengths: Vec<Length> = part.lengths.iter().map(length).collect();
                ResultPart { lengths: Box::leak(lengths.into_boxed_slice()), ..*part }
            });
            Box::leak(Box::new(Quantity { result: Box::leak(result.collect::<Vec<_>>().into_boxed_slice()), ..*self }))
        })
    }

    /// The arguments of its function for an arm, in order.
    pub fn arguments_of(&self, with_parameters: bool, gravity_is_argument: bool) -> impl Iterator<Item = Argument> {
        let there = move |argument: &Argument| *argument != Argument::Gravity || gravity_is_argument;
        with_parameters.then_some(Argument::Pi).into_iter().chain(self.arguments.iter().copied().filter(there))
    }

    /// Whether the acceleration of free fall enters it.
    pub fn depends_on_gravity(&self) -> bool {
        self.arguments.contains(&Argument::Gravity)
    }

    /// The name of the function, or of its form with parameters at run time.
    pub fn function_name(&self, with_parameters: bool) -> String {
        format!("{}{}", self.name, if with_parameters { "_with" } else { "" })
    }

    /// Whether a result has such a dimension.
    pub fn has_length(&self, length: Length) -> bool {
        self.result.iter().any(|part| part.lengths.contains(&length))
    }

    /// The entries of the result, grouped by columns in the order of evaluation.
    ///
    /// Columns of joints run from the last to the first, as a recursion from the tip to the base computes them. Columns of
    /// parameters run from the first to the last, as a body moves by the joints before it. Each entry of a vector is a column,
    /// and each matrix of a list. The same columns of the terms of one equation are neighbours; several results follow one
    /// another.
    pub fn entries_by_columns(&self, sizes: &Sizes) -> Vec<Vec<usize>> {
        let mut columns: BTreeMap<(usize, usize), Vec<usize>> = BTreeMap::new();
        let mut first = 0;
        for (part, number) in self.result.iter().zip(0..) {
            let count = part.len(sizes);
            for entry in 0..count {
                let column = match part.lengths {
                    [] => 0,
                    [list, _, _, ..] => entry / (count / list.of(sizes)),
                    [.., last @ (Length::Parameters | Length::BaseParameters)] => entry % last.of(sizes),
                    [.., last] => last.of(sizes) - 1 - entry % last.of(sizes),
                };
                let result = if self.structure.is_some() { 0 } else { number };
                columns.entry((result, column)).or_default().push(first + entry);
            }
            first += count;
        }
        columns.into_values().collect()
    }

    /// The entries for the coordinates instead of for the joints; those of its dimensions that are of joints stay.
    pub(crate) fn of_coordinates(&self, pool: &mut Pool, arm: &Arm, sizes: &Sizes, entries: Vec<ExprId>) -> Vec<ExprId> {
        let Some(coupled) = arm.coupling.as_ref().filter(|_| !self.recursion.in_coordinates) else { return entries };
        let mut rest = entries.as_slice();
        let mut all = Vec::new();
        for part in self.result {
            let length = |&of: &Length| if of == Length::Dof { arm.dof() } else { of.of(sizes) };
            let lengths: Vec<usize> = part.lengths.iter().map(length).collect();
            let (own, others) = rest.split_at(lengths.iter().product());
            rest = others;
            let mut own = own.to_vec();
            let mut inner = 1;
            for (&of, length) in part.lengths.iter().zip(lengths).rev() {
                if of == Length::Dof {
                    own = coupled.contract(pool, &own, inner);
                    inner *= arm.coordinates();
                } else {
                    inner *= length;
                }
            }
            all.extend(own);
        }
        all
    }

    /// The forms that it has: without parameters at run time, and perhaps with them.
    pub fn forms(&self) -> &'static [bool] {
        if self.has_parameters {
            &[false, true]
        } else {
            &[false]
        }
    }

    /// The entries by recursion over the links, in a pool of their own.
    pub fn by_recursion(&self, model: &Model, view: View<'_>) -> Derivation {
        self.by_plan(model, view, Plan::default(), 0)
    }

    /// The entries by recursion over the links, in the ways that cost least, as far as `effort` (counted in nodes) goes.
    pub fn by_search(&self, model: &Model, view: View<'_>, without: Passes, effort: usize) -> Derivation {
        self.by_plan(model, view, Plan::new(without), effort)
    }

    pub(crate) fn by_plan(&self, model: &Model, view: View<'_>, mut plan: Plan, effort: usize) -> Derivation {
        let of_tip = match self.recursion.of {
            Of::Tip(tip) => Some(model.at(tip)),
            Of::Robot | Of::EndEffector => None,
        };
        let model = of_tip.as_ref().unwrap_or(model);
        let Recursion { entries, rewriting, view: own_view, prepare, without, starts, .. } = self.recursion;
        let input = DerivationInput { model, view: own_view(model, view) };
        let rewriting = match (rewriting, input.view) {
            (RewriteScope::Dynamics, View::Nominal) => RewriteScope::Dynamics,
            (RewriteScope::Dynamics, _) => RewriteScope::KeepParameters,
            (other, _) => other,
        };
        let mut pool = Pool::new(model.field.clone());
        let mut arm = Arm::new(&mut pool, &model.manipulator, input.view);
        prepare(&mut pool, &mut arm);
        let sizes = model.sizes_with(if self.has_length(Length::BaseParameters) { model.base_count() } else { 0 });
        let blank = Pool::new(arm.field_of_coordinates(&model.field));
        let derive = |mut pool: Pool, into: Pool, plan: &mut Plan| {
            let mut arm = arm.clone();
            passes::rewrite(&mut pool, &mut arm, plan, rewriting);
            let entries = entries(&mut pool, &arm, plan, &input);
            let entries = self.of_coordinates(&mut pool, &arm, &sizes, entries);
            arm.in_coordinates_of(pool, entries, into)
        };
        without.iter().for_each(|&pass| plan.disable(pass));
        passes::disable_unsuitable(&pool, &arm, &mut plan);
        let (fingerprints_only, own, mut nodes) = (pool.fingerprints_only(), blank.fingerprints_only(), 0);
        let (pool, entries) = loop {
            if effort > 0 {
                plan = plan.search_from(starts, effort, &mut |plan| {
                    let mut pool = fingerprints_only.clone();
                    pool.reserve(nodes);
                    let (pool, entries) = derive(pool, own.clone(), plan);
                    nodes = pool.len();
                    let (entries, _) = pool.with_gravity(&entries);
                    let pairs = pool.angles(&entries).len();
                    (pool.operations(&entries, DIVISION_COST) + SINE_COSINE_COST * pairs, pool.len())
                });
            }
            let refused = plan.refusals();
            let derived = derive(pool.clone(), blank.clone(), &mut plan);
            // Each round refuses at least one more way, and without a search the plain ways remain.
            if plan.refusals() == refused || effort == 0 {
                break derived;
            }
        };
        let grouped = rewriting == RewriteScope::Dynamics && plan.has(Pass::Grouping);
        let parallel = arm.parallel_coordinates();
        Derivation { pool, entries, parallel, method: if grouped { OVER_GROUPED_BODIES } else { OVER_THE_LINKS } }
    }
}
