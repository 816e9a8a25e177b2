//! The page of a robot: a single HTML file that opens from disk, without network or server.
//!
//! ```text
//! description -> rows, bodies, warnings ─┬─> document: static HTML
//!             -> the module in JavaScript ┴─> script: the files of web/ around it; data: their input
//! ```
//!
//! The emitted JavaScript module does all computations for the robot. The same input text always gives the same page.
//!
//! A page loads nothing and runs only its own script: its content security policy names the hashes of the script and the style.
//! Text enters the document escaped, or through text nodes and attributes that the script sets.

mod bodies;
mod brief;
mod cost;
mod document;
mod drives;
mod equations;
mod html;
mod logs;
mod rows;
mod script;
mod sheet;
mod warnings;
mod words;

pub use logs::{Figure, Log, Run, Verdict, SAMPLES};

use armgen_codegen::description::{Convention, RobotDescription};
use armgen_codegen::diagnostic::Diagnostics;
use armgen_codegen::emit::{javascript, Notes, Origin};
use armgen_codegen::exact::Number;
use armgen_codegen::manipulator::{Coordinate, Limits, Manipulator};
use armgen_codegen::program::{Module, Trig};
use armgen_codegen::schedule::{Options, Selection};
use armgen_codegen::source::Source;
use armgen_codegen::validate::Places;
use armgen_codegen::{programs, validate, Model, Scalar};
use equations::Determinant;
use serde_json::{json, Value};

/// The functions that a page uses, if the arm has them.
const FUNCTIONS: &[&str] = &[
    "direct_kinematics",
    "link_frames",
    "joint_variables",
    "geometric_jacobian",
    "inertia_matrix",
    "coriolis_matrix",
    "gravity",
    "friction",
    "load_friction",
    "inverse_dynamics",
    "kinetic_energy",
    "potential_energy",
];

/// The page omits an optional function with more operations, and a note names it.
const OPERATIONS: usize = 6000;

/// Functions that the page keeps at any length.
const ALWAYS: &[&str] = &[
    "direct_kinematics",
    "link_frames",
    "joint_variables",
    "geometric_jacobian",
    "inertia_matrix",
    "gravity",
    "inverse_dynamics",
];

/// The reason why a valid description has no page: a log does not match it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Misfit {
    /// The name of the run.
    pub run: String,
    /// The reason, in words.
    pub reason: String,
}

/// The page of the arm in `source` with the runs to play, and all diagnostics of the text.
/// A page exists if and only if no diagnostic is an error.
///
/// # Errors
/// A log has other joints than the arm.
pub fn page(source: &Source, runs: &[Run]) -> Result<(Option<String>, Diagnostics), Misfit> {
    let (valid, mut diagnostics) = validate::read_for(source, Scalar::F64);
    let Some((manipulator, places)) = valid else { return Ok((None, diagnostics)) };
    let joints: Vec<&str> = manipulator.coordinates().iter().map(|coordinate| coordinate.joint.name.as_str()).collect();
    for run in runs {
        let fits = run.log.as_ref().map_or(Ok(()), |log| log.fits(&joints));
        fits.map_err(|reason| Misfit { run: run.name.clone(), reason })?;
    }
    let ends = bodies::further_ends(&manipulator);
    let model = Model::new(manipulator.with_one_end_effector());
    let module = match derived(&model, &places, Selection::ALL, &mut diagnostics) {
        Some(module) => module,
        None => return Ok((None, diagnostics)),
    };
    let cost = cost::table(&module);
    let equations = equations::Equations::new(&model);
    let whole = Whole { cost: &cost, equations: &equations.section(), data: Some(equations.data()), ends, nonce: None };
    let page = whole.page(source, &model, module, &equations.determinant, runs, &diagnostics);
    Ok((Some(page), diagnostics))
}

/// The page in the first of two steps: everything but the equations and the table of costs, which take most of the time.
/// Its script waits for a message from the window around it, what [`rest`] gives. `nonce` marks its script and its style for the
/// policy of that window.
pub fn picture(source: &Source, nonce: &str) -> (Option<String>, Diagnostics) {
    let (valid, mut diagnostics) = validate::read_for(source, Scalar::F64);
    let Some((manipulator, places)) = valid else { return (None, diagnostics) };
    let ends = bodies::further_ends(&manipulator);
    let model = Model::new(manipulator.with_one_end_effector());
    let functions = Selection::named(FUNCTIONS).expect("names of the catalogue");
    let Some(module) = derived(&model, &places, functions, &mut diagnostics) else { return (None, diagnostics) };
    let whole = Whole { cost: document::LATER, equations: document::LATER, data: None, ends, nonce: Some(nonce) };
    let page = whole.page(source, &model, module, &Determinant::without_common_factors(&model), &[], &diagnostics);
    (Some(page), diagnostics)
}

/// The second step, of the arm's model and the programs of all its functions: the content of the sections of equations and costs, and the
/// equations and the factors of the determinant for the script.
pub fn rest(model: &Model, module: &Module) -> Value {
    let equations = equations::Equations::new(model);
    json!({
        "equations": equations.section(),
        "cost": cost::table(module),
        "data": equations.data(),
        "determinant": equations.determinant.factors,
    })
}

/// The programs of functions; `None` after a fault.
fn derived(model: &Model, places: &Places, functions: Selection, diagnostics: &mut Diagnostics) -> Option<Module> {
    let options = Options { trig: Trig::Fast, functions, ..Options::default() };
    programs(model, places, &options).map_err(|fault| diagnostics.push(*fault)).ok()
}

/// What only the second step has.
struct Whole<'w> {
    cost: &'w str,
    equations: &'w str,
    data: Option<Value>,
    /// The end effectors but the first one.
    ends: Vec<Value>,
    nonce: Option<&'w str>,
}

impl Whole<'_> {
    fn page(
        self,
        source: &Source,
        model: &Model,
        mut module: Module,
        determinant: &Determinant,
        runs: &[Run],
        diagnostics: &Diagnostics,
    ) -> String {
        let (description, _) = RobotDescription::parse(source);
        let description = description.unwrap_or_default();
        let left_out = keep_what_is_used(&mut module);
        let text = javascript::print(&module, &Origin::of(source), &Notes::default());
        let rows = rows::rows(source, &description, &model.manipulator);
        let bodies = bodies::bodies(&model.manipulator, &description, diagnostics);
        let mut data = data(&model.manipulator, &description, &rows, bodies, &module, &left_out, determinant, runs);
        data["equations"] = self.data.unwrap_or_default();
        if !self.ends.is_empty() {
            data["ends"] = self.ends.into();
        }
        let script = script::script(&text, !runs.is_empty());
        document::document(&document::Parts {
            model,
            drives: &drives::tables(source, &description, &model.manipulator),
            description: &description,
            rows: &rows,
            warnings: warnings::Warnings::new(source, &description, diagnostics),
            equations: self.equations,
            cost: self.cost,
            logs: (!runs.is_empty()).then(|| (logs::title(runs), logs::section(runs))),
            data: &data,
            script: &script,
            nonce: self.nonce,
        })
    }
}

/// Keeps only the functions that a page uses; returns the names and operations of those that are too long.
fn keep_what_is_used(module: &mut Module) -> Vec<(String, usize)> {
    let mut left_out = Vec::new();
    module.functions.retain(|function| {
        let name = function.name();
        if !FUNCTIONS.contains(&name.as_str()) {
            return false;
        }
        let operations = function.steps.len();
        let kept = operations <= OPERATIONS || ALWAYS.contains(&name.as_str());
        if !kept {
            left_out.push((name, operations));
        }
        kept
    });
    left_out
}

/// The input of the script.
#[allow(clippy::too_many_arguments)]
fn data(
    manipulator: &Manipulator,
    description: &RobotDescription,
    rows: &[rows::Row],
    bodies: Value,
    module: &Module,
    left_out: &[(String, usize)],
    determinant: &Determinant,
    runs: &[Run],
) -> Value {
    let row = |row: &rows::Row, limits: Option<[f64; 2]>| {
        let values = row.denavit_hartenberg.as_ref();
        let mut of_row = json!({
            "name": row.name,
            "type": if row.revolute { "revolute" } else { "prismatic" },
            "dh": values.map(|all| all.each_ref().map(|value| value.number)),
            "before": row.before,
            "axis": row.axis,
            "after": row.after,
            "limits": limits,
        });
        if let Some((parent, start)) = &row.branch {
            of_row["branch"] = json!({ "parent": parent, "start": start });
        }
        of_row
    };
    // Sliders are of coordinates, and their limits those of all joints that move with them.
    let limits = |limits: &Limits| limits.position.as_ref().map(|ends| ends.each_ref().map(Number::to_f64));
    let of_coordinate = |coordinate: Coordinate<'_>| row(&rows[coordinate.index], limits(coordinate.limits));
    let mut data = json!({
        "name": manipulator.name,
        "convention": match rows::convention(description) {
            Convention::Standard => "standard",
            Convention::Modified => "modified",
            Convention::Urdf => "urdf",
        },
        "gravity": module.gravity.each_ref().map(Number::to_f64),
        "gravityIsArgument": module.gravity_is_argument,
        "base": rows::base(manipulator, description),
        "rows": manipulator.coordinates().into_iter().map(of_coordinate).collect::<Vec<_>>(),
        "tip": manipulator.tip.0,
        "tool": bodies::tool(manipulator),
        "bodies": bodies,
        "task": module.task,
        "functions": module.functions.iter().map(|function| function.name()).collect::<Vec<_>>(),
        "leftOut": left_out,
        "determinant": determinant.factors,
        "firstSix": determinant.first_six,
        "runs": logs::data(runs, rows),
    });
    if manipulator.coupling.is_some() {
        data["links"] = rows.iter().map(|of| row(of, of.limits)).collect();
    }
    data
}
