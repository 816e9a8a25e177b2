//! Functions over arrays of NumPy.
//!
//! A call of one state whose arguments are vectors of float64 goes straight to the program. Every other call makes such arrays first: leading
//! axes are states and broadcast.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use armgen_codegen::catalogue::{Length, Quantity};
use armgen_codegen::program::{Cost, Function as Steps, Module};
use armgen_evaluate::{Program, Workspace};
use numpy::{
    PyArray1, PyArray2, PyArray3, PyArrayDyn, PyArrayMethods, PyReadonlyArray1, PyReadonlyArrayDyn, PyUntypedArray,
    PyUntypedArrayMethods,
};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::sync::PyOnceLock;
use pyo3::types::{PyDict, PyFloat, PyString, PyTuple, PyType};

use crate::faults::{guarded, named, refused_for};
use crate::robot::Robot;

/// From so many states on, other threads of Python run meanwhile; with fewer, letting them costs more than the work.
pub(crate) const MANY: usize = 64;

/// The most arguments that a function has.
const ARGUMENTS: usize = 6;

/// A function that is ready to be executed.
pub(crate) struct Derived {
    program: Program<f64>,
    cost: Cost,
    method: &'static str,
    /// The parts of the result: where each begins in a state, and how many entries it has.
    parts: Vec<(usize, usize)>,
    /// What runs that are over have left, for the next ones.
    idle: Mutex<Vec<Room>>,
}

/// What a run writes to.
struct Room {
    workspace: Workspace<f64>,
    result: Vec<f64>,
}

impl Derived {
    pub(crate) fn new(module: &Module, function: &Steps) -> Derived {
        let program: Program<f64> = armgen_evaluate::program(module, function);
        let mut first = 0;
        let part = |shape: &[usize]| {
            let entries = shape.iter().product();
            first += entries;
            (first - entries, entries)
        };
        let parts = program.results().iter().map(|result| result.shape.as_slice()).map(part).collect();
        Derived { cost: Cost::of(function), method: function.method, parts, program, idle: Mutex::default() }
    }

    pub(crate) fn program(&self) -> &Program<f64> {
        &self.program
    }

    fn with_room<R>(&self, work: impl FnOnce(&mut Room) -> R) -> R {
        let idle = || self.idle.lock().unwrap_or_else(PoisonError::into_inner);
        let left = idle().pop();
        let mut room =
            left.unwrap_or_else(|| Room { workspace: self.program.workspace(), result: vec![0.0; self.program.outputs()] });
        let done = work(&mut room);
        idle().push(room);
        done
    }

    /// The result of one state.
    fn one<R>(&self, arguments: &[&[f64]], then: impl FnOnce(&[f64]) -> R) -> R {
        self.with_room(|room| {
            self.program.run(arguments, &mut room.result, &mut room.workspace).expect("lengths of one state");
            then(&room.result)
        })
    }

    /// The results of states, one after the other, in each of the parts. An argument has a vector for each state or one for all.
    fn many(&self, arguments: &[&[f64]], parts: Vec<&mut [f64]>, states: usize, threads: usize) {
        let threads = threads.min(states.div_ceil(MANY)).max(1);
        let chunk = states.div_ceil(threads).div_ceil(MANY) * MANY;
        let mut rest = parts;
        let mut works = Vec::new();
        for first in (0..states).step_by(chunk) {
            let count = chunk.min(states - first);
            let mut own = Vec::with_capacity(rest.len());
            for (part, (_, entries)) in rest.iter_mut().zip(&self.parts) {
                let (head, tail) = std::mem::take(part).split_at_mut(count * entries);
                own.push(head);
                *part = tail;
            }
            works.push((first, count, own));
        }
        let works = Mutex::new(works);
        let next = || works.lock().unwrap_or_else(PoisonError::into_inner).pop();
        on_threads(threads, || {
            while let Some((first, count, own)) = next() {
                self.some(arguments, first, count, own, states);
            }
        });
    }

    /// The same of `count` states from `first` on.
    fn some(&self, arguments: &[&[f64]], first: usize, count: usize, mut parts: Vec<&mut [f64]>, states: usize) {
        let own = |first: usize, count: usize| -> Vec<&[f64]> {
            let given = arguments.iter().zip(self.program.arguments().iter().map(|argument| argument.length));
            let is_whole = |given: &[f64], length: usize| given.len() == states * length;
            given
                .map(|(&given, length)| match is_whole(given, length) {
                    true => &given[first * length..(first + count) * length],
                    false => given,
                })
                .collect()
        };
        self.with_room(|room| {
            if let [part] = parts.as_mut_slice() {
                return self.program.run(&own(first, count), part, &mut room.workspace).expect("lengths of these states");
            }
            let outputs = self.program.outputs();
            let mut all = vec![0.0; MANY.min(count) * outputs];
            for at in (0..count).step_by(MANY) {
                let here = MANY.min(count - at);
                let all = &mut all[..here * outputs];
                self.program.run(&own(first + at, here), all, &mut room.workspace).expect("lengths of these states");
                for (part, &(begin, entries)) in parts.iter_mut().zip(&self.parts) {
                    let rows = part[at * entries..].chunks_exact_mut(entries.max(1));
                    for (row, state) in rows.zip(all.chunks_exact(outputs)) {
                        row.copy_from_slice(&state[begin..begin + entries]);
                    }
                }
            }
        });
    }
}

/// Does a work, which is shared by as many threads, this one among them.
pub(crate) fn on_threads(threads: usize, work: impl Fn() + Sync) {
    std::thread::scope(|scope| {
        // Where there are no more threads, those that there are do the work.
        for _ in 1..threads {
            let _ = std::thread::Builder::new().spawn_scoped(scope, &work);
        }
        work();
    });
}

/// How many threads share a work for which `threads` are asked: 0 is as many as there are processors, and there are no more than these.
pub(crate) fn granted(threads: usize) -> usize {
    // Asking the system takes longer than hundreds of states.
    static PROCESSORS: OnceLock<usize> = OnceLock::new();
    let processors = || *PROCESSORS.get_or_init(|| std::thread::available_parallelism().map_or(1, usize::from));
    match threads {
        0 => processors(),
        1 => 1,
        threads => threads.min(processors()),
    }
}

// A function of an arm over arrays. What is documentation here would hide the one of each function.
#[pyclass(frozen, module = "armgen")]
pub(crate) struct Function {
    robot: Arc<Robot>,
    index: usize,
    /// What it is pickled with.
    owner: Py<PyAny>,
    /// Names and lengths of its arguments.
    arguments: Vec<(&'static str, usize)>,
    shapes: Vec<Vec<usize>>,
    /// The type of several results.
    structure: Option<Py<PyAny>>,
}

impl Function {
    pub(crate) fn new(py: Python<'_>, robot: Arc<Robot>, index: usize, owner: Py<PyAny>) -> PyResult<Function> {
        let (quantity, with) = (robot.functions[index].quantity, robot.functions[index].with);
        let base = if quantity.has_length(Length::BaseParameters) { robot.model.base_count() } else { 0 };
        let sizes = robot.model.sizes_with(base);
        let of_arm = quantity.arguments_of(with, robot.model.manipulator.gravity_is_argument);
        let arguments = of_arm.map(|argument| (argument.name(), argument.length().of(&sizes)));
        let shape = |part: &armgen_codegen::catalogue::ResultPart| part.lengths.iter().map(|length| length.of(&sizes)).collect();
        let structure = match quantity.result {
            [_] => None,
            _ => Some(py.import("armgen")?.getattr("_structures")?.get_item(quantity.name)?.unbind()),
        };
        let (arguments, shapes) = (arguments.collect(), quantity.result.iter().map(shape).collect());
        Ok(Function { robot, index, owner, arguments, shapes, structure })
    }

    fn quantity(&self) -> &'static Quantity {
        self.robot.functions[self.index].quantity
    }

    fn name(&self) -> String {
        self.quantity().function_name(self.robot.functions[self.index].with)
    }

    /// Its program, derived now if it was not before.
    fn derived(&self, py: Python<'_>) -> PyResult<&Derived> {
        if let Some(derived) = self.robot.known(self.index) {
            return Ok(derived);
        }
        py.detach(|| self.robot.derived(self.index)).map_err(|fault| refused_for(py, &self.robot.source, *fault))
    }

    /// One thing for each part of the result; of a single part, the thing itself.
    fn gathered<'py>(&self, py: Python<'py>, mut parts: Vec<Bound<'py, PyAny>>) -> PyResult<Bound<'py, PyAny>> {
        match &self.structure {
            Some(structure) => structure.bind(py).call1(PyTuple::new(py, parts)?),
            None => Ok(parts.remove(0)),
        }
    }

    /// The result if all arguments are contiguous vectors of float64.
    fn of_one_state<'py>(&self, py: Python<'py>, given: &Bound<'py, PyTuple>) -> PyResult<Option<Bound<'py, PyAny>>> {
        let count = self.arguments.len();
        if given.len() != count || count > ARGUMENTS {
            return Ok(None);
        }
        let mut held: [Option<PyReadonlyArray1<'py, f64>>; ARGUMENTS] = [const { None }; ARGUMENTS];
        let exact = array_type(py)?;
        for (i, held) in held.iter_mut().enumerate().take(count) {
            let item = given.get_borrowed_item(i)?;
            if !item.is_exact_instance(exact) {
                return Ok(None);
            }
            let Ok(array) = item.cast::<PyArray1<f64>>() else { return Ok(None) };
            let Ok(array) = array.try_readonly() else { return Ok(None) };
            *held = Some(array);
        }
        let mut slices: [&[f64]; ARGUMENTS] = [&[]; ARGUMENTS];
        for ((slice, held), (_, length)) in slices.iter_mut().zip(&held).zip(&self.arguments) {
            match held.as_ref().map(|array| array.as_slice()) {
                Some(Ok(given)) if given.len() == *length && given.as_ptr().is_aligned() => *slice = given,
                _ => return Ok(None),
            }
        }
        let derived = self.derived(py)?;
        derived
            .one(&slices[..count], |result| {
                if let ([shape], None) = (self.shapes.as_slice(), &self.structure) {
                    return fresh(py, shape, result);
                }
                let mut parts = Vec::with_capacity(self.shapes.len());
                for (shape, &(first, entries)) in self.shapes.iter().zip(&derived.parts) {
                    parts.push(fresh(py, shape, &result[first..first + entries])?);
                }
                self.gathered(py, parts)
            })
            .map(Some)
    }

    /// The arguments by their places or names, and `out` and `threads`.
    fn sorted<'py>(&self, given: &Bound<'py, PyTuple>, named: Option<&Bound<'py, PyDict>>) -> PyResult<Given<'py>> {
        let name = self.name();
        let list = self.arguments.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
        if given.len() > self.arguments.len() {
            return Err(PyTypeError::new_err(format!(
                "{name}({list}) takes {} arguments, not {}",
                self.arguments.len(),
                given.len()
            )));
        }
        let mut arguments: Vec<Option<Bound<'py, PyAny>>> = given.iter().map(Some).collect();
        arguments.resize(self.arguments.len(), None);
        let (mut out, mut threads) = (None, 1);
        for (key, value) in named.into_iter().flatten() {
            let key = key.cast_into::<PyString>()?;
            match (key.to_str()?, self.arguments.iter().position(|(name, _)| key == *name)) {
                (_, Some(place)) if arguments[place].is_none() => arguments[place] = Some(value),
                (key, Some(_)) => return Err(PyTypeError::new_err(format!("{name}({list}): {key} is given twice"))),
                ("out", None) => out = Some(value).filter(|value| !value.is_none()),
                ("threads", None) => {
                    let number: i64 = value.extract()?;
                    threads = usize::try_from(number)
                        .map_err(|_| PyValueError::new_err(format!("threads: 0 or more, not {number}")))?;
                }
                (key, None) => {
                    return Err(PyTypeError::new_err(format!("{name}({list}, *, out, threads) has no argument {key}")))
                }
            }
        }
        let missing = |(argument, (own, _)): (Option<_>, &(&str, usize))| {
            argument.ok_or_else(|| PyTypeError::new_err(format!("{name}({list}): {own} is missing")))
        };
        let arguments = arguments.into_iter().zip(&self.arguments).map(missing).collect::<PyResult<_>>()?;
        Ok(Given { arguments, out, threads })
    }

    /// The result of any arguments.
    fn of_all<'py>(&self, py: Python<'py>, given: Given<'py>) -> PyResult<Bound<'py, PyAny>> {
        let numpy = py.import("numpy")?;
        let mut arrays = Vec::with_capacity(given.arguments.len());
        for (argument, (name, length)) in given.arguments.iter().zip(&self.arguments) {
            arrays.push(array(&numpy, name, *length, argument)?);
        }
        let lead = self.states(&arrays)?;
        let shapes: Vec<Vec<usize>> = self.shapes.iter().map(|shape| [lead.as_slice(), shape].concat()).collect();
        let results = match &given.out {
            Some(out) => self.results_in(&numpy, out, &shapes, &given.arguments)?,
            None => shapes.iter().map(|shape| empty(&numpy, shape)).collect::<PyResult<_>>()?,
        };
        let states = lead.iter().product::<usize>();
        if results.iter().any(|result| result.len() > 0) {
            let mut held: Vec<PyReadonlyArrayDyn<'py, f64>> = Vec::with_capacity(arrays.len());
            for (array, (_, length)) in arrays.into_iter().zip(&self.arguments) {
                let is_whole = array.ndim() == 1 || array.shape()[..array.ndim() - 1] == lead;
                let array = if is_whole { array } else { spread(&numpy, &array, &lead, &[*length])? };
                held.push(array.try_readonly().map_err(|error| PyValueError::new_err(error.to_string()))?);
            }
            let slices = held.iter().map(|array| array.as_slice()).collect::<Result<Vec<_>, _>>()?;
            let mut written = Vec::with_capacity(results.len());
            for result in &results {
                let busy = |_| PyValueError::new_err("out: an array that can be written, and that no other call writes");
                written.push(result.try_readwrite().map_err(busy)?);
            }
            let mut parts = Vec::with_capacity(results.len());
            for part in &mut written {
                parts.push(part.as_slice_mut()?);
            }
            let derived = self.derived(py)?;
            let threads = granted(given.threads);
            if states < MANY {
                derived.many(&slices, parts, states, 1);
            } else {
                py.detach(|| derived.many(&slices, parts, states, threads));
            }
        }
        let is_number = |shape: &[usize]| shape.is_empty() && given.out.is_none();
        let parts = results.into_iter().map(|result| match is_number(result.shape()) {
            true => result.get_item(PyTuple::empty(py))?.call_method0("__float__"),
            false => Ok(result.into_any()),
        });
        self.gathered(py, parts.collect::<PyResult<_>>()?)
    }

    /// The axes of states, broadcast.
    fn states(&self, arrays: &[Bound<'_, PyArrayDyn<f64>>]) -> PyResult<Vec<usize>> {
        let leads = arrays.iter().map(|array| &array.shape()[..array.ndim() - 1]);
        let all = broadcast(&self.arguments.iter().map(|(name, _)| *name).zip(leads).collect::<Vec<_>>())?;
        let entries = self.shapes.iter().map(|shape| shape.iter().product::<usize>()).sum::<usize>() * size_of::<f64>();
        let bytes = all.iter().try_fold(entries, |product, axis| product.checked_mul(*axis));
        match bytes.filter(|&bytes| bytes <= isize::MAX as usize) {
            Some(_) => Ok(all),
            None => Err(PyValueError::new_err(format!("{} states are more than an address can count", axes(&all)))),
        }
    }

    /// The arrays of `out`, one for each part.
    fn results_in<'py>(
        &self,
        numpy: &Bound<'py, PyModule>,
        out: &Bound<'py, PyAny>,
        shapes: &[Vec<usize>],
        arguments: &[Bound<'py, PyAny>],
    ) -> PyResult<Vec<Bound<'py, PyArrayDyn<f64>>>> {
        let given: Vec<Bound<'py, PyAny>> = match &self.structure {
            None => vec![out.clone()],
            Some(_) => {
                let wrong = |_| PyTypeError::new_err(format!("out: a tuple of {} arrays", shapes.len()));
                out.cast::<PyTuple>().map_err(wrong)?.iter().collect()
            }
        };
        if given.len() != shapes.len() {
            return Err(PyValueError::new_err(format!("out: {} arrays, not {}", shapes.len(), given.len())));
        }
        let mut results: Vec<Bound<'py, PyArrayDyn<f64>>> = Vec::with_capacity(given.len());
        for (array, shape) in given.into_iter().zip(shapes) {
            let Ok(array) = array.cast_into::<PyArrayDyn<f64>>() else {
                return Err(PyTypeError::new_err("out: an array of float64"));
            };
            if array.shape() != shape {
                return Err(PyValueError::new_err(format!("out: the shape is {}, not {}", axes(shape), axes(array.shape()))));
            }
            if !is_plain(&array) {
                return Err(PyValueError::new_err("out: the array is not C-contiguous"));
            }
            let others = arguments.iter().chain(results.iter().map(Bound::as_any));
            for other in others.filter(|other| other.is_instance_of::<PyUntypedArray>()) {
                if numpy.getattr("may_share_memory")?.call1((&array, other))?.is_truthy()? {
                    return Err(PyValueError::new_err("out: the array overlaps an argument or another one"));
                }
            }
            results.push(array);
        }
        Ok(results)
    }
}

/// What a call is given.
struct Given<'py> {
    arguments: Vec<Bound<'py, PyAny>>,
    out: Option<Bound<'py, PyAny>>,
    threads: usize,
}

#[pymethods]
impl Function {
    #[pyo3(signature = (*given, **named))]
    fn __call__<'py>(
        &self,
        py: Python<'py>,
        given: &Bound<'py, PyTuple>,
        named: Option<&Bound<'py, PyDict>>,
    ) -> PyResult<Bound<'py, PyAny>> {
        guarded(py, || {
            if named.is_none() {
                if let Some(result) = self.of_one_state(py, given)? {
                    return Ok(result);
                }
            }
            self.of_all(py, self.sorted(given, named)?)
        })
    }

    #[getter]
    fn __name__(&self) -> String {
        self.name()
    }

    #[getter]
    fn __doc__(&self) -> String {
        let quantity = self.quantity();
        let words = &quantity.documentation;
        let list: Vec<&str> = self.arguments.iter().map(|(name, _)| *name).collect();
        let mut text = format!("{}({}, *, out=None, threads=1)\n\n", self.name(), list.join(", "));
        text += &format!("{}\n\n{}\n\n", words.title, words.formula);
        let with = self.robot.functions[self.index].with;
        for argument in quantity.arguments_of(with, self.robot.model.manipulator.gravity_is_argument) {
            text += &format!("{}: {}\n", argument.name(), argument.meaning());
        }
        text += &format!("Returns {}\n", words.result);
        for part in quantity.result.iter().filter(|_| self.structure.is_some()) {
            text += &format!("{}: {} {}\n", part.name, part.meaning[0], part.meaning[1]);
        }
        text += "Leading axes of the arguments are states.\n";
        text.replace("{PARAMETER_NAMES}", "parameter_names").replace(['{', '}'], "`")
    }

    /// The names of its arguments.
    #[getter]
    fn arguments<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        PyTuple::new(py, self.arguments.iter().map(|(name, _)| *name))
    }

    /// The shape of its result for one state; of several parts, a named tuple of them.
    #[getter]
    fn shape<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let shapes = self.shapes.iter().map(|shape| Ok(PyTuple::new(py, shape)?.into_any()));
        self.gathered(py, shapes.collect::<PyResult<_>>()?)
    }

    /// The unit of the entries of its result; of several parts, a named tuple of them.
    #[getter]
    fn unit<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.gathered(py, self.quantity().result.iter().map(|part| PyString::new(py, part.unit).into_any()).collect())
    }

    /// How many operations it takes, as `armgen count` counts them. Derives the function.
    #[getter]
    fn operations<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let Cost { mul, add, div, neg, sincos, exp, .. } = guarded(py, || self.derived(py))?.cost;
        let counts = PyDict::new(py);
        for (name, count) in [("mul", mul), ("add", add), ("div", div), ("neg", neg), ("sincos", sincos), ("exp", exp)] {
            counts.set_item(name, count)?;
        }
        Ok(counts)
    }

    /// How it was derived. Derives the function.
    #[getter]
    fn derivation(&self, py: Python<'_>) -> PyResult<&'static str> {
        Ok(guarded(py, || self.derived(py))?.method)
    }

    fn __repr__(&self) -> String {
        let list: Vec<&str> = self.arguments.iter().map(|(name, _)| *name).collect();
        format!("<armgen.Function {}({}) of {}>", self.name(), list.join(", "), self.robot.model.manipulator.name)
    }

    fn __reduce__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let restore = py.import("armgen")?.getattr("_function_of")?;
        Ok((restore, (self.owner.bind(py), self.name())).into_pyobject(py)?.into_any())
    }

    fn __copy__(slf: Py<Self>) -> Py<Self> {
        slf
    }

    fn __deepcopy__(slf: Py<Self>, _memo: &Bound<'_, PyAny>) -> Py<Self> {
        slf
    }
}

/// `numpy.ndarray`
fn array_type(py: Python<'_>) -> PyResult<&Bound<'_, PyType>> {
    static TYPE: PyOnceLock<Py<PyType>> = PyOnceLock::new();
    let known = TYPE.get_or_try_init(py, || {
        py.import("numpy")?.getattr("ndarray")?.cast_into::<PyType>().map(Bound::unbind).map_err(PyErr::from)
    });
    known.map(|known| known.bind(py))
}

/// A new array with these entries; of no axes, a float.
pub(crate) fn fresh<'py>(py: Python<'py>, shape: &[usize], entries: &[f64]) -> PyResult<Bound<'py, PyAny>> {
    match *shape {
        [] => Ok(PyFloat::new(py, entries[0]).into_any()),
        [_] => Ok(PyArray1::from_slice(py, entries).into_any()),
        [rows, columns] => {
            let array = PyArray2::<f64>::zeros(py, [rows, columns], false);
            array.readwrite().as_slice_mut()?.copy_from_slice(entries);
            Ok(array.into_any())
        }
        [list, rows, columns] => {
            let array = PyArray3::<f64>::zeros(py, [list, rows, columns], false);
            array.readwrite().as_slice_mut()?.copy_from_slice(entries);
            Ok(array.into_any())
        }
        _ => Err(named(py, "InternalError", ("a result of more than three axes",))),
    }
}

/// An array whose entries are still to be written.
pub(crate) fn empty<'py>(numpy: &Bound<'py, PyModule>, shape: &[usize]) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    Ok(numpy.getattr("empty")?.call1((PyTuple::new(numpy.py(), shape)?,))?.cast_into()?)
}

/// Whether the entries stand one after the other, where a float may stand.
fn is_plain(array: &Bound<'_, PyArrayDyn<f64>>) -> bool {
    array.is_c_contiguous() && array.data().is_aligned()
}

/// The axes of states of arguments, broadcast.
pub(crate) fn broadcast(leads: &[(&str, &[usize])]) -> PyResult<Vec<usize>> {
    let dimensions = leads.iter().map(|(_, lead)| lead.len()).max().unwrap_or_default();
    let mut all = vec![1; dimensions];
    for (_, lead) in leads {
        for (own, common) in lead.iter().rev().zip(all.iter_mut().rev()) {
            match (*own, *common) {
                (own, common) if own == common => {}
                (1, _) => {}
                (own, 1) => *common = own,
                _ => {
                    let list: Vec<String> = leads.iter().map(|(name, lead)| format!("{name} {}", axes(lead))).collect();
                    return Err(PyValueError::new_err(format!("the axes of states do not go together: {}", list.join(", "))));
                }
            }
        }
    }
    Ok(all)
}

/// An argument as an array of float64, of which nothing is lost but digits beyond those of a float. A number is an array of one entry, and is told.
pub(crate) fn real<'py>(
    numpy: &Bound<'py, PyModule>,
    name: &str,
    given: &Bound<'py, PyAny>,
) -> PyResult<(Bound<'py, PyArrayDyn<f64>>, bool)> {
    let py = numpy.py();
    let plain = given.is_exact_instance(array_type(py)?).then(|| given.cast::<PyArrayDyn<f64>>().ok()).flatten();
    if let Some(array) = plain.filter(|array| is_plain(array) && array.ndim() > 0) {
        return Ok((array.clone(), false));
    }
    // NumPy would drop the mask.
    if given.hasattr("mask")? && given.hasattr("filled")? {
        return Err(PyTypeError::new_err(format!("{name}: a masked array; fill it first")));
    }
    let array = numpy.getattr("asarray")?.call1((given,))?;
    let kind = array.getattr("dtype")?;
    if !"biuf".contains(kind.getattr("kind")?.extract::<char>()?) {
        return Err(PyTypeError::new_err(format!("{name}: real numbers, not {}", kind.str()?)));
    }
    let options = PyDict::new(py);
    options.set_item("dtype", numpy.getattr("float64")?)?;
    options.set_item("requirements", "CA")?;
    // What has no axis has one behind `require`.
    let is_number = array.cast::<PyUntypedArray>()?.ndim() == 0;
    Ok((numpy.getattr("require")?.call((array,), Some(&options))?.cast_into()?, is_number))
}

/// The same of vectors of a length.
pub(crate) fn array<'py>(
    numpy: &Bound<'py, PyModule>,
    name: &str,
    length: usize,
    given: &Bound<'py, PyAny>,
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let (array, is_number) = real(numpy, name, given)?;
    match array.shape().last() {
        Some(&last) if last == length && !is_number => Ok(array),
        Some(&last) if !is_number => {
            let is_turned = array.shape() == [length, last] && !matches!(name, "pose" | "rotation");
            let hint = if is_turned { "; states go in the leading axes: transpose it" } else { "" };
            Err(PyValueError::new_err(format!("{name}: the last axis has {last} entries, not {length}{hint}")))
        }
        _ => Err(PyValueError::new_err(format!("{name}: a number, not a vector of {length}"))),
    }
}

/// An argument with its entries for each state, `shape` of them.
pub(crate) fn spread<'py>(
    numpy: &Bound<'py, PyModule>,
    array: &Bound<'py, PyArrayDyn<f64>>,
    lead: &[usize],
    shape: &[usize],
) -> PyResult<Bound<'py, PyArrayDyn<f64>>> {
    let shape = PyTuple::new(numpy.py(), [lead, shape].concat())?;
    let spread = numpy.getattr("broadcast_to")?.call1((array, shape))?;
    Ok(numpy.getattr("ascontiguousarray")?.call1((spread,))?.cast_into()?)
}

/// Axes as Python writes a tuple.
pub(crate) fn axes(axes: &[usize]) -> String {
    match axes {
        [one] => format!("({one},)"),
        axes => format!("({})", axes.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")),
    }
}
