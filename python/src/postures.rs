//! All postures at a pose, and at arrays of poses.

use std::sync::{Arc, Mutex, PoisonError};

use armgen_evaluate::{Postures as Found, Redundancy, Verdict};
use numpy::{PyArray1, PyArray2, PyArrayDyn, PyArrayMethods, PyReadonlyArray2, PyReadonlyArrayDyn, PyUntypedArrayMethods};
use pyo3::exceptions::{PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyList, PyTuple};

use crate::faults::guarded;
use crate::numbers::{array, axes, broadcast, fresh, granted, on_threads, real, spread, MANY};
use crate::robot::EndEffector;

/// Where the end effector is to be, as it is given: a pose, or its parts.
pub(crate) struct Target<'py> {
    pub(crate) pose: Option<Bound<'py, PyAny>>,
    pub(crate) position: Option<Bound<'py, PyAny>>,
    pub(crate) rotation: Option<Bound<'py, PyAny>>,
}

/// An argument as an array, and its axes of states.
struct Part<'py> {
    name: &'static str,
    array: Bound<'py, PyArrayDyn<f64>>,
    lead: Vec<usize>,
    shape: &'static [usize],
}

impl<'py> Part<'py> {
    fn new(
        numpy: &Bound<'py, PyModule>,
        name: &'static str,
        shape: &'static [usize],
        given: &Bound<'py, PyAny>,
    ) -> PyResult<Part<'py>> {
        let array = match shape.last() {
            Some(last) => array(numpy, name, *last, given)?,
            None => {
                let (array, is_number) = real(numpy, name, given)?;
                let lead = if is_number { Vec::new() } else { array.shape().to_vec() };
                return Ok(Part { name, array, lead, shape });
            }
        };
        match array.shape().strip_suffix(shape).map(<[usize]>::to_vec) {
            Some(lead) => Ok(Part { name, array, lead, shape }),
            None => Err(PyValueError::new_err(format!("{name}: the last axes are {}, not {}", axes(array.shape()), axes(shape)))),
        }
    }

    /// Its entries, for each of the states.
    fn over(self, numpy: &Bound<'py, PyModule>, lead: &[usize]) -> PyResult<PyReadonlyArrayDyn<'py, f64>> {
        let array = if self.lead == lead { self.array } else { spread(numpy, &self.array, lead, self.shape)? };
        array.try_readonly().map_err(|error| PyValueError::new_err(error.to_string()))
    }
}

/// What a rotation is where none is asked for.
const NO_TURN: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

/// The postures at a pose; at an array of poses lists of them.
pub(crate) fn solved<'py>(
    py: Python<'py>,
    end: &Arc<EndEffector>,
    target: Target<'py>,
    redundancy: Option<Bound<'py, PyAny>>,
    threads: i64,
) -> PyResult<Bound<'py, PyAny>> {
    let solver = end.solver(py)?;
    let threads = usize::try_from(threads).map_err(|_| PyValueError::new_err(format!("threads: 0 or more, not {threads}")))?;
    if let (Some(pose), None, None, None, None) =
        (&target.pose, &target.position, &target.rotation, &redundancy, &solver.of().redundancy)
    {
        if let Some(pose) = entries(pose) {
            let found = solver.solve(&pose, None).expect("the arm has no redundancy");
            return Ok(Bound::new(py, Postures::new(end, found, &pose))?.into_any());
        }
    }
    let numpy = py.import("numpy")?;
    let part = |name, shape, given: &_| Part::new(&numpy, name, shape, given);
    let mut parts = match (&target.pose, &target.position, &target.rotation) {
        (Some(pose), None, None) => vec![part("pose", &[4, 4], pose)?],
        (None, Some(position), Some(rotation)) => vec![part("position", &[3], position)?, part("rotation", &[3, 3], rotation)?],
        (None, Some(position), None) if !solver.of().orientation => vec![part("position", &[3], position)?],
        (None, Some(_), None) => {
            return Err(PyTypeError::new_err(
                "rotation is missing: 3 x 3, beside position; where the target is `pointing` its third column counts",
            ))
        }
        (None, None, Some(_)) => return Err(PyTypeError::new_err("position is missing")),
        (None, None, None) => return Err(PyTypeError::new_err("a pose is missing, or its position and rotation")),
        _ => return Err(PyTypeError::new_err("a pose, or its position and rotation, not both")),
    };
    let targets = parts.len();
    match (redundancy, end.redundancy(py)?) {
        (Some(given), Some(_)) => parts.push(part("redundancy", &[], &given)?),
        (None, None) => {}
        (Some(_), None) => {
            return Err(PyValueError::new_err(
                "redundancy: the arm has no joint more than the target asks for, so nothing else is given",
            ))
        }
        (None, Some(name)) => {
            let what = match solver.of().redundancy {
                Some(Redundancy::Swivel) => "the swivel angle of the elbow, rad".to_owned(),
                _ => format!("the value of joint {name}"),
            };
            return Err(PyValueError::new_err(format!(
                "redundancy is missing: the arm has one joint more than the target asks for; give {what}"
            )));
        }
    }
    let lead = broadcast(&parts.iter().map(|part| (part.name, part.lead.as_slice())).collect::<Vec<_>>())?;
    let is_pose = target.pose.is_some();
    let held = parts.into_iter().map(|part| part.over(&numpy, &lead)).collect::<PyResult<Vec<_>>>()?;
    let slices = held.iter().map(|array| array.as_slice()).collect::<Result<Vec<_>, _>>()?;
    let (targets, redundancies) = slices.split_at(targets);
    let pose = |state: usize| -> [[f64; 4]; 4] {
        if is_pose {
            return std::array::from_fn(|row| std::array::from_fn(|column| targets[0][16 * state + 4 * row + column]));
        }
        let position = &targets[0][3 * state..];
        let rotation = targets.get(1).map(|all| &all[9 * state..]);
        let row = |row: usize| {
            let [x, y, z] = rotation.map_or(NO_TURN[row], |rotation| std::array::from_fn(|column| rotation[3 * row + column]));
            [x, y, z, position[row]]
        };
        [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
    };
    let solve = |state: usize| {
        let redundancy = redundancies.first().map(|all| all[state]);
        solver.solve(&pose(state), redundancy).expect("a redundancy where the arm has one")
    };
    let states = lead.iter().product();
    let mut found: Vec<Option<Found<f64>>> = Vec::new();
    found.try_reserve_exact(states).map_err(|_| pyo3::exceptions::PyMemoryError::new_err(format!("{states} poses")))?;
    found.resize(states, None);
    if states < MANY {
        found.iter_mut().enumerate().for_each(|(state, found)| *found = Some(solve(state)));
    } else {
        let works = Mutex::new(found.chunks_mut(MANY).enumerate());
        let next = || works.lock().unwrap_or_else(PoisonError::into_inner).next();
        let work = || {
            while let Some((chunk, found)) = next() {
                found.iter_mut().enumerate().for_each(|(place, found)| *found = Some(solve(MANY * chunk + place)));
            }
        };
        py.detach(|| on_threads(granted(threads).min(states.div_ceil(MANY)), work));
    }
    let named = |(state, found)| Postures::new(end, found, &pose(state));
    nested(py, &lead, &mut found.into_iter().flatten().enumerate().map(named))
}

/// The entries of a single pose that is an array of float64 by rows already.
fn entries(pose: &Bound<'_, PyAny>) -> Option<[[f64; 4]; 4]> {
    let pose: PyReadonlyArray2<'_, f64> = pose.extract().ok()?;
    if pose.shape() != [4, 4] || !pose.is_c_contiguous() {
        return None;
    }
    pose.as_slice().ok()?.as_chunks().0.try_into().ok()
}

/// Why a pose, or the redundancy beside it, has the verdict `Invalid`.
fn why_invalid(pose: &[[f64; 4]; 4]) -> String {
    if !pose.as_flattened().iter().all(|entry| entry.is_finite()) {
        return "an entry of the pose is not finite".to_owned();
    }
    let dot = |i: usize, j: usize| (0..3).map(|k| pose[i][k] * pose[j][k]).sum::<f64>();
    let off = |i: usize, j: usize| (dot(i, j) - if i == j { 1.0 } else { 0.0 }).abs();
    let largest = (0..9).map(|entry| off(entry / 3, entry % 3)).fold(0.0, f64::max);
    let minor = |a: usize, b: usize| pose[1][a] * pose[2][b] - pose[1][b] * pose[2][a];
    let determinant = pose[0][0] * minor(1, 2) + pose[0][1] * minor(2, 0) + pose[0][2] * minor(0, 1);
    match (determinant < 0.0, largest > 1e-7) {
        (true, _) => "the rotation is a reflection: its determinant is negative".to_owned(),
        (false, true) => {
            format!("the rotation R is not orthonormal: R R' differs from 1 by {largest:.1e}, and 1e-6 is the limit")
        }
        (false, false) => "the redundancy is not finite".to_owned(),
    }
}

/// Lists of lists by the axes of states; without axes the postures alone.
fn nested<'py>(py: Python<'py>, lead: &[usize], all: &mut impl Iterator<Item = Postures>) -> PyResult<Bound<'py, PyAny>> {
    let Some((&count, rest)) = lead.split_first() else {
        return Ok(Bound::new(py, all.next().expect("postures at each pose"))?.into_any());
    };
    let list = PyList::empty(py);
    for _ in 0..count {
        list.append(nested(py, rest, all)?)?;
    }
    Ok(list.into_any())
}

/// The redundancies of postures: a float of one, an array of several.
pub(crate) fn redundancy_of<'py>(py: Python<'py>, end: &Arc<EndEffector>, q: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
    let solver = end.solver(py)?;
    if solver.of().redundancy.is_none() {
        return Err(PyValueError::new_err("the arm has no joint more than the target asks for: it has no redundancy"));
    }
    let numpy = py.import("numpy")?;
    let dof = end.arm.dof();
    let q = array(&numpy, "q", dof, q)?;
    let lead = q.shape()[..q.ndim() - 1].to_vec();
    let held = q.try_readonly().map_err(|error| PyValueError::new_err(error.to_string()))?;
    let all: Vec<f64> = held.as_slice()?.chunks(dof).filter_map(|q| solver.redundancy(q)).collect();
    match lead.is_empty() {
        true => fresh(py, &[], &all),
        false => Ok(PyArray1::from_vec(py, all).reshape(lead)?.into_any()),
    }
}

/// All postures at a pose: joint variables q with direct_kinematics(q) = T, and what is known of them.
///
/// `len` is their number; iteration and indices give their joint variables. Attributes are new arrays at each access.
#[pyclass(frozen, module = "armgen")]
pub(crate) struct Postures {
    end: Arc<EndEffector>,
    found: Found<f64>,
    /// Why the pose is invalid.
    reason: Option<String>,
}

impl Postures {
    fn new(end: &Arc<EndEffector>, found: Found<f64>, pose: &[[f64; 4]; 4]) -> Postures {
        let reason = (found.verdict == Verdict::Invalid).then(|| why_invalid(pose));
        Postures { end: end.clone(), found, reason }
    }

    fn dof(&self) -> usize {
        self.end.arm.dof()
    }
}

#[pymethods]
impl Postures {
    /// Joint variables, a row for each posture: angles in (-pi, pi], rad, and lengths, m.
    #[getter]
    fn q<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        PyArray1::from_slice(py, &self.found.q).reshape([self.found.len(), self.dof()])
    }

    /// "complete": these are all; "unreachable": there is none; "near_double": rounding of the pose could change their number; "continuum": some
    /// joints can move while the end effector rests; "invalid": `reason` names what is wrong with the pose.
    #[getter]
    fn verdict(&self) -> &'static str {
        match self.found.verdict {
            Verdict::Complete => "complete",
            Verdict::Unreachable => "unreachable",
            Verdict::NearDouble => "near_double",
            Verdict::Continuum => "continuum",
            Verdict::Invalid => "invalid",
        }
    }

    /// Why the verdict is "invalid"; else None.
    #[getter]
    fn reason(&self) -> Option<&str> {
        self.reason.as_deref()
    }

    /// Of a pose without a posture a hint at how much is missing, m; else how far its rotation is from orthonormal, 0 within rounding.
    #[getter]
    fn miss(&self) -> f64 {
        self.found.miss
    }

    /// The number of the branch of each posture.
    #[getter]
    fn branch<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<i64>> {
        PyArray1::from_vec(py, self.found.branch.iter().map(|branch| i64::from(*branch)).collect())
    }

    /// Its name; empty where the construction has no branches.
    #[getter]
    fn branch_names<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyTuple>> {
        let names = &self.end.solver(py)?.of().branches;
        let name = |branch: &u16| names.get(usize::from(*branch)).map_or("", String::as_str);
        PyTuple::new(py, self.found.branch.iter().map(name))
    }

    /// Whether two postures meet at it, for each.
    #[getter]
    fn double<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<bool>> {
        PyArray1::from_slice(py, &self.found.double)
    }

    /// Whether the construction chose the value of a joint, since some joints can move while the end effector rests: a row for each posture.
    #[getter]
    fn free<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray2<bool>>> {
        let dof = self.dof();
        let all = self.found.free.iter().flat_map(|free| (0..dof).map(move |joint| free >> joint & 1 == 1));
        PyArray1::from_vec(py, all.collect()).reshape([self.found.len(), dof])
    }

    /// The postures within the position limits. Angles are moved by whole turns into them, by as few as possible, and joint variables that rounding
    /// moved beyond a limit are put at it. The verdict stays as it was.
    fn within_limits(&self, py: Python<'_>) -> PyResult<Postures> {
        let solver = self.end.solver(py)?;
        let found = solver.within(&self.found, |joint| self.end.position_limits(joint));
        Ok(Postures { end: self.end.clone(), found, reason: self.reason.clone() })
    }

    /// The joint variables whose largest difference from q is smallest, angles modulo whole turns; None if there is no posture.
    fn nearest_to<'py>(&self, py: Python<'py>, q: &Bound<'py, PyAny>) -> PyResult<Option<Bound<'py, PyArray1<f64>>>> {
        guarded(py, || {
            let (solver, dof) = (self.end.solver(py)?, self.dof());
            let q = array(&py.import("numpy")?, "q", dof, q)?;
            if q.ndim() != 1 {
                return Err(PyValueError::new_err(format!("q: the shape is {}, not {}", axes(q.shape()), axes(&[dof]))));
            }
            let held = q.try_readonly().map_err(|error| PyValueError::new_err(error.to_string()))?;
            let q = held.as_slice()?;
            if !q.iter().all(|q| q.is_finite()) {
                return Err(PyValueError::new_err("q: an entry is not finite"));
            }
            let nearest = solver.nearest(&self.found, q);
            Ok(nearest.map(|number| PyArray1::from_slice(py, &self.found.q[number * dof..][..dof])))
        })
    }

    fn __len__(&self) -> usize {
        self.found.len()
    }

    fn __getitem__<'py>(&self, py: Python<'py>, index: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyAny>> {
        self.q(py)?.get_item(index)
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        Ok(self.q(py)?.try_iter()?.into_any())
    }

    fn __repr__(&self) -> String {
        let postures = if self.found.len() == 1 { "posture" } else { "postures" };
        let reason = self.reason.as_ref().map_or(String::new(), |reason| format!(": {reason}"));
        let (name, count, verdict) = (&self.end.arm.name, self.found.len(), self.verdict());
        format!("<armgen.Postures of {name}: {count} {postures}, {verdict}{reason}>")
    }
}
