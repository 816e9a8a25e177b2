//! The native half of the Python package: descriptions, equations and numbers. `armgen/__init__.py` is the other half.
//!
//! ```text
//! robot.rs     from a text to an arm, and its facts
//! numbers.rs   functions over arrays of NumPy
//! postures.rs  all postures at a pose
//! texts.rs     what the program writes
//! faults.rs    diagnostics and panics as exceptions
//! ```
//!
//! The exceptions and the types of results that have several parts are classes of the other half, which a function here asks for by name.

mod faults;
mod numbers;
mod postures;
mod robot;
mod texts;

use std::ffi::OsString;

use armgen_codegen::catalogue;
use armgen_codegen::suggest::function_meant;
use pyo3::prelude::*;

/// Every function of the catalogue: name, title, arguments of arms with a fixed gravity, and the names of the parts of its result.
#[pyfunction]
fn catalogue_of_functions() -> Vec<(String, &'static str, Vec<&'static str>, Vec<&'static str>, usize)> {
    catalogue::functions()
        .map(|(quantity, with)| {
            let parts = quantity.result.iter().map(|part| part.name).collect();
            let dimensions = quantity.result[0].lengths.len();
            let arguments = quantity.arguments_of(with, false).map(|argument| argument.name()).collect();
            (quantity.function_name(with), quantity.documentation.title, arguments, parts, dimensions)
        })
        .collect()
}

/// The one of `words` that a name probably stands for.
#[pyfunction]
fn meant(name: &str, words: Vec<String>) -> Option<String> {
    function_meant(name, &words.iter().map(String::as_str).collect::<Vec<_>>()).map(str::to_owned)
}

/// Does what the arguments of the program ask for; the exit code.
#[pyfunction]
fn run(py: Python<'_>, arguments: Vec<OsString>) -> PyResult<u8> {
    faults::guarded(py, || Ok(py.detach(|| armgen_commands::run_with(arguments))))
}

/// Panics, for the test of what becomes of that.
#[pyfunction]
fn panic(py: Python<'_>) -> PyResult<()> {
    faults::guarded(py, || panic!("asked for"))
}

#[pymodule(gil_used = false)]
fn _native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_class::<robot::Arm>()?;
    module.add_class::<numbers::Function>()?;
    module.add_class::<postures::Postures>()?;
    module.add_function(wrap_pyfunction!(robot::read, module)?)?;
    module.add_function(wrap_pyfunction!(catalogue_of_functions, module)?)?;
    module.add_function(wrap_pyfunction!(meant, module)?)?;
    module.add_function(wrap_pyfunction!(run, module)?)?;
    module.add_function(wrap_pyfunction!(panic, module)?)?;
    module.add("VERSION", env!("CARGO_PKG_VERSION"))
}
