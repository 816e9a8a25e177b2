//! Diagnostics and panics as exceptions of Python.

use std::panic::{catch_unwind, AssertUnwindSafe};

use armgen_codegen::diagnostic::{Colour, Diagnostic, Diagnostics};
use armgen_codegen::source::Source;
use pyo3::prelude::*;
use pyo3::types::PyTuple;

/// Does a work that may panic, which becomes an exception: no fault of armgen ends the process.
pub(crate) fn guarded<T>(py: Python<'_>, work: impl FnOnce() -> PyResult<T>) -> PyResult<T> {
    catch_unwind(AssertUnwindSafe(work)).unwrap_or_else(|panic| {
        let said = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
        Err(named(py, "InternalError", (said.unwrap_or("it gives no reason"),)))
    })
}

/// An exception of the package.
pub(crate) fn named<'py>(py: Python<'py>, class: &str, arguments: impl pyo3::call::PyCallArgs<'py>) -> PyErr {
    let error = || py.import("armgen")?.getattr(class)?.call1(arguments);
    match error() {
        Ok(error) => PyErr::from_value(error),
        Err(error) => error,
    }
}

/// Why a text is no arm.
pub(crate) fn refused(py: Python<'_>, source: &Source, diagnostics: &Diagnostics) -> PyErr {
    match listed(py, source, diagnostics) {
        Ok(list) => {
            let text = diagnostics.render(source, Colour::Never);
            named(py, "DescriptionError", (text.trim_end(), list, source.text()))
        }
        Err(error) => error,
    }
}

/// The same of one diagnostic.
pub(crate) fn refused_for(py: Python<'_>, source: &Source, diagnostic: Diagnostic) -> PyErr {
    let mut diagnostics = Diagnostics::new();
    diagnostics.push(diagnostic);
    refused(py, source, &diagnostics)
}

/// Diagnostics as a tuple of `armgen.Diagnostic`.
pub(crate) fn listed<'py>(py: Python<'py>, source: &Source, diagnostics: &Diagnostics) -> PyResult<Bound<'py, PyTuple>> {
    let module = py.import("armgen")?;
    let (class, label_class) = (module.getattr("Diagnostic")?, module.getattr("Label")?);
    let mut all = Vec::new();
    for diagnostic in diagnostics.iter() {
        let mut labels = Vec::new();
        for label in &diagnostic.labels {
            let (start, end) = (source.place(label.span.start), source.place(label.span.end));
            labels.push(label_class.call1((&label.text, start.line, start.column, end.line, end.column))?);
        }
        let span = diagnostic.span();
        let (start, end) = (source.place(span.start), source.place(span.end));
        all.push(class.call1((
            diagnostic.code.name(),
            diagnostic.code.severity().name(),
            &diagnostic.message,
            &diagnostic.help,
            start.line,
            start.column,
            end.line,
            end.column,
            PyTuple::new(py, labels)?,
            source.name(),
        ))?);
    }
    PyTuple::new(py, all)
}
