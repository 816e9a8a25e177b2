//! From a text to an arm, its facts and its texts.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, OnceLock};

use armgen_codegen::catalogue::{self, Quantity};
use armgen_codegen::derive::parameters::nominal;
use armgen_codegen::diagnostic::{AnyCode, Colour, Diagnostic, Diagnostics, Severity};
use armgen_codegen::emit::Language;
use armgen_codegen::exact::{Number, Polynomial};
use armgen_codegen::kinds::JointKind;
use armgen_codegen::manipulator::Manipulator;
use armgen_codegen::schedule::{Options, Selection};
use armgen_codegen::source::Source;
use armgen_codegen::validate::{self, Places};
use armgen_codegen::{Model, Scalar, Trig};
use armgen_evaluate::{Redundancy, Solver};
use armgen_verify::certificate::report::FunctionReport;
use armgen_verify::read::reader::ModuleText;
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyTuple};

use crate::faults::{guarded, listed, refused, refused_for};
use crate::numbers::{Derived, Function};
use crate::postures::{self, Target};
use crate::texts;

/// A valid arm, with the programs of its functions as far as they are derived.
pub(crate) struct Robot {
    pub(crate) source: Source,
    pub(crate) model: Model,
    places: Places,
    pub(crate) functions: Vec<Slot>,
    absent: Vec<(String, String)>,
    /// The end effectors: one, or those with names in the order of the description.
    ends: Vec<Arc<EndEffector>>,
}

/// An end effector and what finds its postures.
pub(crate) struct EndEffector {
    /// The arm; of a named end effector the part that moves it.
    pub(crate) arm: Manipulator,
    /// What finds the postures, made at the first use; the reason where nothing does.
    solver: OnceLock<Result<Solver<f64>, String>>,
}

impl EndEffector {
    fn all(arm: &Manipulator) -> Vec<Arc<EndEffector>> {
        let of = |arm| Arc::new(EndEffector { arm, solver: OnceLock::new() });
        match arm.tips.len() {
            0 => vec![of(arm.clone())],
            count => (0..count).map(|tip| of(arm.arm_to(tip))).collect(),
        }
    }

    /// What finds its postures, made now if it was not before.
    pub(crate) fn solver(&self, py: Python<'_>) -> PyResult<&Solver<f64>> {
        let make = || self.solver.get_or_init(|| armgen_evaluate::solver(&self.arm));
        let found = self.solver.get().unwrap_or_else(|| py.detach(make));
        found.as_ref().map_err(|reason| PyValueError::new_err(format!("there is no `inverse_kinematics` of this arm: {reason}")))
    }

    /// What is given to it beside a pose: the name of a joint, or "swivel".
    pub(crate) fn redundancy(&self, py: Python<'_>) -> PyResult<Option<&str>> {
        let name = |redundancy: &Redundancy<f64>| match redundancy {
            Redundancy::Joint(given) => self.arm.joints[self.arm.path_to(self.arm.tip.index())[given.joint]].name.as_str(),
            Redundancy::Swivel => "swivel",
        };
        self.solver(py).map(|solver| solver.of().redundancy.as_ref().map(name))
    }

    /// The lower and the upper end of a coordinate's range, infinite where there is none.
    pub(crate) fn position_limits(&self, coordinate: usize) -> [f64; 2] {
        position_limits(&self.arm, coordinate)
    }
}

fn position_limits(arm: &Manipulator, coordinate: usize) -> [f64; 2] {
    let limits = arm.coordinates()[coordinate].limits.position.as_ref();
    limits.map_or([f64::NEG_INFINITY, f64::INFINITY], |limits| limits.each_ref().map(Number::to_f64))
}

/// A function that the arm has.
pub(crate) struct Slot {
    pub(crate) quantity: &'static Quantity,
    pub(crate) with: bool,
    /// Its program; a fault, if a number in it does not fit a float.
    derived: OnceLock<Result<Derived, Box<Diagnostic>>>,
}

impl Robot {
    fn new(source: Source, manipulator: Manipulator, places: Places) -> Robot {
        let model = Model::new(manipulator);
        let (mut functions, mut absent) = (Vec::new(), Vec::new());
        for (quantity, with) in catalogue::functions_of(&model.manipulator.tips) {
            match quantity.absence(&model, with) {
                Some(reason) => absent.push((quantity.function_name(with), reason)),
                None => functions.push(Slot { quantity, with, derived: OnceLock::new() }),
            }
        }
        let ends = EndEffector::all(&model.manipulator);
        Robot { source, model, places, functions, absent, ends }
    }

    /// A function, derived now if it was not before.
    pub(crate) fn derived(&self, index: usize) -> Result<&Derived, Box<Diagnostic>> {
        let slot = &self.functions[index];
        let made = slot.derived.get_or_init(|| {
            let module = self.module(vec![slot.quantity.function_name(slot.with)])?;
            Ok(Derived::new(&module, module.functions.first().expect("the arm has this function")))
        });
        made.as_ref().map_err(Clone::clone)
    }

    /// The same if it was derived before.
    pub(crate) fn known(&self, index: usize) -> Option<&Derived> {
        self.functions[index].derived.get()?.as_ref().ok()
    }

    /// The end effector that is asked for, by the name of one that has a name.
    fn end(&self, tip: Option<&str>) -> PyResult<&Arc<EndEffector>> {
        let tips = &self.model.manipulator.tips;
        let Some(name) = tip else {
            if tips.is_empty() {
                return Ok(&self.ends[0]);
            }
            let names: Vec<String> = tips.iter().map(|tip| format!("`{}inverse_kinematics`", tip.prefix())).collect();
            return Err(PyValueError::new_err(format!(
                "there is no `inverse_kinematics` of this arm: each end effector has its own, {}",
                names.join(", ")
            )));
        };
        let place = tips.iter().position(|tip| tip.name == name);
        place.map(|place| &self.ends[place]).ok_or_else(|| PyValueError::new_err(format!("there is no end effector `{name}`")))
    }

    /// The functions of these names, which the arm has.
    fn module(&self, names: Vec<String>) -> Result<armgen_codegen::program::Module, Box<Diagnostic>> {
        let functions = Selection::named(names).expect("names of the catalogue");
        let options = Options { trig: Trig::Fast, functions, ..Options::default() };
        armgen_codegen::programs(&self.model, &self.places, &options)
    }
}

/// A valid arm.
#[pyclass(frozen, module = "armgen._native")]
pub(crate) struct Arm {
    robot: Arc<Robot>,
}

/// The tables of parameters: names and nominal values.
type Parameters = (Vec<String>, Vec<f64>);

#[pymethods]
impl Arm {
    /// What the description says, by the names of attributes.
    #[getter]
    fn facts<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let arm = &self.robot.model.manipulator;
        let number = |value: &Polynomial| nominal(arm, value).to_f64();
        let limit = |value: &Option<Number>| value.as_ref().map_or(f64::INFINITY, Number::to_f64);
        let joints = &arm.joints;
        let facts = PyDict::new(py);
        facts.set_item("name", &arm.name)?;
        facts.set_item("dof", arm.dof())?;
        let coordinates = arm.coordinates();
        facts.set_item("joint_names", PyTuple::new(py, coordinates.iter().map(|of| &of.joint.name))?)?;
        facts.set_item("revolute", coordinates.iter().map(|of| of.joint.kind == JointKind::Revolute).collect::<Vec<_>>())?;
        let positions = (0..coordinates.len()).map(|joint| position_limits(arm, joint).to_vec());
        facts.set_item("position_limits", positions.collect::<Vec<_>>())?;
        let limits = coordinates.iter().map(|of| &of.limits);
        facts.set_item("velocity_limits", limits.clone().map(|own| limit(&own.velocity)).collect::<Vec<_>>())?;
        facts.set_item("effort_limits", limits.clone().map(|own| limit(&own.effort)).collect::<Vec<_>>())?;
        facts.set_item("acceleration_limits", limits.clone().map(|own| limit(&own.acceleration)).collect::<Vec<_>>())?;
        facts.set_item("jerk_limits", limits.map(|own| limit(&own.jerk)).collect::<Vec<_>>())?;
        facts.set_item("task", PyTuple::new(py, arm.task.iter().map(|row| row.name()))?)?;
        facts.set_item("gravity_vector", arm.gravity.each_ref().map(number).to_vec())?;
        let rotors = joints.iter().filter_map(|joint| joint.motor.as_ref()).map(|motor| &motor.mass);
        let links = joints.iter().flat_map(|joint| &joint.link).map(|part| &part.body.mass);
        let mass = links.chain(rotors).fold(Number::zero(), |sum, mass| &sum + &nominal(arm, mass));
        facts.set_item("mass", mass.to_f64())?;
        Ok(facts)
    }

    /// Names and nominal values of the parameters.
    #[getter]
    fn parameters(&self) -> Parameters {
        table(&self.robot.model.parameters.entries)
    }

    /// Names and nominal values of the base parameters.
    #[getter]
    fn base_parameters(&self, py: Python<'_>) -> PyResult<Parameters> {
        guarded(py, || Ok(py.detach(|| table(self.robot.model.base_parameters().map_or(&[][..], |vector| &vector.entries[..])))))
    }

    /// The text of the description.
    #[getter]
    fn text(&self) -> &str {
        self.robot.source.text()
    }

    /// The functions that the arm has, in the order of the catalogue. `robot` is what [`Function`] pickles.
    fn functions(&self, py: Python<'_>, robot: Py<PyAny>) -> PyResult<Vec<Function>> {
        let of = |index| Function::new(py, self.robot.clone(), index, robot.clone_ref(py));
        (0..self.robot.functions.len()).map(of).collect()
    }

    /// The functions that it does not have, and why.
    #[getter]
    fn absent(&self) -> Vec<(String, String)> {
        self.robot.absent.clone()
    }

    /// A quantity as `armgen show` writes it, as `text`, `latex` or `json`.
    fn shown(
        &self,
        py: Python<'_>,
        quantity: &str,
        symbolic: bool,
        form: Option<&str>,
        digits: Option<u8>,
        format: &str,
    ) -> PyResult<String> {
        let model = &self.robot.model;
        let made = guarded(py, || Ok(py.detach(|| texts::shown(model, quantity, symbolic, form, digits, format))))?;
        made.map_err(PyValueError::new_err)
    }

    /// The page.
    fn page(&self, py: Python<'_>) -> PyResult<Option<String>> {
        guarded(py, || Ok(py.detach(|| texts::page(&self.robot.source))))
    }

    /// The summary of `armgen check`.
    fn check(&self, py: Python<'_>, allow: Vec<String>, full: bool) -> PyResult<Option<String>> {
        guarded(py, || Ok(py.detach(|| armgen_texts::summary::of(&self.robot.source, &allow, full))))
    }

    /// The files of `armgen generate` with these options, by their names.
    fn generate(&self, py: Python<'_>, options: Vec<String>) -> PyResult<BTreeMap<String, String>> {
        let made = guarded(py, || Ok(py.detach(|| armgen_commands::generated(&self.robot.source, options))))?;
        made.map(BTreeMap::from_iter).map_err(PyValueError::new_err)
    }

    /// The names of the end effectors, the beginnings of the names of their functions, and the coordinates that move each; none where there is
    /// one without a name.
    #[getter]
    fn tips(&self) -> Vec<(String, String, Vec<usize>)> {
        let arm = &self.robot.model.manipulator;
        arm.tips.iter().map(|tip| (tip.name.clone(), tip.prefix(), arm.coordinates_of(tip.joint.index()))).collect()
    }

    /// All postures at a pose or at its position and rotation; at arrays of them lists of these. `tip`: a named end effector.
    #[pyo3(signature = (pose, redundancy, position, rotation, threads, tip))]
    #[allow(clippy::too_many_arguments)]
    fn inverse_kinematics<'py>(
        &self,
        py: Python<'py>,
        pose: Option<Bound<'py, PyAny>>,
        redundancy: Option<Bound<'py, PyAny>>,
        position: Option<Bound<'py, PyAny>>,
        rotation: Option<Bound<'py, PyAny>>,
        threads: i64,
        tip: Option<&str>,
    ) -> PyResult<Bound<'py, PyAny>> {
        guarded(py, || postures::solved(py, self.robot.end(tip)?, Target { pose, position, rotation }, redundancy, threads))
    }

    /// What is given to it beside a pose: the name of a joint, or "swivel". Without inverse kinematics there is nothing to give.
    fn redundancy(&self, py: Python<'_>, tip: Option<&str>) -> PyResult<Option<&str>> {
        guarded(py, || Ok(self.robot.end(tip).and_then(|end| end.redundancy(py)).ok().flatten()))
    }

    /// The redundancy of a posture, of an array of postures an array.
    fn inverse_kinematics_redundancy<'py>(
        &self,
        py: Python<'py>,
        q: Bound<'py, PyAny>,
        tip: Option<&str>,
    ) -> PyResult<Bound<'py, PyAny>> {
        guarded(py, || postures::redundancy_of(py, self.robot.end(tip)?, &q))
    }

    /// What the checker finds of a module, or of the functions as they are executed here: the first fault, and of each function its name, numbers of
    /// points in prime fields and of rational points, and log2 of the odds of a miss.
    fn verified(&self, py: Python<'_>, text: Option<&str>, language: &str) -> PyResult<Verified> {
        let Some(language) = Language::ALL.into_iter().find(|known| known.name() == language) else {
            let known = Language::ALL.map(Language::name).join("`, `");
            return Err(PyValueError::new_err(format!("language: one of `{known}`, not `{language}`")));
        };
        let robot = &*self.robot;
        let report = guarded(py, || {
            Ok(py.detach(|| match text {
                Some(text) => Ok(armgen_certify::verify(&robot.source, ModuleText { language, text }, None)),
                None => {
                    let derived = (0..robot.functions.len()).map(|index| robot.derived(index));
                    let derived = derived.collect::<Result<Vec<_>, _>>()?;
                    let programs: Vec<_> = derived.into_iter().map(Derived::program).collect();
                    Ok(armgen_certify::verify_executed(&robot.source, &programs))
                }
            }))
        })?;
        let report = report.map_err(|fault: Box<Diagnostic>| refused_for(py, &robot.source, *fault))?;
        let fault = match report.first_fault() {
            None if report.functions.is_empty() => Some("there is no function".to_owned()),
            fault => fault,
        };
        let of = |one: &FunctionReport| (one.name.clone(), one.points, one.exact_points, one.log2_odds);
        Ok((fault, report.functions.iter().map(of).collect()))
    }

    /// Derives functions at the same time; all that the arm has if none is named.
    fn prepare(&self, py: Python<'_>, names: Vec<String>) -> PyResult<()> {
        let robot = &*self.robot;
        let chosen = Selection::named(&names).map_err(|unknown| PyValueError::new_err(unknown.to_string()))?;
        let unknown = chosen.unknown_to(&robot.model.manipulator.tips).into_iter().map(|absent| (absent.function, absent.reason));
        let absent = robot.absent.iter().filter(|(name, _)| names.contains(name)).cloned();
        if let Some((name, reason)) = unknown.chain(absent).next() {
            return Err(PyValueError::new_err(format!("there is no `{name}` of this arm: {reason}")));
        }
        let is_wanted = |slot: &&Slot| {
            let name = slot.quantity.function_name(slot.with);
            slot.derived.get().is_none() && (names.is_empty() || names.contains(&name))
        };
        let wanted: Vec<&Slot> = robot.functions.iter().filter(is_wanted).collect();
        if wanted.is_empty() {
            return Ok(());
        }
        let done = guarded(py, || {
            Ok(py.detach(|| {
                let module = robot.module(wanted.iter().map(|slot| slot.quantity.function_name(slot.with)).collect())?;
                for slot in &wanted {
                    let own = |function: &&armgen_codegen::program::Function| {
                        function.quantity == slot.quantity && function.with_parameters == slot.with
                    };
                    let function = module.functions.iter().find(own).expect("the arm has this function");
                    // Another thread may have been faster, with the same program.
                    let _ = slot.derived.set(Ok(Derived::new(&module, function)));
                }
                Ok(())
            }))
        })?;
        done.map_err(|fault: Box<Diagnostic>| refused_for(py, &robot.source, *fault))
    }
}

/// The first fault that the checker finds, and the functions that it has looked at.
type Verified = (Option<String>, Vec<(String, usize, usize, f64)>);

fn table(entries: &[catalogue::Parameter]) -> Parameters {
    entries.iter().map(|parameter| (parameter.name.clone(), parameter.nominal.to_f64())).unzip()
}

/// What was read: the arm, the text with all that it includes, the warnings as objects and as the program shows them, and of an import its
/// report as JSON and in sentences.
type Read<'py> = (Arm, String, Bound<'py, PyTuple>, String, Option<String>, Vec<String>);

/// What is made of a text: the options of the package, checked there as far as their types go.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Asked {
    base: Option<String>,
    /// The link of the only end effector, or the links of several with their names.
    tip: Option<String>,
    tips: Vec<(Option<String>, String)>,
    all: bool,
    lock: Vec<(String, String)>,
    name: Option<String>,
    snap: f64,
    massless: bool,
    inertia_as_written: bool,
    strict: bool,
    allow: Vec<String>,
}

/// The arm of a text: a description, a URDF or a MuJoCo model. `folder` has the files that a model includes; `made` is the name of the
/// description that an import makes.
#[pyfunction]
pub(crate) fn read<'py>(
    py: Python<'py>,
    name: &str,
    text: &str,
    folder: Option<PathBuf>,
    made: &str,
    asked: Asked,
) -> PyResult<Read<'py>> {
    let is_of_import = |kind: &&String| {
        let kinds = armgen_import::Code::ALL.iter().map(|&code| AnyCode::from(code));
        kinds.filter(|code| code.severity() == Severity::Warning).any(|code| code.name() == kind.as_str())
    };
    if let Some(unknown) = asked.allow.iter().filter(|kind| !is_of_import(kind)).find_map(|kind| validate::warning(kind).err()) {
        return Err(PyValueError::new_err(format!("allow: {unknown}")));
    }
    if asked.name.as_ref().is_some_and(|name| !validate::is_rust_name(name)) {
        return Err(PyValueError::new_err("name: letters, digits and `_`, a letter first"));
    }
    let source = Source::new(name, text);
    let (given, source, warnings, mut shown, report, notes) = match is_xml(source.text()) {
        false => (source.text().to_owned(), source, PyTuple::empty(py), String::new(), None, Vec::new()),
        true => {
            let (imported, source, mut found) = guarded(py, || Ok(py.detach(|| imported(&source, folder, &asked))))?;
            found.allow(&asked.allow);
            let is_refused = asked.strict && !found.is_empty();
            let Some(imported) = imported.filter(|_| !is_refused) else { return Err(refused(py, &source, &found)) };
            let (report, notes) = (imported.report.to_json(), imported.report.short_lines().to_vec());
            let warnings = (listed(py, &source, &found)?, found.render(&source, Colour::Never));
            (source.text().to_owned(), Source::new(made, imported.yaml), warnings.0, warnings.1, Some(report), notes)
        }
    };
    let (valid, mut found) = guarded(py, || Ok(py.detach(|| validate::read_for(&source, Scalar::F64))))?;
    found.allow(&asked.allow);
    let is_refused = asked.strict && !found.is_empty();
    let Some((manipulator, places)) = valid.filter(|_| !is_refused) else { return Err(refused(py, &source, &found)) };
    let warnings = warnings.add(listed(py, &source, &found)?)?.cast_into::<PyTuple>()?;
    shown += &found.render(&source, Colour::Never);
    let robot = guarded(py, || Ok(py.detach(|| Robot::new(source, manipulator, places))))?;
    Ok((Arm { robot: Arc::new(robot) }, given, warnings, shown, report, notes))
}

/// Whether a text is to be imported.
fn is_xml(text: &str) -> bool {
    text.trim_start().starts_with('<')
}

/// The arm of a URDF or a MuJoCo model, the text with all that it includes, and what there is to say of it.
fn imported(source: &Source, folder: Option<PathBuf>, asked: &Asked) -> (Option<armgen_import::Imported>, Source, Diagnostics) {
    let beside = |path: &str| match &folder {
        Some(folder) => armgen_import::build_script::beside(folder, path),
        None => Err("a text is in no folder: load the file of the model".to_owned()),
    };
    let source = match armgen_import::included(source, &beside) {
        Ok(source) => source,
        Err(fault) => {
            let mut diagnostics = Diagnostics::new();
            diagnostics.push(*fault);
            return (None, source.clone(), diagnostics);
        }
    };
    let options = armgen_import::Options {
        base: asked.base.clone(),
        tip: asked.tip.clone(),
        tips: asked.tips.clone(),
        all: asked.all,
        lock: asked.lock.clone(),
        name: asked.name.clone(),
        snap: asked.snap,
        massless: asked.massless,
        inertia_as_written: asked.inertia_as_written,
        ..armgen_import::Options::default()
    };
    let (imported, diagnostics) = armgen_import::import(&source, &options);
    (imported, source, diagnostics)
}
