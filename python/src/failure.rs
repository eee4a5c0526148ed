//! Errors of the libraries as Python exceptions, with the texts of the command line.

use peelnet::Failure;
use pyo3::{exceptions::PyValueError, prelude::*};
use std::ffi::CString;

pyo3::create_exception!(
    peelnet,
    PeelnetError,
    pyo3::exceptions::PyException,
    "What the command line reports with exit code 1: a file that cannot be read, an adapter that is lost, ….\n\n\
     The text is that of the command line, one line, with control characters escaped. Wrong values raise\n\
     ValueError instead, which the command line reports with exit code 2."
);

pub fn wrong(text: impl Into<String>) -> PyErr {
    raised(Failure::wrong(text))
}

pub fn failed(text: impl Into<String>) -> PyErr {
    raised(Failure::failed(text))
}

/// An error of a library. After a lost adapter the next call opens it anew.
pub fn raised(error: impl Into<Failure>) -> PyErr {
    let failure = error.into();
    if failure.is_gpu_lost {
        crate::gpu::forget();
    }
    // On one line, without what could move a terminal's cursor.
    let text = peelnet_core::files::printable_lines(&failure.text).into_owned();
    if failure.is_wrong_value {
        PyValueError::new_err(text)
    } else {
        PeelnetError::new_err(text)
    }
}

/// A warning, as the command line prints it to stderr; an error where Python was asked to turn warnings into errors.
pub fn warn(py: Python<'_>, text: &str) -> PyResult<()> {
    let text = peelnet_core::files::printable_lines(text);
    let text = CString::new(text.replace('\0', " "))?;
    let category = py.get_type::<pyo3::exceptions::PyUserWarning>();
    PyErr::warn(py, &category, &text, 1)
}
